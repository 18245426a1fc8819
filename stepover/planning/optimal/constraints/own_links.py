"""The robot's own links: signed distances between legs, arms and trunk, by GJK and EPA (coal).

Beside the pairs of Robot.own_pairs, the thighs keep away from trunk and chest. The gradient is that of the two nearest
points along the normal between them.
"""

from __future__ import annotations

import numpy as np

from stepover.model.collision import Shape
from stepover.model.legs import KNEE
from stepover.model.robot import Robot
from stepover.model.self_collision import near_pairs
from stepover.planning.optimal.constraints.group import Group, Local, of_posture
from stepover.planning.optimal.instants import Instants

LENGTH = 0.03
"""Violation [m] that counts as 1."""
NEAR = 0.02
"""Distances beyond it [m] are not told apart."""


def own_distance(seen: Instants) -> Group:
    """Distances of all pairs that might touch."""
    robot, p, n = seen.scene.robot, seen.scene.parameters, len(seen.scene.samples)
    trunk = thigh_pairs(robot)
    pairs = [*trunk, *robot.own_pairs]
    wanted = np.where(np.arange(len(pairs)) < len(trunk), p.trunk_distance, p.own_distance)
    near = near_pairs(pairs, seen.placements, NEAR)
    values, place = np.full((n, len(pairs)), -NEAR / LENGTH), np.full((n, len(pairs)), -1)
    values[near.sample, near.pair] = (wanted[near.pair] - near.distance) / LENGTH
    place[near.sample, near.pair] = np.arange(len(near.sample))
    joints = np.array([[shape.joint for shape in pair] for pair in pairs])

    def gradient(rows: np.ndarray, columns: np.ndarray) -> Local:
        at = place[rows, columns]
        one, other = (
            np.einsum("rci,ri->rc", seen.twists(joints[columns, k], points[at], rows), near.normal[at])
            for k, points in ((0, near.first), (1, near.second))
        )
        return Local(motion=of_posture((one - other) / LENGTH))

    names = [f"{one.link} and {other.link}" for one, other in pairs]
    return Group("own distance", values, names, LENGTH, "m", gradient)


def thigh_pairs(robot: Robot) -> list[tuple[Shape, Shape]]:
    """Trunk and chest with each thigh: all that no shoulder and no leg moves, with what moves up to the knee."""
    body = robot.body
    legs = {body.index(joint) for leg in (robot.legs.left, robot.legs.right) for joint in leg}
    thighs = {body.index(leg[KNEE - 1]) for leg in (robot.legs.left, robot.legs.right)}
    arms = body.beyond(robot.upper_body.shoulders, 0)
    trunk = [shape for shape in robot.shapes if shape.joint not in legs | arms]
    return [(one, thigh) for one in trunk for thigh in robot.shapes if thigh.joint in thighs]
