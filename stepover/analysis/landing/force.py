"""The force under leg 1 when it lands, at every time step of the physics.

The floor's vertical force on the landing foot is read at every time step and averaged over the last 5 ms. There is no
other filter. The peak is the largest force from the middle of the swing until the weight has moved to the foot. On
rubber this takes longer than the landing window of simulate, at whose end the force still rises. The touch-down force
is the largest force in the first moments of contact.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from stepover.analysis.landing.control import AsPlanned, LandingControl
from stepover.control.stabilizer import Stabilizer
from stepover.model.gravity import GRAVITY
from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.simulation.commands import Controller, commands_of
from stepover.simulation.disturbances import Disturbances
from stepover.simulation.engine import DEFAULT, Engine, Scene, engine_named
from stepover.simulation.loop import carry_out
from stepover.simulation.observers import Observer, Sample

AVERAGED = 0.005
"""Time over which forces are averaged [s]."""
TOUCHED = 20.0
"""Averaged force from which on the foot counts as touching the floor [N]."""
TOUCH_DOWN = 0.03
"""Time after the first contact that counts as touch-down [s]."""
SETTLED = 0.25
"""Time after the planned touch-down until which the force is read [s]. By then the weight has moved to the foot."""


@dataclass(frozen=True, eq=False)
class Landing:
    """Measurements of leg 1's landing in SI units, for n time steps. Time zero is the planned touch-down.

    Attributes:
        time: (n,) [s].
        raw: (n,) vertical force of the floor on the landing foot in each time step [N].
        force: (n,) the same as a mean over AVERAGED [N].
        weight: weight of the robot [N].
        contact: time of the first contact [s].
        speed: the foot's speed of descent just before contact, a mean over AVERAGED [m/s].
        touch_down: largest averaged force in the first TOUCH_DOWN of contact [N].
        peak: largest averaged force [N].
        peak_time: time of the peak [s].
        fell: why the robot counts as fallen; empty if it stands.
    """

    time: np.ndarray
    raw: np.ndarray
    force: np.ndarray
    weight: float
    contact: float
    speed: float
    touch_down: float
    peak: float
    peak_time: float
    fell: str


def land(
    robot: Robot,
    motion: Motion,
    *,
    limited: bool = True,
    sole: str = "compliant",
    stabilizer: bool = True,
    control: bool = False,
    perturb: Mapping[str, float] | None = None,
    engine: str = DEFAULT,
) -> Landing:
    """Carry a motion out until leg 1 has landed, and read the force.

    Args:
        robot: the robot; another rubber, servo or time step by dataclasses.replace.
        motion: from landing_motion.
        limited: servos with limits, or ideal motors.
        sole: "rigid" or "compliant".
        stabilizer: with or without it.
        control: whether a LandingControl stops the descent.
        perturb: as in simulate.
        engine: as in simulate.
    """
    disturbances = Disturbances.read(perturb or {}, motion)
    actuators = "limited" if limited else "ideal"
    scene = Scene(robot, (disturbances.obstacle(motion.obstacle),), actuators, sole, disturbances)
    lift_off, touch_down = motion.samples(1).start, motion.samples(1).stop
    last = touch_down + round(SETTLED / motion.dt)
    force = LandingForce(0 if motion.support[touch_down - 1] < 0 else 1)
    with engine_named(engine)(scene) as world:
        controller = _controller(robot, motion, sole == "compliant", stabilizer, control)
        fall = carry_out(world, motion, commands_of(controller, motion, world), [force], until=last)
    time = (np.arange(len(force.raw)) + 1) * robot.simulation.time_step - touch_down * motion.dt
    shown = time > -(touch_down - lift_off) * motion.dt / 2.0
    raw, heights, weight = np.array(force.raw)[shown], np.array(force.heights)[shown], robot.body.mass * GRAVITY
    return measured(time[shown], raw, heights, weight, fall.reason if fall else "")


class LandingForce(Observer):
    """Reads one foot at every time step.

    Attributes:
        raw: vertical force of the floor on the foot in each step [N].
        heights: of the ankle at the end of each step [m].
    """

    def __init__(self, foot: int) -> None:
        """Watch a foot, 0 left or 1 right."""
        self._foot = foot
        self.raw: list[float] = []
        self.heights: list[float] = []

    def stepped(self, engine: Engine) -> None:
        """Read the height."""
        self.heights.append(engine.ankle(self._foot)[0][2])

    def sampled(self, sample: Sample) -> None:
        """Read the forces of the steps since the sample before."""
        steps = range(len(self.heights) - len(self.raw))
        self.raw += [sample.contacts.floor_force(self._foot, step)[2] for step in steps]


def measured(time: np.ndarray, raw: np.ndarray, heights: np.ndarray, weight: float, fell: str = "") -> Landing:
    """Read contact and peaks out of the vertical force.

    Args:
        time: (n,) of the ends of the time steps, zero at the planned touch-down [s].
        raw: (n,) force in each [N].
        heights: (n,) of the ankle at its end [m].
        weight: of the robot [N].
        fell: why it counts as fallen.
    """
    dt = float(time[1] - time[0])
    count = round(AVERAGED / dt)
    force = np.convolve(raw, np.full(count, 1.0 / count))[: len(raw)]
    touching = np.flatnonzero(force > TOUCHED)
    if len(touching) == 0:
        nothing = float("nan")
        return Landing(time, raw, force, weight, nothing, nothing, nothing, nothing, nothing, fell)
    first, highest = int(touching[0]), int(force.argmax())
    free = max(first - count, count)  # the whole mean lies before the first contact
    speed = float(heights[free - count] - heights[free]) / (count * dt)
    early = float(force[first : first + round(TOUCH_DOWN / dt)].max())
    peak, when = float(force[highest]), float(time[highest])
    return Landing(time, raw, force, weight, float(time[first]), speed, early, peak, when, fell)


def _controller(robot: Robot, motion: Motion, rubber: bool, stabilizer: bool, control: bool) -> Controller | None:
    """The stabilizer, or none, with a landing control around it where there is one."""
    inner = Stabilizer(robot, motion, rubber) if stabilizer else None
    return LandingControl(robot, motion, inner or AsPlanned(motion)) if control else inner
