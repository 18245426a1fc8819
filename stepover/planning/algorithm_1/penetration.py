"""Method (3) of FTA: from a penetration of the leg to a displacement of its ankle. Sec. III-E3, Eqs. (23)-(25).

The leg's point P_s that lies deepest in the safety boundary shall leave it by a small horizontal dS. With the
Jacobians J_s of that point and J_p of the ankle over the four joints between waist and ankle, both expressed in
the waist's frame, the ankle moves by dP = J_p J_s^+ dS, which is then turned into the world's frame.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stepover.model import pose
from stepover.model.collision import Shape, profile
from stepover.model.legs import Leg
from stepover.model.robot import Robot


class PointsOnLeg(NamedTuple):
    """A point of a leg at each of N postures.

    Attributes:
        waist: (N, 7) poses.
        angles: (N, 6) joint angles of the leg [rad].
        point: (N, 3) in the world [m].
        joint: (N,) index of the joint whose link the point is on: 2 thigh, 3 shank, 4 or 5 foot.
    """

    waist: np.ndarray
    angles: np.ndarray
    point: np.ndarray
    joint: np.ndarray


def ankle_displacements(
    robot: Robot, side: int, waist: np.ndarray, sole: np.ndarray, rectangle: np.ndarray
) -> np.ndarray:
    """Displacements (N, 3) [m] of the ankle, in the world, that take the leg out of the rectangle; 0 where it is free.

    Args:
        robot: the robot; its adaptor says how far beyond the boundary to go, the largest dS and the damping.
        side: of the leg, +1 left, -1 right.
        waist: (N, 7) poses.
        sole: (N, 7) poses.
        rectangle: x_min, x_max, z_min, z_max (4,) [m] that must stay free.
    """
    leg, adaptor = robot.leg(side), robot.adaptor
    angles, _ = leg.attempt(waist, sole)
    q = np.tile(robot.half_sitting(), (len(waist), 1))
    q[:, :7], q[:, leg.columns] = waist, angles
    placements = robot.body.placements(q, leg.joints)
    joints = [robot.body.index(joint) for joint in leg.joints]
    depth, point, order = np.zeros(len(waist)), np.zeros((len(waist), 3)), np.zeros(len(waist), dtype=int)
    for shape in (robot.shapes[k] for k in robot.leg_shapes[side]):
        dx, where = horizontal_depth(profile(shape, placements), rectangle, adaptor.spare)
        dx = np.clip(dx, -adaptor.push_step, adaptor.push_step)  # dS is small, or the Jacobians say nothing
        deeper = np.abs(dx) > np.abs(depth)
        centre = _world_y(shape, placements.rotations, placements.positions)
        point[deeper] = np.column_stack([where[:, 0], centre, where[:, 1]])[deeper]
        depth[deeper], order[deeper] = dx[deeper], joints.index(shape.joint)
    displacement, inside = np.zeros((len(waist), 3)), np.flatnonzero(depth)
    push = np.outer(depth[inside], [1.0, 0.0, 0.0])
    deepest = PointsOnLeg(waist[inside], angles[inside], point[inside], order[inside])
    displacement[inside] = displace(leg, deepest, push, adaptor.damping)
    return displacement


def displace(leg: Leg, points: PointsOnLeg, push: np.ndarray, damping: float) -> np.ndarray:
    """Eq. (25): displacements (N, 3) of the ankle, in the world, that move points of the leg by push (N, 3).

    Args:
        leg: the leg.
        points: N points of it.
        push: (N, 3) dS, in the world [m].
        damping: of the inverse [m]; where a thigh's point leaves the knee's column empty, rank is lost.
    """
    j_s, j_p = jacobians(leg, points)
    to_world, back = pose.rotation(points.waist), np.swapaxes(j_s, 1, 2)
    wanted = np.swapaxes(to_world, 1, 2) @ push[..., None]
    motion = back @ np.linalg.solve(j_s @ back + damping**2 * np.eye(3), wanted)
    return np.asarray((to_world @ (j_p @ motion))[..., 0])


def jacobians(leg: Leg, points: PointsOnLeg) -> tuple[np.ndarray, np.ndarray]:
    """J_s and J_p (N, 3, 4) of Eqs. (23) and (24) in the waist's frame, over the joints between waist and ankle."""
    waist, angles, point, joint = points
    ankle, axes, centres = leg.joint_frames(waist, angles)
    to_waist = np.swapaxes(pose.rotation(waist), 1, 2)
    columns = []
    for target, last in ((point, joint), (ankle, np.full_like(joint, 3))):
        moving = np.arange(4) <= last[:, None]
        arms = np.cross(axes[:, :4], target[:, None] - centres[:, :4]) * moving[..., None]
        columns.append(to_waist @ np.swapaxes(arms, 1, 2))
    return columns[0], columns[1]


def horizontal_depth(corners: np.ndarray, rectangle: np.ndarray, spare: float) -> tuple[np.ndarray, np.ndarray]:
    """How far convex profiles must move along x to leave a rectangle that stands on the floor.

    Args:
        corners: (N, V, 2) of the profiles (x, z) [m].
        rectangle: x_min, x_max, z_min, z_max [m].
        spare: how much further to go [m].

    Returns:
        Signed distance (N,) [m], the shorter one of back (negative) and ahead, 0 where the profile is free; and the
        profile's point (N, 2) that lies deepest.
    """
    x_min, x_max, _, top = rectangle
    top = top + spare
    (low_x, low_z), (high_x, _) = corners.min(axis=1).T, corners.max(axis=1).T
    near = np.flatnonzero((low_z <= top) & (high_x > x_min - spare) & (low_x < x_max + spare))
    result, points, corners = np.zeros(len(corners)), np.zeros((len(corners), 2)), corners[near]
    first, second = np.triu_indices(corners.shape[1], 1)
    a, b = corners[:, first], corners[:, second]
    rise = b[..., 1] - a[..., 1]
    crossing = (a[..., 1] - top) * (b[..., 1] - top) < 0.0
    share = np.where(crossing, (top - a[..., 1]) / np.where(crossing, rise, 1.0), 0.0)
    cut = a[..., 0] + share * (b[..., 0] - a[..., 0])  # where the profile passes the top's height
    x = np.concatenate([np.where(corners[..., 1] <= top, corners[..., 0], np.nan), np.where(crossing, cut, np.nan)], 1)
    z = np.concatenate([corners[..., 1], np.full_like(cut, top)], 1)
    foremost = np.where(np.isnan(x), -np.inf, x)
    rearmost = np.where(np.isnan(x), np.inf, x)
    back, ahead = foremost.max(axis=1) - x_min + spare, x_max - rearmost.min(axis=1) + spare
    inside = (back > 0.0) & (ahead > 0.0)
    backward = back <= ahead
    result[near] = np.where(inside, np.where(backward, -back, ahead), 0.0)
    rows = np.arange(len(corners))
    deepest = np.where(backward, foremost.argmax(axis=1), rearmost.argmin(axis=1))
    points[near] = np.column_stack([np.where(inside, x[rows, deepest], 0.0), z[rows, deepest]])
    return result, points


def _world_y(shape: Shape, rotations: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """Lateral position (N,) [m] of a shape's middle."""
    middle = shape.vertices.mean(axis=0)
    return np.asarray((rotations[:, shape.joint] @ middle + positions[:, shape.joint])[:, 1])
