"""Forward kinematics of a tree of revolute joints over a whole motion at once, one pass along the tree.

Inside, time is the last axis of all arrays, so that every step is a few operations on long contiguous rows. Returned
arrays have time first, as views of the same memory.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Placements(NamedTuple):
    """Poses of the joints: rotations (N, J, 3, 3) and positions (N, J, 3) in the world. Joint 1 is the root."""

    rotations: np.ndarray
    positions: np.ndarray


class Joint(NamedTuple):
    """A revolute joint of the tree: its parent's index; its place in the parent's frame; its axis in its own."""

    parent: int
    rotation: np.ndarray
    translation: np.ndarray
    axis: np.ndarray


def place_joints(
    joints: dict[int, Joint], count: int, root: tuple[np.ndarray, np.ndarray], angles: np.ndarray
) -> Placements:
    """Place joints from the root outwards. The positions of all other joints are NaN.

    Args:
        joints: the joints to place, by their index in Placements, parents before children.
        count: number of joints in Placements, including the world and the root.
        root: rotations (N, 3, 3) and positions (N, 3) of the root.
        angles: (N, count - 2) angles of all joints after the root [rad].
    """
    rotations = np.empty((3, count, 3, len(angles)))  # world's row, joint, joint's column, time
    positions = np.empty((3, count, len(angles)))
    positions[:, [index for index in range(2, count) if index not in joints]] = np.nan
    rotations[:, 0], positions[:, 0] = np.eye(3)[..., None], 0.0
    rotations[:, 1], positions[:, 1] = np.moveaxis(root[0], 0, -1), root[1].T
    columns = [index - 2 for index in joints]
    sines, cosines = np.sin(angles[:, columns].T), np.cos(angles[:, columns].T)
    for (index, joint), sine, cosine in zip(joints.items(), sines, cosines, strict=True):
        base = rotations[:, joint.parent]
        positions[:, index] = positions[:, joint.parent] + joint.translation @ base
        if np.any(joint.rotation != np.eye(3)):
            base = np.einsum("abn,bc->acn", base, joint.rotation)
        _turn(base, joint.axis, sine, cosine, rotations[:, index])
    return Placements(rotations.transpose(3, 1, 0, 2), positions.transpose(2, 1, 0))


def axis_rotation(axis: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Rotations (N, 3, 3) about one unit axis (3,) by angles (N,) [rad]: Rodrigues' formula."""
    turns = np.empty((3, 3, len(angles)))
    _turn(np.broadcast_to(np.eye(3)[..., None], turns.shape), axis, np.sin(angles), np.cos(angles), turns)
    return turns.transpose(2, 0, 1)


def _turn(base: np.ndarray, axis: np.ndarray, sine: np.ndarray, cosine: np.ndarray, out: np.ndarray) -> None:
    """Write base (3, 3, N) times the rotation about a unit axis (3,) with sine and cosine (N,) into out (3, 3, N)."""
    along = int(np.argmax(np.abs(axis)))
    if abs(axis[along]) == 1.0:  # about a coordinate axis: one column stays, two turn into each other
        one, other, sine = (along + 1) % 3, (along + 2) % 3, sine * axis[along]
        out[:, along] = base[:, along]
        np.multiply(base[:, one], cosine, out=out[:, one])
        out[:, one] += base[:, other] * sine
        np.multiply(base[:, other], cosine, out=out[:, other])
        out[:, other] -= base[:, one] * sine
        return
    skew = np.cross(axis, np.eye(3)).T
    out[:] = base + sine * np.einsum("abn,bc->acn", base, skew)
    out += (1.0 - cosine) * np.einsum("abn,bc->acn", base, skew @ skew)
