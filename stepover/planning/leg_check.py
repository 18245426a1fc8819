"""Can the legs take these postures? Reach, joint limits and collision with the obstacle, for many samples at once.

What FU asks of a key configuration, UBMG of the lead knee and FTA of the trailing leg.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from stepover.model.collision import Shape, keep_free, least_separation
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


@lru_cache(maxsize=16)
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
    up_to: float = np.inf,
) -> LegCheck:
    """Judge the legs between a waist and two soles.

    Args:
        robot: the robot.
        waist: (N, 7) poses.
        left: (N, 7) sole poses.
        right: (N, 7) sole poses.
        rectangle: x_min, x_max, z_min, z_max (4,) or (N, 4) that must stay free [m].
        knee_margin: how far knees must stay from straight [rad].
        up_to: separations larger than that are not told apart [m].
    """
    soles = ((1, left), (-1, right))
    postures = [leg_posture(robot, side, waist, sole, knee_margin) for side, sole in soles]
    nearest = [
        leg_separation(robot, side, posture, rectangle, up_to)
        for (side, _), posture in zip(soles, postures, strict=True)
    ]
    first, second = (distances for distances, _ in nearest)
    return LegCheck(
        reach=np.maximum(*(posture.reach for posture in postures)),
        limit=np.minimum(*(posture.limit for posture in postures)),
        separation=np.minimum(first, second),
        shape=np.where(first <= second, *(shape for _, shape in nearest)),
    )


def leg_is_free(
    robot: Robot,
    side: int,
    waist: np.ndarray,
    sole: np.ndarray,
    rectangle: np.ndarray,
    knee_margin: float,
    spare: float = 0.0,
) -> np.ndarray:
    """Which postures one leg can take, (N,) bool: what LegCheck.good says of both, without saying why not."""
    posture = leg_posture(robot, side, waist, sole, knee_margin)
    free = posture.able()
    able = LegPosture(*(part[free] for part in posture))
    there = rectangle if rectangle.ndim == 1 else rectangle[free]
    placements = robot.body.placements(able.q, robot.leg(side).joints)
    free[free] = keep_free(_own_shapes(robot, side)[1], placements, there, spare)
    return free


class LegPosture(NamedTuple):
    """One leg at N postures: configurations (N, nq) with nothing else set, reach and limit as in LegCheck."""

    q: np.ndarray
    reach: np.ndarray
    limit: np.ndarray

    def able(self) -> np.ndarray:
        """Which postures the leg can take, (N,) bool."""
        return (self.reach <= 0.0) & (self.limit >= 0.0)


def leg_posture(robot: Robot, side: int, waist: np.ndarray, sole: np.ndarray, knee_margin: float) -> LegPosture:
    """One leg between waists (N, 7) and soles (N, 7): reach, joint limits and the knee's margin [rad]."""
    body, leg = robot.body, robot.leg(side)
    q = np.zeros((len(waist), 7 + len(body.joint_names)))
    q[:, :7] = waist
    angles, reach = leg.attempt(waist, sole)
    q[:, leg.columns] = angles
    joints = np.array(leg.columns) - 7
    margin = np.minimum(angles - body.lower[joints], body.upper[joints] - angles)
    knees = [k for k, joint in enumerate(leg.joints) if joint in robot.legs.knee]
    margin[:, knees] = np.minimum(margin[:, knees], np.abs(angles[:, knees]) - knee_margin)
    return LegPosture(q, reach, margin.min(axis=1))


def leg_separation(
    robot: Robot, side: int, posture: LegPosture, rectangle: np.ndarray, up_to: float = np.inf
) -> tuple[np.ndarray, np.ndarray]:
    """Smallest separation (N,) [m] of one leg from a rectangle, up to a largest one; its index (N,) in leg_shapes."""
    placements = robot.body.placements(posture.q, robot.leg(side).joints)
    own, shapes = _own_shapes(robot, side)
    distance, which = least_separation(shapes, placements, rectangle, up_to)
    return distance, own[which]


@lru_cache(maxsize=32)
def _own_shapes(robot: Robot, side: int) -> tuple[np.ndarray, list[Shape]]:
    """Indices in leg_shapes of one leg's shapes, and those shapes."""
    joints = {robot.body.index(joint) for joint in robot.leg(side).joints}
    own = [k for k, shape in enumerate(leg_shapes(robot)) if shape.joint in joints]
    return np.array(own), [leg_shapes(robot)[k] for k in own]
