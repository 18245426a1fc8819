"""How long the single supports over the obstacle last: as the robot walks, a given time, or the shortest that works.

The search is a bisection on a grid of durations. It assumes that what can be done quickly can also be done slowly.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from numbers import Real
from typing import NamedTuple, TypeVar

from stepover.errors import Infeasible, InvalidInput
from stepover.model.parameters.optimal import Optimal
from stepover.model.robot import Robot

BEST = "best"
"""Asks for the shortest duration."""
Plan = TypeVar("Plan")


class Trial(NamedTuple):
    """A duration that was tried.

    Attributes:
        duration: of the single supports over the obstacle [s].
        refused: why not, or "".
    """

    duration: float
    refused: str


def require_time(time: float | str | None, p: Optimal) -> None:
    """Reject what is no duration.

    Raises:
        InvalidInput: neither None, nor "best", nor a time in range.
    """
    least, most = p.duration_least, p.duration_most
    known = time is None or (isinstance(time, str) and time == BEST)
    if known or (isinstance(time, Real) and not isinstance(time, bool) and least <= time <= most):
        return
    raise InvalidInput(f"time must be {BEST!r} or from {least:g} to {most:g} s, not {time!r}")


def lasting(robot: Robot, duration: float) -> Robot:
    """The robot that takes some time [s] for each single support over the obstacle."""
    walk = dataclasses.replace(robot.walk, single_support_over=duration, single_support_leg_2=duration)
    return dataclasses.replace(robot, walk=walk)


def shortest(robot: Robot, plan: Callable[[Robot, bool], Plan]) -> tuple[Plan, list[Trial]]:
    """The plan with the shortest single supports, and all durations that were tried.

    Args:
        robot: the robot.
        plan: plans with a robot of a certain duration, and looks for a nearest obstacle if it is told to.

    Raises:
        Infeasible: not even the longest duration works.
    """
    p = robot.optimal
    count = round((p.duration_most - p.duration_least) / p.duration_step)
    durations = [round(p.duration_most - k * p.duration_step, 6) for k in range(count + 1)]
    best = plan(lasting(robot, durations[0]), True)
    trials, kept, refused = [Trial(durations[0], "")], 0, count + 1
    at = count
    while refused - kept > 1:
        try:
            best, kept = plan(lasting(robot, durations[at]), False), at
            trials.append(Trial(durations[at], ""))
        except Infeasible as error:
            refused = at
            trials.append(Trial(durations[at], error.constraint))
        at = (kept + refused) // 2
    return best, trials
