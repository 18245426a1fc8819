"""Measures of a finished motion of any planner, from its own arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stepover.model.collision import Clearance, clearance
from stepover.model.gravity import GRAVITY
from stepover.model.kinematics import Placements
from stepover.model.robot import Robot
from stepover.model.support import zmp_margin
from stepover.motion.motion import Motion


@dataclass(frozen=True)
class Measures:
    """What a motion comes to, in SI units: most of what `plan --json` prints.

    Attributes:
        duration, step_over_duration: whole motion; lift-off of leg 1 to touch-down of leg 2, NaN without phases [s].
        samples: number of samples.
        zmp_rms_first_stage, zmp_rms: multi-body ZMP against its reference before and after the filter, x, y [m]; the
            first is None where the planner has no filter.
        zmp_error_max: largest single error after the filter, x, y [m].
        zmp_margin_min: smallest distance of the ZMP from the edge of the support polygon [m].
        clearance_min, clearance_link, clearance_time: smallest signed distance from the bare obstacles [m].
        joint_margin_min, joint_margin_joint: smallest distance of a joint that moves to its limit [rad]; one that
            stands still at its limit, as a finger may, counts only beyond it.
        joint_speed_ratio_max, joint_speed_joint: largest joint speed over its limit.
        com_travel_double_support: way of the CoM in the double support over the obstacle, x, NaN without phases [m].
        com_acceleration_ratio_max: largest vertical acceleration of the CoM over g.
    """

    duration: float
    step_over_duration: float
    samples: int
    zmp_rms_first_stage: list[float] | None
    zmp_rms: list[float]
    zmp_error_max: list[float]
    zmp_margin_min: float
    clearance_min: float
    clearance_link: str
    clearance_time: float
    joint_margin_min: float
    joint_margin_joint: str
    joint_speed_ratio_max: float
    joint_speed_joint: str
    com_travel_double_support: float
    com_acceleration_ratio_max: float


def measure(robot: Robot, motion: Motion) -> Measures:
    """Measure a motion from its own arrays."""
    body, dt = robot.body, motion.dt
    error, first = motion.zmp - motion.zmp_reference, motion.zmp_first_stage
    nearest = _nearest(robot, motion, body.placements(motion.q))
    angles = motion.q[:, 7:]
    limits = np.minimum(angles - body.lower, body.upper - angles)
    telling = (np.ptp(angles, axis=0) > 0.0) | (limits.min(axis=0) < 0.0)
    tightest = np.unravel_index(np.where(telling, limits, np.inf).argmin(), limits.shape)
    fastest = speed_ratio(robot, motion)
    step_over_duration, com_travel = _over_the_obstacle(motion)
    return Measures(
        duration=float(motion.time[-1] - motion.time[0]),
        step_over_duration=step_over_duration,
        samples=len(motion.time),
        zmp_rms_first_stage=None if first is None else _rms(first - motion.zmp_reference),
        zmp_rms=_rms(error),
        zmp_error_max=np.abs(error).max(axis=0).tolist(),
        zmp_margin_min=float(zmp_margin(robot, motion.zmp, motion.support, motion.left_foot, motion.right_foot).min()),
        clearance_min=nearest.distance,
        clearance_link=nearest.link,
        clearance_time=float(motion.time[nearest.sample]),
        joint_margin_min=float(limits[tightest]),
        joint_margin_joint=body.joint_names[tightest[1]],
        joint_speed_ratio_max=fastest[0],
        joint_speed_joint=fastest[1],
        com_travel_double_support=com_travel,
        com_acceleration_ratio_max=float(np.abs(np.diff(motion.com[:, 2], 2)).max() / dt**2 / GRAVITY),
    )


def speed_ratio(robot: Robot, motion: Motion) -> tuple[float, str, float]:
    """Largest joint speed over its limit, that joint, and when [s]."""
    speeds = np.abs(robot.body.velocities(motion.q, motion.dt)[:, 6:]) / robot.body.speed_limits
    sample, joint = np.unravel_index(speeds.argmax(), speeds.shape)
    return float(speeds[sample, joint]), robot.body.joint_names[joint], float(motion.time[sample])


def _nearest(robot: Robot, motion: Motion, placements: Placements) -> Clearance:
    """Smallest distance of all links from all bare obstacles."""
    found = [
        clearance(robot.shapes, seen_from(placements, row), motion.profile(number, margins=False))
        for number, row in enumerate(motion.obstacles)
    ]
    return min(found, key=lambda nearest: nearest.distance)


def seen_from(placements: Placements, row: np.ndarray) -> Placements:
    """Placements in the frame of an obstacle (7,), which is turned about the middle of its front face."""
    front, yaw = row[0], row[6]
    if yaw == 0.0:
        return placements
    middle, c, s = np.array([front, 0.0, 0.0]), np.cos(yaw), np.sin(yaw)
    back = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    return Placements(back @ placements.rotations, (placements.positions - middle) @ back.T + middle)


def _over_the_obstacle(motion: Motion) -> tuple[float, float]:
    """How long it takes to step over [s], and how far the CoM goes in the double support [m]; NaN without phases."""
    if not motion.has_phases:
        return float("nan"), float("nan")
    first, over, second = (motion.samples(phase) for phase in (1, 2, 3))
    travel = float(motion.com[over.stop, 0] - motion.com[over.start, 0])
    return (second.stop - first.start) * motion.dt, travel


def _rms(error: np.ndarray) -> list[float]:
    """Root mean square over the samples, per axis."""
    return [float(x) for x in np.sqrt((error**2).mean(axis=0))]
