"""Servos with limits, and the rubber of compliant soles: the numbers of their springs, which hold in every engine."""

from __future__ import annotations

import numpy as np

from stepover.model.robot import Robot


def springs(robot: Robot, bushes: int, stiffer: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness [N m/rad, N/m] and damping [N m s/rad, N s/m] of all servos and of B bushes, each (J + 3 B,).

    Args:
        robot: with the parameters of the servos and the rubber.
        bushes: how many of them, 0 or 2.
        stiffer: factor of the servos' stiffness and damping.
    """
    stiffness = stiffer * robot.servo.stiffness_per_torque * robot.body.effort_limits
    legs = [robot.body.column(joint) - 7 for joint in (*robot.legs.left, *robot.legs.right)]
    stiffness[legs] = stiffer * robot.servo.leg_stiffness
    rubber = robot.sole
    spring = [rubber.vertical_stiffness, rubber.tilt_stiffness, rubber.tilt_stiffness]
    damper = [rubber.vertical_damping, rubber.tilt_damping, rubber.tilt_damping]
    damping = robot.servo.damping_time * stiffness
    return np.concatenate([stiffness, spring * bushes]), np.concatenate([damping, damper * bushes])


def limits_at(robot: Robot, speed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Least and most torque (J,) that limited servos can give at joint speeds (J,) [N m, rad/s].

    A torque that accelerates a joint fades below its speed limit, and is zero at it.
    """
    limit, share, fade = robot.body.effort_limits, speed / robot.body.speed_limits, robot.servo.speed_fade
    most = np.minimum((1.0 - share) / fade, 1.0) * limit
    least = np.minimum((1.0 + share) / fade, 1.0) * limit
    return -np.maximum(least, 0.0), np.maximum(most, 0.0)


def fading(robot: Robot, torque: np.ndarray, speed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The line on which a servo's torque fades near the speed limit, in the direction of torques (J,).

    Args:
        robot: with the limits.
        torque: (J,) whose signs say which of the two lines [N m].
        speed: (J,) [rad/s].

    Returns:
        Torque (J,) on the line [N m], and by how much it falls with the speed (J,) [N m s/rad].
    """
    limit, fade = robot.body.effort_limits, robot.servo.speed_fade
    slope = limit / (fade * robot.body.speed_limits)
    return np.sign(torque) * limit / fade - slope * speed, slope


def within_limits(robot: Robot, torque: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Torques (J,) that limited servos can give at joint speeds (J,) [N m, rad/s]."""
    least, most = limits_at(robot, speed)
    return np.minimum(np.maximum(torque, least), most)
