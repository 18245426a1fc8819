"""What robot.toml says to the stabilizer, as a frozen dataclass: every field with its unit."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Stabilization:
    """Gains and limits of the estimator and the stabilizer.

    Attributes:
        age: of the readings, when the command that they lead to is reached: computing and carrying out [samples].
        velocity_cutoff: of the low-pass filter on the CoM's velocity [Hz].
        contact_share: of the weight on a foot, from which on it counts as standing.
        dcm_proportional: [1/s], of the DCM's error.
        dcm_integral: [1/s^2], of its integral.
        dcm_leak: time in which the integral forgets [s].
        dcm_integral_max: most of the integral's part of the desired ZMP [m].
        zmp_inset: of the desired ZMP from the edge of the support polygon, at least [m].
        ankle_admittance: turning speed of a foot for a moment that it lacks [rad/s / (N m)].
        ankle_return: time in which it turns back [s].
        ankle_max_deg: furthest turn [deg].
        com_admittance: acceleration of the CoM for a ZMP that is ahead of the desired one [1/s^2].
        com_return: natural frequency with which it comes back [rad/s].
        com_max: furthest displacement [m].
        force_admittance: speed of a foot for a force that it lacks [m/s / N].
        force_return: time in which it comes back [s].
        force_max: furthest displacement [m].
        posture_gain: turning speed of the waist's command for its tilt [1/s].
        posture_return: time in which it turns back [s].
        posture_max_deg: furthest turn [deg].
        height_gain: rising speed of the waist's command for its sinking [1/s].
        height_return: time in which it comes down again [s].
        height_max: furthest displacement [m].
        slope_time: in which the floor's slope is learnt from the stance foot [s].
        slope_max_deg: most that is believed [deg].
        swing_follow: time in which a swinging leg takes the true waist for the commanded one [s].
        stance_follow: time in which a standing leg goes back to the commanded one [s].
    """

    age: int
    velocity_cutoff: float
    contact_share: float
    dcm_proportional: float
    dcm_integral: float
    dcm_leak: float
    dcm_integral_max: float
    zmp_inset: float
    ankle_admittance: float
    ankle_return: float
    ankle_max_deg: float
    com_admittance: float
    com_return: float
    com_max: float
    force_admittance: float
    force_return: float
    force_max: float
    posture_gain: float
    posture_return: float
    posture_max_deg: float
    height_gain: float
    height_return: float
    height_max: float
    slope_time: float
    slope_max_deg: float
    swing_follow: float
    stance_follow: float
