"""The crossing before it was adapted, and what each unit of Algorithm 1 buys. Sec. III-D, III-E and IV, Figs. 5, 7.

"Before" means: the feet as FTG made them and the waist of CWTG1, with the ZMP reference under the ankles and the
arms at rest, for the key configuration of the finished plan. Nothing is clamped in silence: where a sole is out of
reach, knee angles are NaN and the distance that is missing is kept beside them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stepover.analysis.key_posture import knees_from_straight
from stepover.errors import Infeasible
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.planning.algorithm_1.adaptor_ways import raise_waist
from stepover.planning.algorithm_1.beyond_paper import extra_shape, extra_zmp, waist_delay
from stepover.planning.algorithm_1.com_waist import ComWaist, com_and_waist
from stepover.planning.algorithm_1.dynamic_filter import filtered_waist
from stepover.planning.algorithm_1.feasibility import KeyConfiguration
from stepover.planning.algorithm_1.feet_adaptor import METHODS, adapt_feet
from stepover.planning.algorithm_1.feet_trajectories import FeetTrajectories, feet_trajectories
from stepover.planning.algorithm_1.planned import Effort, Plan
from stepover.planning.algorithm_1.planner import algorithm_1, whole_body
from stepover.planning.algorithm_1.step_sequence import LEG_1, LEG_2, StepSequence, step_sequence
from stepover.planning.algorithm_1.upper_body import moved, upper_body
from stepover.planning.leg_check import check_legs


@dataclass(frozen=True, eq=False)
class Stage:
    """Waist and feet at some stage of Algorithm 1.

    Attributes:
        name: of the stage.
        sequence: the steps.
        waist: (N, 7) poses.
        feet: trajectories of the feet.
    """

    name: str
    sequence: StepSequence
    waist: np.ndarray
    feet: FeetTrajectories

    def swing(self, kind: int) -> slice:
        """Samples from lift-off to touch-down of leg 1 or leg 2."""
        step = self.sequence.step(kind)
        return slice(step.lift_off, step.touch_down + 1)


@dataclass(frozen=True)
class Bought:
    """What a combination of units comes to in phase 3.

    Attributes:
        units: which units.
        clearance: smallest distance of the legs from the bare obstacle in phase 3 [m], negative inside.
        free: the same from the obstacle with its margins [m], as FTA judges it.
        lead_knee: smallest angle of the lead knee from straight before it lands [deg], NaN where out of reach.
        missing: how far the soles are out of reach in phases 1 and 3 [m], 0 where none is.
        reason: why Algorithm 1 refuses it; empty where it plans.
    """

    units: str
    clearance: float
    free: float
    lead_knee: float
    missing: float
    reason: str


COMBINATIONS = (
    ("none", "off", (), 0),
    ("(1)", "off", (1,), 0),
    ("(2)", "off", (2,), 0),
    ("(1), (2)", "off", (1, 2), 0),
    ("(1), (2), (3)", "off", METHODS, 0),
    ("FTA, UBMG", "auto", METHODS, 0),
    ("FTA, UBMG, beyond the paper", "auto", METHODS, 1),
)
"""Name, arms, methods of FTA, and 1 where what is added beyond the paper may be used."""


def first_stage(robot: Robot, obstacle: Obstacle, key: KeyConfiguration, level: int) -> tuple[Stage, ComWaist]:
    """Steps 2 and 3 of Algorithm 1 alone: feet of FTG, waist of CWTG1; level as in Effort."""
    sequence = extra_zmp(robot, step_sequence(robot, obstacle, key, robot.rest_zmp()), level)
    feet = feet_trajectories(robot, obstacle, sequence, extra_shape(robot, level))
    first = com_and_waist(robot, sequence, key, waist_delay(robot, level))
    return Stage("CWTG1", sequence, first.waist, feet), first


def lead_leg_stages(robot: Robot, obstacle: Obstacle, planned: Plan) -> list[Stage]:
    """How the waist comes ahead before leg 1 lands: what each of the units adds, for the plan's key configuration."""
    plain, first = first_stage(robot, obstacle, planned.key, 0)
    arms = upper_body(robot, plain.sequence, plain.feet, first, "on")
    result = [
        Stage("before adaptation", plain.sequence, plain.waist, plain.feet),
        Stage("with the arms as far back as they may go", plain.sequence, moved(plain.waist, arms.waist_shift),
              plain.feet),
    ]  # fmt: skip
    if planned.effort.level:
        result.append(Stage("ZMP inside the soles, arms at rest", planned.sequence, planned.first_stage.waist,
                            planned.feet))  # fmt: skip
    return [*result, after_adaptation(planned)]


def before_feet_adaptor(robot: Robot, planned: Plan) -> Stage:
    """What FTA was given: the feet of FTG, and the plan's waist without the rise of method (2)."""
    waist = raise_waist(robot, planned.sequence, planned.motion.waist, -planned.adaptation.raised)
    return Stage("before adaptation", planned.sequence, waist, planned.feet)


