"""Joint angles at every time step of the physics, between the samples of a motion or of a controller."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from stepover.errors import InvalidInput
from stepover.motion.motion import Motion


@dataclass(frozen=True, eq=False)
class JointTrajectory:
    """Joint angles that the motors shall follow, S time steps long.

    Attributes:
        angles: (S + 1, J) at the ends of all time steps [rad].
        speeds: (S, J) in each time step [rad/s].
    """

    angles: np.ndarray
    speeds: np.ndarray

    def __len__(self) -> int:
        """How many time steps it has."""
        return len(self.speeds)

    def __iter__(self) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Of each time step the angles at its start and its end, and the speed: what Engine.command takes."""
        return zip(self.angles[:-1], self.angles[1:], self.speeds, strict=True)

    def part(self, first: int, steps: int) -> JointTrajectory:
        """Some time steps of it."""
        return JointTrajectory(self.angles[first : first + steps + 1], self.speeds[first : first + steps])


def steps_a_sample(motion: Motion, step: float) -> int:
    """Time steps from one sample of a motion to the next.

    Raises:
        InvalidInput: its sample time is no multiple of the time step [s].
    """
    steps = round(motion.dt / step)
    if steps < 1 or abs(steps * step - motion.dt) > 1e-9:
        raise InvalidInput(f"the motion's sample time, {motion.dt:g} s, is no multiple of the time step {step:g} s")
    return steps


def spline(motion: Motion, steps: int) -> JointTrajectory:
    """A whole motion by cubic splines through its samples, with so many time steps from one to the next."""
    samples = np.arange(len(motion.time)) * steps
    through = CubicSpline(samples, motion.q[:, 7:], bc_type="clamped")
    angles = through(np.arange(samples[-1] + 1))
    return JointTrajectory(angles, np.diff(angles, axis=0) / (motion.dt / steps))


def straight(begin: np.ndarray, end: np.ndarray, steps: int, duration: float) -> JointTrajectory:
    """At constant speed from angles (J,) to others within a duration [s]."""
    shares = np.arange(steps + 1)[:, None] / steps
    return JointTrajectory(begin + shares * (end - begin), np.repeat((end - begin)[None] / duration, steps, axis=0))
