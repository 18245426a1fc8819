"""Settings of simulated landings: named variations of motors, soles, floor and control. Sec. II-C, III-B."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

from stepover.analysis.landing.force import Landing, land
from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.simulation.engine import DEFAULT


@dataclass(frozen=True)
class Setting:
    """Setting of a simulated landing. Factors multiply the robot's parameters.

    Attributes:
        sole, limited, stabilizer, control: as in land.
        rubber_stiffness, rubber_damping: factors of the rubber's vertical stiffness and damping.
        rubber_tilt: factor of the rubber's stiffness and damping in tilt.
        servo: factor of the legs' servo stiffness.
        time_step: factor of the physics' time step.
        ground: height of the floor under the foothold of leg 1 [m].
    """

    sole: str = "compliant"
    limited: bool = True
    stabilizer: bool = True
    control: bool = False
    rubber_stiffness: float = 1.0
    rubber_damping: float = 1.0
    rubber_tilt: float = 1.0
    servo: float = 1.0
    time_step: float = 1.0
    ground: float = 0.0

    def of(self, robot: Robot) -> Robot:
        """The robot with the factors applied."""
        sole, servo, physics = robot.sole, robot.servo, robot.simulation
        return dataclasses.replace(
            robot,
            sole=dataclasses.replace(
                sole, vertical_stiffness=sole.vertical_stiffness * self.rubber_stiffness,
                vertical_damping=sole.vertical_damping * self.rubber_damping,
                tilt_stiffness=sole.tilt_stiffness * self.rubber_tilt,
                tilt_damping=sole.tilt_damping * self.rubber_tilt,
            ),
            servo=dataclasses.replace(servo, leg_stiffness=servo.leg_stiffness * self.servo),
            simulation=dataclasses.replace(physics, time_step=physics.time_step * self.time_step),
        )  # fmt: skip

    def land(self, robot: Robot, motion: Motion, engine: str = DEFAULT) -> Landing:
        """Simulate the landing of a motion with this setting, in an engine."""
        perturb = {"ground_leg_1": self.ground} if self.ground else {}
        return land(self.of(robot), motion, limited=self.limited, sole=self.sole, stabilizer=self.stabilizer,
                    control=self.control, perturb=perturb, engine=engine)  # fmt: skip

    @property
    def assumptions(self) -> int:
        """Number of differences from servos and stabilizer on the published rubber."""
        return sum(getattr(self, field.name) != field.default for field in dataclasses.fields(self))


def _varied(base: Setting, names: dict[str, dict[str, float | bool]]) -> dict[str, Setting]:
    """Variations of a base case."""
    return {name: dataclasses.replace(base, **values) for name, values in names.items()}  # type: ignore[arg-type]


RUBBER, RIGID = Setting(), Setting(sole="rigid")
"""Both base cases: servos and stabilizer on rubber as published, and on rigid soles."""
IDEAL = Setting(sole="rigid", limited=False, stabilizer=False)
"""The setting of the paper's simulation."""
BASES = ("rubber as published", "rigid soles")
NOISY = "rigid, ideal motors"
"""The setting in which peaks come from the contact solver."""
FITTED = "rubber: hardly tilts, 5 x damping"
"""The setting fitted to the paper's pair of forces. The fit also needs a faster naive swing."""
VARIATIONS = {
    **_varied(RUBBER, {
        BASES[0]: {},
        "rubber: 1/2 stiffness": {"rubber_stiffness": 0.5},
        "rubber: 2 x stiffness": {"rubber_stiffness": 2.0},
        "rubber: 4 x damping": {"rubber_damping": 4.0},
        "rubber: hardly tilts": {"rubber_tilt": 10.0},
        "rubber: hardly tilts, 4 x damping": {"rubber_tilt": 10.0, "rubber_damping": 4.0},
        FITTED: {"rubber_tilt": 10.0, "rubber_damping": 5.0},
        "the same, no stabilizer": {"rubber_tilt": 10.0, "rubber_damping": 5.0, "stabilizer": False},
        "the same, landing control": {"rubber_tilt": 10.0, "rubber_damping": 5.0, "control": True},
        "rubber, servos 1/2 as stiff": {"servo": 0.5},
        "rubber, servos 2 x as stiff": {"servo": 2.0},
        "rubber, floor 10 mm higher": {"ground": 0.01},
        "rubber, floor 10 mm lower": {"ground": -0.01},
        "rubber, no stabilizer": {"stabilizer": False},
        "rubber, landing control": {"control": True},
    }),
    **_varied(RIGID, {
        BASES[1]: {},
        "rigid, servos 1/2 as stiff": {"servo": 0.5},
        "rigid, servos 1.5 x as stiff": {"servo": 1.5},
        "rigid, servos 2 x as stiff": {"servo": 2.0},
        "rigid, floor 10 mm higher": {"ground": 0.01},
        "rigid, floor 10 mm lower": {"ground": -0.01},
        "rigid, no stabilizer": {"stabilizer": False},
        "rigid, landing control": {"control": True},
        "rigid, 1/2 time step": {"time_step": 0.5},
    }),
    **_varied(IDEAL, {NOISY: {}, "rigid, ideal motors, 1/2 time step": {"time_step": 0.5}}),
}  # fmt: skip
"""All variations, by name."""
