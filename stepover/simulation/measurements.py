"""The result of a simulation: the numbers that are reported, and the series that they were made from."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from stepover.motion.motion import Motion


@dataclass(frozen=True, eq=False)
class Series:
    """Measured series, M samples at the motion's sample times, as long as the physics ran. SI units.

    Forces and torques are means over the 5 ms since the sample before, zero at the first sample.

    Attributes:
        time: (M,) the motion's time.
        q: (M, nq) measured configurations, in pinocchio's order.
        dq: (M, nq - 7) joint speeds.
        torque: (M, nq - 7) motor torques.
        left_foot, right_foot: (M, 7) measured sole poses, beyond the rubber where there is any.
        bush: (M, 6) deflections of the rubber: left up, roll, pitch, then right [m, rad]; zero on rigid soles.
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
        zmp_error: (M, 2) measured ZMP minus the motion's reference.
        waist_believed_error, com_believed_error: (M, 3) where the stabilizer's estimator took waist and CoM to be,
            minus where they were; NaN without a stabilizer.
    """

    time: np.ndarray
    q: np.ndarray
    dq: np.ndarray
    torque: np.ndarray
    left_foot: np.ndarray
    right_foot: np.ndarray
    bush: np.ndarray
    left_wrench: np.ndarray
    right_wrench: np.ndarray
    com: np.ndarray
    zmp: np.ndarray
    zmp_margin: np.ndarray
    clearance: np.ndarray
    waist_error: np.ndarray
    obstacle_depth: np.ndarray
    zmp_error: np.ndarray
    waist_believed_error: np.ndarray
    com_believed_error: np.ndarray


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
        speed_violation_samples: samples with a speed beyond the limit, of the joints that have any.
        actuators, sole, stabilizer: how it was simulated.
        duration: simulated time [s].
        realtime_factor: simulated time over computing time.
        perturb: what was otherwise than planned, by name.
        engine: the physics engine, by name.
        state_hash: SHA-256 of all recorded states, torques and forces, to the last bit.
        contact_reason: the first contact with the obstacle, in one sentence; None where there is none.
        motion: what was carried out.
        obstacle: (4,) rectangle x_min, x_max, z_min, z_max of the bare obstacle, where it really was [m].
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
    speed_violation_samples: dict[str, int]
    perturb: dict[str, float]
    engine: str
    contact_reason: str | None
    motion: Motion
    obstacle: np.ndarray
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
        beyond = ("contact_reason", "motion", "obstacle", "series")
        numbers = {f.name: _plain(getattr(self, f.name)) for f in fields(self) if f.name not in beyond}
        return {"crossed": self.crossed} | numbers


def _plain(value: Any) -> Any:
    """NaN and infinity as None, also inside lists and dictionaries."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value
