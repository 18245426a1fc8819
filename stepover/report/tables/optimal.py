"""The tables of the optimising planner: both planners compared, what it crosses, and how robust its motions are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from stepover.analysis.key_posture import knees_from_straight
from stepover.model.robot import Robot
from stepover.model.self_collision import self_clearance
from stepover.motion.footsteps import LEG_1, LEG_2
from stepover.motion.motion import Motion
from stepover.planning.measures import measure
from stepover.planning.optimal.channels import euler
from stepover.planning.optimal.constraints.own_links import thigh_pairs
from stepover.planning.optimal.planner import EVERY
from stepover.planning.optimal.torques import largest_torque
from stepover.report.tables.table import Table, table
from stepover.studies.optimal.disturbed import CASES, Disturbed
from stepover.studies.optimal.frontier import Found
from stepover.studies.success_rates import rate

NAMES = {"paper": "Algorithm 1", "optimal": "optimiser"}


def planners_table(robot: Robot, motions: Mapping[str, Motion]) -> Table:
    """What each motion takes of the limits."""
    pairs, lines = [*thigh_pairs(robot), *robot.own_pairs], []
    for name, motion in motions.items():
        found, torque = measure(robot, motion), largest_torque(robot, motion)
        apart, one, other, _ = self_clearance(pairs, robot.body.placements(motion.q), EVERY)
        lines.append((
            name, f"{1e3 * found.clearance_min:.1f}", f"{1e3 * found.zmp_margin_min:.1f}",
            f"{found.joint_speed_ratio_max:.2f} ({found.joint_speed_joint})", f"{torque.ratio:.2f} ({torque.joint})",
            f"{1e3 * apart:.1f} ({one}, {other})",
        ))  # fmt: skip
    return table(
        "motion | clearance [mm] | ZMP margin [mm] | speed over limit | torque over limit | own links apart [mm]", lines
    )


def moves_table(robot: Robot, motions: Mapping[str, Motion]) -> Table:
    """How each motion goes over the obstacle: waist, swinging feet, and the lead knee as it lands."""
    lines = []
    for name, motion in motions.items():
        over = slice(motion.samples(1).start, motion.samples(3).stop)
        turns = np.degrees(np.abs(euler(motion.waist[over])[:, 3:])).max(axis=0)
        aside = []
        for phase, kind in ((1, LEG_1), (3, LEG_2)):
            path = motion.foot(int(motion.footsteps.of_kind(kind).side[0]))[motion.samples(phase), 1]
            aside.append(1e3 * float(np.abs(path - np.linspace(path[0], path[-1], len(path))).max()))
        knees = knees_from_straight(robot, motion.q[motion.samples(1).stop])
        lines.append((name, *(f"{turn:.0f}" for turn in turns), *(f"{one:.0f}" for one in aside), f"{knees.min():.0f}"))
    return table(
        "motion | waist's yaw [deg] | pitch [deg] | roll [deg] | leg 1 aside [mm] | leg 2 aside [mm] "
        "| straighter knee as leg 1 lands, from straight [deg]", lines,
    )  # fmt: skip


def frontier_table(rows: Sequence[Found]) -> Table:
    """The chosen obstacles: plan, and clearances in PyBullet and in MuJoCo."""
    lines = []
    for row in rows:
        size = f"{1e2 * row.height:g} x {1e2 * row.width:g}"
        if row.group not in ("corner", "higher"):
            continue
        if not row.planned:
            lines.append((size, "refused", "", "", "", "", "", row.reason))
            continue
        lines.append((
            size, _mm(row.clearance), _mm(row.zmp_margin), _mm(row.own_links), str(row.iterations),
            f"{_mm(row.pybullet_ideal)}, {_mm(row.mujoco_ideal)}", f"{_mm(row.pybullet_real)}, {_mm(row.mujoco_real)}",
            f"{_share(row.pybullet_saturated, row)}, {_share(row.mujoco_saturated, row)} %",
        ))  # fmt: skip
    return table(
        "height x width [cm] | clearance [mm] | ZMP margin [mm] | own links [mm] | iterations | ideal [mm] "
        "| real [mm] | saturated",
        lines,
    )


def random_table(rows: Sequence[Found]) -> Table:
    """The random obstacles, summed up."""
    some = [row for row in rows if row.group == "random"]
    planned = [row for row in some if row.planned]

    def least(name: str) -> str:
        return _mm(min(getattr(row, name) for row in planned))

    crossed = sum((row.mujoco_ideal or -1.0) > 0.0 and (row.mujoco_real or -1.0) > 0.0 for row in planned)
    most = max(planned, key=lambda row: row.mujoco_saturated or 0)
    return table(
        "random obstacles | planned | cross with ideal and real motors | least clearance, ideal [mm] | real [mm] "
        "| most saturated",
        [
            (
                len(some),
                len(planned),
                crossed,
                least("mujoco_ideal"),
                least("mujoco_real"),
                f"{_share(most.mujoco_saturated, most)} %",
            )
        ],
    )


def disturbed_table(rows: Sequence[Disturbed]) -> Table:
    """Success under disturbances, with real motors and the stabilizer."""
    lines = []
    for planner, height in CASES:
        some = [row for row in rows if (row.planner, row.height) == (planner, height)]
        found = rate(some)
        low, high = found.interval
        lines.append((
            f"{NAMES[planner]}, {1e2 * height:g} cm", f"{found.good} of {found.of}",
            f"{1e2 * low:.0f} to {1e2 * high:.0f} %", _mm(min(row.clearance for row in some)),
        ))  # fmt: skip
    return table("motion | crossed | Wilson interval, 95 % | nearest to the obstacle [mm]", lines)


def _mm(value: float | None) -> str:
    """A length in mm."""
    return "-" if value is None else f"{1e3 * value:.1f}"


def _share(samples: int | None, row: Found) -> str:
    """How many of a motion's samples, in percent."""
    return "-" if samples is None or row.samples is None else f"{1e2 * samples / row.samples:.1f}"
