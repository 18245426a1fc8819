"""Distances between the robot's links and the obstacle.

The obstacle is a beam along y, so only each link's profile in the x-z plane matters. Profiles are tested for all
samples at once by separating axes. The result is the exact depth of a penetration, or a lower bound of the distance,
exact if a face is nearest. For the few samples that may be nearest, coal gives the exact signed distance in 3-D.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import coal
import numpy as np
from scipy.spatial import ConvexHull

from stepover.model.body import Body
from stepover.model.kinematics import Placements
from stepover.model.obstacle import LATERAL_HALF_EXTENT

NEAR = 0.05
"""Separation up to which a shape's own axes are used for a better bound [m]."""


@dataclass(frozen=True, eq=False)
class Shape:
    """A convex collision shape of a link.

    Attributes:
        link: name of its link.
        joint: index of the joint that moves it, in Placements.
        vertices: (V, 3) corners in the joint's frame [m].
        edges: (E, 3) unit directions of its edges, one for each set of parallel edges.
        solid: the same shape as coal's geometry, in the joint's frame.
    """

    link: str
    joint: int
    vertices: np.ndarray
    edges: np.ndarray
    solid: coal.Convex

    @cached_property
    def sphere(self) -> tuple[np.ndarray, float]:
        """Centre (3,) in the joint's frame and radius of a sphere around it [m]."""
        centre = (self.vertices.min(axis=0) + self.vertices.max(axis=0)) / 2.0
        return centre, float(np.linalg.norm(self.vertices - centre, axis=1).max())


class Clearance(NamedTuple):
    """Smallest signed distance [m], its link and its sample."""

    distance: float
    link: str
    sample: int


def shapes_of(body: Body) -> list[Shape]:
    """Convex shapes of all links, in the order of the joints that move them."""
    shapes = []
    for link in sorted(body.description.links, key=lambda link: body.joint_of(link.name)):
        for solid in link.solids:
            vertices = solid.corners @ solid.place.rotation.T + solid.place.translation
            hull = ConvexHull(vertices)
            vertices = vertices[hull.vertices]
            shapes.append(
                Shape(link.name, body.joint_of(link.name), vertices, _edge_directions(hull), _convex(vertices))
            )
    return shapes


def profile(shape: Shape, placements: Placements) -> np.ndarray:
    """Corners of a shape in the x-z plane: (N, V, 2) [m]."""
    return _rows(shape.vertices, shape.joint, placements, slice(None)).transpose(2, 1, 0)


def _rows(vertices: np.ndarray, joint: int, placements: Placements, samples: np.ndarray | slice) -> np.ndarray:
    """The same of points (V, 3) with time as the last, contiguous axis: (2, V, n)."""
    rows = [vertices @ placements.rotations[samples, joint, k].T for k in (0, 2)]
    return np.array(rows) + placements.positions[samples, joint][:, [0, 2]].T[:, None]


def separation(shape: Shape, placements: Placements, rectangle: np.ndarray) -> np.ndarray:
    """Signed separation (N,) [m] of a shape from a rectangle x_min, x_max, z_min, z_max (4,) or (N, 4).

    Negative values are the depth of the penetration; positive values are a lower bound of the distance. The axes of the
    rectangle come first. Those of the shape are only used if the result is less than NEAR.
    """
    return _separation(shape, placements, rectangle, slice(None), NEAR)


def _separation(
    shape: Shape, placements: Placements, rectangle: np.ndarray, samples: np.ndarray | slice, enough: float
) -> np.ndarray:
    """The same (n,) at some samples (n,) only. It is only refined if the first bound is less than enough [m]."""
    corners = _rows(shape.vertices, shape.joint, placements, samples)
    rectangle = rectangle if rectangle.ndim == 1 else rectangle[samples]
    low, high = _ends(rectangle)
    result = np.maximum(corners.min(axis=1) - high, low - corners.max(axis=1)).max(axis=0)
    near = np.flatnonzero(result < enough)
    if len(near):
        limits = np.broadcast_to(rectangle, (len(result), 4))[near].T
        when = np.arange(len(placements.positions))[samples][near]
        edges = np.array([shape.edges @ placements.rotations[when, shape.joint, k].T for k in (0, 2)])
        result[near] = np.maximum(result[near], _along_edges(corners[..., near], edges, limits))
    return result


