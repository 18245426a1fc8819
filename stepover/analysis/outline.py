"""The outline L1 ... L7 of a leg (Fig. 1) along a motion, and how deep it is inside the obstacle's margins: Fig. 5."""

from __future__ import annotations

import numpy as np

from stepover.model.kinematics import Placements
from stepover.model.robot import Robot

POINTS = 60
"""Samples along each of the two lines."""


def outline(robot: Robot, placed: Placements, side: int) -> list[np.ndarray]:
    """The lines L1 ... L4 and L5 ... L7 of a leg in the plane x, z: (N, POINTS, 2) each [m]."""
    joints = robot.legs.left if side > 0 else robot.legs.right
    knee = next(robot.body.index(joint) for joint in robot.legs.knee if joint in joints)
    rotations, centres = placed.rotations[:, knee][:, [0, 2]][:, :, [0, 2]], placed.positions[:, knee][:, [0, 2]]
    return [line @ np.swapaxes(rotations, 1, 2) + centres[:, None] for line in in_knee_frame(robot)]


def in_knee_frame(robot: Robot) -> list[np.ndarray]:
    """The same lines in the knee's frame, x ahead and z up along the shank: (POINTS, 2) each [m]."""
    lines = []
    for line in (robot.outline.front, robot.outline.rear):
        corners = np.array(line)
        along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
        at = np.sort(np.concatenate([np.linspace(0.0, along[-1], POINTS - len(along)), along]))
        lines.append(np.column_stack([np.interp(at, along, corners[:, axis]) for axis in (0, 1)]))
    return lines


def depth(points: np.ndarray, rectangle: np.ndarray) -> np.ndarray:
    """Depth of points (N, P, 2) inside a rectangle: (N, P) [m], the shortest distance to its edge, 0 outside."""
    x_min, x_max, _, top = rectangle
    x, z = points[..., 0], points[..., 1]
    return np.asarray(np.maximum(np.minimum(np.minimum(x - x_min, x_max - x), top - z), 0.0))


def depth_of_parts(robot: Robot, placed: Placements, side: int, rectangle: np.ndarray) -> dict[str, float]:
    """Largest depth of the knee, at and above its axis (L1 ... L3), and of the shank below it [m]."""
    lines, own = outline(robot, placed, side), in_knee_frame(robot)
    deepest = [depth(line, rectangle).max(axis=0) for line in lines]
    above = [line[:, 1] >= 0.0 for line in own]
    return {
        name: max(float(deep[part == knee].max(initial=0.0)) for deep, part in zip(deepest, above, strict=True))
        for name, knee in (("knee", True), ("shank", False))
    }
