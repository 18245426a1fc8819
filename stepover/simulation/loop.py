"""The physics, step by step: motors, floor, pushes, the stabilizer's commands, and what is recorded."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from stepover.control.stabilizer import Stabilizer
from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.simulation.disturbances import Disturbances
from stepover.simulation.motors import Course, IdealMotors, Motors, planned_course, steps_a_sample, straight_course
from stepover.simulation.pybullet.world import World
from stepover.simulation.recording import Recording, has_fallen
from stepover.simulation.sensing import Senses
from stepover.simulation.servos import Servos
from stepover.simulation.touch import NOTHING, Touch


class Guide(Protocol):
    """Says what course the joints shall take from one sample of the motion to the next."""

    def course(self, sample: int) -> Course:
        """To a sample from the one before it."""

    def look(self, touch: Touch, recording: Recording) -> None:
        """Take notice of a sample that has been reached."""


class Plan:
    """Open loop: the motion as it is."""

    def __init__(self, motion: Motion, steps: int) -> None:
        """Interpolate the motion, as many time steps a sample."""
        self._whole, self._steps = planned_course(motion, steps), steps

    def course(self, sample: int) -> Course:
        """Along the spline."""
        return self._whole.part((sample - 1) * self._steps, self._steps)

    def look(self, touch: Touch, recording: Recording) -> None:
        """Nothing is sensed."""


class Pilot:
    """The stabilizer, which sees what the senses read and nothing else.

    It works out a command from the readings of one sample before, and in the time until the next sample the motors
    go straight to it: so the command for a sample rests on what was sensed two samples earlier, plus extra latency.
    """

    def __init__(self, robot: Robot, world: World, motion: Motion, disturbances: Disturbances, steps: int) -> None:
        """Begin where the motion does."""
        self.stabilizer = Stabilizer(robot, motion, bool(world.passive))
        self._senses = Senses(robot, world, disturbances, motion.dt)
        self._steps, self._period, self._command = steps, motion.dt, motion.q[0, 7:]
        self._senses.read(NOTHING)

    def course(self, sample: int) -> Course:
        """From the last command to a new one."""
        before = self._command
        self._command = self.stabilizer.command(sample, self._senses.late(self._period))
        return straight_course(before, self._command, self._steps, self._period)

    def look(self, touch: Touch, recording: Recording) -> None:
        """Read the sensors; and write down where the stabilizer takes the robot to be."""
        self._senses.read(touch)
        estimate = self.stabilizer.estimate
        if estimate is not None:
            recording.believe(recording.count - 3, estimate.waist, estimate.com)


def carry_out(
    world: World,
    robot: Robot,
    motion: Motion,
    disturbances: Disturbances,
    limited: bool,
    stabilizer: bool,
    progress: Callable[[float], None],
) -> tuple[Recording, tuple[int, str] | None]:
    """To the end of the motion, or a while after a fall.

    Returns:
        What was recorded; the sample of a fall and what it shows by, or None.
    """
    parameters, last = robot.simulation, len(motion.time) - 1
    steps = steps_a_sample(motion, parameters.time_step)
    world.reset(motion.q[0])
    soft = limited or bool(world.passive)
    motors: Motors = Servos(robot, world, limited) if soft else IdealMotors(world, parameters)
    guide: Guide = Pilot(robot, world, motion, disturbances, steps) if stabilizer else Plan(motion, steps)
    floor = floor_changes(motion, disturbances)
    if floor:
        world.set_ground(1, 0.0)
    recording = Recording(len(motion.time), len(motion.joint_names), world.description.bush_height)
    recording.add(world, NOTHING, motors.torque, motors.saturated)
    fall: tuple[int, str] | None = None
    while recording.count <= last:
        k = recording.count
        for side, height in floor.get(k - 1, ()):
            world.set_ground(side, height)
        touch, torque, saturated = _one_sample(world, motors, guide.course(k), disturbances, motion.time[k - 1])
        recording.add(world, touch, torque, saturated)
        guide.look(touch, recording)
        reason = None if fall else has_fallen(parameters, recording.q[k, :7], motion.waist[k], touch)
        if reason:
            fall = k, reason
            last = min(last, k + round(parameters.after_fall / motion.dt))
        if k % 100 == 0 or k == last:
            progress(k / last)
    return recording, fall


def _one_sample(
    world: World, motors: Motors, course: Course, disturbances: Disturbances, time: float
) -> tuple[Touch, np.ndarray, np.ndarray]:
    """The time steps of a course, which begins at a time [s].

    Returns:
        Mean wrenches and findings, mean motor torques (nq - 7,), and which motors were saturated in any step.
    """
    contacts, torque, saturated = [], np.zeros(len(motors.torque)), np.zeros(len(motors.torque), dtype=bool)
    steps = len(course.speeds)
    for step in range(steps):
        motors.drive(course, step)
        if disturbances.pushes:
            world.push(disturbances.push(time + step * world.time_step))
        world.step()
        present = world.contacts()
        motors.look(present)
        contacts += present
        torque += motors.torque
        saturated |= motors.saturated
    return world.touch(contacts, steps), torque / steps, saturated


def floor_changes(motion: Motion, disturbances: Disturbances) -> dict[int, list[tuple[int, float]]]:
    """When the floor of a foot moves, by sample: side and height [m]; in the middle of the swing to each foothold."""
    heights = disturbances.floor(motion)
    changes: dict[int, list[tuple[int, float]]] = {}
    if not heights.any():
        return changes
    for touch_down, side, height in zip(motion.footsteps.time, motion.footsteps.side, heights, strict=True):
        landing = int(np.searchsorted(motion.time, touch_down - 1e-9))
        if landing == len(motion.time):
            continue  # a motion that was cut
        swinging = motion.support[:landing] == -side
        still = np.flatnonzero(~swinging[: int(np.flatnonzero(swinging)[-1])])
        lift_off = int(still[-1]) if len(still) else 0
        changes.setdefault((lift_off + landing) // 2, []).append((int(side), float(height)))
    return changes
