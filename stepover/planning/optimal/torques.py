"""Joint torques of a finished motion, in single and in double support: an independent look at the limit.

In single support the bearing foot takes the whole wrench of the floor; in double support both share it by the rule of
constraints/sharing.py. Unlike there, speeds and accelerations are taken on the manifold, as in all checks.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stepover.model import pose
from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.planning.optimal.channels import SIDES
from stepover.planning.optimal.constraints.sharing import lever_rule, nearest_in


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
    left = lever_rule(motion.zmp, points[1][:, :2], points[-1][:, :2])
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
    sole = motion.foot(side)
    found = nearest_in(robot.contact_patch(side), pose.rotation(sole)[:, :2, :2], sole[:, :2], motion.zmp)
    return np.column_stack([found, np.zeros(len(found))])
