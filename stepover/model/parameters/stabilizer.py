"""Parameters of the stabilizer, as a frozen dataclass.

The defaults are HRP-2's. Admittances are divided by the mass. Lengths scale with the leg or the sole. Gains over time
do not scale.
"""

from __future__ import annotations

from dataclasses import dataclass

from stepover.model.parameters.entry import parameter


@dataclass(frozen=True)
class Stabilization:
    """Gains and limits of the estimator and the stabilizer."""

    age: float = parameter(
        0.010, "s", "time from a reading until its command is reached: one period to compute, one to move", most=0.1
    )
    velocity_cutoff: float = parameter(
        8.0, "Hz", "cutoff of the low-pass on the CoM's velocity error: well above sqrt(g / z_c)"
    )
    contact_share: float = parameter(
        0.03,
        "share",
        "part of the weight from which on a foot counts as standing: above the readings of a swinging sole",
    )
    dcm_proportional: float = parameter(4.0, "1/s", "decay rate of the DCM's deviation", source="P S7")
    dcm_integral: float = parameter(
        2.0, "1/s^2", "integral gain; published: 15. Here the moving CoM removes most of a lasting error"
    )
    dcm_leak: float = parameter(3.0, "s", "time constant in which the integral decays: a few steps")
    dcm_integral_max: float = parameter(0.05, "m", "largest part of the integral in the desired ZMP", scale="toe")
    zmp_inset: float = parameter(
        0.010, "m", "distance of the desired ZMP from the soles' edges: less than the 15 mm of the checks"
    )
    ankle_admittance: float = parameter(
        0.006, "rad/s/(N m)", "turning speed of a foot for a missing moment; published: 0.01. With our stiff servos "
        "that oscillates if the readings are 10 ms later; 0.015 always does", scale="1/mass",
    )  # fmt: skip
    ankle_return: float = parameter(1.0, "s", "time constant in which a foot turns back: longer than a normal step")
    ankle_max_deg: float = parameter(8.0, "deg", "largest turn of a foot: rubber under the largest moment bends by 6")
    com_admittance: float = parameter(
        20.0, "1/s^2", "acceleration of the CoM for a ZMP ahead of the desired one; published: 0. With 0, a "
        "foothold 10 mm too high needs more torque",
    )  # fmt: skip
    com_return: float = parameter(4.0, "rad/s", "frequency of the CoM's return: about as fast as the pendulum falls")
    com_max: float = parameter(0.05, "m", "largest displacement of the CoM", scale="leg")
    force_admittance: float = parameter(
        1e-4, "m/s/N", "speed of a foot for a missing force; four times this value oscillates if a foothold is 10 mm "
        "too high", source="P S7", scale="1/mass",
    )  # fmt: skip
    force_return: float = parameter(1.0, "s", "time constant in which a foot comes back: as for the ankles")
    force_max: float = parameter(
        0.03, "m", "largest displacement of a foot: unevenness within the legs' reach", scale="leg"
    )
    posture_gain: float = parameter(
        4.0,
        "1/s",
        "turning speed of the waist's command for its tilt: the tilt decays before the next step, as the DCM does",
    )
    posture_return: float = parameter(
        1.0, "s", "time constant in which the waist turns back: a fifth of a lasting tilt remains"
    )
    posture_max_deg: float = parameter(6.0, "deg", "largest turn of the waist")
    height_gain: float = parameter(
        4.0, "1/s", "rising speed of the waist's command for its sag: servos sag by 3 mm, rubber by 14 mm"
    )
    height_return: float = parameter(1.0, "s", "time constant in which the waist comes down again")
    height_max: float = parameter(
        0.015, "m", "largest rise of the waist: within reach of the stance knee at 30 degrees", scale="leg"
    )
    slope_time: float = parameter(
        0.3, "s", "time constant of the slope estimate from the stance foot: within half a normal step"
    )
    slope_max_deg: float = parameter(3.0, "deg", "steepest slope accepted: twice the steepest that we test")
    swing_follow: float = parameter(0.05, "s", "time in which a swinging leg changes to the waist's true place")
    stance_follow: float = parameter(
        0.07, "s", "time in which a standing leg changes back after landing; with a longer time the waist sinks"
    )
