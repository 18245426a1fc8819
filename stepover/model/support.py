"""The support polygon: where the ZMP may be. Sec. II-B, Eqs. (10)-(12)."""

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
    It is constant from one change of support to the next.

    Args:
        robot: the robot, for its contact patches.
        zmp: (N, 2) [m].
        support: (N,) 0 double, +1 left, -1 right.
        left_foot: (N, 7) sole poses.
        right_foot: (N, 7) sole poses.
    """
    changes = np.flatnonzero(np.diff(support)) + 1
    margin = np.empty(len(zmp))
    for first, last in zip([0, *changes], [*changes, len(zmp)], strict=True):
        corners = [
            corners_on_floor(robot, side, foot[first])
            for side, foot in ((1, left_foot), (-1, right_foot))
            if support[first] in (0, side)
        ]
        edges = ConvexHull(np.vstack(corners)).equations
        margin[first:last] = -(zmp[first:last] @ edges[:, :2].T + edges[:, 2]).max(axis=1)
    return margin


def corners_on_floor(robot: Robot, side: int, sole: np.ndarray) -> np.ndarray:
    """Corners (4, 2) [m] of a contact patch on the floor, for a sole pose (7,)."""
    turn = pose.rotation(sole[None])[0, :2, :2]
    return np.asarray(robot.contact_patch(side) @ turn.T + sole[:2])
