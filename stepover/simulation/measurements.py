"""The result of a simulation: reported numbers, and the time series behind them."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from stepover.motion.motion import Motion


@dataclass(frozen=True, eq=False)
class Series:
    """Measured series in SI units, with M samples at the motion's sample times. They end when the physics ends.

    Forces and torques are means over the last 5 ms. They are zero at the first sample.

    Attributes:
        time: (M,) the motion's time.
        q: (M, nq) measured configurations, in pinocchio's order.
        dq: (M, nq - 7) joint speeds.
        torque: (M, nq - 7) motor torques.
        left_foot, right_foot: (M, 7) measured sole poses, below the rubber if there is any.
        bush: (M, 6) deflections of the rubber: left up, roll, pitch, then right [m, rad]; zero for rigid soles.
        left_wrench, right_wrench: (M, 6) force and moment of the floor on each foot, about the world's origin.
        com: (M, 3) centre of mass.
        zmp: (M, 2) measured ZMP: the point where the floor's forces on the whole robot have no horizontal moment. NaN
            if the floor bears less than the loaded share of the weight.
        zmp_margin: (M,) distance of the ZMP from the edge of the support polygon; negative outside. The polygon covers
            the contact patches of the feet that bear at least the loaded share of the weight, at their measured
            places. The soles themselves are larger than the contact patches.
        clearance: (M,) signed distance of the whole robot from the bare obstacle; a lower bound if the nearest points
            lie on two edges.
        waist_error: (M,) distance of the waist from its planned place.
        obstacle_depth: (M,) largest depth of a contact with the obstacle; NaN without contact.
        zmp_error: (M, 2) measured ZMP minus the motion's reference.
        waist_believed_error, com_believed_error: (M, 3) the stabilizer's estimates of waist and CoM minus their true
            places; NaN without a stabilizer.
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
    """A simulation's result in SI units. The numbers cover all samples up to the end, or up to a fall.

    Attributes:
        fell, fall_time, fall_reason: whether the robot fell, when [s], and how, in one sentence; time and reason are
            None without a fall.
        obstacle_contacts: number of samples (5 ms) in which a link touches the obstacle.
        clearance_min, clearance_link: smallest signed distance of all links from the bare obstacle [m].
        zmp_rms: measured ZMP against the motion's reference over all loaded samples, [x, y] [m].
        landing_force_peak: largest vertical force on the foot of leg 1 and of leg 2 within the landing window around
            its planned touch-down [N]. The force is a mean over 5 ms, without any other filter.
        waist_error_max: largest distance of the waist from its planned place [m].
        torque_ratio_max, speed_ratio_max: largest torque (mean over 5 ms) and speed over the joint's limit.
        torque_saturated_samples: number of samples with a torque at or beyond the limit, by joint; joints without any
            are left out.
        speed_violation_samples: the same for speeds beyond the limit.
        actuators, sole, stabilizer: options of the simulation.
        duration: simulated time [s].
        realtime_factor: simulated time over computing time.
        perturb: values of the disturbances by name.
        engine: name of the physics engine.
        state_hash: SHA-256 of all recorded states, torques and forces, to the last bit.
        contact_reason: the first contact with the obstacle, in one sentence; None without contact.
        motion: the planned motion.
        obstacle: (4,) rectangle x_min, x_max, z_min, z_max of the bare obstacle at its true place [m].
        series: the time series behind the numbers.
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
        """Whether the robot finished the motion, upright and without touching the obstacle."""
        return not self.fell and self.obstacle_contacts == 0

    @property
    def explanation(self) -> str:
        """One sentence for each failure; empty without a failure."""
        return "; ".join(reason for reason in (self.contact_reason, self.fall_reason) if reason)

    def to_json(self) -> dict[str, Any]:
        """The numbers that `simulate --json` prints. NaN and infinity are None."""
        beyond = ("contact_reason", "motion", "obstacle", "series")
        numbers = {f.name: _plain(getattr(self, f.name)) for f in fields(self) if f.name not in beyond}
        return {"crossed": self.crossed} | numbers


def _plain(value: Any) -> Any:
    """Replace NaN and infinity by None, also inside lists and dictionaries."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value