def after_adaptation(planned: Plan) -> Stage:
    """The finished plan."""
    motion = planned.motion
    feet = FeetTrajectories(motion.left_foot, motion.right_foot)
    return Stage("after adaptation", planned.sequence, motion.waist, feet)


def postures(robot: Robot, stage: Stage, samples: slice) -> tuple[np.ndarray, np.ndarray]:
    """Configurations (n, nq) at some samples, arms at rest, and how far the soles are out of reach (n, 2) [m].

    The legs are straight where a sole is out of reach; the columns of reach are left and right.
    """
    waist = stage.waist[samples]
    q = np.tile(robot.half_sitting(), (len(waist), 1))
    q[:, :7] = waist
    missing = np.zeros((len(waist), 2))
    for column, side in enumerate((1, -1)):
        leg = robot.leg(side)
        q[:, leg.columns], missing[:, column] = leg.attempt(waist, stage.feet.foot(side)[samples])
    return q, missing


def lead_knee(robot: Robot, stage: Stage) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The lead knee over phase 1: time (n,) [s], angle from straight (n,) [deg] or NaN, sole out of reach (n,) [m]."""
    step = stage.sequence.step(LEG_1)
    over = stage.swing(LEG_1)
    q, missing = postures(robot, stage, over)
    knee = next(k for k, name in enumerate(robot.legs.knee) if name in robot.leg(step.side).joints)
    beyond = missing[:, 0 if step.side > 0 else 1]
    return stage.sequence.time[over], np.where(beyond > 0.0, np.nan, knees_from_straight(robot, q)[:, knee]), beyond


def before_landing(robot: Robot, stage: Stage) -> tuple[float, float]:
    """The lead knee in the second half of phase 1: least angle from straight [deg] or NaN, out of reach [m]."""
    _, angle, beyond = lead_knee(robot, stage)
    half = len(angle) // 2
    return float(angle[half:].min()), float(beyond[half:].max())


def waist_ahead(stage: Stage, other: Stage) -> float:
    """Largest lead of one stage's waist over another's in phase 1, x [m]."""
    over = stage.swing(LEG_1)
    return float((stage.waist[over, 0] - other.waist[over, 0]).max())


def lift(stage: Stage, kind: int) -> float:
    """Highest point of a sole frame in its swing over the obstacle [m]."""
    return float(stage.feet.foot(stage.sequence.step(kind).side)[stage.swing(kind), 2].max())


def bought(robot: Robot, obstacle: Obstacle, key: KeyConfiguration, level: int) -> list[Bought]:
    """What the combinations of units come to, all for one key configuration.

    Args:
        robot: the robot.
        obstacle: the obstacle.
        key: key configuration.
        level: of what is added beyond the paper, for the last combination.
    """
    return [
        bought_by(robot, obstacle, key, Effort(arms, methods, beyond * level), units)
        for units, arms, methods, beyond in COMBINATIONS
    ]


def bought_by(robot: Robot, obstacle: Obstacle, key: KeyConfiguration, effort: Effort, units: str = "") -> Bought:
    """One combination: the plan where there is one, else as far as its units come."""
    reason = ""
    try:
        stage = after_adaptation(algorithm_1(robot, obstacle, key, effort))
    except Infeasible as error:
        reason, stage = str(error), as_far_as_it_goes(robot, obstacle, key, effort)
    third = stage.swing(LEG_2)
    soles = stage.feet.left[third], stage.feet.right[third]
    check, free = (
        check_legs(robot, stage.waist[third], *soles, obstacle.profile(stage.sequence.front_face, margins), 0.0)
        for margins in (False, True)
    )
    knee, beyond = before_landing(robot, stage)
    missing = max(beyond, float(check.reach.max()))
    return Bought(units, float(check.separation.min()), float(free.separation.min()), knee, missing, reason)


def as_far_as_it_goes(robot: Robot, obstacle: Obstacle, key: KeyConfiguration, effort: Effort) -> Stage:
    """One pass through the units of an effort, for what Algorithm 1 refuses to plan.

    The filter is left out where a sole is out of reach: it may not see a posture that over-reaches.
    """
    stage, first = first_stage(robot, obstacle, key, effort.level)
    sequence, ftg = stage.sequence, stage.feet
    upper = upper_body(robot, sequence, ftg, first, effort.arms)
    waist = moved(first.waist, upper.waist_shift)
    try:
        q = whole_body(robot, waist, ftg, upper.q, sequence.time)
        waist = filtered_waist(robot, waist, sequence.zmp, robot.body.zmp(q, robot.walk.sample_time))
    except Infeasible:
        pass
    adaptation = adapt_feet(robot, obstacle, sequence, waist, ftg, effort.methods)
    return Stage("", sequence, raise_waist(robot, sequence, waist, adaptation.raised), adaptation.feet)
