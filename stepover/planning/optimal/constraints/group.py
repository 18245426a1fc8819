"""What a constraint group is: values that must not be positive, and how they change with the motion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Local:
    """Derivatives of R values by what is seen at their samples; None where there is none.

    Attributes:
        motion: (R, 3 C) by q, v and a.
        channels: (R, C) by the channels at the sample.
        channel_speeds: (R, C) by the speeds of the channels there.
        front: (R,) by the place of the obstacle.
    """

    motion: np.ndarray | None = None
    channels: np.ndarray | None = None
    channel_speeds: np.ndarray | None = None
    front: np.ndarray | None = None


@dataclass(frozen=True, eq=False)
class Group:
    """One kind of constraint at n samples.

    Attributes:
        name: in words, such as "joint speed".
        values: (n, m) what must not be positive, in units of `scale`.
        parts: m names of what each column belongs to.
        scale: amount that counts as a violation of 1.
        unit: of that amount.
        gradient: derivatives of values, for rows and columns (R,) of them.
    """

    name: str
    values: np.ndarray
    parts: Sequence[str]
    scale: float
    unit: str
    gradient: Callable[[np.ndarray, np.ndarray], Local]


def of_speed(gradient: np.ndarray) -> np.ndarray:
    """Derivatives (R, 3 C) by q, v, a of something with derivatives (R, C) by v alone."""
    none = np.zeros_like(gradient)
    return np.hstack([none, gradient, none])


def of_posture(gradient: np.ndarray) -> np.ndarray:
    """Derivatives (R, 3 C) by q, v, a of something with derivatives (R, C) by q alone."""
    return np.hstack([gradient, np.zeros((len(gradient), 2 * gradient.shape[1]))])


def one_hot(columns: np.ndarray, count: int) -> np.ndarray:
    """(R, count) with a one in each row."""
    found = np.zeros((len(columns), count))
    found[np.arange(len(columns)), columns] = 1.0
    return found
