"""The contact wrench: the ZMP inside the soles, friction, vertical force, and the moment about the vertical.

ZMP: Vukobratovic and Borovac, IJHR 2004; exact, from the dynamics of all links. The rest bounds the wrench that a flat
sole holds (Caron, Pham and Nakamura, ICRA 2015) by a friction cone and a largest moment about the ZMP's vertical. In
double support the polygon is the hull of both soles, which moves with the footholds.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import ConvexHull

from stepover.model.gravity import GRAVITY
from stepover.planning.optimal.channels import SIDES, of_sole
from stepover.planning.optimal.constraints.group import Group, Local
from stepover.planning.optimal.instants import Instants
from stepover.planning.optimal.scene import Scene

LENGTH, FORCE, MOMENT = 0.03, 1.0, 30.0
"""Violations that count as 1: of the ZMP [m], of forces over the weight, of the moment [N m]."""
QUARTER = np.array([[0.0, -1.0], [1.0, 0.0]])
"""Turn to the left by a quarter."""
LANDING = 0.04
"""How long before a touch-down the ZMP keeps its larger margin [s]."""


class Polygons(NamedTuple):
    """Support polygons at n samples, in the bearing sole's frame.

    Attributes:
        corners: (n, 8, 2): four of the bearing sole, four of the other one [m].
        edges: (n, 8, 2) indices of the corners from which and to which each edge goes, to the left around.
        there: (n, 8) bool: which edges there are.
    """

    corners: np.ndarray
    edges: np.ndarray
    there: np.ndarray


def polygons(seen: Instants) -> Polygons:
    """The bearing sole, and in double support the hull of both."""
    scene, n = seen.scene, len(seen.scene.samples)
    patch = {side: scene.robot.contact_patch(side) for side in SIDES}
    own = np.where(scene.bearing[:, None, None] > 0, patch[1], patch[-1])
    corners = np.concatenate([own, _others(seen, patch)], axis=1)
    edges = np.zeros((n, 8, 2), dtype=int)
    edges[:, :4] = [[0, 1], [1, 2], [2, 3], [3, 0]]
    there = np.tile(np.arange(8) < 4, (n, 1))
    double = np.flatnonzero(scene.support == 0)
    breaks = np.flatnonzero(np.diff(double, prepend=-2) > 1)
    for some in np.split(double, breaks):  # the feet stand still in one double support
        if len(some):
            around = ConvexHull(corners[some[0]]).vertices
            edges[some, : len(around)] = np.column_stack([around, np.roll(around, -1)])
            there[some] = np.arange(8) < len(around)
    return Polygons(corners, edges, there)


def zmp(seen: Instants) -> Group:
    """How far the ZMP is beyond each edge of the support polygon, moved inwards by the margin."""
    found = polygons(seen)
    rows = np.arange(len(found.corners))[:, None]
    one, other = (found.corners[rows, found.edges[..., k]] for k in (0, 1))
    way = other - one
    length = np.maximum(np.linalg.norm(way, axis=2), 1e-9)
    outward = way @ QUARTER / length[..., None]
    off = seen.zmp[:, None] - one
    beyond = np.einsum("nei,nei->ne", outward, off) + margins(seen.scene)[:, None]
    values = np.where(found.there, beyond / LENGTH, -1.0)
    share = np.einsum("nei,nei->ne", off, way) / length**2

    def gradient(rows: np.ndarray, columns: np.ndarray) -> Local:
        normal, at = outward[rows, columns], share[rows, columns]
        motion = np.einsum("ri,ric->rc", normal, seen.zmp_by[rows])
        channels = np.zeros((len(rows), seen.now.shape[1]))
        for k, weight in ((0, 1.0 - at), (1, at)):
            corner = found.edges[rows, columns, k]
            moved = _others_by(seen, rows, found.corners[rows, corner])
            channels -= np.where(corner >= 4, weight, 0.0)[:, None] * np.einsum("ri,ric->rc", normal, moved)
        return Local(motion=motion / LENGTH, channels=channels / LENGTH)

    return Group("ZMP", values, ["the ZMP"] * 8, LENGTH, "m", gradient)


def margins(scene: Scene) -> np.ndarray:
    """Least distance (n,) of the ZMP from the polygon's edge [m]: larger just before a foot touches down."""
    found = np.full(len(scene.samples), scene.parameters.zmp_margin)
    for step in scene.base.crossing:
        before = step.touch_down - round(LANDING / scene.dt)
        found[(scene.samples >= before) & (scene.samples < step.touch_down)] = scene.parameters.zmp_margin_landing
    return found


