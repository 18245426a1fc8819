"""What robot.toml says to the physics, as frozen dataclasses: every field with its unit."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Simulation:
    """The physics. Times in s, torques in N m, lengths in m, angles in degrees; friction and shares without unit."""

    time_step: float
    solver_iterations: int
    friction: float
    ideal_motor_torque: float
    ideal_motor_correction: float
    loaded_share: float
    landing_window: float
    fall_tilt_deg: float
    fall_drop: float
    after_fall: float


@dataclass(frozen=True)
class Servo:
    """Limited motors: stiffness in N m/rad, and in 1/rad per N m of the torque limit; time in s, fade a share."""

    leg_stiffness: float
    stiffness_per_torque: float
    damping_time: float
    speed_fade: float


@dataclass(frozen=True)
class SoleRubber:
    """The rubber between ankle and sole: N/m, N s/m, N m/rad, N m s/rad; masses in kg."""

    vertical_stiffness: float
    vertical_damping: float
    tilt_stiffness: float
    tilt_damping: float
    mass: float
    bush_mass: float
