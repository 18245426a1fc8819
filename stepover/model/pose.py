"""Poses as arrays (..., 7): x y z and a unit quaternion x y z w, as in pinocchio's free-flyer."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

Quaternion = tuple[float, float, float, float]
"""x y z w."""


def pose(position: np.ndarray, yaw: np.ndarray | float = 0.0, pitch: np.ndarray | float = 0.0) -> np.ndarray:
    """Poses of upright frames: first pitch about y, then yaw about z.

    Args:
        position: (N, 3) [m].
        yaw: (N,) or scalar [rad].
        pitch: (N,) or scalar [rad], toe-down positive.

    Returns:
        (N, 7) poses.
    """
    half_yaw, half_pitch = (np.broadcast_to(angle, position.shape[:1]) / 2.0 for angle in (yaw, pitch))
    cy, sy, cp, sp = np.cos(half_yaw), np.sin(half_yaw), np.cos(half_pitch), np.sin(half_pitch)
    return np.column_stack([position, -sy * sp, cy * sp, sy * cp, cy * cp])


def rotation(poses: np.ndarray) -> np.ndarray:
    """Rotation matrices (N, 3, 3) of poses (N, 7)."""
    return Rotation.from_quat(poses[:, 3:]).as_matrix()


def turns(poses: np.ndarray) -> np.ndarray:
    """Rotation vectors (N - 1, 3) [rad] from each pose to the next, in its own frame."""
    here, there = poses[:-1, 3:].T, poses[1:, 3:].T
    vector = here[3] * there[:3] - there[3] * here[:3] - np.cross(here[:3], there[:3], axis=0)
    scalar, sine = (here * there).sum(axis=0), np.sqrt((vector**2).sum(axis=0))
    way = np.where(scalar < 0.0, -2.0, 2.0)  # the shorter of the two rotations
    factor = np.divide(way * np.arctan2(sine, np.abs(scalar)), sine, out=way.copy(), where=sine > 0.0)
    return np.asarray((factor * vector).T)


def from_matrices(rotations: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """Poses (N, 7) of rotations (N, 3, 3) and positions (N, 3), without sign jumps between the quaternions."""
    quaternions = Rotation.from_matrix(rotations).as_quat()
    flips = np.sign(np.einsum("ij,ij->i", quaternions[1:], quaternions[:-1]))
    signs = np.concatenate([[1.0 if quaternions[0, 3] >= 0.0 else -1.0], np.where(flips < 0.0, -1.0, 1.0)])
    return np.column_stack([positions, quaternions * np.cumprod(signs)[:, None]])


def offset(poses: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Poses moved by a vector (3,) given in their own frames: (N, 7) to (N, 7)."""
    return np.column_stack([poses[:, :3] + rotation(poses) @ np.asarray(vector), poses[:, 3:]])


def unit(quaternion: Sequence[float]) -> Quaternion:
    """A quaternion x y z w at length one."""
    x, y, z, w = quaternion
    length = math.sqrt(x * x + y * y + z * z + w * w)
    return x / length, y / length, z / length, w / length


def product(first: Sequence[float], second: Sequence[float]) -> Quaternion:
    """The rotation by the second unit quaternion, followed by that by the first.

    The order of the sums is that of scipy, so that both results are equal to the bit. For a single rotation, scipy's
    Rotation takes thirty times as long.
    """
    (ax, ay, az, aw), (bx, by, bz, bw) = first, second
    return unit((
        aw * bx + bw * ax + (ay * bz - az * by),
        aw * by + bw * ay + (az * bx - ax * bz),
        aw * bz + bw * az + (ax * by - ay * bx),
        aw * bw - ax * bx - ay * by - az * bz,
    ))  # fmt: skip


def axes(quaternion: Sequence[float]) -> np.ndarray:
    """Rotation matrix (3, 3) of a single unit quaternion, as rotation gives it."""
    x, y, z, w = quaternion
    xx, yy, zz, ww = x * x, y * y, z * z, w * w
    return np.array([
        [xx - yy - zz + ww, 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), -xx + yy - zz + ww, 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), -xx - yy + zz + ww],
    ])  # fmt: skip


def cross(a: Sequence[float], b: Sequence[float]) -> np.ndarray:
    """Cross product (3,) of two single vectors. np.cross takes ten times as long."""
    (ax, ay, az), (bx, by, bz) = a, b
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
