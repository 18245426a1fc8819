"""What moves the joints: the course that they shall take, and motors that follow it, ideal ones or limited servos."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.interpolate import CubicSpline

from stepover.errors import InvalidInput
from stepover.model.parameters.physics import Simulation
from stepover.motion.motion import Motion
from stepover.simulation.pybullet.world import World


@dataclass(frozen=True, eq=False)
class Course:
    """Joint angles that the motors shall follow, a step at a time.

    Attributes:
        angles: (S + 1, nq - 7) at every time step [rad].
        speeds: (S, nq - 7) from each time step to the next [rad/s].
    """

    angles: np.ndarray
    speeds: np.ndarray

    def part(self, first: int, steps: int) -> Course:
        """Some steps of it."""
        return Course(self.angles[first : first + steps + 1], self.speeds[first : first + steps])


def steps_a_sample(motion: Motion, step: float) -> int:
    """Time steps from one sample of a motion to the next.

    Raises:
        InvalidInput: its sample time is no multiple of the time step [s].
    """
    steps = round(motion.dt / step)
    if steps < 1 or abs(steps * step - motion.dt) > 1e-9:
        raise InvalidInput(f"the motion's sample time, {motion.dt:g} s, is no multiple of the time step {step:g} s")
    return steps


def planned_course(motion: Motion, steps: int) -> Course:
    """A whole motion by cubic splines through its samples, with as many time steps from one to the next."""
    samples = np.arange(len(motion.time)) * steps
    spline = CubicSpline(samples, motion.q[:, 7:], bc_type="clamped")
    angles = spline(np.arange(samples[-1] + 1))
    return Course(angles, np.diff(angles, axis=0) / (motion.dt / steps))


def straight_course(begin: np.ndarray, end: np.ndarray, steps: int, duration: float) -> Course:
    """From one command (nq - 7,) straight to the next, within a duration [s]."""
    shares = np.arange(steps + 1)[:, None] / steps
    return Course(begin + shares * (end - begin), np.repeat((end - begin)[None] / duration, steps, axis=0))


class Motors(Protocol):
    """Motors of all joints.

    Attributes:
        torque: (nq - 7,) of the last step [N m].
        saturated: (nq - 7,) whether the last step took all the torque that a motor has.
    """

    torque: np.ndarray
    saturated: np.ndarray

    def drive(self, course: Course, step: int) -> None:
        """Drive the world's next step, along a step of a course."""

    def look(self, contacts: list[tuple]) -> None:
        """Take notice of a step that has passed, and of its contacts."""


class IdealMotors:
    """Position-controlled motors that follow the course without any limit that they could reach."""

    def __init__(self, world: World, parameters: Simulation) -> None:
        """Take hold of a world's joints."""
        self._world, self._parameters = world, parameters
        self.torque = np.zeros(len(world.joints))
        self.saturated = np.zeros(len(world.joints), dtype=bool)

    def drive(self, course: Course, step: int) -> None:
        """Command one time step."""
        torque, correction = self._parameters.ideal_motor_torque, self._parameters.ideal_motor_correction
        self._world.command(course.angles[step], course.speeds[step], torque, correction)

    def look(self, contacts: list[tuple]) -> None:
        """Read the torques that the step took."""
        self.torque = self._world.joint_states()[2]
