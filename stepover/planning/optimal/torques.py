"""Joint torques of a finished motion, in single and in double support: an independent look at the limit.

In single support the bearing foot takes the whole wrench of the floor. In double support each foot's force acts at the
point of its sole that is nearest to the ZMP, and the two share the force by the lever rule: a foot bears the more, the
nearer this point is. While the ZMP is inside a sole, that foot bears all. What is left of the moment is shared alike.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stepover.model import pose
from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.planning.optimal.channels import SIDES


class TorqueRatio(NamedTuple):
    """Largest joint torque over its limit, the joint and when [s]."""

    ratio: float
    joint: str
    time: float


def largest_torque(robot: Robot, motion: Motion) -> TorqueRatio:
    """The joint that comes nearest to its torque limit, or exceeds it most."""
    ratios = np.abs(torques(robot, motion)) / robot.body.effort_limits
    sample, joint = np.unravel_index(ratios.argmax(), ratios.shape)
    return TorqueRatio(float(ratios[sample, joint]), robot.body.joint_names[joint], float(motion.time[sample]))


def torques(robot: Robot, motion: Motion) -> np.ndarray:
    """Torques (N, nq - 7) of all joints [N m]."""
    body, q, dt = robot.body, motion.q, motion.dt
    found = body.dynamics_sweep(q, dt)().T[:, 6:].copy()
    wrench, placements = body.contact_wrench(q, dt), body.placements(q)
    for side, force, moment in _shares(robot, motion, wrench):
        leg = robot.leg(side)
        indices = [body.index(joint) for joint in leg.joints]
        axes = np.array([body.axes[index - 2] for index in indices])
        axes = np.einsum("njab,jb->nja", placements.rotations[:, indices], axes)
        about = moment[:, None] - np.cross(placements.positions[:, indices], force[:, None])
        found[:, np.array(leg.columns) - 7] -= np.einsum("nja,nja->nj", axes, about)
    return found


def _shares(robot: Robot, motion: Motion, wrench: np.ndarray) -> list[tuple[int, np.ndarray, np.ndarray]]:
    """Side, force (N, 3) and moment about the world's origin (N, 3) of each foot."""
    force, moment = wrench[:, :3], wrench[:, 3:]
    points = {side: _nearest(robot, motion, side) for side in SIDES}
    away = {side: np.linalg.norm(motion.zmp - point[:, :2], axis=1) for side, point in points.items()}
    left = away[-1] / np.maximum(away[1] + away[-1], 1e-12)
    left = np.select([motion.support > 0, motion.support < 0], [1.0, 0.0], left)[:, None]
    middle = left * points[1] + (1.0 - left) * points[-1]
    rest = moment - np.cross(middle, force)
    found = []
    for side in SIDES:
        share = left if side > 0 else 1.0 - left
        found.append((side, share * force, share * (np.cross(points[side], force) + rest)))
    return found


def _nearest(robot: Robot, motion: Motion, side: int) -> np.ndarray:
    """Point (N, 3) of a sole that is nearest to the ZMP."""
    sole, patch = motion.foot(side), robot.contact_patch(side)
    turn = pose.rotation(sole)[:, :2, :2]
    own = np.einsum("nba,nb->na", turn, motion.zmp - sole[:, :2])
    inside = np.clip(own, patch.min(axis=0), patch.max(axis=0))
    return np.column_stack([sole[:, :2] + np.einsum("nab,nb->na", turn, inside), np.zeros(len(sole))])
