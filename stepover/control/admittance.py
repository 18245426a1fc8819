"""The loops of the stabilizer, each a state that is fed once a period: after Kajita et al. (2010), Caron et al. (2019).

A robot whose joints are stiff gives way where it is told to: what a sensor lacks becomes a speed of the command, and
a slow return takes it back.
"""

from __future__ import annotations

import numpy as np

State = np.ndarray


def damped(state: State, lack: State, admittance: float, back: float, most: float, dt: float) -> State:
    """One period of damping control: x' = admittance * lack - x / back, within +-most.

    Kajita et al. (2010), Sec. IV: the law of both the ankles and the force difference.

    Args:
        state: x itself.
        lack: what is to vanish.
        admittance: speed of x for a lack of one.
        back: time in which x returns [s].
        most: largest absolute value of x.
        dt: period [s].
    """
    return bounded(state + dt * (admittance * lack - state / back), -most, most)


def bounded(value: State, low: State | float, high: State | float) -> State:
    """Within bounds; quicker than np.clip for a few numbers."""
    return np.asarray(np.minimum(np.maximum(value, low), high))


class Integral:
    """A leaky integral that cannot wind up: it stands still where its effect is cut off anyway."""

    def __init__(self, leak: float, most: float, dt: float) -> None:
        """Begin at zero. Leak time [s], largest value of each component, period [s]."""
        self.value = np.zeros(2)
        self._leak, self._most, self._dt = leak, most, dt

    def add(self, error: np.ndarray, cut: np.ndarray) -> None:
        """Integrate one period.

        Args:
            error: (2,) to integrate.
            cut: (2,) what was cut off from the command in which the integral takes part; an error of the same sign
                would only lead further out.
        """
        grown = np.where(error * cut > 0.0, 0.0, error)
        self.value = bounded(self.value + self._dt * (grown - self.value / self._leak), -self._most, self._most)


class Swaying:
    """CoM admittance with a way back: x'' = admittance * lack - 2 w x' - w^2 x, within +-most.

    Caron et al. (2019): the CoM's acceleration answers a ZMP that is not the desired one. There the tasks of a
    whole-body controller bring the CoM back; here it is a critically damped spring.
    """

    def __init__(self, admittance: float, frequency: float, most: float, dt: float) -> None:
        """Begin at rest. Admittance [1/s^2], frequency of the way back [rad/s], largest offset [m], period [s]."""
        self.offset, self._speed = np.zeros(2), np.zeros(2)
        self._admittance, self._frequency, self._most, self._dt = admittance, frequency, most, dt

    def add(self, lack: np.ndarray) -> None:
        """One period with a ZMP that is ahead of the desired one by lack (2,) [m]."""
        back = 2.0 * self._frequency * self._speed + self._frequency**2 * self.offset
        self._speed = self._speed + self._dt * (self._admittance * lack - back)
        free = self.offset + self._dt * self._speed
        self.offset = bounded(free, -self._most, self._most)
        self._speed = np.where(self.offset == free, self._speed, 0.0)
