"""The obstacle of Sec. III: a rectangular beam across the way, with a safety margin around it."""

from __future__ import annotations

import sys
from dataclasses import dataclass

import numpy as np

from stepover.errors import InvalidInput

LATERAL_HALF_EXTENT = 1.0
"""Half length of the beam along y [m]: longer than any robot here is wide, so that it is met in profile."""
FLOOR_DEPTH = 1.0
"""How far below the floor the obstacle reaches [m]: no way out of a penetration leads downwards."""


@dataclass(frozen=True)
class Obstacle:
    """A beam across the way: o_h, o_w, s_h, s_w of the paper.

    Attributes:
        height: o_h [m], of the bare obstacle.
        width: o_w [m], along the walking direction, of the bare obstacle.
        margin_height: s_h [m], above it.
        margin_width: s_w [m], before it and again behind it.
        distance: front face from the point between the ankles at the start [m]; None: where the nominal steps lead.
        yaw: how far the beam is turned to the left, about the point where the path meets its front face [rad].

    Raises:
        InvalidInput: a value that is not a finite number; a height, width or distance that is not positive; a negative
            margin; a yaw that does not lie between -pi/2 and pi/2.
    """

    height: float
    width: float
    margin_height: float = 0.03
    margin_width: float = 0.03
    distance: float | None = None
    yaw: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what is no obstacle."""
        for name, positive in (("height", True), ("width", True), ("margin_height", False), ("margin_width", False)):
            _require_length(name, getattr(self, name), positive)
        if self.distance is not None:
            _require_length("distance", self.distance, positive=True)
        _require_yaw(self.yaw)

    @property
    def safe_height(self) -> float:
        """Height with its margin [m]: h' of the trajectory generator."""
        return self.height + self.margin_height

    @property
    def safe_depth(self) -> float:
        """Width with both margins [m]: 11 cm for the paper's 5 cm."""
        return self.width + 2.0 * self.margin_width

    def profile(self, front: float, margins: bool) -> np.ndarray:
        """Rectangle that must stay free, with the front face at x = front, in the frame of an obstacle that is turned.

        Args:
            front: x of the bare obstacle's front face [m].
            margins: with the safety margins or bare.

        Returns:
            (4,) array x_min, x_max, z_min, z_max [m]. It reaches below the floor, so that the way out of
            it never leads through the ground.
        """
        side, top = (self.margin_width, self.margin_height) if margins else (0.0, 0.0)
        return np.array([front - side, front + self.width + side, -FLOOR_DEPTH, self.height + top])

    def as_advice(self) -> str:
        """Say that this one can be crossed, for error messages."""
        place = "" if self.distance is None else f" at a distance of {self.distance:.3f} m"
        return (
            f"the nearest obstacle that can be stepped over is {self.height:.3f} m high, {self.width:.3f} m wide{place}"
        )


def _require_length(name: str, value: float, positive: bool) -> None:
    """Refuse a length that is not a finite number or has the wrong sign."""
    kind = "a positive" if positive else "a non-negative"
    try:
        good = abs(value) <= sys.float_info.max and (value > 0.0 if positive else value >= 0.0)
    except TypeError:
        good = False
    if not good:
        raise InvalidInput(f"obstacle {name} = {value!r} must be {kind} finite number of metres")


def _require_yaw(yaw: float) -> None:
    """Refuse an angle that is not a number, or with which the beam would lie along the path."""
    try:
        good = abs(yaw) < np.pi / 2.0
    except TypeError:
        good = False
    if not good:
        raise InvalidInput(f"obstacle yaw = {yaw!r} must be an angle between -pi/2 and pi/2 rad")
