"""The obstacle of Sec. III: a rectangular beam across the path, with a safety margin around it."""

from __future__ import annotations

import sys
from dataclasses import dataclass

import numpy as np

from stepover.errors import InvalidInput

LATERAL_HALF_EXTENT = 1.0
"""Half length of the beam along y [m]. The beam is longer than any robot is wide, so only its profile matters."""
FLOOR_DEPTH = 1.0
"""Depth of the obstacle below the floor [m], so that the shortest exit from a penetration never leads downwards."""


@dataclass(frozen=True)
class Obstacle:
    """A beam across the path: o_h, o_w, s_h, s_w of the paper.

    Attributes:
        height: height o_h of the bare obstacle [m].
        width: width o_w of the bare obstacle along the walking direction [m].
        margin_height: safety margin s_h above the obstacle [m].
        margin_width: safety margin s_w before the obstacle, and the same behind it [m].
        distance: distance of the front face from the point between the ankles at the start [m]; None: set by the
            nominal steps.
        yaw: rotation of the beam to the left, about the point where the path meets its front face [rad].

    Raises:
        InvalidInput: a value is not a finite number; a height, width or distance is not positive; a margin is negative;
            or a yaw is not between -pi/2 and pi/2.
    """

    height: float
    width: float
    margin_height: float = 0.03
    margin_width: float = 0.03
    distance: float | None = None
    yaw: float = 0.0

    def __post_init__(self) -> None:
        """Reject invalid sizes."""
        for name, positive in (("height", True), ("width", True), ("margin_height", False), ("margin_width", False)):
            _require_length(name, getattr(self, name), positive)
        if self.distance is not None:
            _require_length("distance", self.distance, positive=True)
        _require_yaw(self.yaw)

    @property
    def safe_height(self) -> float:
        """Height with the margin [m]: h' of the trajectory generator."""
        return self.height + self.margin_height

    @property
    def safe_depth(self) -> float:
        """Width with both margins [m]: 11 cm for the paper's 5 cm."""
        return self.width + 2.0 * self.margin_width

    def profile(self, front: float, margins: bool) -> np.ndarray:
        """Rectangle of the obstacle with the front face at x = front. A turned obstacle has its own frame.

        Args:
            front: x of the bare obstacle's front face [m].
            margins: whether to include the safety margins.

        Returns:
            (4,) array x_min, x_max, z_min, z_max [m]. It reaches below the floor, so that the shortest exit never
            leads through the ground.
        """
        side, top = (self.margin_width, self.margin_height) if margins else (0.0, 0.0)
        return np.array([front - side, front + self.width + side, -FLOOR_DEPTH, self.height + top])

    def as_advice(self) -> str:
        """A statement that this obstacle can be crossed, for error messages."""
        place = "" if self.distance is None else f" at a distance of {self.distance:.3f} m"
        return (
            f"the nearest obstacle that can be stepped over is {self.height:.3f} m high, {self.width:.3f} m wide{place}"
        )


def _require_length(name: str, value: float, positive: bool) -> None:
    """Reject a length that is not a finite number or has the wrong sign."""
    kind = "a positive" if positive else "a non-negative"
    try:
        good = abs(value) <= sys.float_info.max and (value > 0.0 if positive else value >= 0.0)
    except TypeError:
        good = False
    if not good:
        raise InvalidInput(f"obstacle {name} = {value!r} must be {kind} finite number of metres")


def _require_yaw(yaw: float) -> None:
    """Reject an angle that is not a number, or that would put the beam along the path."""
    try:
        good = abs(yaw) < np.pi / 2.0
    except TypeError:
        good = False
    if not good:
        raise InvalidInput(f"obstacle yaw = {yaw!r} must be an angle between -pi/2 and pi/2 rad")
