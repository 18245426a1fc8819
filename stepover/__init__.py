"""stepover: humanoid robots that walk dynamically over large obstacles, after Stasse et al., T-RO 2009.

Example::

    robot = load_robot("hrp2")
    motion = plan(robot, Obstacle(height=0.15, width=0.05))
    run = simulate(motion)
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stepover.errors import CorruptMotion, Infeasible, InvalidInput, StepOverError
    from stepover.model.course import Course
    from stepover.model.obstacle import Obstacle
    from stepover.model.robot import Robot
    from stepover.motion.motion import Motion
    from stepover.planning.algorithm_1.planner import plan
    from stepover.planning.optimal.planner import optimal_plan
    from stepover.planning.quasi_static.planner import quasi_static_plan
    from stepover.robots.loading import load_robot
    from stepover.simulation.run import simulate

__version__ = "0.2.0"

_HOMES = {
    "CorruptMotion": "stepover.errors",
    "Course": "stepover.model.course",
    "Infeasible": "stepover.errors",
    "InvalidInput": "stepover.errors",
    "Motion": "stepover.motion.motion",
    "Obstacle": "stepover.model.obstacle",
    "Robot": "stepover.model.robot",
    "StepOverError": "stepover.errors",
    "load_robot": "stepover.robots.loading",
    "optimal_plan": "stepover.planning.optimal.planner",
    "plan": "stepover.planning.algorithm_1.planner",
    "quasi_static_plan": "stepover.planning.quasi_static.planner",
    "simulate": "stepover.simulation.run",
}
__all__ = [
    "CorruptMotion",
    "Course",
    "Infeasible",
    "InvalidInput",
    "Motion",
    "Obstacle",
    "Robot",
    "StepOverError",
    "load_robot",
    "optimal_plan",
    "plan",
    "quasi_static_plan",
    "simulate",
]


def __getattr__(name: str) -> Any:
    """Load what is asked for when it is asked for: pinocchio and PyBullet take their time."""
    if name not in _HOMES:
        raise AttributeError(f"module 'stepover' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    """Also what has not been loaded yet, for those who press the tab key."""
    return sorted({*globals(), *_HOMES})
