"""Compute the results of a simulation from its recording."""

from __future__ import annotations

from typing import Any

import numpy as np

from stepover.model import pose
from stepover.model.collision import Shape, clearance, separation
from stepover.model.gravity import GRAVITY
from stepover.model.kinematics import Placements
from stepover.model.robot import Robot
from stepover.model.support import zmp_margin
from stepover.motion.motion import Motion
from stepover.simulation.measurements import Run, Series
from stepover.simulation.recording import Recording
from stepover.simulation.soles import plate, with_plate_shapes, with_plates

PHASES = ("walking", "phase 1, leg 1 over the obstacle", "phase 2, both feet down", "phase 3, leg 2 over the obstacle")
"""The phases of Sec. II, as an explanation names them."""


def measured(
    robot: Robot,
    motion: Motion,
    recording: Recording,
    fall: tuple[int, str] | None,
    obstacle: np.ndarray,
    how: dict[str, Any],
) -> Run:
    """Compute the result of a simulation.

    Args:
        robot: the robot.
        motion: the planned motion.
        recording: the measured motion.
        fall: sample and sign of a fall, or None.
        obstacle: (4,) rectangle of the bare obstacle at its true place.
        how: actuators, sole, stabilizer, perturb, engine and realtime_factor, copied into the result.
    """
    placements, shapes = _bodies(robot, recording)
    series = _series(robot, motion, recording, placements, _separation(shapes, placements, obstacle))
    end = fall[0] + 1 if fall else recording.count
    upright = Placements(placements.rotations[:end], placements.positions[:end])
    nearest = clearance(shapes, upright, obstacle)
    torque = np.abs(series.torque[:end]) / robot.body.effort_limits
    speed = np.abs(series.dq[:end]) / robot.body.speed_limits
    saturated = (torque >= 1.0) | recording.saturated[:end]
    return Run(
        fell=fall is not None,
        fall_time=float(series.time[fall[0]]) if fall else None,
        fall_reason=_sentence("fell", motion, series, *fall) if fall else None,
        obstacle_contacts=int(np.isfinite(series.obstacle_depth[:end]).sum()),
        clearance_min=nearest.distance,
        clearance_link=nearest.link,
        zmp_rms=_rms(series.zmp_error[:end]),
        landing_force_peak={
            "first": _landing_force(robot, motion, series, 2, end),
            "second": _landing_force(robot, motion, series, 3, end),
        },
        waist_error_max=float(series.waist_error[:end].max()),
        torque_ratio_max=float(torque.max()),
        speed_ratio_max=float(speed.max()),
        torque_saturated_samples=_counts(robot, saturated),
        speed_violation_samples=_counts(robot, speed > 1.0),
        duration=float(series.time[-1] - series.time[0]),
        state_hash=recording.state_hash(),
        contact_reason=_contact(motion, series, recording, end),
        motion=motion,
        obstacle=obstacle,
        series=series,
        **how,
    )


def _bodies(robot: Robot, recording: Recording) -> tuple[Placements, list[Shape]]:
    """Measured places of all links, and their shapes. With rubber soles, the plates of the feet are separate links."""
    placements = robot.body.placements(recording.q[: recording.count])
    if not recording.bush_depth:
        return placements, robot.shapes
    bush = recording.bush[: recording.count]
    return with_plates(robot, placements, bush, recording.bush_depth), with_plate_shapes(robot)


def _separation(shapes: list[Shape], placements: Placements, obstacle: np.ndarray) -> np.ndarray:
    """Lower bound (M,) of the distance of all shapes from the obstacle [m]."""
    return np.asarray(np.min([separation(shape, placements, obstacle) for shape in shapes], axis=0))


