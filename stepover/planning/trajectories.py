"""Waist and feet over time: what a planner lays out, and inverse kinematics turns into joint angles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class FeetTrajectories:
    """Sole poses (N, 7) of both feet over the motion: L(t) and R(t) of Algorithm 1."""

    left: np.ndarray
    right: np.ndarray

    def foot(self, side: int) -> np.ndarray:
        """Poses of a side: +1 left, -1 right."""
        return self.left if side > 0 else self.right


@dataclass(frozen=True, eq=False)
class WaistAndFeet:
    """Poses of the waist and of both soles at the same N samples.

    Attributes:
        waist: (N, 7) poses of the root.
        feet: sole poses.
    """

    waist: np.ndarray
    feet: FeetTrajectories

    def at(self, samples: slice | np.ndarray) -> WaistAndFeet:
        """The poses at some of the samples: a slice, indices or (N,) bool."""
        return WaistAndFeet(self.waist[samples], FeetTrajectories(self.feet.left[samples], self.feet.right[samples]))
