"""Distances between the robot's own links: by boxes for most pairs, separating axes for some, coal for the rest."""

from __future__ import annotations

from typing import NamedTuple

import coal
import numpy as np

from stepover.model.collision import Shape, distance_between, smallest
from stepover.model.kinematics import Placements


def self_clearance(
    pairs: list[tuple[Shape, Shape]], placements: Placements, every: int, up_to: float = np.inf
) -> tuple[float, str, str, int]:
    """Smallest signed distance between pairs of the robot's own shapes [m], with their links and the sample.

    Args:
        pairs: pairs of shapes that must not touch.
        placements: placements of all joints.
        every: step between the samples to test.
        up_to: if all distances are larger than this [m], the result is one of them, not always the smallest.
    """
    look = Placements(placements.rotations[::every], placements.positions[::every])
    bounds = lower_bounds(pairs, look, up_to)
    distance, which, k = smallest(bounds, lambda i, k: distance_between(*pairs[i], look, k), up_to)
    return distance, pairs[which][0].link, pairs[which][1].link, k * every


def lower_bounds(pairs: list[tuple[Shape, Shape]], look: Placements, up_to: float) -> np.ndarray:
    """Lower bounds (pairs, n) of the distances [m].

    Boxes along the root's axes come first, since the legs hang side by side from the root. Most pairs are separated by
    boxes that contain a shape at all samples. If boxes intersect, the directions of the shapes' own edges are used.
    """
    shapes = list({id(shape): shape for pair in pairs for shape in pair}.values())
    row = {id(shape): k for k, shape in enumerate(shapes)}
    first, second = np.array([[row[id(shape)] for shape in pair] for pair in pairs]).T
    root, every = np.ascontiguousarray(look.rotations[:, 1].transpose(1, 2, 0)), slice(None)
    boxes = np.array([_extent(shape, look, every, root) for shape in shapes]).transpose(1, 2, 0, 3)
    whole = np.array([boxes[0].min(axis=-1), boxes[1].max(axis=-1)])  # low and high, axes, shapes
    always = _gap(whole[..., first], whole[..., second])
    bounds, near = np.tile(always[:, None], (1, len(look.positions))), always <= up_to
    bounds[near] = _gap(boxes[:, :, first[near]], boxes[:, :, second[near]])
    for k in np.flatnonzero((bounds <= 0.0).any(axis=1)):
        meet = np.flatnonzero(bounds[k] <= 0.0)
        bounds[k, meet] = np.maximum(bounds[k, meet], _apart(*pairs[k], look, meet))
    return bounds


def _apart(first: Shape, second: Shape, look: Placements, samples: np.ndarray) -> np.ndarray:
    """Lower bound (n,) of the distance between two shapes [m], along the edges of both."""
    bounds = []
    for shape in (first, second):
        axes = np.ascontiguousarray((look.rotations[samples, shape.joint] @ shape.edges.T).transpose(1, 2, 0))
        bounds.append(_gap(*(_extent(each, look, samples, axes) for each in (first, second))))
    return np.maximum(*bounds)


def _gap(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Largest gap (...) along any axis between two extents: low and high, axes, ..."""
    return np.maximum(one[0] - other[1], other[0] - one[1]).max(axis=0)


def _extent(shape: Shape, look: Placements, samples: np.ndarray | slice, axes: np.ndarray) -> np.ndarray:
    """Lowest and highest coordinates (2, E, n) [m] of a shape along unit axes in the world (3, E, n)."""
    own = np.ascontiguousarray(look.rotations[samples, shape.joint].transpose(1, 2, 0))
    turns = np.einsum("aen,abn->ebn", axes, own)
    shift = np.einsum("aen,an->en", axes, look.positions[samples, shape.joint].T)
    along = shape.vertices @ turns + shift[:, None]  # (E, V, n)
    return np.array([along.min(axis=1), along.max(axis=1)])


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
