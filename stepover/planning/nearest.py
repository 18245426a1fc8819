"""Which obstacle can be crossed instead? Bisection towards smaller heights and smaller widths."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Callable

import numpy as np

from stepover.model.obstacle import Obstacle

SMALLEST = 0.02
"""Height or width [m] at which the search ends."""
RESOLUTION = 0.002
"""At which the bisection ends [m]."""


def nearest_crossable(
    obstacle: Obstacle, crossable: Callable[[Obstacle], bool], progress: Callable[[float], None] | None = None
) -> Obstacle | None:
    """Obstacle nearest to one that cannot be crossed: lower, or narrower, or, where neither helps, both.

    Args:
        obstacle: the one that cannot be crossed.
        crossable: tells whether another one can.
        progress: called with the share done, after each obstacle that was tried.

    Returns:
        One for which crossable returned true, its sizes in whole millimetres; None if none is found.
    """
    here = np.array([obstacle.height, obstacle.width])
    lower, narrower = np.minimum([SMALLEST, here[1]], here), np.minimum([here[0], SMALLEST], here)
    tries, tried = _tries(lower - here) + _tries(narrower - here), itertools.count(1)

    def works(other: Obstacle) -> bool:
        yes = crossable(other)
        if progress is not None:
            progress(min(next(tried) / tries, 1.0))
        return yes

    found = [_farthest(obstacle, here, goal - here, works) for goal in (lower, narrower)]
    if not any(found):
        found = [_farthest(obstacle, here, np.minimum([SMALLEST, SMALLEST], here) - here, works)]
    good = [one for one in found if one is not None]
    return min(good, key=lambda one: np.hypot(one.height - here[0], one.width - here[1]), default=None)


def _tries(change: np.ndarray) -> int:
    """How many obstacles bisection tries at most for a change of height and width (2,)."""
    return 1 + math.ceil(math.log2(max(float(np.abs(change).max()) / RESOLUTION, 1.0)))


def _farthest(
    obstacle: Obstacle, here: np.ndarray, change: np.ndarray, crossable: Callable[[Obstacle], bool]
) -> Obstacle | None:
    """Obstacle with the least share of a change of height and width (2,) that can be crossed, by bisection."""

    def at(share: float) -> Obstacle:
        height, width = np.floor((here + share * change) * 1e3 + 1e-6) / 1e3
        return dataclasses.replace(obstacle, height=float(height), width=float(width))

    low, high = 0.0, 1.0
    if not np.any(change) or not crossable(at(high)):
        return None
    while (high - low) * np.abs(change).max() > RESOLUTION:
        middle = (low + high) / 2.0
        low, high = (low, middle) if crossable(at(middle)) else (middle, high)
    return at(high)
