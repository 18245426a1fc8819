"""Triangles to samples of a picture: which triangle is nearest at each sample, for all triangles at once.

A triangle covers a span of samples in each row. Spans become fragments, and the nearest fragment of each sample stays.
A fragment is one whole number: its distance in the high bits, its triangle in the low ones. So one minimum decides
both, whatever the order of the triangles.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

NEAR = 0.05
"""Nearest distance that is drawn [m]. A triangle with a nearer corner is left out."""
THIN = 1e-9
"""Twice the area of a triangle that is not drawn, in samples."""
TRIANGLE_BITS, DISTANCE_BITS = 20, 42
NOTHING = np.iinfo(np.int64).max
"""Value of a sample that no triangle covers."""


class Window(NamedTuple):
    """A rectangle of samples: the first column and row, and the ones behind the last."""

    left: int
    top: int
    right: int
    bottom: int

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.bottom - self.top, self.right - self.left

    @property
    def slices(self) -> tuple[slice, slice]:
        """Of rows and columns."""
        return slice(self.top, self.bottom), slice(self.left, self.right)


def window_of(points: np.ndarray, size: tuple[int, int], around: float = 1.0) -> Window:
    """The part of a picture, width and height, that holds points (..., 2) and some pixels around them."""
    low = np.clip(np.floor(points.reshape(-1, 2).min(axis=0) - around), 0, size).astype(int).tolist()
    high = np.clip(np.ceil(points.reshape(-1, 2).max(axis=0) + around), 0, size).astype(int).tolist()
    return Window(*low, *high)


def nearest(corners: np.ndarray, distances: np.ndarray, window: Window) -> np.ndarray:
    """The nearest triangle at each sample.

    Args:
        corners: (T, 3, 2) corners of triangles, in samples; the middle of the first sample is (0.5, 0.5).
        distances: (T, 3) distances of the corners along the camera's axis [m].
        window: the samples.

    Returns:
        (rows, columns) of int64, the larger the farther; seen() and triangle_of() read it.
    """
    rows, columns = window.shape
    buffer = np.full(rows * columns, NOTHING)
    triangle, row, start, count = _spans(corners, distances, window)
    if len(triangle):
        plane = planes(corners, 1.0 / np.maximum(distances, NEAR))[triangle]
        closeness = NEAR * (plane[:, 2] + plane[:, 0] * (start + 0.5) + plane[:, 1] * (row + 0.5))
        along = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        far = 1.0 - (np.repeat(closeness, count) + np.repeat(NEAR * plane[:, 0], count) * along)
        key = (far * 2.0**DISTANCE_BITS).astype(np.int64)
        key = (np.clip(key, 0, 2**DISTANCE_BITS) << TRIANGLE_BITS) | np.repeat(triangle, count)
        np.minimum.at(buffer, np.repeat((row - window.top) * columns + start - window.left, count) + along, key)
    return buffer.reshape(rows, columns)


def seen(buffer: np.ndarray) -> np.ndarray:
    """Samples that any triangle covers, from what nearest() gives."""
    return buffer != NOTHING


def triangle_of(buffer: np.ndarray) -> np.ndarray:
    """Triangles of samples, from what nearest() gives."""
    return buffer & (2**TRIANGLE_BITS - 1)


def covered(corners: np.ndarray, distances: np.ndarray, window: Window) -> np.ndarray:
    """Which samples (rows, columns) lie in any triangle; arguments as in nearest."""
    rows, columns = window.shape
    steps = np.zeros(rows * columns + 1, dtype=np.int32)
    _, row, start, count = _spans(corners, distances, window)
    first = (row - window.top) * columns + start - window.left
    np.add.at(steps, first, 1)
    np.add.at(steps, first + count, -1)
    return np.cumsum(steps)[:-1].reshape(rows, columns) > 0


def _spans(
    corners: np.ndarray, distances: np.ndarray, window: Window
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The samples of all triangles, row by row: triangle, row, first column and number of columns, (S,) each."""
    area = areas(corners)
    drawn = np.flatnonzero((distances.min(axis=1) > NEAR) & (np.abs(area) > THIN))
    y = corners[drawn, :, 1]
    first = np.clip(np.ceil(y.min(axis=1) - 0.5), window.top, window.bottom).astype(np.int64)
    last = np.clip(np.floor(y.max(axis=1) - 0.5) + 1.0, window.top, window.bottom).astype(np.int64)
    high = np.maximum(last - first, 0)
    which = np.repeat(np.arange(len(drawn)), high)
    row = np.arange(high.sum()) - np.repeat(np.cumsum(high) - high, high) + first[which]
    low, top = np.full(len(row), float(window.left)), np.full(len(row), float(window.right))
    sign = np.sign(area[drawn])
    for k in range(3):  # a sample lies inside if it is on the inner side of all three edges
        here, there = corners[drawn, k], corners[drawn, (k + 1) % 3]
        slope = sign * (here[:, 1] - there[:, 1])
        offset = sign * (here[:, 0] * there[:, 1] - here[:, 1] * there[:, 0])
        across = sign * (there[:, 0] - here[:, 0])
        with np.errstate(divide="ignore", invalid="ignore"):
            crossing = -(across[which] * (row + 0.5) + offset[which]) / slope[which]
        rising, falling = slope[which] > 0.0, slope[which] < 0.0
        low[rising] = np.maximum(low[rising], crossing[rising])
        top[falling] = np.minimum(top[falling], crossing[falling])
    start = np.ceil(low - 0.5 - 1e-9).astype(np.int64)
    start = np.maximum(start, window.left)
    count = np.minimum(np.floor(top - 0.5 + 1e-9).astype(np.int64) + 1, window.right) - start
    some = count > 0
    return drawn[which][some], row[some], start[some], count[some]


def areas(corners: np.ndarray) -> np.ndarray:
    """Twice the signed areas (T,) of triangles (T, 3, 2); negative if they turn counter-clockwise, since y is down."""
    (x, y), (u, v) = ((corners[:, k] - corners[:, 0]).T for k in (1, 2))
    return np.asarray(x * v - y * u)


def planes(corners: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Coefficients (T, 3) a, b, c of values (T, 3) at corners (T, 3, 2), so that a value is a x + b y + c."""
    (x, y), (u, v) = ((corners[:, k] - corners[:, 0]).T for k in (1, 2))
    area = x * v - y * u
    area = np.where(np.abs(area) > THIN, area, np.inf)
    one, two = values[:, 1] - values[:, 0], values[:, 2] - values[:, 0]
    a, b = (one * v - two * y) / area, (two * x - one * u) / area
    return np.stack([a, b, values[:, 0] - a * corners[:, 0, 0] - b * corners[:, 0, 1]], axis=1)
