"""Which obstacle can be crossed instead? Bisection towards smaller heights and smaller widths."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Callable
from functools import cache

import numpy as np

from stepover.model.obstacle import Obstacle

SMALLEST = 0.02
"""Height or width [m] at which the search ends."""
RESOLUTION = 0.005
"""At which the bisection ends [m]."""


def nearest_crossable(
    obstacle: Obstacle, crossable: Callable[[Obstacle], bool], progress: Callable[[float], None] | None = None
) -> Obstacle | None:
    """Obstacle nearest to one that cannot be crossed: lower, or narrower, or, where neither helps, both.

    Where no lower one and not even the smallest can be crossed, the size is not what is wrong, and the search ends.

    Args:
        obstacle: the one that cannot be crossed.
        crossable: tells whether another one can.
        progress: called with the share done, after each obstacle that was tried.

    Returns:
        One for which crossable returned true, its sizes in whole millimetres; None if none is found.
    """
    here = np.array([obstacle.height, obstacle.width])
    lower, narrower = np.minimum([SMALLEST, here[1]], here), np.minimum([here[0], SMALLEST], here)
    smallest = np.minimum(lower, narrower)
    tries, tried = 1 + _tries(lower - here) + _tries(narrower - here), itertools.count(1)

    @cache
    def works(other: Obstacle) -> bool:
        yes = crossable(other)
        if progress is not None:
            progress(min(next(tried) / tries, 1.0))
        return yes

    found = [_farthest(obstacle, here, lower - here, works)]
    if found[0] is None and not works(_resized(obstacle, smallest)):
        return None
    found.append(_farthest(obstacle, here, _at_most(narrower - here, _change(found[0], here)), works))
    if not any(found):
        found = [_farthest(obstacle, here, smallest - here, works)]
    good = [one for one in found if one is not None]
    return min(good, key=lambda one: _change(one, here), default=None)


def _change(found: Obstacle | None, here: np.ndarray) -> float:
    """How far an obstacle that was found is from the one that was asked for, by height and width (2,) [m]."""
    return float(np.inf) if found is None else float(np.hypot(found.height - here[0], found.width - here[1]))


def _at_most(change: np.ndarray, length: float) -> np.ndarray:
    """A change of height and width (2,), no longer than that [m]: what is further away cannot be the nearest."""
    return change * min(1.0, length / max(float(np.hypot(*change)), 1e-9))


def _tries(change: np.ndarray) -> int:
    """How many obstacles bisection tries at most for a change of height and width (2,)."""
    return 1 + math.ceil(math.log2(max(float(np.abs(change).max()) / RESOLUTION, 1.0)))


def _farthest(
    obstacle: Obstacle, here: np.ndarray, change: np.ndarray, crossable: Callable[[Obstacle], bool]
) -> Obstacle | None:
    """Obstacle with the least share of a change of height and width (2,) that can be crossed, by bisection."""

    def at(share: float) -> Obstacle:
        return _resized(obstacle, here + share * change)

    low, high = 0.0, 1.0
    if not np.any(change) or not crossable(at(high)):
        return None
    while (high - low) * np.abs(change).max() > RESOLUTION:
        middle = (low + high) / 2.0
        low, high = (low, middle) if crossable(at(middle)) else (middle, high)
    return at(high)


def _resized(obstacle: Obstacle, size: np.ndarray) -> Obstacle:
    """The obstacle with another height and width (2,) [m], down to whole millimetres."""
    height, width = np.floor(size * 1e3 + 1e-6) / 1e3
    return dataclasses.replace(obstacle, height=float(height), width=float(width))
