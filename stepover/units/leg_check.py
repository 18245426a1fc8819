"""Can the legs take these postures? Reach, joint limits and collision with the obstacle, for many samples at once.

What FU asks of a key configuration, UBMG of the lead knee and FTA of the trailing leg.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stepover.model.collision import Shape, separation
from stepover.model.robot import Robot


class LegCheck(NamedTuple):
    """What N postures come to, (N,) each.

    Attributes:
        reach: how far a sole is out of reach [m], 0 if none is.
        limit: smallest distance of a leg joint to its limit, or of a knee to its margin from straight [rad].
        separation: smallest signed separation of the legs from the rectangle [m].
        shape: index into leg_shapes of the shape that has it.
    """

    reach: np.ndarray
    limit: np.ndarray
    separation: np.ndarray
    shape: np.ndarray

    def good(self, spare: float = 0.0) -> np.ndarray:
        """Which postures the robot can take with some distance to spare [m], (N,) bool."""
        return (self.reach <= 0.0) & (self.limit >= 0.0) & (self.separation >= spare)


def leg_shapes(robot: Robot) -> list[Shape]:
    """Collision shapes of the legs' links."""
    joints = {robot.body.index(joint) for joint in (*robot.legs.left, *robot.legs.right)}
    return [shape for shape in robot.shapes if shape.joint in joints]


def check_legs(
    robot: Robot,
    waist: np.ndarray,
    left: np.ndarray,
    right: np.ndarray,
    rectangle: np.ndarray,
    knee_margin: float,
) -> LegCheck:
    """Judge the legs between a waist and two soles.

    Args:
        robot: the robot.
        waist: (N, 7) poses.
        left: (N, 7) sole poses.
        right: (N, 7) sole poses.
        rectangle: x_min, x_max, z_min, z_max (4,) or (N, 4) that must stay free [m].
        knee_margin: how far knees must stay from straight [rad].
    """
    body = robot.body
    q = np.tile(robot.half_sitting(), (len(waist), 1))
    q[:, :7] = waist
    reach, limit = np.zeros(len(waist)), np.full(len(waist), np.inf)
    for side, sole in ((1, left), (-1, right)):
        leg = robot.leg(side)
        q[:, leg.columns], excess = leg.attempt(waist, sole)
        reach = np.maximum(reach, excess)
        joints = np.array(leg.columns) - 7
        angles = q[:, leg.columns]
        margin = np.minimum(angles - body.lower[joints], body.upper[joints] - angles)
        knees = [k for k, joint in enumerate(leg.joints) if joint in robot.legs.knee]
        margin[:, knees] = np.minimum(margin[:, knees], np.abs(angles[:, knees]) - knee_margin)
        limit = np.minimum(limit, margin.min(axis=1))
    placements = body.placements(q, (*robot.legs.left, *robot.legs.right))
    distances = np.array([separation(shape, placements, rectangle) for shape in leg_shapes(robot)])
    return LegCheck(reach, limit, distances.min(axis=0), distances.argmin(axis=0))
