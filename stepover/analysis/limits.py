"""Limits of the planner: the highest obstacle with a plan, and joint speeds over their limits. Sec. III, IV.

Heights are found by bisection between a possible and an impossible one.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stepover.errors import Infeasible
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.motion.footsteps import LEG_1
from stepover.planning.algorithm_1.plan import Plan
from stepover.planning.algorithm_1.planner import plan_in_detail
from stepover.planning.measures import speed_ratio


@dataclass(frozen=True)
class Speeds:
    """The fastest joint of a plan.

    Attributes:
        ratio: largest joint speed over its limit; NaN without a plan.
        joint, time: the joint, and when it is fastest [s].
        duration: time from lift-off of leg 1 to touch-down of leg 2 [s].
        reason: why there is no plan; empty if there is one.
    """

    ratio: float
    joint: str
    time: float
    duration: float
    reason: str = ""


def highest(possible: Callable[[float], bool], low: float, high: float, resolution: float) -> float:
    """Highest possible height between two heights [m]; NaN if even the lower one is impossible."""
    if not possible(low):
        return float("nan")
    while high - low > resolution:
        middle = (low + high) / 2.0
        low, high = (middle, high) if possible(middle) else (low, middle)
    return low


def highest_plan(robot: Robot, width: float, *, arms: str, extras: bool, resolution: float) -> float:
    """Highest obstacle of a width that has a plan [m], for an option of the arms, with or without extras."""
    options = {"arms": arms, "extras": extras, "look_for_nearest": False}
    return highest(
        lambda height: _works(plan_in_detail, robot, Obstacle(height, width), **options), 0.1, 0.35, resolution
    )


def with_authors_swing(robot: Robot) -> Robot:
    """The robot with the authors' control points of FTG alone: no later swing is tried."""
    return dataclasses.replace(robot, late_swing=dataclasses.replace(robot.late_swing, leg1_descent=()))


def landing_speed(planned: Plan, height: float = 0.01) -> float:
    """How fast leg 1 comes down at a height of its sole frame before it lands [m/s]."""
    step = planned.sequence.step(LEG_1)
    above = planned.motion.foot(step.side)[step.swing, 2]
    last = int(np.flatnonzero(above > height)[-1])
    return float(above[last] - above[last + 1]) / planned.motion.dt


def speeds(robot: Robot, obstacle: Obstacle, speed_limits: str = "ignore") -> Speeds:
    """The fastest joint of the plan for an obstacle."""
    try:
        motion = plan_in_detail(robot, obstacle, speed_limits=speed_limits, look_for_nearest=False).motion
    except Infeasible as error:
        return Speeds(float("nan"), "", float("nan"), float("nan"), error.constraint)
    lasting = (motion.samples(3).stop - motion.samples(1).start) * motion.dt
    return Speeds(*speed_ratio(robot, motion), lasting)


def _works(attempt: Callable[..., object], *values: object, **options: object) -> bool:
    """Whether a call is feasible."""
    try:
        attempt(*values, **options)
    except Infeasible:
        return False
    return True
