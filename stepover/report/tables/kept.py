"""The limits that a plan must keep at every sample, beside the values that it reaches."""

from __future__ import annotations

import numpy as np

from stepover.analysis.key_posture import knees_from_straight
from stepover.analysis.stages import after_adaptation, postures
from stepover.model.parameters.planning import samples
from stepover.model.robot import Robot
from stepover.model.self_collision import self_clearance
from stepover.planning.algorithm_1.plan import Plan
from stepover.planning.measures import measure
from stepover.report.tables.table import Table, table


def kept_table(robot: Robot, planned: Plan) -> Table:
    """Quantities of a plan: the limit, the value here, and whether the limit is kept."""
    motion, found = planned.motion, measure(robot, planned.motion)
    _, short = postures(robot, after_adaptation(planned), slice(None))
    knee = float(knees_from_straight(robot, motion.q).min())
    placements, every = robot.body.placements(motion.q), samples(robot.checks.self_look_every, motion.dt)
    own, one, other, _ = self_clearance(robot.own_pairs, placements, every)
    apart = float((motion.left_foot - motion.right_foot)[:, 1].min())
    zmp, joint = max(found.zmp_rms), np.degrees(found.joint_margin_min)
    rows = [
        ("clearance of all links [mm]", ">= 30", f"{1e3 * found.clearance_min:.1f}", found.clearance_min >= 0.03),
        ("soles out of reach [mm]", "0", f"{1e3 * short.max():.1f}", short.max() == 0.0),
        ("knees from straight [deg]", ">= 5", f"{knee:.1f}", knee > 5.0 - 1e-6),
        ("nearest joint limit [deg]", ">= 0", f"{joint:.1f} ({found.joint_margin_joint})", joint >= 0.0),
        ("ZMP inside the support [mm]", ">= 15", f"{1e3 * found.zmp_margin_min:.1f}", found.zmp_margin_min >= 0.015),
        ("ZMP off its reference, rms [mm]", "<= 4", f"{1e3 * zmp:.1f}", zmp <= 0.004),
        ("between own links [mm]", "> 0", f"{1e3 * own:.0f} ({one}, {other})", own > 0.0),
        ("between the feet, across [mm]", "> 0", f"{1e3 * apart:.0f}", apart > 0.0),
        ("fastest joint, over its limit", "ignored",
         f"{found.joint_speed_ratio_max:.2f} ({found.joint_speed_joint})", True),
    ]  # fmt: skip
    return table("quantity | limit | here | kept", [(*row, "yes" if kept else "no") for *row, kept in rows])
