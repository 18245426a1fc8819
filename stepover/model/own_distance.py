"""Which of the robot's own links come near to each other, where, and in which direction: for an optimiser."""

from __future__ import annotations

from typing import NamedTuple

import coal
import numpy as np

from stepover.model.collision import Shape
from stepover.model.kinematics import Placements
from stepover.model.self_collision import lower_bounds


class NearPairs(NamedTuple):
    """R cases of two shapes that are near to each other.

    Attributes:
        sample, pair: (R,) indices.
        distance: (R,) signed [m].
        first, second: (R, 3) nearest points in the world [m].
        normal: (R, 3) unit vectors from the first to the second shape.
    """

    sample: np.ndarray
    pair: np.ndarray
    distance: np.ndarray
    first: np.ndarray
    second: np.ndarray
    normal: np.ndarray


def near_pairs(pairs: list[tuple[Shape, Shape]], placements: Placements, up_to: float) -> NearPairs:
    """All cases in which a lower bound of the distance is at most up_to [m]."""
    bounds = lower_bounds(pairs, placements, up_to)
    pair, sample = np.nonzero(bounds <= up_to)
    request, result = coal.DistanceRequest(True, True), coal.DistanceResult()
    rows = np.empty((len(pair), 10))
    for row, i, k in zip(rows, pair.tolist(), sample.tolist(), strict=True):  # coal takes one pair at a time
        (one, other), result = pairs[i], coal.DistanceResult()
        row[0] = coal.distance(one.solid, _place(one, placements, k), other.solid, _place(other, placements, k),
                               request, result)  # fmt: skip
        row[1:4], row[4:7], row[7:] = result.getNearestPoint1(), result.getNearestPoint2(), result.normal
    return NearPairs(sample, pair, rows[:, 0], rows[:, 1:4], rows[:, 4:7], rows[:, 7:])


def _place(shape: Shape, placements: Placements, sample: int) -> coal.Transform3s:
    """Where a shape is."""
    rotation, position = placements.rotations[sample, shape.joint], placements.positions[sample, shape.joint]
    return coal.Transform3s(rotation.copy(), position.copy())
