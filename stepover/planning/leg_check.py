"""Can the legs take these postures? Reach, joint limits and collision with the obstacle, for many samples at once.

What FU asks of a key configuration, UBMG of the lead knee and FTA of the trailing leg.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from stepover.model.collision import keep_free, least_separation
from stepover.model.robot import Robot
from stepover.planning.trajectories import WaistAndFeet


@dataclass(frozen=True, eq=False)
class LegLimits:
    """What the legs must keep at N postures, beside reach and joint limits.

    Attributes:
        rectangle: x_min, x_max, z_min, z_max (4,) or (N, 4) that must stay free [m].
        knee_margin: how far knees must stay from straight [rad].
    """

    rectangle: np.ndarray
    knee_margin: float

    def at(self, samples: np.ndarray) -> LegLimits:
        """The limits at some of the postures: indices or (N,) bool."""
        same = self.rectangle.ndim == 1
        return self if same else LegLimits(self.rectangle[samples], self.knee_margin)


class LegCheck(NamedTuple):
    """What N postures come to, (N,) each.

    Attributes:
        reach: how far a sole is out of reach [m], 0 if none is.
        limit: smallest distance of a leg joint to its limit, or of a knee to its margin from straight [rad].
        separation: smallest signed separation of the legs from the rectangle [m].
        shape: index into Robot.shapes of the shape that has it.
    """

    reach: np.ndarray
    limit: np.ndarray
    separation: np.ndarray
    shape: np.ndarray

    def good(self, spare: float = 0.0) -> np.ndarray:
        """Which postures the robot can take with some distance to spare [m], (N,) bool."""
        return (self.reach <= 0.0) & (self.limit >= 0.0) & (self.separation >= spare)


def check_legs(robot: Robot, poses: WaistAndFeet, limits: LegLimits, up_to: float = np.inf) -> LegCheck:
    """Judge both legs between waist and soles.

    Args:
        robot: the robot.
        poses: N postures.
        limits: what they must keep.
        up_to: separations larger than that are not told apart [m].
    """
    sides = (1, -1)
    postures = [leg_posture(robot, side, poses.waist, poses.feet.foot(side), limits.knee_margin) for side in sides]
    nearest = [
        leg_separation(robot, side, posture, limits.rectangle, up_to)
        for side, posture in zip(sides, postures, strict=True)
    ]
    first, second = (distances for distances, _ in nearest)
    return LegCheck(
        reach=np.maximum(*(posture.reach for posture in postures)),
        limit=np.minimum(*(posture.limit for posture in postures)),
        separation=np.minimum(first, second),
        shape=np.where(first <= second, *(shape for _, shape in nearest)),
    )


def leg_is_free(robot: Robot, side: int, poses: WaistAndFeet, limits: LegLimits, spare: float = 0.0) -> np.ndarray:
    """Which postures one leg can take, (N,) bool: what LegCheck.good says of both, without saying why not."""
    posture = leg_posture(robot, side, poses.waist, poses.feet.foot(side), limits.knee_margin)
    free = posture.able()
    placements = robot.body.placements(posture.q[free], robot.leg(side).joints)
    shapes = [robot.shapes[k] for k in robot.leg_shapes[side]]
    free[free] = keep_free(shapes, placements, limits.at(free).rectangle, spare)
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
    """Smallest separation (N,) [m] of one leg from a rectangle, up to a largest one; its index (N,) in robot.shapes."""
    placements = robot.body.placements(posture.q, robot.leg(side).joints)
    own = robot.leg_shapes[side]
    distance, which = least_separation([robot.shapes[k] for k in own], placements, rectangle, up_to)
    return distance, np.array(own)[which]
