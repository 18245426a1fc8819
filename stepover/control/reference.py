"""The stabilizer's reference values at every sample of a motion. They are computed once, before the first step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stepover.model import pose
from stepover.model.gravity import GRAVITY
from stepover.model.robot import Robot
from stepover.motion.motion import Motion


@dataclass(frozen=True, eq=False)
class Reference:
    """Reference values of a motion with N samples. Feet are in the order left, right.

    Attributes:
        dt: sample time [s].
        omega: natural frequency of the pendulum, sqrt(g / z_c) [1/s].
        com, com_velocity: (N, 3) [m], [m/s].
        dcm: (N, 2) c + c' / omega [m].
        zmp: (N, 2) ZMP of the multi-body model [m]: the sensors' value if all goes as planned.
        waist: (N, 7) poses of the waist.
        attitude: (N, 3, 3) rotations of the waist.
        joints: (N, nq - 7) joint angles [rad].
        ankles: (N, 2, 3) positions of the ankles [m].
        feet: (N, 2, 3, 3) rotations of the feet.
        soles: (N, 2, 3) places of the sole frames [m].
        support: (N,) as in a motion.
        landing: (N, 2) whether a foot is in the second half of its swing. If it touches something then, it is the
            floor.
    """

    dt: float
    omega: float
    com: np.ndarray
    com_velocity: np.ndarray
    dcm: np.ndarray
    zmp: np.ndarray
    waist: np.ndarray
    attitude: np.ndarray
    joints: np.ndarray
    ankles: np.ndarray
    feet: np.ndarray
    soles: np.ndarray
    support: np.ndarray
    landing: np.ndarray


def reference(robot: Robot, motion: Motion) -> Reference:
    """Compute the reference values of a motion."""
    omega = float(np.sqrt(GRAVITY / robot.preview.com_height))
    velocity = np.gradient(motion.com, motion.dt, axis=0)
    soles = (motion.left_foot, motion.right_foot)
    up = np.array([0.0, 0.0, robot.foot.ankle_height])
    ankles = np.stack([pose.offset(sole, up)[:, :3] for sole in soles], axis=1)
    return Reference(
        dt=motion.dt, omega=omega, com=motion.com, com_velocity=velocity,
        dcm=motion.com[:, :2] + velocity[:, :2] / omega, zmp=motion.zmp, waist=motion.waist,
        attitude=pose.rotation(motion.waist), joints=motion.q[:, 7:], ankles=ankles,
        feet=np.stack([pose.rotation(sole) for sole in soles], axis=1),
        soles=np.stack([sole[:, :3] for sole in soles], axis=1),
        support=motion.support, landing=np.stack([_landing(motion.support == -side) for side in (1, -1)], axis=1),
    )  # fmt: skip


def _landing(swings: np.ndarray) -> np.ndarray:
    """The second half of each swing: (N,) bool to (N,) bool."""
    edges = np.flatnonzero(np.diff(swings, prepend=False, append=False))
    result = np.zeros(len(swings), dtype=bool)
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        result[(first + last) // 2 : last] = True
    return result
