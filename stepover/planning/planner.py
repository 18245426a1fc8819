"""What a planner is, and which ones there are.

A planner takes a robot and an obstacle, or a course of obstacles, and returns a motion that `planning.checks` accepts.
A new one is a module with such a function and a line in PLANNERS; nothing else has to be told about it.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Protocol

from stepover.errors import InvalidInput

if TYPE_CHECKING:
    from stepover.model.course import Course
    from stepover.model.obstacle import Obstacle
    from stepover.model.robot import Robot
    from stepover.motion.motion import Motion

PLANNERS = {
    "paper": "stepover.planning.algorithm_1.planner:plan",
    "optimal": "stepover.planning.optimal.planner:optimal_plan",
    "quasi-static": "stepover.planning.quasi_static.planner:quasi_static_plan",
}
"""Module and function of each planner, by its name. They are imported when they are first asked for."""


class Planner(Protocol):
    """From a robot and what it shall cross to a motion. A planner may take options of its own, with defaults."""

    def __call__(self, robot: Robot, obstacle: Obstacle | Course, /) -> Motion:
        """Plan the motion.

        Args:
            robot: from load_robot.
            obstacle: an obstacle, or a course of several.

        Raises:
            InvalidInput: an argument that makes no sense, or a course that this planner does not take.
            Infeasible: names what cannot be met, by how much and when.
        """


def find_planner(name: str) -> Planner:
    """The planner of a name.

    Raises:
        InvalidInput: there is no such planner; the message lists the known ones.
    """
    if name not in PLANNERS:
        raise InvalidInput(f"unknown planner {name!r}: known are {', '.join(PLANNERS)}")
    module, _, function = PLANNERS[name].partition(":")
    planner: Planner = getattr(import_module(module), function)
    return planner
