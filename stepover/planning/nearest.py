"""Which obstacle can be crossed instead? Bisection along the ways down in height and in width."""

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
"""How finely it looks [m]."""


def nearest_crossable(
    obstacle: Obstacle, crossable: Callable[[Obstacle], bool], progress: Callable[[float], None] | None = None
) -> Obstacle | None:
    """Obstacle nearest to one that cannot be crossed: lower, or narrower, or, where neither helps, both.

    Args:
        obstacle: the one that cannot be crossed.
        crossable: tells whether another one can.
        progress: called with the share done, after each that was looked at.

    Returns:
        One for which crossable said yes, its sizes in whole millimetres; None if there is none on these ways.
    """
    here = np.array([obstacle.height, obstacle.width])
    lower, narrower = np.minimum([SMALLEST, here[1]], here), np.minimum([here[0], SMALLEST], here)
    looks, looked = _looks(lower - here) + _looks(narrower - here), itertools.count(1)

    def ask(other: Obstacle) -> bool:
        yes = crossable(other)
        if progress is not None:
            progress(min(next(looked) / looks, 1.0))
        return yes

    found = [_farthest(obstacle, here, goal - here, ask) for goal in (lower, narrower)]
    if not any(found):
        found = [_farthest(obstacle, here, np.minimum([SMALLEST, SMALLEST], here) - here, ask)]
    good = [one for one in found if one is not None]
    return min(good, key=lambda one: np.hypot(one.height - here[0], one.width - here[1]), default=None)


def _looks(way: np.ndarray) -> int:
    """How many obstacles on a way (2,) bisection looks at, at most."""
    return 1 + math.ceil(math.log2(max(float(np.abs(way).max()) / RESOLUTION, 1.0)))


def _farthest(
    obstacle: Obstacle, here: np.ndarray, way: np.ndarray, crossable: Callable[[Obstacle], bool]
) -> Obstacle | None:
    """First obstacle on a way (2,) down in height and width that can be crossed, by bisection."""

    def at(share: float) -> Obstacle:
        height, width = np.floor((here + share * way) * 1e3 + 1e-6) / 1e3
        return dataclasses.replace(obstacle, height=float(height), width=float(width))

    low, high = 0.0, 1.0
    if not np.any(way) or not crossable(at(high)):
        return None
    while (high - low) * np.abs(way).max() > RESOLUTION:
        middle = (low + high) / 2.0
        low, high = (low, middle) if crossable(at(middle)) else (middle, high)
    return at(high)
