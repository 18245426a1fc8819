"""Whole-body postures whose centre of mass is where it shall be: the quasi-static half of Sec. II-A.

Conditions (6)-(8) speak of the CoM's projection, and the robot's is that of all its links. So the waist's height and
heading are given, and its place is found by fixed-point iteration on the multi-body CoM: the waist moves by what the
CoM lacks, the legs follow by inverse kinematics, and as most of the mass moves with the waist, little is left.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stepover.model.pose import pose
from stepover.model.robot import Robot


class Targets(NamedTuple):
    """What N postures shall have.

    Attributes:
        com: (N, 2) projection of the centre of mass [m].
        height: (N,) of the waist [m].
        yaw: (N,) of the waist [rad]; the chest turns against it.
        left, right: (N, 7) sole poses.
    """

    com: np.ndarray
    height: np.ndarray
    yaw: np.ndarray
    left: np.ndarray
    right: np.ndarray

    def foot(self, side: int) -> np.ndarray:
        """Sole poses (N, 7) of a side: +1 left, -1 right."""
        return self.left if side > 0 else self.right


def joined(parts: list[Targets]) -> Targets:
    """Several targets behind each other."""
    return Targets(*(np.concatenate(values) for values in zip(*parts, strict=True)))


def balanced(robot: Robot, targets: Targets, rounds: int) -> np.ndarray:
    """Configurations (N, nq) with the CoM over its target.

    A sole that is out of reach is not refused here: the leg then points to it; see check_legs.

    Args:
        robot: the robot.
        targets: what the postures shall have.
        rounds: how often the waist is moved; each one leaves about a sixth of the error.
    """
    body, rest = robot.body, robot.half_sitting()
    q = np.tile(rest, (len(targets.com), 1))
    q[:, body.column(robot.upper_body.chest_yaw)] = -targets.yaw
    place = targets.com + (rest[:2] - robot.rest_zmp())
    for last in [*[False] * rounds, True]:
        q[:, :7] = pose(np.column_stack([place, targets.height]), targets.yaw)
        for side in (1, -1):
            leg = robot.leg(side)
            q[:, leg.columns] = leg.attempt(q[:, :7], targets.foot(side))[0]
        if not last:
            place = place + targets.com - body.com(body.placements(q))[:, :2]
    return q
