"""The force under leg 1 when it lands, at every time step of the physics, with or without what a robot has.

The floor's vertical force on the landing foot is read at every time step and averaged over the 5 ms that end there;
there is no other filter. The peak is the largest from the middle of the swing until the weight has moved over: on
rubber that takes longer than the landing window of simulate, at whose end the force still rises. The touch-down
alone is the largest in the first moments after the first contact.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from stepover.analysis.landing.control import AsPlanned, LandingControl
from stepover.model.gravity import GRAVITY
from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.simulation.disturbances import Disturbances
from stepover.simulation.loop import Guide, Pilot, Plan, floor_changes
from stepover.simulation.motors import IdealMotors, Motors, steps_a_sample
from stepover.simulation.pybullet.world import World
from stepover.simulation.recording import Recording, has_fallen
from stepover.simulation.servos import Servos
from stepover.simulation.touch import NOTHING

AVERAGED = 0.005
"""s: forces are means over this time."""
TOUCHED = 20.0
"""N, a mean over AVERAGED: from there on the foot touches the floor."""
TOUCH_DOWN = 0.03
"""s after the first contact that count as the touch-down."""
SETTLED = 0.25
"""s after the planned touch-down, by which the weight has moved over: so long the force is read."""


@dataclass(frozen=True, eq=False)
class Landing:
    """What happened when leg 1 landed. SI units; n time steps, time zero at the planned touch-down.

    Attributes:
        time: (n,) [s].
        raw: (n,) vertical force of the floor on the landing foot in each time step [N].
        force: (n,) the same as a mean over AVERAGED [N].
        weight: of the robot [N].
        contact: time of the first contact [s].
        speed: the foot's descent just before that, a mean over AVERAGED [m/s].
        touch_down: largest force (a mean) in the first TOUCH_DOWN of contact [N].
        peak: largest force (a mean) at all [N].
        peak_time: when [s].
        fell: why the robot counts as fallen until then; empty where it stands.
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
    """
    disturbances, dt = Disturbances.read(perturb or {}, motion), robot.simulation.time_step
    steps, touch_down = steps_a_sample(motion, dt), motion.samples(1).stop
    last = touch_down + round(SETTLED / motion.dt)
    row = 0 if motion.support[touch_down - 1] < 0 else 1
    forces, heights, fell = np.zeros((2, last, steps)), np.zeros((last, steps)), ""
    with World(robot, motion.obstacle, sole, disturbances) as world:
        world.reset(motion.q[0])
        soft = limited or bool(world.passive)
        motors: Motors = Servos(robot, world, limited) if soft else IdealMotors(world, robot.simulation)
        guide = _guide(robot, world, motion, disturbances, steps, stabilizer, control)
        floor = floor_changes(motion, disturbances)
        if floor:
            world.set_ground(1, 0.0)
        ankle = world.joints[robot.body.column(robot.leg((1, -1)[row]).joints[-1]) - 7]
        recording = Recording(last + 1, len(motion.joint_names), world.description.bush_height)
        recording.add(world, NOTHING, motors.torque, motors.saturated)
        for k in range(last):
            for side, height in floor.get(k, ()):
                world.set_ground(side, height)
            course, contacts = guide.course(k + 1), []
            for step in range(steps):
                motors.drive(course, step)
                world.step()
                present = world.contacts()
                motors.look(present)
                forces[:, k, step] = world.touch(present, 1).feet[:, 2]
                heights[k, step] = world.link_frame(ankle)[0][2]
                contacts += present
            touch = world.touch(contacts, steps)
            recording.add(world, touch, motors.torque, motors.saturated)
            guide.look(touch, recording)
            fell = fell or has_fallen(robot.simulation, recording.q[k + 1, :7], motion.waist[k + 1], touch) or ""
    time = (np.arange(last * steps) + 1) * dt - touch_down * motion.dt
    shown = time > -(touch_down - motion.samples(1).start) * motion.dt / 2.0
    weight = robot.body.mass * GRAVITY
    return measured(time[shown], forces[row].ravel()[shown], heights.ravel()[shown], weight, fell)


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


def _guide(
    robot: Robot, world: World, motion: Motion, disturbances: Disturbances, steps: int, stabilizer: bool, control: bool
) -> Guide:
    """What leads the joints: the plan, the stabilizer, or either with a landing control around it."""
    if not (stabilizer or control):
        return Plan(motion, steps)
    pilot = Pilot(robot, world, motion, disturbances, steps)
    leads = pilot.stabilizer if stabilizer else AsPlanned(motion)
    pilot.stabilizer = LandingControl(robot, motion, leads) if control else leads  # type: ignore[assignment]
    return pilot
