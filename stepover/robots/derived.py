"""What the model knows of a robot, so that robot.toml need not say it."""

from __future__ import annotations

from stepover.model.robot import Robot


def standing(robot: Robot) -> dict[str, float]:
    """Waist height with the soles on the floor in half-sitting, and distance between the feet [m], to a micron."""
    rest = robot.half_sitting()[None]
    rest[:, 2] = 0.0
    left, right = (robot.leg(side).sole(rest[:, :7], rest[:, robot.leg(side).columns])[1][0] for side in (1, -1))
    height = -float(left[2] + right[2]) / 2.0
    return {"waist_height": round(height, 6), "feet_apart": round(float(left[1] - right[1]), 6)}


def com_height(robot: Robot) -> float:
    """Height of the centre of mass above the floor in half-sitting [m], to 0.1 mm."""
    return round(float(robot.body.com(robot.body.placements(robot.half_sitting()[None]))[0, 2]), 4)