def friction(seen: Instants) -> Group:
    """Horizontal over vertical force, least and largest vertical force over the weight."""
    p, weight = seen.scene.parameters, seen.scene.channels.dynamics.mass * GRAVITY
    across, up = np.linalg.norm(seen.wrench.force[:, :2], axis=1), seen.wrench.force[:, 2]
    most = np.where(seen.scene.landed, p.force_max_landed, p.force_max)
    values = np.column_stack([across / up - p.friction, p.force_min - up / weight, up / weight - most])

    def gradient(rows: np.ndarray, columns: np.ndarray) -> Local:
        by, force = seen.wrench_by[0][rows], seen.wrench.force[rows]
        side = np.einsum("ri,ric->rc", force[:, :2], by[:, :2]) / (across * up)[rows, None]
        slip = side - (across / up**2)[rows, None] * by[:, 2]
        lift = np.where(columns == 1, -1.0, 1.0)[:, None] * by[:, 2] / weight
        return Local(motion=np.where(columns[:, None] == 0, slip, lift))

    parts = ["horizontal force", "vertical force (too small)", "vertical force (too large)"]
    return Group("floor force", values, parts, FORCE, "of the vertical force or weight", gradient)


def yaw_moment(seen: Instants) -> Group:
    """Moment about the vertical through the ZMP, both ways."""
    moment = seen.yaw_moment
    values = (np.column_stack([moment, -moment]) - seen.scene.parameters.yaw_moment) / MOMENT

    def gradient(rows: np.ndarray, columns: np.ndarray) -> Local:
        return Local(motion=np.where(columns == 0, 1.0, -1.0)[:, None] * seen.yaw_moment_by[rows] / MOMENT)

    return Group("yaw moment", values, ["left", "right"], MOMENT, "N m", gradient)


def _soles(seen: Instants) -> tuple[np.ndarray, np.ndarray]:
    """Channels (n, 6) of the bearing and of the other sole."""
    left, right = (seen.now[:, of_sole(side)] for side in SIDES)
    bears = seen.scene.bearing[:, None] > 0
    return np.where(bears, left, right), np.where(bears, right, left)


def _turn(yaw: np.ndarray) -> np.ndarray:
    """Plane rotations (n, 2, 2)."""
    c, s = np.cos(yaw), np.sin(yaw)
    return np.moveaxis(np.array([[c, -s], [s, c]]), 2, 0)


def _others(seen: Instants, patch: dict[int, np.ndarray]) -> np.ndarray:
    """Corners (n, 4, 2) of the other sole in the bearing sole's frame [m]."""
    here, there = _soles(seen)
    own = np.where(seen.scene.bearing[:, None, None] > 0, patch[-1], patch[1])
    world = own @ np.swapaxes(_turn(there[:, 3]), 1, 2) + (there - here)[:, None, :2]
    return world @ _turn(here[:, 3])


def _others_by(seen: Instants, rows: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Derivative (R, 2, C) by the channels of corners (R, 2) of the other sole in the bearing sole's frame."""
    here, there = (part[rows] for part in _soles(seen))
    back = np.swapaxes(_turn(here[:, 3]), 1, 2)
    found = np.zeros((len(rows), 2, seen.now.shape[1]))
    world = np.einsum("rij,rj->ri", _turn(here[:, 3]), corners)
    from_there = world - (there - here)[:, :2]
    for side in SIDES:
        first = of_sole(side).start
        own = seen.scene.bearing[rows] == side
        sign = np.where(own, -1.0, 1.0)
        found[:, :, first : first + 2] = sign[:, None, None] * back
        lever = np.where(own[:, None], -world, from_there) @ QUARTER.T
        found[:, :, first + 3] = np.einsum("rij,rj->ri", back, lever)
    return found
