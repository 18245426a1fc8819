"""From what was recorded to what is reported: the result of a simulation."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from stepover.model import pose
from stepover.model.kinematics import Placements
from stepover.model.collision import clearance, separation
from stepover.model.robot import Robot
from stepover.model.support import zmp_margin
from stepover.motion import Motion
from stepover.simulation.recording import Recording
from stepover.units.preview_control import GRAVITY

PHASES = ("walking", "phase 1, leg 1 over the obstacle", "phase 2, both feet down", "phase 3, leg 2 over the obstacle")
"""The phases of Sec. II, as an explanation names them."""


@dataclass(frozen=True, eq=False)
class Series:
    """Measured series, M samples at the motion's sample times, as long as the physics ran. SI units.

    Forces and torques are means over the 5 ms since the sample before, zero at the first sample.

    Attributes:
        time: (M,) the motion's time.
        q: (M, nq) measured configurations, in pinocchio's order.
        dq: (M, nq - 7) joint speeds.
        torque: (M, nq - 7) motor torques.
        left_foot, right_foot: (M, 7) measured sole poses.
        left_wrench, right_wrench: (M, 6) force and moment of the floor on each foot, about the world's origin.
        com: (M, 3) centre of mass.
        zmp: (M, 2) measured ZMP: where the floor's forces on the whole robot have no horizontal moment; NaN where
            the floor bears less than the loaded share of the weight.
        zmp_margin: (M,) distance of it from the edge of the support polygon of the feet that bear at least the loaded
            share of the weight, where they are; negative outside. The soles touch with more than the contact patch.
        clearance: (M,) signed distance of the whole robot from the bare obstacle; a lower bound where an edge is
            nearest to an edge.
        waist_error: (M,) distance of the waist from its planned place.
        obstacle_depth: (M,) largest depth of a contact with the obstacle, NaN where there is none.
    """

    time: np.ndarray
    q: np.ndarray
    dq: np.ndarray
    torque: np.ndarray
    left_foot: np.ndarray
    right_foot: np.ndarray
    left_wrench: np.ndarray
    right_wrench: np.ndarray
    com: np.ndarray
    zmp: np.ndarray
    zmp_margin: np.ndarray
    clearance: np.ndarray
    waist_error: np.ndarray
    obstacle_depth: np.ndarray


@dataclass(frozen=True, eq=False)
class Run:
    """A simulation's result in SI units. Numbers are over the samples up to the end, or up to a fall.

    Attributes:
        fell, fall_time, fall_reason: whether, when [s], and in one sentence how; None where it did not.
        obstacle_contacts: samples (5 ms) in which a link touches the obstacle.
        clearance_min, clearance_link: smallest signed distance of all links from the bare obstacle [m].
        zmp_rms: measured ZMP against the motion's reference over all loaded samples, [x, y] [m].
        landing_force_peak: largest vertical force on the foot, as a mean over 5 ms and without any other filter,
            within the landing window before and after the planned touch-down of leg 1 and leg 2 [N].
        waist_error_max: largest distance of the waist from its planned place [m].
        torque_ratio_max, speed_ratio_max: largest torque (mean over 5 ms) and speed over the joint's limit.
        torque_saturated_samples: samples with a torque at or beyond the limit, of the joints that have any.
        actuators, sole, stabilizer: how it was simulated.
        duration: simulated time [s].
        realtime_factor: simulated time over computing time.
        state_hash: SHA-256 of all recorded states, torques and forces, to the last bit.
        contact_reason: the first contact with the obstacle, in one sentence; None where there is none.
        motion: what was carried out.
        series: the time series that the numbers were made from.
    """

    fell: bool
    fall_time: float | None
    fall_reason: str | None
    obstacle_contacts: int
    clearance_min: float
    clearance_link: str
    zmp_rms: list[float]
    landing_force_peak: dict[str, float]
    waist_error_max: float
    torque_ratio_max: float
    speed_ratio_max: float
    torque_saturated_samples: dict[str, int]
    actuators: str
    sole: str
    stabilizer: bool
    duration: float
    realtime_factor: float
    state_hash: str
    contact_reason: str | None
    motion: Motion
    series: Series

    @property
    def crossed(self) -> bool:
        """Whether the robot carried the motion out to the end, upright and without touching the obstacle."""
        return not self.fell and self.obstacle_contacts == 0

    @property
    def explanation(self) -> str:
        """What went wrong, one sentence each; empty where nothing did."""
        return "; ".join(reason for reason in (self.contact_reason, self.fall_reason) if reason)

    def to_json(self) -> dict[str, Any]:
        """The numbers as `simulate --json` prints them, None for what is not a number."""
        beyond = ("contact_reason", "motion", "series")
        return {f.name: _plain(getattr(self, f.name)) for f in fields(self) if f.name not in beyond}


def measured(
    robot: Robot, motion: Motion, recording: Recording, fall: tuple[int, str] | None, how: dict[str, Any]
) -> Run:
    """Judge a recording.

    Args:
        robot: the robot.
        motion: what it was to do.
        recording: what it did.
        fall: sample of a fall and what it shows by, or None.
        how: actuators, sole, stabilizer and realtime_factor, as they go into the result.
    """
    placements = robot.body.placements(recording.q[: recording.count])
    series = _series(robot, motion, recording, placements)
    end = fall[0] + 1 if fall else recording.count
    upright = Placements(placements.rotations[:end], placements.positions[:end])
    nearest = clearance(robot.shapes, upright, motion.bare_obstacle)
    torque = np.abs(series.torque[:end]) / robot.body.effort_limits
    saturated = (torque >= 1.0).sum(axis=0)
    return Run(
        fell=fall is not None,
        fall_time=float(series.time[fall[0]]) if fall else None,
        fall_reason=_sentence("fell", motion, series, *fall) if fall else None,
        obstacle_contacts=int(np.isfinite(series.obstacle_depth[:end]).sum()),
        clearance_min=nearest.distance,
        clearance_link=nearest.link,
        zmp_rms=_rms(series.zmp[:end] - motion.zmp_reference[:end]),
        landing_force_peak={
            "first": _landing_force(robot, motion, series, 2, end),
            "second": _landing_force(robot, motion, series, 3, end),
        },
        waist_error_max=float(series.waist_error[:end].max()),
        torque_ratio_max=float(torque.max()),
        speed_ratio_max=float((np.abs(series.dq[:end]) / robot.body.speed_limits).max()),
        torque_saturated_samples={
            joint: int(n) for joint, n in zip(robot.body.joint_names, saturated, strict=True) if n
        },
        duration=float(series.time[-1] - series.time[0]),
        state_hash=recording.state_hash(),
        contact_reason=_contact(motion, series, recording, end),
        motion=motion,
        series=series,
        **how,
    )


def _series(robot: Robot, motion: Motion, recording: Recording, placements: Placements) -> Series:
    """Cut the recording to its length and add what follows from it."""
    m = recording.count
    total, least = recording.total[:m], robot.simulation.loaded_share * robot.body.mass * GRAVITY
    bearing = recording.feet[:m, :, 2] >= least
    support = bearing[:, 0].astype(int) - bearing[:, 1].astype(int)
    with np.errstate(divide="ignore", invalid="ignore"):
        zmp = np.column_stack([-total[:, 4], total[:, 3]]) / total[:, 2:3]
    zmp[total[:, 2] < least] = np.nan
    left, right = (_sole(robot, placements, side) for side in (1, -1))
    distances = [separation(shape, placements, motion.bare_obstacle) for shape in robot.shapes]
    return Series(
        time=motion.time[:m], q=recording.q[:m], dq=recording.dq[:m], torque=recording.torque[:m],
        left_foot=left, right_foot=right, left_wrench=recording.feet[:m, 0], right_wrench=recording.feet[:m, 1],
        com=robot.body.com(placements), zmp=zmp, zmp_margin=zmp_margin(robot, zmp, support, left, right),
        clearance=np.min(distances, axis=0),
        waist_error=np.linalg.norm(recording.q[:m, :3] - motion.waist[:m, :3], axis=1),
        obstacle_depth=recording.obstacle_depth[:m],
    )  # fmt: skip


def _sole(robot: Robot, placements: Placements, side: int) -> np.ndarray:
    """Poses (M, 7) of a measured sole frame."""
    ankle = robot.body.index((robot.legs.left if side > 0 else robot.legs.right)[-1])
    poses = pose.from_matrices(placements.rotations[:, ankle], placements.positions[:, ankle])
    return pose.offset(poses, np.array([0.0, 0.0, -robot.foot.ankle_height]))


def _landing_force(robot: Robot, motion: Motion, series: Series, kind: int, end: int) -> float:
    """Peak of the vertical force on a foot around its planned touch-down [N]; NaN where that was not reached."""
    step = motion.footsteps[motion.footsteps[:, 5] == kind]
    window = robot.simulation.landing_window
    if len(step) == 0 or series.time[end - 1] < step[0, 0]:
        return float("nan")
    wrench = series.left_wrench if step[0, 1] > 0 else series.right_wrench
    near = np.abs(series.time[:end] - step[0, 0]) <= window + 1e-9
    return float(wrench[:end][near, 2].max())


def _contact(motion: Motion, series: Series, recording: Recording, end: int) -> str | None:
    """The first contact with the obstacle as a sentence; None where there is none before the end."""
    if recording.touched is None or recording.touched[0] >= end:
        return None
    sample, links = recording.touched
    depth = 1e3 * float(np.nanmax(series.obstacle_depth[:end]))
    cause = f"{' and '.join(links)} touches it, at most {depth:.1f} mm deep"
    return _sentence("hit the obstacle", motion, series, sample, cause)


def _sentence(what: str, motion: Motion, series: Series, sample: int, cause: str) -> str:
    """One sentence: what, when, which link, stance foot and phase, last ZMP margin."""
    stance = {0: "both feet bear", 1: "the left foot bears", -1: "the right foot bears"}[int(motion.support[sample])]
    margins = series.zmp_margin[: sample + 1]
    margins = margins[np.isfinite(margins)]
    margin = f"last ZMP margin {1e3 * margins[-1]:.0f} mm" if len(margins) else "ZMP never measured"
    phase = PHASES[int(motion.phase[sample])]
    return f"{what} at t = {series.time[sample]:.3f} s: {cause}; by the plan {stance} ({phase}); {margin}"


def _rms(error: np.ndarray) -> list[float]:
    """Root mean square per axis over the rows without NaN."""
    good = error[np.isfinite(error).all(axis=1)]
    return [float(x) for x in np.sqrt((good**2).mean(axis=0))] if len(good) else [float("nan")] * error.shape[1]


def _plain(value: Any) -> Any:
    """NaN and infinity as None, also inside lists and dictionaries."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value
