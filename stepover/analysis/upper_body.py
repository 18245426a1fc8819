"""What the upper body does to balance: the momentum of its part of (21), and how far arms and chest move the CoM.

The upper body is all that no leg joint moves: waist, chest, head and arms. Sec. II-B, III-D.
"""

from __future__ import annotations

import numpy as np

from stepover.model.robot import Robot
from stepover.motion.motion import Motion


def upper_links(robot: Robot) -> list[int]:
    """Indices of the links that no leg joint moves."""
    legs = robot.body.beyond([robot.legs.left[0], robot.legs.right[0]], 0)
    return [k for k, link in enumerate(robot.description.links) if robot.body.joint_of(link.name) not in legs]


def upper_momentum_share(robot: Robot, motion: Motion) -> np.ndarray:
    """Rate of the upper body's angular momentum about the robot's CoM over the cart's, Eq. (21): rms about x, y (2,).

    The cart is the whole robot's: m c_z times the CoM's acceleration. A cart has no momentum about its CoM.
    """
    turns, places = robot.body.placements(motion.q)
    links = [robot.description.links[k] for k in upper_links(robot)]
    joints = [robot.body.joint_of(link.name) for link in links]
    mass = np.array([link.inertia.mass for link in links])
    centres = np.stack(
        [places[:, j] + turns[:, j] @ link.inertia.centre for j, link in zip(joints, links, strict=True)], axis=1
    )
    apart = centres - motion.com[:, None]
    speed = np.gradient(apart, motion.dt, axis=0)
    momentum = np.einsum("l,nlk->nk", mass, np.cross(apart, speed))
    for j, link in zip(joints, links, strict=True):
        inertia = turns[:, j] @ link.inertia.matrix @ np.swapaxes(turns[:, j], 1, 2)
        momentum += np.einsum("nij,nj->ni", inertia, _turning(turns[:, j], motion.dt))
    rate = np.gradient(momentum, motion.dt, axis=0)[:, :2]
    force = np.gradient(np.gradient(motion.com, motion.dt, axis=0), motion.dt, axis=0) * robot.body.mass
    cart = motion.com[:, 2:] * force[:, 1::-1] * (-1.0, 1.0)
    return np.asarray(np.sqrt((rate**2).mean(axis=0) / (cart**2).mean(axis=0)))


def com_back(robot: Robot, joints: list[str], angle: float) -> float:
    """How far the CoM goes back where some joints turn from half-sitting by an angle, within their limits [m]."""
    rest = robot.half_sitting()
    turned = rest.copy()
    for joint in joints:
        column = robot.body.column(joint)
        low, high = robot.body.lower[column - 7], robot.body.upper[column - 7]
        turned[column] = np.clip(rest[column] + angle, low, high)
    com = robot.body.com(robot.body.placements(np.array([rest, turned])))
    return float(com[0, 0] - com[1, 0])


def trunk_joints(robot: Robot) -> list[str]:
    """Joints between waist and shoulders that can lean the chest: all but its yaw."""
    body = robot.body
    above = {joint for name in robot.upper_body.shoulders for joint in body.model.supports[body.index(name)]}
    known = {*robot.upper_body.shoulders, robot.upper_body.chest_yaw}
    return [name for name in body.joint_names if name not in known and body.index(name) in above]


def chest_and_arms(robot: Robot) -> tuple[float, float]:
    """How far the CoM goes back where the chest leans to its limit, and where the arms swing as far as UBMG may [m]."""
    arms = com_back(robot, list(robot.upper_body.shoulders), np.radians(robot.upper_body.arm_swing_max_deg))
    return max(com_back(robot, trunk_joints(robot), angle) for angle in (-np.pi, np.pi)), arms


def _turning(turns: np.ndarray, dt: float) -> np.ndarray:
    """Angular velocity (N, 3) of rotations (N, 3, 3) in the world [rad/s]."""
    skew = np.gradient(turns, dt, axis=0) @ np.swapaxes(turns, 1, 2)
    return np.column_stack([skew[:, 2, 1] - skew[:, 1, 2], skew[:, 0, 2] - skew[:, 2, 0],
                            skew[:, 1, 0] - skew[:, 0, 1]]) / 2.0  # fmt: skip