def _ends(rectangle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper ends (2, 1) or (2, N), x and z, of a rectangle (4,) or (N, 4)."""
    low, high = np.atleast_2d(rectangle).T.reshape(2, 2, -1).swapaxes(0, 1)
    return low, high


def _sphere_separation(shape: Shape, placements: Placements, rectangle: np.ndarray) -> np.ndarray:
    """Lower bound (N,) [m] of a shape's separation, by the sphere around it."""
    centre, radius = shape.sphere
    low, high = _ends(rectangle)
    middle = _rows(centre[None], shape.joint, placements, slice(None))[:, 0]
    return np.asarray(np.maximum(middle - high, low - middle).max(axis=0) - radius)


def least_separation(
    shapes: list[Shape], placements: Placements, rectangle: np.ndarray, up_to: float = np.inf
) -> tuple[np.ndarray, np.ndarray]:
    """Smallest separation (N,) of some shapes [m], at most up_to, and the index (N,) of the nearest shape.

    A shape is only tested at samples where the sphere around it is nearer than the shapes before it. The last link
    comes first, since the foot is usually nearest.
    """
    least, which = np.full(len(placements.positions), up_to), np.zeros(len(placements.positions), dtype=int)
    for k in reversed(range(len(shapes))):
        near = np.flatnonzero(_sphere_separation(shapes[k], placements, rectangle) <= least)
        if len(near):
            here = _separation(shapes[k], placements, rectangle, near, min(NEAR, up_to))
            nearer = here <= least[near]
            least[near[nearer]], which[near[nearer]] = here[nearer], k
    return least, which


def keep_free(shapes: list[Shape], placements: Placements, rectangle: np.ndarray, spare: float) -> np.ndarray:
    """Samples that keep some distance [m], (N,) bool. The test of a sample ends at the first shape that is too near."""
    free = np.ones(len(placements.positions), dtype=bool)
    for shape in reversed(shapes):
        near = np.flatnonzero(free & (_sphere_separation(shape, placements, rectangle) < spare))
        if len(near):
            free[near] = _separation(shape, placements, rectangle, near, min(NEAR, spare)) >= spare
    return free


def _along_edges(corners: np.ndarray, edges: np.ndarray, rectangle: np.ndarray) -> np.ndarray:
    """Largest separation (n,) over the normals of projected edges (2, E, n), of corners (2, V, n) and (4, n)."""
    lengths = np.hypot(*edges)
    normal_x, normal_z = edges[::-1] * [[[1.0]], [[-1.0]]] / np.maximum(lengths, 1e-9)
    lowest, highest = np.full((2, *lengths.shape), [[[np.inf]], [[-np.inf]]])
    for x, z in corners.swapaxes(0, 1):  # one by one, since (E, V, n) of a fine mesh would fill the memory
        along = normal_x * x + normal_z * z
        np.minimum(lowest, along, out=lowest)
        np.maximum(highest, along, out=highest)
    x_min, x_max, z_min, z_max = rectangle
    centre = (normal_x * (x_min + x_max) + normal_z * (z_min + z_max)) / 2.0
    reach = (np.abs(normal_x) * (x_max - x_min) + np.abs(normal_z) * (z_max - z_min)) / 2.0
    apart = np.maximum(lowest - centre, centre - highest) - reach
    return np.where(lengths > 1e-6, apart, -np.inf).max(axis=0)


def clearance(shapes: list[Shape], placements: Placements, rectangle: np.ndarray) -> Clearance:
    """Smallest distance of all links from the obstacle over a motion: a broad phase by profiles, then coal."""
    bounds = np.array([separation(shape, placements, rectangle) for shape in shapes])
    distance, which, sample = smallest(bounds, lambda i, k: exact_distance(shapes[i], placements, k, rectangle))
    return Clearance(distance, shapes[which].link, sample)


def smallest(bounds: np.ndarray, exact: Callable[[int, int], float], up_to: float = np.inf) -> tuple[float, int, int]:
    """Smallest exact value, its row and column, with as few calls as the lower bounds (A, B) allow.

    If all values are larger than up_to, the result is one of them, not always the smallest.
    """
    flat = bounds.ravel()
    best = exact(*divmod(int(flat.argmin()), bounds.shape[1])), int(flat.argmin())
    rest = np.flatnonzero(flat <= min(best[0], up_to))  # usually few; only these need sorting
    for index in rest[np.argsort(flat[rest])].tolist():
        if flat[index] > best[0]:
            break
        best = min(best, (exact(*divmod(index, bounds.shape[1])), index))
    return best[0], *divmod(best[1], bounds.shape[1])


def exact_distance(shape: Shape, placements: Placements, sample: int, rectangle: np.ndarray) -> float:
    """Signed distance [m] of one shape at one sample from the obstacle's solid, by coal."""
    x_min, x_max, z_min, z_max = rectangle
    beam = coal.Box(x_max - x_min, 2.0 * LATERAL_HALF_EXTENT, z_max - z_min)
    place = coal.Transform3s(np.eye(3), np.array([(x_min + x_max) / 2.0, 0.0, (z_min + z_max) / 2.0]))
    where = coal.Transform3s(
        placements.rotations[sample, shape.joint].copy(), placements.positions[sample, shape.joint].copy()
    )
    return float(coal.distance(shape.solid, where, beam, place, coal.DistanceRequest(), coal.DistanceResult()))


def distance_between(first: Shape, second: Shape, placements: Placements, sample: int) -> float:
    """Signed distance [m] between two shapes of the robot at one sample, by coal."""
    places = [
        coal.Transform3s(placements.rotations[sample, s.joint].copy(), placements.positions[sample, s.joint].copy())
        for s in (first, second)
    ]
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    return float(coal.distance(first.solid, places[0], second.solid, places[1], request, result))


def hull_of(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners (V, 3) of the convex hull of points, and its triangles (T, 3), seen from outside counter-clockwise."""
    hull = ConvexHull(corners)
    kept, faces = hull.points[hull.vertices], np.searchsorted(hull.vertices, hull.simplices)
    first, second, third = (kept[faces[:, k]] for k in range(3))
    inward = np.einsum("na,na->n", np.cross(second - first, third - first), hull.equations[:, :3]) < 0.0
    faces[inward] = faces[inward, ::-1]
    return kept, faces


def _convex(vertices: np.ndarray) -> coal.Convex:
    """Convex hull (V, 3) as coal's geometry."""
    points = coal.StdVec_Vec3s()
    for vertex in vertices:
        points.append(vertex)
    return coal.ConvexBase.convexHull(points, True, "Qt")


def _edge_directions(hull: ConvexHull) -> np.ndarray:
    """Unit directions (E, 3) of a hull's edges, one for each set of parallel edges, without diagonals of flat faces."""
    corners = hull.points[hull.simplices[:, [[1, 2], [0, 2], [0, 1]]]]  # (T, 3, 2, 3), of the edge across each corner
    normals = hull.equations[:, :3]
    bent = np.einsum("ta,tka->tk", normals, normals[hull.neighbors]) <= 1.0 - 1e-9
    edges = (corners[:, :, 1] - corners[:, :, 0])[bent]
    edges /= np.linalg.norm(edges, axis=1, keepdims=True)
    found = np.empty((0, 3))
    while len(edges):
        found = np.vstack([found, edges[:1]])
        edges = edges[np.abs(edges @ edges[0]) < 1.0 - 1e-9]
    return found
