"""What a planner is asked for: the check that every planner for a single obstacle begins with."""

from __future__ import annotations

from stepover.errors import InvalidInput, require_type
from stepover.model.course import Course
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot


def one_obstacle(robot: Robot, obstacle: Obstacle | Course) -> Obstacle:
    """The one obstacle that a robot is asked to step over.

    Args:
        robot: from load_robot.
        obstacle: the obstacle, or a course that holds one.

    Raises:
        InvalidInput: no Robot, no Obstacle, a course of several obstacles, or an obstacle that is turned.
    """
    require_type("robot", robot, Robot, "load_robot(...)")
    if isinstance(obstacle, Course):
        if len(obstacle.obstacles) > 1:
            raise InvalidInput(f"this planner takes one obstacle; the course has {len(obstacle.obstacles)}")
        obstacle = obstacle.obstacles[0]
    require_type("obstacle", obstacle, Obstacle, "Obstacle(height, width)")
    if obstacle.yaw != 0.0:
        raise InvalidInput(f"this planner takes obstacles square to the path; obstacle yaw = {obstacle.yaw:g} rad")
    return obstacle
