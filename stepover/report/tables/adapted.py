"""The tables of the notebook on 25 cm: what UBMG and FTA do to a plan, and the claims on it. Sec. III-D, III-E, IV."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stepover.analysis import limits, stages
from stepover.analysis.outline import depth_of_parts
from stepover.analysis.stages import Stage
from stepover.analysis.upper_body import chest_and_arms
from stepover.model.robot import Robot
from stepover.motion.footsteps import LEG_2
from stepover.planning.algorithm_1.feasibility import KeyConfiguration
from stepover.planning.algorithm_1.feet_trajectories import swing_shape
from stepover.planning.algorithm_1.plan import Plan
from stepover.planning.measures import measure
from stepover.report.tables.table import Table, table


def lead_table(robot: Robot, lead: Sequence[Stage]) -> Table:
    """The lead knee before landing, and how far the waist is ahead of the first stage, stage by stage."""
    rows = []
    for stage in lead:
        angle, missing = stages.before_landing(robot, stage)
        shown = f"{angle:.1f}" if missing == 0.0 else f"over-stretched, {1e3 * missing:.1f} mm short"
        rows.append((stage.name, shown, 1e3 * stages.waist_ahead(stage, lead[0])))
    return table(
        "stage | lead knee before landing, from straight [deg] | waist ahead of the first stage, at most [mm]", rows
    )


def units_table(planned: Plan) -> Table:
    """What UBMG and FTA did."""
    ubmg, fta = planned.nominal.upper, planned.adaptation
    change = -1e3 * ubmg.zmp_change[:, 0]
    rows = [
        ("UBMG: arms back [deg]", float(np.degrees(ubmg.arm_swing))),
        ("UBMG: waist ahead by [mm]", 1e3 * float(np.abs(ubmg.waist_shift[:, 0]).max())),
        ("UBMG: p_ref2, least and largest [mm]", f"{change.min():.1f}, {change.max():.1f}"),
        ("FTA: leg, from, to [s]", f"{'leg 2' if fta.acted else None}, {fta.start:.2f}, {fta.end:.2f}"),
        ("FTA (1): foot back by [mm]", 1e3 * fta.shift),
        ("FTA (2): waist raised by [mm]", 1e3 * fta.raised),
        ("FTA (3): ankle pushed by [mm]", 1e3 * fta.pushed),
        ("passes of the dynamic filter", planned.filter_passes),
        ("level of what is beyond the paper", planned.options.level),
    ]
    return table("unit | what it did", rows)


def swings_table(robot: Robot, plans: Sequence[Plan]) -> Table:
    """Plans with additions beyond the paper and without: when leg 1 comes down, and what it costs."""
    rows = []
    for plan in plans:
        kept, shape = measure(robot, plan.motion), swing_shape(robot, plan.options.late, leg_2_late=False)
        name = "with additions" if plan.options.level else "the paper's methods alone"
        arms, zmp = np.degrees(plan.nominal.upper.arm_swing), 1e3 * kept.zmp_margin_min
        rows.append((name, shape.leg1_descent, arms, zmp, kept.joint_speed_ratio_max, limits.landing_speed(plan)))
    what = "plan | leg 1 is above its foothold at | arms back [deg] | ZMP to the edge [mm] | joint speed, of the limit"
    return table(f"{what} | descent at 10 mm [m/s]", rows)


def units_claims(robot: Robot, planned: Plan, first: KeyConfiguration) -> list[tuple[str, float | str, str]]:
    """The claims on arms, chest and FTA: id, measured value, and what it depends on.

    Args:
        robot: the robot.
        planned: the plan.
        first: FU's first key configuration over the same obstacle.
    """
    obstacle, fta, leg_2 = planned.nominal.crossing.obstacle, planned.adaptation, planned.sequence.step(LEG_2)
    plain, before = stages.lead_leg_stages(planned)[0], stages.before_feet_adaptor(robot, planned)
    after = stages.after_adaptation(planned)
    by_shape, by_fta = 1e3 * np.diff([stages.lift(stage, LEG_2) for stage in (plain, before, after)])
    longer = (after.feet.foot(leg_2.side) - before.feet.foot(leg_2.side))[leg_2.touch_down, 0]
    refused = stages.contribution(robot, obstacle, first, planned.options).reason or "it plans"
    length, more = leg_2.end[0] - leg_2.start[0], 1e3 * (planned.key.x_ads - first.x_ads)
    angles, _ = stages.postures(robot, before, before.swing(LEG_2))
    margins = obstacle.profile(before.sequence.front_face, margins=True)
    deep = depth_of_parts(robot, robot.body.placements(angles), leg_2.side, margins)
    chest, arms = (1e3 * shift for shift in chest_and_arms(robot))
    return [
        ("chest-for-arms", chest / arms, f"the CoM goes back by {chest:.1f} mm with the chest at its limit, by "
                                         f"{arms:.1f} mm with the arms back"),
        ("fta-25", "leg 2" if fta.acted else "inactive",
         f"foot {1e3 * fta.shift:.0f} mm back, waist {1e3 * fta.raised:.0f} mm up"),
        ("fta-lift", by_fta, "methods (1) and (2) do not lift the foot, (3) is not needed; FTG lifts it from the "
                             f"start; the waist rises; additions beyond the paper: {by_shape:.1f} mm"),
        ("fta-step", 1e3 * longer, "FTA keeps the footholds; the key configuration in use has a step "
                                   f"{more:.0f} mm longer than FU's first, with which {refused}"),
        ("small-corrections", fta.shift / length, f"{1e3 * fta.shift:.0f} of {1e3 * length:.0f} mm"),
        ("knee-intersects", 1e3 * deep["knee"], f"the shank below it, {1e3 * deep['shank']:.0f} mm"),
    ]  # fmt: skip
