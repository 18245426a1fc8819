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
