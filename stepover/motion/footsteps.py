"""Footsteps: the places and times at which a motion's feet come down."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np


class Kind(IntEnum):
    """Purpose of a step."""

    NORMAL = 0
    BEFORE = 1
    LEG_1 = 2
    LEG_2 = 3
    AFTER = 4


NORMAL, BEFORE, LEG_1, LEG_2, AFTER = Kind
"""Kinds: a normal step, the step before the obstacle, the leading leg over it, the trailing leg, the step after it."""


@dataclass(frozen=True, eq=False)
class Footsteps:
    """K footsteps in the order of their touch-down.

    Attributes:
        time: (K,) touch-down [s].
        side: (K,) +1 left foot, -1 right foot.
        x, y: (K,) foothold, the ankle's projection [m].
        yaw: (K,) heading of the sole [rad].
        kind: (K,) Kind.
    """

    time: np.ndarray
    side: np.ndarray
    x: np.ndarray
    y: np.ndarray
    yaw: np.ndarray
    kind: np.ndarray

    @staticmethod
    def from_rows(rows: np.ndarray) -> Footsteps:
        """Footsteps from rows (K, 6): time, side, x, y, yaw, kind, as in a motion file."""
        time, side, x, y, yaw, kind = np.reshape(rows, (-1, 6)).T
        return Footsteps(time, side.astype(int), x, y, yaw, kind.astype(int))

    def rows(self) -> np.ndarray:
        """The same as one array (K, 6)."""
        return np.column_stack([self.time, self.side, self.x, self.y, self.yaw, self.kind]).astype(float)

    def __len__(self) -> int:
        """Number of footsteps."""
        return len(self.time)

    def select(self, which: np.ndarray | slice) -> Footsteps:
        """Some of them, by a mask or a slice."""
        return Footsteps.from_rows(self.rows()[which])

    def of_side(self, side: int) -> Footsteps:
        """Those of one foot: +1 left, -1 right."""
        return self.select(self.side == side)

    def of_kind(self, kind: int) -> Footsteps:
        """Those of one kind."""
        return self.select(self.kind == kind)
