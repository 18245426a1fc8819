"""Where the soles are beyond the rubber: the plates of compliant feet, as two more joints of the robot's placements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stepover.model.collision import Shape
from stepover.model.kinematics import Placements, axis_rotation
from stepover.model.robot import Robot


SIDES = (1, -1)
BUSH = ("LIFT", "ROLL", "PITCH")
"""The joints of a bush, from the ankle down: along z, about x, about y."""
NEAR_SOLE = 1e-3
"""m: a shape whose underside is as near to the sole belongs to the plate."""


def with_plates(robot: Robot, placements: Placements, bush: np.ndarray, depth: float) -> Placements:
    """Placements with both plates behind the last joint, in the ankles' frames where the rubber is at rest.

    Args:
        robot: the robot.
        placements: of its joints at N samples.
        bush: (N, 6) deflections, left up, roll, pitch, then right [m, rad].
        depth: of the bush below the ankle [m].
    """
    rotations, positions = [placements.rotations], [placements.positions]
    x, y, z = np.eye(3)
    for side, (up, roll, pitch) in zip(SIDES, np.reshape(bush.T, (2, 3, -1)), strict=True):
        ankle = robot.body.index(robot.leg(side).joints[-1])
        turn, place = placements.rotations[:, ankle], placements.positions[:, ankle]
        plate = axis_rotation(x, roll) @ axis_rotation(y, pitch)
        shift = (up - depth)[:, None] * z + plate @ (depth * z)
        rotations.append((turn @ plate)[:, None])
        positions.append((place + np.einsum("nab,nb->na", turn, shift))[:, None])
    return Placements(np.concatenate(rotations, axis=1), np.concatenate(positions, axis=1))


def plate(robot: Robot, side: int) -> int:
    """Index of a plate in the placements that with_plates gives: +1 left, -1 right."""
    return 2 + len(robot.body.joint_names) + SIDES.index(side)


def with_plate_shapes(robot: Robot) -> list[Shape]:
    """The robot's shapes, those that touch the floor moved by the plates."""
    ankles = {robot.body.index(robot.leg(side).joints[-1]): plate(robot, side) for side in SIDES}
    shapes = []
    for shape in robot.shapes:
        beyond = shape.joint in ankles and shape.vertices[:, 2].min() < NEAR_SOLE - robot.foot.ankle_height
        shapes.append(replace(shape, joint=ankles[shape.joint]) if beyond else shape)
    return shapes
