"""Parameters of the stabilizer, as a frozen dataclass.

The defaults are HRP-2's. Admittances are divided by the mass, lengths scale with the leg or the sole, and gains over
time do not scale.
"""

from __future__ import annotations

from dataclasses import dataclass

from stepover.model.parameters.entry import parameter


@dataclass(frozen=True)
class Stabilization:
    """Gains and limits of the estimator and the stabilizer."""

    age: float = parameter(
        0.010, "s", "from a reading to the command reached: a period to compute, a period to carry out", most=0.1
    )
    velocity_cutoff: float = parameter(
        8.0, "Hz", "low-pass on the velocity by which the CoM deviates: well above sqrt(g / z_c)"
    )
    contact_share: float = parameter(
        0.03, "share", "of the weight on a foot, from which on it stands: above what a swinging sole reads"
    )
    dcm_proportional: float = parameter(4.0, "1/s", "with which the DCM's deviation decays", source="P S7")
    dcm_integral: float = parameter(2.0, "1/s^2", "published: 15. Here the swaying CoM takes most of a lasting error")
    dcm_leak: float = parameter(3.0, "s", "in which the integral forgets: a few steps")
    dcm_integral_max: float = parameter(0.05, "m", "most of the integral's part of the desired ZMP", scale="toe")
    zmp_inset: float = parameter(0.010, "m", "desired ZMP inside the soles: less than the 15 mm of the checks")
    ankle_admittance: float = parameter(
        0.006, "rad/s/(N m)", "turning speed of a foot for a moment that it lacks; published: 0.01, which rings on "
        "our stiff servos when the readings are 10 ms later (at 0.015 always)", scale="1/mass",
    )  # fmt: skip
    ankle_return: float = parameter(1.0, "s", "in which a foot turns back: longer than a normal step")
    ankle_max_deg: float = parameter(8.0, "deg", "furthest turn: rubber under the largest moment bends by 6")
    com_admittance: float = parameter(
        20.0, "1/s^2", "acceleration of the CoM for a ZMP that is ahead of the desired one; published: 0. With 0 a "
        "foothold 10 mm too high costs more torque",
    )  # fmt: skip
    com_return: float = parameter(4.0, "rad/s", "with which the CoM comes back: about as quick as the pendulum falls")
    com_max: float = parameter(0.05, "m", "furthest displacement of the CoM", scale="leg")
    force_admittance: float = parameter(
        1e-4, "m/s/N", "speed of a foot for a force that it lacks; four times as much swings where a foothold is 10 mm "
        "too high", source="P S7", scale="1/mass",
    )  # fmt: skip
    force_return: float = parameter(1.0, "s", "in which a foot comes back: as the ankles")
    force_max: float = parameter(
        0.03, "m", "furthest displacement of a foot: an unevenness that the legs still reach", scale="leg"
    )
    posture_gain: float = parameter(
        4.0, "1/s", "turning speed of the waist's command for its tilt: it decays before the next step, as the DCM"
    )
    posture_return: float = parameter(1.0, "s", "in which the waist turns back: a fifth of a lasting tilt remains")
    posture_max_deg: float = parameter(6.0, "deg", "furthest turn of the waist")
    height_gain: float = parameter(
        4.0, "1/s", "rising speed of the waist's command for its sinking: servos sag by 3 mm, rubber by 14 mm"
    )
    height_return: float = parameter(1.0, "s", "in which the waist comes down again")
    height_max: float = parameter(
        0.015, "m", "furthest rise of the waist: what the stance knee still has at 30 degrees", scale="leg"
    )
    slope_time: float = parameter(
        0.3, "s", "in which the floor's slope is learnt from the stance foot: within half a normal step"
    )
    slope_max_deg: float = parameter(3.0, "deg", "steepest slope that is believed: twice what we try")
    swing_follow: float = parameter(0.05, "s", "in which a swinging foot's path takes up the waist's true place")
    stance_follow: float = parameter(
        0.07, "s", "in which a standing leg gives it back after landing: longer lets the waist sink"
    )
