"""Sweep over many obstacles: each is planned and, on request, simulated. Each gives one row of a table.

`python -m stepover sweep` writes a table for any obstacles. obstacle_plane.py defines the obstacles of the stored
table. study.py explains how a sweep is interrupted and continued, and parallel.py where the work is done.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from stepover import __version__
from stepover.errors import Infeasible
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.planning.algorithm_1.plan import Plan
from stepover.planning.algorithm_1.planner import plan_in_detail
from stepover.planning.measures import measure
from stepover.planning.planner import find_planner
from stepover.simulation.engine import DEFAULT
from stepover.studies.study import Row, make_table, read_rows, robot_of, rounded


@dataclass(frozen=True)
class Point:
    """One obstacle of a sweep.

    Attributes:
        height, width: size of the bare obstacle [m].
        robot: name of the robot, or the path of its robot.toml.
        physics: whether planned motions are simulated.
        margin_height, margin_width: safety margins [m].
        arms, speed_limits: as for plan.
        planner: name of the planner, as in planning.planner.
        engine: of the physics.
    """

    height: float
    width: float
    robot: str = "hrp2"
    physics: bool = True
    margin_height: float = 0.03
    margin_width: float = 0.03
    arms: str = "auto"
    speed_limits: str = "ignore"
    planner: str = "paper"
    engine: str = DEFAULT

    @property
    def obstacle(self) -> Obstacle:
        """The obstacle for the planner. Raises InvalidInput for impossible sizes."""
        return Obstacle(self.height, self.width, self.margin_height, self.margin_width)


@dataclass(frozen=True, kw_only=True)
class Crossing:
    """The result for one obstacle: a row of the table. Missing values are None.

    Attributes:
        robot, version: robot, and version of stepover.
        height, width, margin_height, margin_width: sizes of the obstacle [m].
        arms, speed_limits: as for plan.
        planned: whether there is a plan.
        beyond_paper_level: level of the methods beyond the paper that the plan uses.
        arm_swing_deg: swing of the arms by UBMG [deg].
        foot_back, waist_raised, ankle_pushed: adaptation by FTA's methods (1), (2), (3) [m].
        x_ads, x_hds, z_hds: key configuration [m].
        planned_clearance: smallest distance from the bare obstacle [m].
        zmp_margin: smallest distance of the ZMP from the edge of the support polygon [m].
        joint_speed_ratio: largest joint speed over its limit.
        motion: hash of the motion.
        engine: of the physics; None if nothing was simulated.
        crossed: whether the simulated robot crossed.
        simulated_clearance: smallest distance in the physics [m].
        reason: why there is no plan, or why the robot did not cross.
        planner: name of the planner.
    """

    robot: str
    version: str
    height: float
    width: float
    margin_height: float
    margin_width: float
    arms: str = "auto"
    speed_limits: str = "ignore"
    planned: bool
    beyond_paper_level: int | None = None
    arm_swing_deg: float | None = None
    foot_back: float | None = None
    waist_raised: float | None = None
    ankle_pushed: float | None = None
    x_ads: float | None = None
    x_hds: float | None = None
    z_hds: float | None = None
    planned_clearance: float | None = None
    zmp_margin: float | None = None
    joint_speed_ratio: float | None = None
    motion: str | None = None
    engine: str | None = None
    crossed: bool | None = None
    simulated_clearance: float | None = None
    reason: str = ""
    planner: str = "paper"


def cross(point: Point) -> Row:
    """Plan for one obstacle and, if there is a plan, simulate it: a row for run_study."""
    robot = robot_of(point.robot)
    row = Crossing(
        robot=robot.name, version=__version__, height=point.height, width=point.width,
        margin_height=point.margin_height, margin_width=point.margin_width, arms=point.arms,
        speed_limits=point.speed_limits, planned=False, planner=point.planner,
    )  # fmt: skip
    try:
        if point.planner == "paper":
            found = plan_in_detail(
                robot, point.obstacle, arms=point.arms, speed_limits=point.speed_limits, look_for_nearest=False
            )
            row, motion = _adapted(row, found), found.motion
        else:
            motion = find_planner(point.planner)(robot, point.obstacle)
    except Infeasible as error:
        return dataclasses.asdict(dataclasses.replace(row, reason=error.constraint))
    row = _planned(row, robot, motion)
    if point.physics:
        from stepover.simulation.run import simulate  # imported here, since planning alone needs no physics

        run = simulate(motion, robot=robot, engine=point.engine)
        row = dataclasses.replace(
            row, engine=point.engine, crossed=run.crossed, simulated_clearance=rounded(run.clearance_min),
            reason=run.explanation,
        )  # fmt: skip
    return dataclasses.asdict(row)


def _adapted(row: Crossing, found: Plan) -> Crossing:
    """A row with what Algorithm 1 chose and adapted."""
    feet = found.adaptation
    return dataclasses.replace(
        row, beyond_paper_level=found.options.level,
        arm_swing_deg=rounded(np.degrees(found.nominal.upper.arm_swing), 2), foot_back=rounded(feet.shift),
        waist_raised=rounded(feet.raised), ankle_pushed=rounded(feet.pushed), x_ads=rounded(found.key.x_ads),
        x_hds=rounded(found.key.x_hds), z_hds=rounded(found.key.z_hds),
    )  # fmt: skip


def _planned(row: Crossing, robot: Robot, motion: Motion) -> Crossing:
    """A row with the measures of a motion."""
    measured = measure(robot, motion)
    return dataclasses.replace(
        row, planned=True, planned_clearance=rounded(measured.clearance_min),
        zmp_margin=rounded(measured.zmp_margin_min), joint_speed_ratio=rounded(measured.joint_speed_ratio_max, 3),
        motion=motion.hash(),
    )  # fmt: skip


def sweep(points: Sequence[Point], table: Path, workers: int | str | None = None) -> list[Crossing]:
    """Run or resume a sweep and write its table. The part file lies beside the table.

    Args:
        points: obstacles, all for one robot.
        table: path of the table.
        workers: number of processes, or the address of a Dask scheduler; see parallel.computed.

    Returns:
        The rows of the table.

    Raises:
        InvalidInput: an impossible obstacle, an unknown robot, or a cluster that cannot do the work.
    """
    robot_of(points[0].robot)
    for point in points:
        _ = point.obstacle
    make_table(table.stem, points, cross, Crossing, table, table.parent, workers)
    return read_rows(Crossing, table)


def summary(rows: Sequence[Crossing]) -> dict[str, Any]:
    """The values that `sweep --json` prints, in SI units; None if nothing was planned or simulated."""
    planned, simulated = [row for row in rows if row.planned], [row for row in rows if row.crossed is not None]
    first = rows[0]
    return {
        "robot": first.robot, "margin_height": first.margin_height, "margin_width": first.margin_width,
        "arms": first.arms, "speed_limits": first.speed_limits,
        "engine": simulated[0].engine if simulated else None, "obstacles": len(rows), "planned": len(planned),
        "refused": len(rows) - len(planned), "simulated": len(simulated),
        "crossed": sum(bool(row.crossed) for row in simulated) if simulated else None,
        "highest_planned": max((row.height for row in planned), default=None),
        "widest_planned": max((row.width for row in planned), default=None),
        "planned_clearance_min": _smallest(row.planned_clearance for row in planned),
        "zmp_margin_min": _smallest(row.zmp_margin for row in planned),
        "simulated_clearance_min": _smallest(row.simulated_clearance for row in simulated),
    }  # fmt: skip


def _smallest(values: Iterable[float | None]) -> float | None:
    """The smallest of some values; None if there are none."""
    return min((value for value in values if value is not None), default=None)


def summary_lines(result: dict[str, Any]) -> list[tuple[str, str]]:
    """The same summary as names and values, for printing."""
    lines = [
        ("robot", result["robot"]),
        ("margins", f"{result['margin_height']:.3f} m above, {result['margin_width']:.3f} m before and behind"),
        ("planned", f"{result['planned']} of {result['obstacles']} obstacles"),
    ]
    if result["planned"]:
        lines += [
            ("highest, widest planned", f"{result['highest_planned']:.3f} m, {result['widest_planned']:.3f} m"),
            ("clearance", f"{1e3 * result['planned_clearance_min']:.1f} mm at least"),
            ("ZMP to support's edge", f"{1e3 * result['zmp_margin_min']:.1f} mm at least"),
        ]
    if result["simulated"]:
        lines += [
            ("crossed in the physics", f"{result['crossed']} of {result['simulated']}, engine {result['engine']}"),
            ("clearance in the physics", f"{1e3 * result['simulated_clearance_min']:.1f} mm at least"),
        ]
    return lines
