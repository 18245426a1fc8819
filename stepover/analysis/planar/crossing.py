"""Test whether two segments intersect. Sec. II-A, Eqs. (5) and (9).

As printed, (5) requires a negative cross product of the segments' directions. This is impossible: o1o2 and o3o4 point
in opposite directions, so their products have opposite signs. The test meant is that of the paper's reference [14].
"""

from __future__ import annotations

import numpy as np


def segments_meet(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Whether the segments from a to b and from c to d (..., 2) have a common point, Eqs. (5) and (9).

    Two segments cross if the ends of each lie on opposite sides of the other. Touching counts. Overlapping pieces of a
    line count too: all four cross products are zero, and the bounding boxes decide.
    """
    sides = [np.sign(_cross(q - p, r - p)) for p, q, r in ((a, b, c), (a, b, d), (c, d, a), (c, d, b))]
    boxes = (np.minimum(a, b) <= np.maximum(c, d)) & (np.minimum(c, d) <= np.maximum(a, b))
    return np.asarray((sides[0] * sides[1] <= 0.0) & (sides[2] * sides[3] <= 0.0) & boxes.all(axis=-1))


def lines_meet(lines: list[np.ndarray], obstacle: np.ndarray) -> np.ndarray:
    """Whether any segment of some lines (..., V, 2) meets the obstacle's edges o1 ... o4 (..., 4, 2): (...) bool."""
    edges = [(obstacle[..., j, :], obstacle[..., j + 1, :]) for j in range(3)]
    pieces = [(line[..., k, :], line[..., k + 1, :]) for line in lines for k in range(line.shape[-2] - 1)]
    return np.any([segments_meet(*piece, *edge) for piece in pieces for edge in edges], axis=0)


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Cross product (...) of plane vectors (..., 2)."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
