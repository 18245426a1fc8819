"""Poses as arrays (..., 7): x y z and a unit quaternion x y z w, as in pinocchio's free-flyer."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation


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


def from_matrices(rotations: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """Poses (N, 7) of rotations (N, 3, 3) and positions (N, 3), without sign jumps between the quaternions."""
    quaternions = Rotation.from_matrix(rotations).as_quat()
    flips = np.sign(np.einsum("ij,ij->i", quaternions[1:], quaternions[:-1]))
    signs = np.concatenate([[1.0 if quaternions[0, 3] >= 0.0 else -1.0], np.where(flips < 0.0, -1.0, 1.0)])
    return np.column_stack([positions, quaternions * np.cumprod(signs)[:, None]])


def offset(poses: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Poses moved by a vector (3,) given in their own frames: (N, 7) to (N, 7)."""
    return np.column_stack([poses[:, :3] + rotation(poses) @ np.asarray(vector), poses[:, 3:]])