def _series(robot: Robot, motion: Motion, recording: Recording, placements: Placements, distance: np.ndarray) -> Series:
    """The filled part of the recording, with the series that are computed from it."""
    m, body = recording.count, robot.body
    total, least = recording.total[:m], robot.simulation.loaded_share * body.mass * GRAVITY
    bearing = recording.feet[:m, :, 2] >= least
    support = bearing[:, 0].astype(int) - bearing[:, 1].astype(int)
    with np.errstate(divide="ignore", invalid="ignore"):
        zmp = np.column_stack([-total[:, 4], total[:, 3]]) / total[:, 2:3]
    zmp[total[:, 2] < least] = np.nan
    soft = bool(recording.bush_depth)
    left, right = (_sole(robot, placements, plate(robot, side) if soft else _ankle(robot, side)) for side in (1, -1))
    joints = slice(0, 2 + len(body.joint_names))
    com = body.com(Placements(placements.rotations[:, joints], placements.positions[:, joints]))
    return Series(
        time=motion.time[:m], q=recording.q[:m], dq=recording.dq[:m], torque=recording.torque[:m],
        left_foot=left, right_foot=right, bush=recording.bush[:m],
        left_wrench=recording.feet[:m, 0], right_wrench=recording.feet[:m, 1],
        com=com, zmp=zmp, zmp_margin=zmp_margin(robot, zmp, support, left, right), clearance=distance,
        waist_error=np.linalg.norm(recording.q[:m, :3] - motion.waist[:m, :3], axis=1),
        obstacle_depth=recording.obstacle_depth[:m], zmp_error=zmp - motion.zmp_reference[:m],
        waist_believed_error=recording.believed_waist[:m] - recording.q[:m, :3],
        com_believed_error=recording.believed_com[:m] - com,
    )  # fmt: skip


def _counts(robot: Robot, flags: np.ndarray) -> dict[str, int]:
    """Number of flagged samples (M, nq - 7) by joint; joints without any are left out."""
    return {joint: int(n) for joint, n in zip(robot.body.joint_names, flags.sum(axis=0), strict=True) if n}


def _ankle(robot: Robot, side: int) -> int:
    """Index of the last joint of a leg in the placements."""
    return robot.body.index(robot.leg(side).joints[-1])


def _sole(robot: Robot, placements: Placements, joint: int) -> np.ndarray:
    """Poses (M, 7) of a measured sole frame, from the joint that moves it."""
    poses = pose.from_matrices(placements.rotations[:, joint], placements.positions[:, joint])
    return pose.offset(poses, np.array([0.0, 0.0, -robot.foot.ankle_height]))


def _landing_force(robot: Robot, motion: Motion, series: Series, kind: int, end: int) -> float:
    """Peak of the vertical force on a foot around its planned touch-down [N]; NaN if the run ended before that."""
    step = motion.footsteps.of_kind(kind)
    window = robot.simulation.landing_window
    if len(step) == 0 or series.time[end - 1] < step.time[0]:
        return float("nan")
    wrench = series.left_wrench if step.side[0] > 0 else series.right_wrench
    near = np.abs(series.time[:end] - step.time[0]) <= window + 1e-9
    return float(wrench[:end][near, 2].max())


def _contact(motion: Motion, series: Series, recording: Recording, end: int) -> str | None:
    """The first contact with the obstacle as a sentence; None if there was no contact."""
    if recording.touched is None or recording.touched[0] >= end:
        return None
    sample, links = recording.touched
    depth = 1e3 * float(np.nanmax(series.obstacle_depth[:end]))
    cause = f"{' and '.join(links)} touch{'es' * (len(links) == 1)} it, at most {depth:.1f} mm deep"
    return _sentence("hit the obstacle", motion, series, sample, cause)


def _sentence(what: str, motion: Motion, series: Series, sample: int, cause: str) -> str:
    """A sentence that states what happened, when, by which link, the stance foot, the phase and the last ZMP margin."""
    stance = {0: "both feet bear", 1: "the left foot bears", -1: "the right foot bears"}[int(motion.support[sample])]
    margins = series.zmp_margin[: sample + 1]
    margins = margins[np.isfinite(margins)]
    margin = f"last ZMP margin {1e3 * margins[-1]:.0f} mm" if len(margins) else "ZMP never measured"
    phase = PHASES[int(motion.phase[sample])]
    return f"{what} at t = {series.time[sample]:.3f} s: {cause}; by the plan {stance} ({phase}); {margin}"


def _rms(error: np.ndarray) -> list[float]:
    """Root mean square of each axis, over the rows without NaN."""
    good = error[np.isfinite(error).all(axis=1)]
    return [float(x) for x in np.sqrt((good**2).mean(axis=0))] if len(good) else [float("nan")] * error.shape[1]
