"""Clearance: each link's profile is separated from the obstacle with its margins by a line.

The separation along a direction d(theta) that points up or sideways is min over corners of d . p - max over the
rectangle's corners of d . r; the largest over theta is the distance, or the depth with a minus. Theta comes from a fan
that is refined twice, to a fifth of a degree: coarser ones err by millimetres on a long thigh. Along the best direction
the nearest corners of a shape are constraints of their own: a sole that lies parallel to the obstacle's top would
otherwise seem free to turn about the nearest one.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stepover.model.collision import Shape, profile
from stepover.model.kinematics import Placements
from stepover.planning.optimal.constraints.group import Group, Local, of_posture
from stepover.planning.optimal.instants import Instants

LENGTH = 0.05
"""Violation [m] that counts as 1."""
NEAR = 0.08
"""Separations beyond it [m] are not told apart."""
CORNERS = 4
"""How many corners of a shape are told apart: as many as a face of a box has."""
FAN, FINER = np.radians(np.arange(0.0, 181.0, 5.0)), (np.radians(5.0), np.radians(1.0))
"""Directions from the obstacle to a link, and by how much they are refined [rad]."""


class Separations(NamedTuple):
    """One shape at R samples near to the obstacle.

    Attributes:
        rows: (R,) samples.
        value: (R, CORNERS) separation of its nearest corners along the best direction [m].
        direction: (R, 2) x and z of that direction.
        corner: (R, CORNERS) their indices.
    """

    rows: np.ndarray
    value: np.ndarray
    direction: np.ndarray
    corner: np.ndarray


def clearance(seen: Instants) -> Group:
    """Separation of all links from the obstacle with its margins."""
    scene = seen.scene
    rectangle = scene.obstacle.profile(seen.front, margins=True)
    shapes = scene.robot.shapes
    found = [_separations(shape, seen.placements, rectangle) for shape in shapes]
    values = np.full((len(scene.samples), len(shapes), CORNERS), -NEAR / LENGTH)
    for number, near in enumerate(found):
        values[near.rows, number] = (scene.parameters.clearance - near.value) / LENGTH

    def gradient(rows: np.ndarray, columns: np.ndarray) -> Local:
        motion, front = np.empty((len(rows), seen.q.shape[1])), np.empty(len(rows))
        numbers, ranks = np.divmod(columns, CORNERS)
        for number in np.unique(numbers):
            some = np.flatnonzero(numbers == number)
            near, shape = found[number], shapes[number]
            at = np.searchsorted(near.rows, rows[some])
            joints, turn = np.full(len(some), shape.joint), seen.placements.rotations[rows[some], shape.joint]
            points = np.einsum("rab,rb->ra", turn, shape.vertices[near.corner[at, ranks[some]]])
            points += seen.placements.positions[rows[some], shape.joint]
            along = near.direction[at]
            moved = seen.twists(joints, points, rows[some])[..., [0, 2]]
            motion[some] = np.einsum("rci,ri->rc", moved, along)
            front[some] = -along[:, 0]
        return Local(motion=of_posture(-motion / LENGTH), front=-front / LENGTH)

    names = [shape.link for shape in shapes for _ in range(CORNERS)]
    return Group("clearance", values.reshape(len(values), -1), names, LENGTH, "m", gradient)


def _separations(shape: Shape, placements: Placements, rectangle: np.ndarray) -> Separations:
    """Separation of one shape where the sphere around it is near."""
    x_min, x_max, _, top = rectangle
    centre, radius = shape.sphere
    middle = placements.positions[:, shape.joint] + placements.rotations[:, shape.joint] @ centre
    beside = np.maximum(np.maximum(x_min - middle[:, 0], middle[:, 0] - x_max), 0.0)
    rows = np.flatnonzero(np.hypot(beside, np.maximum(middle[:, 2] - top, 0.0)) - radius < NEAR)
    some = Placements(placements.rotations[rows], placements.positions[rows])
    corners = profile(shape, some)
    if not len(rows):
        return Separations(rows, np.empty((0, CORNERS)), np.empty((0, 2)), np.empty((0, CORNERS), dtype=int))
    fan = np.column_stack([np.cos(FAN), np.sin(FAN)])
    theta = FAN[((corners @ fan.T).min(axis=1) - _extent(fan, rectangle)).argmax(axis=1)]
    each = np.arange(len(rows))
    for half in FINER:
        thetas = np.clip(theta[:, None] + np.linspace(-half, half, 11), 0.0, np.pi)
        ways = np.stack([np.cos(thetas), np.sin(thetas)], axis=2)
        along = np.einsum("rvi,rdi->rvd", corners, ways)
        apart = along.min(axis=1) - _extent(ways, rectangle)
        best = apart.argmax(axis=1)
        theta = thetas[each, best]
    direction, along = ways[each, best], along[each, :, best]
    nearest = np.argsort(along, axis=1, kind="stable")[:, :CORNERS]
    value = np.take_along_axis(along, nearest, axis=1) - _extent(direction, rectangle)[:, None]
    return Separations(rows, value, direction, nearest)


def _extent(ways: np.ndarray, rectangle: np.ndarray) -> np.ndarray:
    """Largest coordinate of the rectangle along directions (..., 2) that do not point down."""
    x_min, x_max, _, top = rectangle
    return np.asarray(np.maximum(ways[..., 0] * x_min, ways[..., 0] * x_max) + ways[..., 1] * top)
