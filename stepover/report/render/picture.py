"""One picture of a scene: a floor with a grid, shadows, solids, and the veil of the safety margin.

Solids are drawn at FINENESS times the size of the picture and averaged. The floor's lines are averaged over each pixel
by a formula. The light comes from far away, from above.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.ndimage import binary_dilation, gaussian_filter

from stepover.report.render.camera import Camera
from stepover.report.render.ground import ground
from stepover.report.render.mesh import Mesh, outwards
from stepover.report.render.raster import Window, areas, covered, nearest, planes, seen, triangle_of, window_of
from stepover.report.scene import VEIL

FINENESS = 2
"""Samples along each side of a pixel."""
AMBIENT, SKY, SUN = 0.66, 0.10, 0.28
"""Shares of a colour that are seen in the dark, from above, and towards the light."""
LIGHT = np.array([0.20, -0.40, 0.8944])
"""Direction towards the light (3,), of length 1: from above, and from the camera's side of the path."""
SHADOW, SOFTNESS = 0.26, 0.004
"""Darkness of a shadow, and the standard deviation of its edge, as a share of the picture's height."""
EDGE, OUTLINE, RIM = 0.66, 0.8, 1
"""Brightness of a face's edge, as a share of the face's; opacity of an edge of the veil, and its extra width in samples
to either side."""


Samples = tuple[np.ndarray, np.ndarray]
"""Rows (K,) and columns (K,)."""


class Layer(NamedTuple):
    """Triangles, their corners (T, 3, 2) in a picture, and the distances (T, 3) of these from the camera."""

    mesh: Mesh
    points: np.ndarray
    distances: np.ndarray


def draw(camera: Camera, solid: Mesh, veil: Mesh | None = None) -> np.ndarray:
    """A picture (height, width, 3) of uint8, of what is solid and what is a veil, both in the world."""
    picture = ground(camera).copy()
    _darken(picture, camera, solid)
    _put(picture, camera, solid, veil)
    return np.asarray(np.clip(picture, 0.0, 1.0) * 255.0 + 0.5, dtype=np.uint8)


def _darken(picture: np.ndarray, camera: Camera, solid: Mesh) -> None:
    """Cast the shadow of solids on the floor of a picture (height, width, 3)."""
    lit = solid.corners[outwards(solid.corners) @ LIGHT > 0.0]
    points, distances = camera.project(lit - lit[..., 2:] / LIGHT[2] * LIGHT)
    blur = SOFTNESS * camera.size.height
    window = window_of(points, camera.size, 4.0 * blur)
    mask = gaussian_filter(covered(points, distances, window).astype(np.float32), blur)
    picture[window.slices] *= 1.0 - SHADOW * mask[..., None]


def _put(picture: np.ndarray, camera: Camera, solid: Mesh, veil: Mesh | None) -> None:
    """Put solids and a veil over a picture (height, width, 3)."""
    layers = [_facing(camera, mesh) for mesh in (solid, veil) if mesh is not None]
    window = window_of(np.concatenate([points.reshape(-1, 2) for _, points, _ in layers]), camera.size)
    fine = Window(*(FINENESS * edge for edge in window))
    buffers = [nearest(FINENESS * points, distances, fine) for _, points, distances in layers]
    layer = np.zeros((*fine.shape, 4), dtype=np.float32)
    where, colours, edges = _looks(layers[0], buffers[0], fine)
    colours[edges[where], :3] *= EDGE
    layer[where] = colours
    if veil is not None:
        where, colours, edges = _looks(layers[1], buffers[1], fine)
        edges = binary_dilation(edges, iterations=RIM)
        before = (buffers[1] < buffers[0])[where]
        where = where[0][before], where[1][before]
        opacity = np.where(edges[where], np.float32(OUTLINE), np.float32(VEIL))[:, None]
        layer[where] += opacity * (colours[before] - layer[where])
    layer = _averaged(layer)
    picture[window.slices] *= 1.0 - layer[..., 3:]
    picture[window.slices] += layer[..., :3]


def _averaged(layer: np.ndarray) -> np.ndarray:
    """Samples (rows, columns, 4) as pixels."""
    rows = [layer[k::FINENESS] for k in range(FINENESS)]
    parts = [row[:, k::FINENESS] for row in rows for k in range(FINENESS)]
    return np.asarray(np.sum(parts, axis=0) / np.float32(FINENESS**2))


def _facing(camera: Camera, mesh: Mesh) -> Layer:
    """The triangles that face a camera."""
    points, distances = camera.project(mesh.corners)
    facing = areas(points) < 0.0
    return Layer(mesh.only(facing), points[facing], distances[facing])


def _looks(layer: Layer, buffer: np.ndarray, window: Window) -> tuple[Samples, np.ndarray, np.ndarray]:
    """What a layer looks like in a window.

    Returns:
        Rows and columns (K,) of the samples where it is seen, red, green, blue and 1 (K, 4) there, and the samples of
        the window (rows, columns) at the edge of a face.
    """
    mesh, points, _ = layer
    rows, columns = np.nonzero(seen(buffer))
    triangle = triangle_of(buffer[rows, columns])
    shades = AMBIENT + SKY * mesh.normals[..., 2] + SUN * np.maximum(mesh.normals @ LIGHT, 0.0)
    a, b, c = planes(FINENESS * points, shades).astype(np.float32).T
    x, y = columns + np.float32(window.left + 0.5), rows + np.float32(window.top + 0.5)
    shade = a[triangle] * x + b[triangle] * y + c[triangle]
    colours = np.ones((len(triangle), 4), dtype=np.float32)
    colours[:, :3] = mesh.colours.astype(np.float32)[triangle] * shade[:, None]
    faces = np.zeros(buffer.shape, dtype=np.int32)
    faces[rows, columns] = mesh.faces[triangle]
    return (rows, columns), colours, _edges(faces, buffer)


def _edges(faces: np.ndarray, buffer: np.ndarray) -> np.ndarray:
    """Samples (rows, columns) beside another face, on the nearer one of both."""
    edge = np.zeros(faces.shape, dtype=bool)
    for one, other in (((slice(None), slice(-1)), (slice(None), slice(1, None))), (slice(-1), slice(1, None))):
        differ, first = faces[one] != faces[other], buffer[one] < buffer[other]
        edge[one] |= differ & first
        edge[other] |= differ & ~first
    return edge
