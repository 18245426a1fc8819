"""A camera without roll, and where it sees points."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stepover.errors import InvalidInput

LENS = 17.0
"""Vertical angle of view [deg]: a long lens, so that near and far legs look equally large."""
SMALLEST, LARGEST = 16, 8192
"""Width and height of a picture, in pixels."""


class Size(NamedTuple):
    """Width and height of a picture, in pixels."""

    width: int
    height: int


def checked(size: tuple[int, int], even: bool = False) -> Size:
    """A size, refused where it is not two whole numbers of pixels, or where they must be even and are not.

    Raises:
        InvalidInput: it is not.
    """
    try:
        width, height = size
        whole = all(isinstance(length, int | np.integer) and not isinstance(length, bool) for length in size)
    except (TypeError, ValueError):
        whole = False
    if not whole or not all(SMALLEST <= length <= LARGEST for length in size):
        raise InvalidInput(f"size = {size!r} must be a width and a height of {SMALLEST} to {LARGEST} pixels")
    if even and any(length % 2 for length in size):
        raise InvalidInput(f"size = {size!r}: a video's width and height must be even")
    return Size(int(width), int(height))


class Camera:
    """A camera that looks at a point. The picture's x axis points to the right, its y axis down.

    Attributes:
        eye: (3,) place of the lens [m].
        forward, right, up: (3,) unit axes.
        size: of the picture.
        focal: distance of the picture from the lens, in pixels.
    """

    def __init__(self, eye: np.ndarray, target: np.ndarray, size: Size, lens: float = LENS) -> None:
        """Look from a place at another one, neither above nor below it; lens as in LENS."""
        self.eye, self.size = np.asarray(eye, dtype=float), size
        self.forward, self.right, self.up = _axes(np.asarray(target, dtype=float) - self.eye)
        self.focal = size.height / 2.0 / np.tan(np.radians(lens) / 2.0)

    @classmethod
    def around(
        cls, points: np.ndarray, towards: tuple[float, float, float], size: Size, border: float = 0.05
    ) -> Camera:
        """The camera that sees points (N, 3) as large as the picture allows.

        Args:
            points: what it sees [m].
            towards: the direction in which it looks.
            size: of the picture.
            border: share of the picture's height that stays free on every side.
        """
        forward, right, up = _axes(np.asarray(towards))
        slope = np.tan(np.radians(LENS) / 2.0)
        wide = slope * (size.width / size.height - 2.0 * border)
        deep = points @ forward
        (across, back_1), (above, back_2) = (
            _middle(points @ axis, deep, tangent)
            for axis, tangent in ((right, wide), (up, slope * (1.0 - 2.0 * border)))
        )
        eye = across * right + above * up - max(back_1, back_2) * forward
        return cls(eye, eye + forward, size)

    def moved(self, shift: np.ndarray) -> Camera:
        """The same camera elsewhere."""
        other = object.__new__(Camera)
        other.__dict__.update(self.__dict__, eye=self.eye + shift)
        return other

    def project(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pixels (..., 2) at which points (..., 3) appear, with (0, 0) at the upper left corner; distances (...) [m].

        Distances are along the camera's axis; points behind it have a negative one and no meaningful pixel.
        """
        away = points - self.eye
        distance = away @ self.forward
        safe = np.where(np.abs(distance) < 1e-9, 1e-9, distance)
        x, y = away @ self.right / safe, away @ self.up / safe
        middle = self.size.width / 2.0, self.size.height / 2.0
        return np.stack([middle[0] + self.focal * x, middle[1] - self.focal * y], axis=-1), distance

    @property
    def columns(self) -> np.ndarray:
        """(width,) slopes to the right of rays through the middles of the pixels: a ray is forward + x right + y up."""
        return ((np.arange(self.size.width) + 0.5 - self.size.width / 2.0) / self.focal).astype(np.float32)

    @property
    def rows(self) -> np.ndarray:
        """(height,) their slopes upwards."""
        return (self.size.height / 2.0 - np.arange(self.size.height) - 0.5) / self.focal


def _axes(towards: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Forward, right and up (3,) of a camera that looks in a direction (3,)."""
    forward = towards / np.linalg.norm(towards)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    return forward, right, np.cross(right, forward)


def _middle(across: np.ndarray, deep: np.ndarray, tangent: float) -> tuple[float, float]:
    """Where a camera stands across its axis, and how far it stands back, to see points between two slopes.

    Args:
        across: (N,) places of the points across the axis [m].
        deep: (N,) their places along it, from the world's origin [m].
        tangent: of half the angle of view.
    """
    high, low = (across - tangent * deep).max(), (across + tangent * deep).min()
    return float(high + low) / 2.0, float(high - low) / (2.0 * tangent)
