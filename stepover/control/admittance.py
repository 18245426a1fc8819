"""The stabilizer's loops. Each has a state, updated once a period. After Kajita et al. (2010), Caron et al. (2019).

A robot with stiff joints yields only if its command moves. An error of a sensor becomes a speed of the command, and a
slow return takes the motion back.
"""

from __future__ import annotations

import numpy as np

State = np.ndarray


def damped(state: State, lack: State, admittance: float, back: float, most: float, dt: float) -> State:
    """One period of damping control: x' = admittance * lack - x / back, within +-most.

    Kajita et al. (2010), Sec. IV: the law for both the ankles and the force difference.

    Args:
        state: the state x.
        lack: the error to remove.
        admittance: speed of x for an error of one.
        back: time constant of the return of x [s].
        most: largest absolute value of x.
        dt: period [s].
    """
    return bounded(state + dt * (admittance * lack - state / back), -most, most)


def bounded(value: State, low: State | float, high: State | float) -> State:
    """Clip to bounds. Faster than np.clip for a few numbers."""
    return np.asarray(np.minimum(np.maximum(value, low), high))


class Integral:
    """A leaky integral without wind-up: it stops if its effect is cut off anyway."""

    def __init__(self, leak: float, most: float, dt: float) -> None:
        """Start at zero. Takes the leak time [s], the largest value of each component and the period [s]."""
        self.value = np.zeros(2)
        self._leak, self._most, self._dt = leak, most, dt

    def add(self, error: np.ndarray, cut: np.ndarray) -> None:
        """Integrate one period.

        Args:
            error: (2,) error to integrate.
            cut: (2,) part that was cut off from the command. An error with the same sign would only increase the cut,
                so it is not integrated.
        """
        grown = np.where(error * cut > 0.0, 0.0, error)
        self.value = bounded(self.value + self._dt * (grown - self.value / self._leak), -self._most, self._most)


class Swaying:
    """CoM admittance with a return: x'' = admittance * lack - 2 w x' - w^2 x, within +-most.

    Caron et al. (2019): the CoM accelerates if the ZMP differs from the desired one. There a whole-body controller
    brings the CoM back; here a critically damped spring does.
    """

    def __init__(self, admittance: float, frequency: float, most: float, dt: float) -> None:
        """Start at rest. Takes the admittance [1/s^2], return frequency [rad/s], largest offset [m] and period [s]."""
        self.offset, self._speed = np.zeros(2), np.zeros(2)
        self._admittance, self._frequency, self._most, self._dt = admittance, frequency, most, dt

    def add(self, lack: np.ndarray) -> None:
        """Advance one period. The ZMP is ahead of the desired one by lack (2,) [m]."""
        back = 2.0 * self._frequency * self._speed + self._frequency**2 * self.offset
        self._speed = self._speed + self._dt * (self._admittance * lack - back)
        free = self.offset + self._dt * self._speed
        self.offset = bounded(free, -self._most, self._most)
        self._speed = np.where(self.offset == free, self._speed, 0.0)
