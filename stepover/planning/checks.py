"""Is a motion what was asked for? Measures of a finished motion, and the refusal of one that breaks a limit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stepover.errors import Infeasible
from stepover.model.collision import clearance, least_separation
from stepover.model.gravity import GRAVITY
from stepover.model.kinematics import Placements
from stepover.model.obstacle import Obstacle
from stepover.model.parameters.planning import samples
from stepover.model.robot import Robot
from stepover.model.self_collision import self_clearance
from stepover.model.support import zmp_margin
from stepover.motion.motion import Motion


@dataclass(frozen=True)
class Measures:
    """What a motion comes to, in SI units: most of what `plan --json` prints.

    Attributes:
        duration, step_over_duration: whole motion; lift-off of leg 1 to touch-down of leg 2 [s].
        samples: number of samples.
        zmp_rms_first_stage, zmp_rms: multi-body ZMP against its reference before and after the filter, x, y [m].
        zmp_error_max: largest single error after the filter, x, y [m].
        zmp_margin_min: smallest distance of the ZMP from the edge of the support polygon [m].
        clearance_min, clearance_link, clearance_time: smallest signed distance from the bare obstacle [m].
        joint_margin_min, joint_margin_joint: smallest distance of a joint that moves to its limit [rad]; one that
            stands still at its limit, as a finger may, counts only beyond it.
        joint_speed_ratio_max, joint_speed_joint: largest joint speed over its limit.
        com_travel_double_support: way of the CoM in the double support over the obstacle, x [m].
        com_acceleration_ratio_max: largest vertical acceleration of the CoM over g.
    """

    duration: float
    step_over_duration: float
    samples: int
    zmp_rms_first_stage: list[float]
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
    error, first_error = motion.zmp - motion.zmp_reference, motion.zmp_first_stage - motion.zmp_reference
    nearest = clearance(robot.shapes, body.placements(motion.q), motion.bare_obstacle)
    angles = motion.q[:, 7:]
    limits = np.minimum(angles - body.lower, body.upper - angles)
    telling = (np.ptp(angles, axis=0) > 0.0) | (limits.min(axis=0) < 0.0)
    tightest = np.unravel_index(np.where(telling, limits, np.inf).argmin(), limits.shape)
    fastest = speed_ratio(robot, motion)
    first, over, second = (motion.samples(phase) for phase in (1, 2, 3))
    return Measures(
        duration=float(motion.time[-1] - motion.time[0]),
        step_over_duration=(second.stop - first.start) * dt,
        samples=len(motion.time),
        zmp_rms_first_stage=_rms(first_error),
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
        com_travel_double_support=float(motion.com[over.stop, 0] - motion.com[over.start, 0]),
        com_acceleration_ratio_max=float(np.abs(np.diff(motion.com[:, 2], 2)).max() / dt**2 / GRAVITY),
    )


def speed_ratio(robot: Robot, motion: Motion) -> tuple[float, str, float]:
    """Largest joint speed over its limit, that joint, and when [s]."""
    speeds = np.abs(robot.body.velocities(motion.q, motion.dt)[:, 6:]) / robot.body.speed_limits
    sample, joint = np.unravel_index(speeds.argmax(), speeds.shape)
    return float(speeds[sample, joint]), robot.body.joint_names[joint], float(motion.time[sample])


def require_speeds(robot: Robot, motion: Motion) -> None:
    """Refuse a motion in which a joint exceeds its speed limit.

    Raises:
        Infeasible: names the joint that moves fastest for its limit, its share of it and when.
    """
    ratio, joint, when = speed_ratio(robot, motion)
    if ratio > 1.0:
        raise Infeasible(f"{joint} moves at {ratio:.2f} of its speed limit at t = {when:.3f} s")


def require(robot: Robot, obstacle: Obstacle, motion: Motion, placements: Placements | None = None) -> None:
    """Refuse a motion that breaks a limit.

    Args:
        robot: the robot.
        obstacle: what the motion must leave free, with its margins.
        motion: the motion.
        placements: of its configurations, where they are at hand already.

    Raises:
        Infeasible: names the joint, link or ZMP, by how much and when.
    """
    body, angles = robot.body, motion.q[:, 7:]
    limits = np.minimum(angles - body.lower, body.upper - angles)
    _refuse(motion, limits, body.joint_names, "degrees", "beyond its limit")
    knees = [body.column(knee) - 7 for knee in robot.legs.knee]
    bent = np.abs(angles[:, knees]) - np.radians(robot.checks.knee_margin_deg)
    wanted = f"nearer to straight than {robot.checks.knee_margin_deg:g}"
    _refuse(motion, bent, list(robot.legs.knee), "degrees", wanted)
    margin = zmp_margin(robot, motion.zmp, motion.support, motion.left_foot, motion.right_foot)
    missing = margin[:, None] - robot.checks.zmp_margin
    _refuse(motion, missing, ["the ZMP"], "mm", "short of its margin to the support polygon's edge")
    placements = placements or body.placements(motion.q)
    every = samples(robot.checks.self_look_every, motion.dt)
    distance, one, other, sample = self_clearance(robot.own_pairs, placements, every, up_to=0.0)
    if distance <= 0.0:
        raise Infeasible(f"{one} and {other} meet, {-1e3 * distance:.1f} mm deep, at t = {motion.time[sample]:.3f} s")
    safe = obstacle.profile(float(motion.obstacle[0]), margins=True)
    free, which = least_separation(robot.shapes, placements, safe, up_to=0.0)
    link = robot.shapes[which[free.argmin()]].link
    _refuse(motion, free[:, None], [link], "mm", "inside the obstacle's safety margin")


UNITS = {"mm": 1e3, "degrees": 180.0 / np.pi}
"""How margins in m and rad are said."""


def _refuse(motion: Motion, margin: np.ndarray, names: list[str], unit: str, what: str) -> None:
    """Raise Infeasible for the most negative margin (N, len(names))."""
    sample, which = np.unravel_index(margin.argmin(), margin.shape)
    amount = -float(margin[sample, which])
    if amount > 1e-9:
        where = f"phase {motion.phase[sample]}" if motion.phase[sample] else "walking"
        raise Infeasible(
            f"{names[which]} is {amount * UNITS[unit]:.1f} {unit} {what} at t = {motion.time[sample]:.3f} s ({where})",
            short=amount if unit == "mm" else np.inf,
        )


def _rms(error: np.ndarray) -> list[float]:
    """Root mean square over the samples, per axis."""
    return [float(x) for x in np.sqrt((error**2).mean(axis=0))]
