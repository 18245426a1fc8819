"""The obstacle of Sec. III: a rectangular beam across the path, with a safety margin around it."""

from __future__ import annotations

import reprlib
from dataclasses import dataclass

import numpy as np

from stepover.errors import InvalidInput

LATERAL_HALF_EXTENT = 1.0
"""Half length of the beam along y [m]. The beam is longer than any robot is wide, so only its profile matters."""
FLOOR_DEPTH = 1.0
"""How far below the floor the obstacle reaches [m]: no way out of a penetration leads downwards."""
LARGEST = 10.0
"""Largest height, width or margin [m]: more is a wrong unit."""
FARTHEST = 20.0
"""Largest distance [m]: more is a wrong unit, and a walk of a minute and more to plan."""


@dataclass(frozen=True)
class Obstacle:
    """A beam across the path: o_h, o_w, s_h, s_w of the paper.

    Python's and NumPy's integers and floats are taken, and kept as Python floats.

    Attributes:
        height: height o_h of the bare obstacle [m].
        width: width o_w of the bare obstacle along the walking direction [m].
        margin_height: safety margin s_h above the obstacle [m].
        margin_width: safety margin s_w before the obstacle, and the same behind it [m].
        distance: distance of the front face from the point between the ankles at the start [m]; None: set by the
            nominal steps.
        yaw: rotation of the beam to the left, about the point where the path meets its front face [rad].

    Raises:
        InvalidInput: a value that is not a real number; a height, width or distance that is not positive; a negative
            margin; a length of more than LARGEST, a distance of more than FARTHEST; a yaw that does not lie between
            -pi/2 and pi/2.
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
            object.__setattr__(self, name, _length(name, getattr(self, name), positive, LARGEST))
        if self.distance is not None:
            object.__setattr__(self, "distance", _length("distance", self.distance, True, FARTHEST))
        object.__setattr__(self, "yaw", _yaw(self.yaw))

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


def _length(name: str, value: object, positive: bool, most: float) -> float:
    """A length as a float; refused where it is no real number, has the wrong sign or is too long."""
    length = _real(value)
    if not (0.0 < length < np.inf if positive else 0.0 <= length < np.inf):
        kind = "a positive" if positive else "a non-negative"
        raise InvalidInput(f"obstacle {name} = {_shown(value)} must be {kind} finite number of metres")
    if length > most:
        raise InvalidInput(f"obstacle {name} = {_shown(value)} must be {most:g} m at most")
    return length


def _yaw(value: object) -> float:
    """An angle as a float; refused where it is no real number, or where the beam would lie along the path."""
    yaw = _real(value)
    if not abs(yaw) < np.pi / 2.0:
        raise InvalidInput(f"obstacle yaw = {_shown(value)} must be an angle between -pi/2 and pi/2 rad")
    return yaw


def _real(value: object) -> float:
    """A real number as a float; NaN for anything else, such as True or a Decimal; infinity where it overflows."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        return float("nan")
    try:
        return float(value)
    except OverflowError:
        return float("inf")


def _shown(value: object) -> str:
    """A refused value in a few characters, on one line."""
    try:
        return " ".join(reprlib.repr(value).split())
    except ValueError:  # Python does not write integers of thousands of digits
        return f"a huge {type(value).__name__}"
