"""Solids as triangles that move with the robot's joints."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields, replace

import numpy as np

from stepover.model.collision import hull_of
from stepover.model.kinematics import Placements
from stepover.report.scene import Solid


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles of many solids.

    Attributes:
        corners: (T, 3, 3) corners in their joints' frames [m], counter-clockwise from outside.
        normals: (T, 3, 3) unit vectors at the corners, in the same frames.
        joints: (T,) the joints that move them, as in Placements.
        colours: (T, 3) red, green, blue from 0 to 1.
        faces: (T,) numbers of the flat or smooth faces that they belong to, from 1.
    """

    corners: np.ndarray
    normals: np.ndarray
    joints: np.ndarray
    colours: np.ndarray
    faces: np.ndarray

    @classmethod
    def of(cls, solids: Iterable[Solid]) -> Mesh:
        """The triangles of some solids."""
        parts, first = [], 1
        for solid in solids:
            mesh = _triangles(solid)
            parts.append(replace(mesh, faces=mesh.faces + first))
            first += int(mesh.faces.max()) + 1
        return _joined(parts)

    def placed(self, placements: Placements, sample: int) -> Mesh:
        """The same in the world, at a sample."""
        turn, shift = placements.rotations[sample][self.joints], placements.positions[sample][self.joints]
        back = np.swapaxes(turn, 1, 2)
        return replace(self, corners=self.corners @ back + shift[:, None], normals=self.normals @ back)

    def only(self, kept: np.ndarray) -> Mesh:
        """Some of the triangles."""
        return Mesh(*(getattr(self, one.name)[kept] for one in fields(self)))


def _joined(parts: list[Mesh]) -> Mesh:
    """The triangles of several meshes."""
    return Mesh(*(np.concatenate([getattr(part, one.name) for part in parts]) for one in fields(Mesh)))


def _triangles(solid: Solid) -> Mesh:
    """The triangles of one solid, with faces from 0: all that is smooth is one face, and all that lies in one plane."""
    parts = []
    for number, hull in enumerate(solid.hulls):
        corners, triangles = hull_of(hull)
        placed, flat = corners[triangles], _normals(corners[triangles])
        smooth = _around_corners(flat, triangles, len(corners)) if solid.smooth else np.repeat(flat[:, None], 3, axis=1)
        colour = np.array([int(solid.colour[k : k + 2], 16) / 255.0 for k in (1, 3, 5)])
        count = len(triangles)
        parts.append(
            Mesh(placed, smooth, np.full(count, solid.joint), np.tile(colour, (count, 1)), np.full(count, number))
        )
    mesh = _joined(parts)
    return mesh if solid.smooth else replace(mesh, faces=_planes(mesh.corners[:, 0], mesh.normals[:, 0]))


def _planes(points: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Numbers (T,) from 0 of planes through points (T, 3) with normals (T, 3), the same where they agree to a mm."""
    planes = np.column_stack([normals, np.einsum("ta,ta->t", points, normals)])
    return np.unique(np.round(planes, 3) + 0.0, axis=0, return_inverse=True)[1].ravel()


def _normals(corners: np.ndarray) -> np.ndarray:
    """Unit normals (T, 3) of triangles (T, 3, 3)."""
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(across / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-12))


def _around_corners(flat: np.ndarray, triangles: np.ndarray, count: int) -> np.ndarray:
    """Normals (T, 3, 3) at the corners of triangles: means over the triangles that meet there."""
    total = np.zeros((count, 3))
    np.add.at(total, triangles.ravel(), np.repeat(flat, 3, axis=0))
    return np.asarray(total / np.linalg.norm(total, axis=1, keepdims=True))[triangles]
