"""The support polygon, in which the ZMP must lie. Sec. II-B, Eqs. (10)-(12)."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull

from stepover.model import pose
from stepover.model.robot import Robot


def zmp_margin(
    robot: Robot, zmp: np.ndarray, support: np.ndarray, left_foot: np.ndarray, right_foot: np.ndarray
) -> np.ndarray:
    """Distance (N,) [m] of the ZMP from the edge of the support polygon, negative outside.

    The polygon is the contact patch of the stance foot, or the convex hull of both patches in double support.
    It is constant between two changes of support.

    Args:
        robot: the robot, for its contact patches.
        zmp: (N, 2) [m].
        support: (N,) 0 double, +1 left, -1 right.
        left_foot: (N, 7) sole poses.
        right_foot: (N, 7) sole poses.
    """
    firsts = np.flatnonzero(np.diff(support, prepend=2))
    patches = {side: corners_on_floor(robot, side, foot[firsts]) for side, foot in ((1, left_foot), (-1, right_foot))}
    margin = np.empty(len(zmp))
    for k, (first, last) in enumerate(zip(firsts, [*firsts[1:], len(zmp)], strict=True)):
        corners = [patch[k] for side, patch in patches.items() if support[first] in (0, side)]
        edges = ConvexHull(np.vstack(corners)).equations
        margin[first:last] = -(zmp[first:last] @ edges[:, :2].T + edges[:, 2]).max(axis=1)
    return margin


def corners_on_floor(robot: Robot, side: int, sole: np.ndarray) -> np.ndarray:
    """Corners (..., 4, 2) [m] of a contact patch on the floor, for sole poses (..., 7)."""
    turns = pose.rotation(sole.reshape(-1, 7))[:, :2, :2].reshape(*sole.shape[:-1], 2, 2)
    return np.asarray(robot.contact_patch(side) @ np.swapaxes(turns, -1, -2) + sole[..., None, :2])
