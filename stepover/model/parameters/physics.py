"""Parameters of the physics, as frozen dataclasses. The defaults are HRP-2's; forces scale with the mass."""

from __future__ import annotations

from dataclasses import dataclass

from stepover.model.parameters.entry import parameter


@dataclass(frozen=True)
class Simulation:
    """The physics simulation."""

    time_step: float = parameter(0.001, "s", "time step, fixed", least=1e-5, most=0.1)
    solver_iterations: int = parameter(
        200, "count", "PyBullet: rounds of the solver per step. With its default, 50, the ZMP's error is twice as large"
    )
    contact_time: float = parameter(
        0.002, "s", "MuJoCo: time in which a contact settles. It allows two time steps at least. With its default, "
        "20 ms, the ZMP's error is three times as large", least=1e-4, most=0.1,
    )  # fmt: skip
    friction_stiffness: float = parameter(
        10.0, "", "MuJoCo: stiffness of friction over that of the normal direction. With 1, loaded feet creep by 0.5 mm"
    )
    friction: float = parameter(0.8, "", "friction of all contacts: rubber on a dry floor")
    ideal_motor_torque: float = parameter(1e4, "N m", "largest torque of an ideal motor, never reached")
    ideal_motor_correction: float = parameter(
        0.1, "", "share of the angle error that an ideal motor removes per step: PyBullet's default. Near 1 the closed "
        "loop of two feet on the floor locks, and the feet slip",
    )  # fmt: skip
    loaded_share: float = parameter(0.1, "share", "share of the weight on the floor above which the ZMP is measured")
    landing_window: float = parameter(
        0.1, "s", "time before and after a planned touch-down in which a landing is searched"
    )
    fall_tilt_deg: float = parameter(30.0, "deg", "tilt of the waist from its plan that counts as a fall")
    fall_drop: float = parameter(0.1, "m", "drop of the waist below its plan that counts as a fall", scale="leg")
    after_fall: float = parameter(0.3, "s", "time simulated after a fall, to see how it ends")


@dataclass(frozen=True)
class Servo:
    """Limited motors: their torque for a joint's error."""

    leg_stiffness: float = parameter(
        4000.0,
        "N m/rad",
        "stiffness of the leg joints: they yield by 0.8 degrees at the ankle's largest load",
        scale="mass",
    )
    stiffness_per_torque: float = parameter(
        40.0, "1/rad", "stiffness of other joints over their torque limit: as for the legs"
    )
    damping_time: float = parameter(0.015, "s", "damping over stiffness: 60 N m s/rad for the legs")
    speed_fade: float = parameter(0.10, "share", "part of the speed limit, just below it, in which the torque fades")


@dataclass(frozen=True)
class SoleRubber:
    """The rubber bush between ankle and sole, and the plate below it."""

    vertical_stiffness: float = parameter(40e3, "N/m", "stiffness of one foot", source="P S8", scale="mass")
    vertical_damping: float = parameter(600.0, "N s/m", "damping of one foot", source="P S8", scale="mass")
    tilt_stiffness: float = parameter(600.0, "N m/rad", "stiffness in roll and pitch", source="P S8", scale="mass")
    tilt_damping: float = parameter(60.0, "N m s/rad", "damping in roll and pitch", source="P S8", scale="mass")
    mass: float = parameter(0.3, "kg", "part of the foot's mass in the plate", scale="mass")
    bush_mass: float = parameter(
        0.02, "kg", "part of the foot's mass in each of the two links inside the bush", scale="mass"
    )
