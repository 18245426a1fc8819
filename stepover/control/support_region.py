"""The region for the desired ZMP: a slightly smaller support polygon, and its nearest point to a given one."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import ConvexHull

from stepover.model import pose
from stepover.model.robot import Robot
from stepover.motion.motion import Motion


@dataclass(frozen=True, eq=False)
class Region:
    """A convex polygon: corners (C, 2) [m], counter-clockwise."""

    corners: np.ndarray

    @cached_property
    def _sides(self) -> np.ndarray:
        """From each corner to the next (C, 2)."""
        return np.roll(self.corners, -1, axis=0) - self.corners

    def nearest(self, point: np.ndarray) -> np.ndarray:
        """The point (2,) of the polygon that is nearest to a point (2,). A point inside is returned unchanged."""
        along, to = self._sides, point - self.corners
        if (along[:, 0] * to[:, 1] >= along[:, 1] * to[:, 0]).all():
            return point
        share = np.clip((to * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
        feet = self.corners + share[:, None] * along
        return np.asarray(feet[((feet - point) ** 2).sum(axis=1).argmin()])


def patch(robot: Robot, side: int, inset: float) -> np.ndarray:
    """Corners (4, 2) [m] of a contact patch in the sole frame, each edge moved inwards."""
    corners = robot.contact_patch(side)
    return np.asarray(corners - inset * np.sign(corners - corners.mean(axis=0)))


def regions(robot: Robot, motion: Motion, inset: float) -> list[Region]:
    """The support region at each of N samples. Samples between two changes of support share one object.

    Args:
        robot: gives the contact patches.
        motion: gives the poses of the feet and when they stand.
        inset: distance by which each edge of a patch is moved inwards [m].
    """
    changes = np.flatnonzero(np.diff(motion.support)) + 1
    result: list[Region] = []
    for first, last in zip([0, *changes], [*changes, len(motion.time)], strict=True):
        standing = [side for side in (1, -1) if motion.support[first] in (0, side)]
        corners = np.vstack([_on_floor(robot, side, motion.foot(side)[first], inset) for side in standing])
        result += [Region(corners[ConvexHull(corners).vertices])] * int(last - first)
    return result


def _on_floor(robot: Robot, side: int, sole: np.ndarray, inset: float) -> np.ndarray:
    """Corners (4, 2) of a smaller contact patch on the floor, for a sole pose (7,)."""
    return np.asarray(patch(robot, side, inset) @ pose.rotation(sole[None])[0, :2, :2].T + sole[:2])
