"""How two feet share the wrench of the floor in double support: by the place of the ZMP.

Each foot's force acts at the point of its sole that is nearest to the ZMP. The feet share the force by the lever rule:
a foot bears the more, the nearer its point is. While the ZMP is inside a sole, that foot bears all. What the two
forces leave of the moment is shared alike. The rule is continuous: at its ends it is single support.
"""

from __future__ import annotations

import numpy as np

from stepover.planning.optimal.channels import SIDES
from stepover.planning.optimal.instants import Posed


def lever_rule(zmp: np.ndarray, left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Share (n,) of the left foot, for the ZMP and both feet's points (n, 2)."""
    from_left, from_right = (np.linalg.norm(zmp - point, axis=1) for point in (left, right))
    return np.asarray(from_right / np.maximum(from_left + from_right, 1e-12))


def nearest_in(patch: np.ndarray, turn: np.ndarray, place: np.ndarray, zmp: np.ndarray) -> np.ndarray:
    """Point (n, 2) of a sole nearest to the ZMP: patch (4, 2) in the sole, plane rotation (n, 2, 2), place (n, 2)."""
    own = np.einsum("nba,nb->na", turn, zmp - place)
    inside = np.clip(own, patch.min(axis=0), patch.max(axis=0))
    return np.asarray(place + np.einsum("nab,nb->na", turn, inside))


def shared_torques(posed: Posed) -> np.ndarray:
    """Torques (n, C - 6) of the joints in q when both feet bear [N m]."""
    robot, columns = posed.scene.robot, posed.scene.channels.leg_columns
    force, moment = posed.floor_wrench
    about = moment + np.cross(posed.q[:, :3], force)  # about the world's origin
    zmp = np.column_stack([-about[:, 1], about[:, 0]]) / force[:, 2:]
    points = np.zeros((2, len(zmp), 3))
    for point, side in zip(points, SIDES, strict=True):
        ankle = robot.body.index(robot.leg(side).joints[-1])
        turn, place = posed.placements.rotations[:, ankle, :2, :2], posed.placements.positions[:, ankle, :2]
        point[:, :2] = nearest_in(robot.contact_patch(side), turn, place, zmp)
    left = lever_rule(zmp, points[0, :, :2], points[1, :, :2])[:, None]
    shares = (left, 1.0 - left)
    middle = sum(share * point for share, point in zip(shares, points, strict=True))
    (axes, origins), torques = posed.axes, posed.forces[:, 6:].copy()
    for share, point, side in zip(shares, points, SIDES, strict=True):
        leg = columns(side)
        moved = share * (about + np.cross(point - middle, force))
        borne = moved[:, None] - np.cross(origins[:, leg], (share * force)[:, None])
        torques[:, np.array(leg) - 6] -= np.einsum("nja,nja->nj", axes[:, leg], borne)
    return torques
