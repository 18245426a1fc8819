"""The crossing before adaptation, and the contribution of each unit of Algorithm 1. Sec. III-D, III-E, IV, Figs. 5, 7.

"Before" means the feet of FTG and the waist of CWTG1, with the ZMP reference under the ankles and the arms at rest, for
the key configuration of the finished plan. If a sole is out of reach, knee angles are NaN, and the missing distance is
kept beside them.
"""

from __future__ import annotations

import contextlib
import dataclasses
from dataclasses import dataclass

import numpy as np

from stepover.analysis.key_posture import knees_from_straight
from stepover.errors import Infeasible
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.motion.footsteps import LEG_1, LEG_2
from stepover.planning.algorithm_1.feasibility import KeyConfiguration
from stepover.planning.algorithm_1.feet_adaptor import METHODS, adapt_feet
from stepover.planning.algorithm_1.plan import Nominal, Options, Plan
from stepover.planning.algorithm_1.planner import algorithm_1, filter_pass, nominal_trajectories
from stepover.planning.algorithm_1.shift_and_raise import raise_waist
from stepover.planning.algorithm_1.step_sequence import StepSequence
from stepover.planning.leg_check import LegLimits, check_legs
from stepover.planning.trajectories import FeetTrajectories, WaistAndFeet


@dataclass(frozen=True, eq=False)
class Stage:
    """Waist and feet at one stage of Algorithm 1.

    Attributes:
        name: name of the stage.
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
        return self.sequence.step(kind).swing


@dataclass(frozen=True)
class Contribution:
    """Results of a combination of units in phase 3.

    Attributes:
        units: names of the units.
        clearance: smallest distance of the legs from the bare obstacle in phase 3 [m], negative inside.
        free: the same for the obstacle with its margins, as FTA measures it [m].
        lead_knee: smallest angle of the lead knee from straight before landing [deg]; NaN if out of reach.
        missing: largest distance of a sole from its reach in phases 1 and 3 [m]; 0 if all are within reach.
        reason: why Algorithm 1 finds no plan; empty if it finds one.
    """

    units: str
    clearance: float
    free: float
    lead_knee: float
    missing: float
    reason: str


COMBINATIONS = {
    "none": Options("off", ()),
    "(1)": Options("off", (1,)),
    "(2)": Options("off", (2,)),
    "(1), (2)": Options("off", (1, 2)),
    "(1), (2), (3)": Options("off", METHODS),
    "FTA, UBMG": Options("auto", METHODS),
    "FTA, UBMG, beyond the paper": Options("auto", METHODS, level=1),
}
"""Options of each combination, by name. Level 1 stands for the level that the obstacle needs."""


def lead_leg_stages(planned: Plan) -> list[Stage]:
    """Stages that move the waist ahead before leg 1 lands, one unit after another, for the plan's key configuration."""
    crossing = planned.nominal.crossing
    at_rest, back = (
        nominal_trajectories(crossing.robot, crossing.obstacle, planned.key, Options(arms)) for arms in ("off", "on")
    )
    result = [_stage("before adaptation", at_rest), _stage("with the arms as far back as they may go", back)]
    if planned.options.level:
        waist = planned.nominal.first_stage.waist
        result.append(Stage("ZMP inside the soles, arms at rest", planned.sequence, waist, planned.nominal.feet))
    return [*result, after_adaptation(planned)]


def _stage(name: str, nominal: Nominal) -> Stage:
    """Nominal waist and feet."""
    return Stage(name, nominal.crossing.sequence, nominal.waist, nominal.feet)


def before_feet_adaptor(robot: Robot, planned: Plan) -> Stage:
    """Input of FTA: the feet of FTG, and the plan's waist without the rise of method (2)."""
    waist = raise_waist(robot, planned.sequence, planned.motion.waist, -planned.adaptation.raised)
    return Stage("before adaptation", planned.sequence, waist, planned.nominal.feet)


def after_adaptation(planned: Plan) -> Stage:
    """The finished plan."""
    motion = planned.motion
    feet = FeetTrajectories(motion.left_foot, motion.right_foot)
    return Stage("after adaptation", planned.sequence, motion.waist, feet)


def postures(robot: Robot, stage: Stage, samples: slice) -> tuple[np.ndarray, np.ndarray]:
    """Configurations (n, nq) at some samples with arms at rest, and the missing reach of each sole (n, 2) [m].

    A leg is straight if its sole is out of reach. The columns of the missing reach are left and right.
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
    """The lead knee over phase 1: time (n,) [s], angle from straight (n,) [deg] or NaN, missing reach (n,) [m]."""
    step = stage.sequence.step(LEG_1)
    over = stage.swing(LEG_1)
    q, missing = postures(robot, stage, over)
    knee = next(k for k, name in enumerate(robot.legs.knee) if name in robot.leg(step.side).joints)
    beyond = missing[:, 0 if step.side > 0 else 1]
    return stage.sequence.time[over], np.where(beyond > 0.0, np.nan, knees_from_straight(robot, q)[:, knee]), beyond


def before_landing(robot: Robot, stage: Stage) -> tuple[float, float]:
    """The lead knee in the second half of phase 1: least angle from straight [deg] or NaN, and missing reach [m]."""
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


def contributions(robot: Robot, obstacle: Obstacle, key: KeyConfiguration, level: int) -> list[Contribution]:
    """Results of all combinations of units, for one key configuration.

    Args:
        robot: the robot.
        obstacle: the obstacle.
        key: key configuration.
        level: level of the methods beyond the paper in the last combination.
    """
    return [
        contribution(robot, obstacle, key, dataclasses.replace(options, level=options.level * level), units)
        for units, options in COMBINATIONS.items()
    ]


def contribution(
    robot: Robot, obstacle: Obstacle, key: KeyConfiguration, options: Options, units: str = ""
) -> Contribution:
    """Results of one combination: from the plan if there is one, else from a single pass of its units."""
    reason = ""
    try:
        stage = after_adaptation(algorithm_1(robot, obstacle, key, options))
    except Infeasible as error:
        reason, stage = str(error), after_one_pass(nominal_trajectories(robot, obstacle, key, options), options)
    third = WaistAndFeet(stage.waist, stage.feet).at(stage.swing(LEG_2))
    check, free = (
        check_legs(robot, third, LegLimits(obstacle.profile(stage.sequence.front_face, margins), 0.0))
        for margins in (False, True)
    )
    knee, beyond = before_landing(robot, stage)
    missing = max(beyond, float(check.reach.max()))
    return Contribution(units, float(check.separation.min()), float(free.separation.min()), knee, missing, reason)


def after_one_pass(nominal: Nominal, options: Options) -> Stage:
    """Apply filter and FTA once to the nominal trajectories, if Algorithm 1 finds no plan.

    The filter is left out if a sole is out of reach, since it needs postures within reach.
    """
    crossing, waist = nominal.crossing, nominal.waist
    with contextlib.suppress(Infeasible):
        waist, _ = filter_pass(crossing, WaistAndFeet(waist, nominal.feet), nominal.upper.q)
    adaptation = adapt_feet(crossing, WaistAndFeet(waist, nominal.feet), options.methods)
    raised = raise_waist(crossing.robot, crossing.sequence, waist, adaptation.raised)
    return Stage("", crossing.sequence, raised, adaptation.feet)
