"""Corners of a URDF's collision shapes. Round shapes get the corners of a hull around them."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull

from stepover.model.description.links import BOX, SPHERE

SIDES = 16
"""Number of sides of the prism around a cylinder. Its edges stand out by 2 % of the radius."""


def corners_of(kind: str, size: tuple[float, ...]) -> np.ndarray:
    """Corners (V, 3) [m] of a shape in its own frame; of a hull around a cylinder or sphere.

    Args:
        kind: BOX, CYLINDER or SPHERE.
        size: as in Solid [m].
    """
    if kind == BOX:
        signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
        return np.asarray(signs * (np.array(size) / 2.0))
    if kind == SPHERE:
        return size[0] * _around_a_ball()
    radius, length = size
    ends = np.array([[0.0, 0.0, -length / 2.0], [0.0, 0.0, length / 2.0]])
    return np.concatenate([radius * _around_a_disc() + end for end in ends])


def _around_a_disc() -> np.ndarray:
    """Corners (SIDES, 3) of a regular polygon around the unit circle in the x-y plane."""
    angles = 2.0 * np.pi * np.arange(SIDES) / SIDES
    return np.column_stack([np.cos(angles), np.sin(angles), np.zeros(SIDES)]) / np.cos(np.pi / SIDES)


def _around_a_ball() -> np.ndarray:
    """Corners (42, 3) of a polyhedron around the unit ball: an icosahedron's, and those over its edges' middles."""
    golden = (1.0 + np.sqrt(5.0)) / 2.0
    first = np.array([[0.0, one, other] for one in (-1.0, 1.0) for other in (-golden, golden)])
    corners = np.concatenate([np.roll(first, shift, axis=1) for shift in range(3)])
    one, other = np.triu_indices(len(corners), 1)
    sides = np.isclose(np.linalg.norm(corners[one] - corners[other], axis=1), 2.0)
    points = np.concatenate([corners, (corners[one] + corners[other])[sides]])
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    return np.asarray(points / -ConvexHull(points).equations[:, 3].max())
