"""Sensor readings of one period: encoders, an IMU with an attitude filter, and a six-axis sensor in each ankle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Sensed:
    """Readings at one sample.

    Attributes:
        joints: (nq - 7,) joint angles, in the order of q[7:] [rad].
        attitude: (4,) quaternion x y z w of the waist in the world.
        rate: (3,) angular velocity of the waist in its own axes [rad/s].
        left_wrench, right_wrench: (6,) force [N] and moment [N m] of the floor on the foot, means over the period that
            ends here. The reference point is the ankle, which is the origin of the last leg joint's link; the axes are
            those of that link.
    """

    joints: np.ndarray
    attitude: np.ndarray
    rate: np.ndarray
    left_wrench: np.ndarray
    right_wrench: np.ndarray

    def wrench(self, side: int) -> np.ndarray:
        """Wrench (6,) of a side: +1 left, -1 right."""
        return self.left_wrench if side > 0 else self.right_wrench
