"""Parameters of the physics, as frozen dataclasses. The defaults are HRP-2's; forces scale with the mass."""

from __future__ import annotations

from dataclasses import dataclass

from stepover.model.parameters.entry import parameter


@dataclass(frozen=True)
class Simulation:
    """The physics that a motion is tried in."""

    time_step: float = parameter(0.001, "s", "fixed", least=1e-5, most=0.1)
    solver_iterations: int = parameter(50, "count", "of the constraint solver, a step: PyBullet's own")
    friction: float = parameter(0.8, "", "between everything: rubber on a dry floor")
    ideal_motor_torque: float = parameter(1e4, "N m", "what an ideal motor may use: never the limit")
    ideal_motor_correction: float = parameter(
        0.1, "", "share of the angle's error that an ideal motor removes in a step: PyBullet's own; near 1 the closed "
        "loop of two feet on the floor locks, and the feet slip",
    )  # fmt: skip
    loaded_share: float = parameter(0.1, "share", "of the weight on the floor, from which on a ZMP is measured")
    landing_window: float = parameter(0.1, "s", "before and after a planned touch-down: where a landing is looked for")
    fall_tilt_deg: float = parameter(30.0, "deg", "waist against the plan: a fall")
    fall_drop: float = parameter(0.1, "m", "waist below the plan: a fall", scale="leg")
    after_fall: float = parameter(0.3, "s", "simulated on, to see how a fall ends")


@dataclass(frozen=True)
class Servo:
    """Limited motors: the torque for a joint's error."""

    leg_stiffness: float = parameter(
        4000.0, "N m/rad", "of the leg joints: 0.8 degrees at the ankle's largest load", scale="mass"
    )
    stiffness_per_torque: float = parameter(
        40.0, "1/rad", "of the other joints, times the torque limit: as that of the legs"
    )
    damping_time: float = parameter(0.015, "s", "damping over stiffness: 60 N m s/rad for the legs")
    speed_fade: float = parameter(0.10, "share", "of the speed limit below it in which the torque fades")


@dataclass(frozen=True)
class SoleRubber:
    """The rubber bush between ankle and sole, and the plate below it."""

    vertical_stiffness: float = parameter(40e3, "N/m", "of a foot", source="P S8", scale="mass")
    vertical_damping: float = parameter(600.0, "N s/m", "of a foot", source="P S8", scale="mass")
    tilt_stiffness: float = parameter(600.0, "N m/rad", "roll and pitch", source="P S8", scale="mass")
    tilt_damping: float = parameter(60.0, "N m s/rad", "roll and pitch", source="P S8", scale="mass")
    mass: float = parameter(0.3, "kg", "of the foot's mass, that is plate", scale="mass")
    bush_mass: float = parameter(0.02, "kg", "of the foot's mass, between the bush's joints: each of two", scale="mass")
