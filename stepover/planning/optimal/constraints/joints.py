"""Joint limits and joint speeds: q_min + s <= q <= q_max - s and abs(dq/dt) <= r dq_max, from the robot's URDF.

The knees' own lower limit is left to the length of the leg (reach.py), which has no singularity.
"""

from __future__ import annotations

import numpy as np

from stepover.model.legs import KNEE
from stepover.planning.optimal.channels import SIDES
from stepover.planning.optimal.constraints.group import Group, Local, of_posture, of_speed, one_hot
from stepover.planning.optimal.instants import Instants

ANGLE = 0.2
"""Violation [rad] that counts as 1."""


def joint_limits(seen: Instants) -> Group:
    """Angles of all joints that move, the upper limits first."""
    channels, body, p = seen.scene.channels, seen.scene.robot.body, seen.scene.parameters
    joints, spare = np.array(channels.full_columns) - 7, np.radians(p.joint_margin_deg)
    lower, upper, angles = body.lower[joints] + spare, body.upper[joints] - spare, seen.q[:, 6:]
    for side in SIDES:
        knee = channels.leg_columns(side)[KNEE] - 6
        bends = np.sign(seen.scene.robot.leg(side).rest[KNEE])
        lower[knee], upper[knee] = (-np.inf, upper[knee]) if bends > 0 else (lower[knee], np.inf)
    values = np.hstack([angles - upper, lower - angles]) / ANGLE

    def gradient(rows: np.ndarray, columns: np.ndarray) -> Local:
        return Local(motion=of_posture(_upwards_and_downwards(seen, columns)[1] / ANGLE))

    return Group("joint limit", values, 2 * channels.dynamics.joints, ANGLE, "rad", gradient)


def joint_speeds(seen: Instants) -> Group:
    """Speeds of all joints that move, as shares of their limits."""
    joints = np.array(seen.scene.channels.full_columns) - 7
    limits, share = seen.scene.robot.body.speed_limits[joints], seen.v[:, 6:]
    values = np.hstack([share / limits, -share / limits]) - seen.scene.parameters.speed_share

    def gradient(rows: np.ndarray, columns: np.ndarray) -> Local:
        joint, way = _upwards_and_downwards(seen, columns)
        return Local(motion=of_speed(way / limits[joint, None]))

    return Group("joint speed", values, 2 * seen.scene.channels.dynamics.joints, 1.0, "of its limit", gradient)


def _upwards_and_downwards(seen: Instants, columns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Joint (R,) of columns of a group over all joints twice, and its gradient (R, C) by q or v in the column's way."""
    way, joint = np.divmod(columns, seen.q.shape[1] - 6)
    return joint, (1.0 - 2.0 * way)[:, None] * one_hot(6 + joint, seen.q.shape[1])
