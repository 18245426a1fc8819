"""Rods that fill the gaps at a robot's joints, in films and in the 3-D page.

Shapes end before a joint, so that they do not collide with each other as it bends. Rods are drawn only; nothing is
measured to them.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator

import numpy as np

from stepover.model.collision import hull_of
from stepover.model.description.links import Hinge
from stepover.model.robot import Robot

THICKNESS, INNER = 0.34, 0.94
"""Radius of a rod, as a share of the smallest side of the links that it connects; of its thinner half, as a share of
the other one's, so that no surfaces coincide."""


def rods(robot: Robot) -> dict[int, list[np.ndarray]]:
    """Rods with round ends, from the middle of each link that has shapes to its joints.

    Returns:
        Corners (V, 3) of each rod [m], in the frame of the joint that moves the link, by its index in Placements.
    """
    boxes = {}
    for joint in {shape.joint for shape in robot.shapes}:
        corners = np.vstack([shape.vertices for shape in robot.shapes if shape.joint == joint])
        boxes[joint] = corners.min(axis=0), corners.max(axis=0)
    found: dict[int, list[np.ndarray]] = {joint: [] for joint in boxes}
    for child, parent, hinge, single in _neighbours(robot, boxes):
        middles = {joint: (boxes[joint][0] + boxes[joint][1]) / 2.0 for joint in (child, parent)}
        # a joint may lie beside its links, on its axis
        here = middles[child] @ hinge.axis * hinge.axis if single else np.zeros(3)
        there = hinge.place.translation + hinge.place.rotation @ here
        radius = THICKNESS * min(float((high - low).min()) for low, high in (boxes[child], boxes[parent]))
        found[parent].append(_rod(middles[parent], there, radius))
        found[child].append(_rod(middles[child], here, INNER * radius))
    return found


def _neighbours(robot: Robot, drawn: Collection[int]) -> Iterator[tuple[int, int, Hinge, bool]]:
    """Drawn links that joints connect: child, parent, the first joint behind the parent, whether it is the only one."""
    above, joint_of = robot.description.joint_above, robot.body.joint_of
    for link in robot.description.links:
        child, last = joint_of(link.name), above.get(link.name)
        if child not in drawn or last is None:
            continue
        hinge = last
        while joint_of(hinge.parent) not in drawn and hinge.parent in above:
            hinge = above[hinge.parent]
        if joint_of(hinge.parent) in drawn:
            yield child, joint_of(hinge.parent), hinge, hinge is last


def _rod(start: np.ndarray, end: np.ndarray, radius: float) -> np.ndarray:
    """Corners (V, 3) of a rod with round ends between two points (3,)."""
    turn, tilt = np.meshgrid(np.linspace(0.0, 2.0 * np.pi, 20, endpoint=False), np.linspace(-np.pi, np.pi, 11) / 2.0)
    ball = np.stack([np.cos(tilt) * np.cos(turn), np.cos(tilt) * np.sin(turn), np.sin(tilt)], axis=-1).reshape(-1, 3)
    return hull_of(np.vstack([radius * ball + start, radius * ball + end]))[0]
