"""Solids as triangles that move with the robot's joints."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields, replace

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from stepover.model.collision import hull_of
from stepover.model.kinematics import Placements
from stepover.report.scene import Solid

CREASE = 22.0
"""Angle between two triangles from which on there is an edge [deg]."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles of many solids.

    Attributes:
        corners: (T, 3, 3) corners in their joints' frames [m], counter-clockwise from outside.
        normals: (T, 3, 3) unit vectors at the corners, in the same frames.
        joints: (T,) the joints that move them, as in Placements.
        colours: (T, 3) red, green, blue from 0 to 1.
        faces: (T,) numbers of the faces that they belong to, from 1.
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
    """The triangles of one solid, with faces from 0: what bends a little or lies in one plane is one face."""
    colour = np.array([int(solid.colour[k : k + 2], 16) / 255.0 for k in (1, 3, 5)])
    parts, count = [], 0
    for hull in solid.hulls:
        corners, triangles = hull_of(hull)
        placed = corners[triangles]
        normals, faces = _bent(outwards(placed), triangles)
        size = len(triangles)
        parts.append(Mesh(placed, normals, np.full(size, solid.joint), np.tile(colour, (size, 1)), faces + count))
        count += size
    mesh = _joined(parts)
    return replace(mesh, faces=_with_planes(mesh))


def outwards(corners: np.ndarray) -> np.ndarray:
    """Unit normals (T, 3) of triangles (T, 3, 3); zero for one without area."""
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(across / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-12))


def _bent(flat: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Normals (T, 3, 3) at the corners of a hull's triangles, and their faces (T,), from their own normals (T, 3).

    A normal is the mean over the triangles that meet there, without those beyond a crease.
    """
    alike = flat @ flat.T > np.cos(np.radians(CREASE))
    meet = [(corner[:, None, None] == triangles).any(axis=2) & alike for corner in triangles.T]
    normals = np.stack([near @ flat for near in meet], axis=1)
    normals /= np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-12)
    beside = sum(near.astype(int) for near in meet) >= 2  # two corners in common
    return normals, connected_components(csr_array(beside), directed=False)[1]


def _with_planes(mesh: Mesh) -> np.ndarray:
    """Faces (T,) in which also those are one that have a triangle in the same plane, to a mm."""
    flat = outwards(mesh.corners)
    planes = np.round(np.column_stack([flat, np.einsum("ta,ta->t", mesh.corners[:, 0], flat)]), 3) + 0.0
    _, first, which = np.unique(planes, axis=0, return_index=True, return_inverse=True)
    pairs = mesh.faces, mesh.faces[first[which.ravel()]]
    size = int(mesh.faces.max()) + 1
    joined = connected_components(csr_array((np.ones(len(which)), pairs), (size, size)), directed=False)[1]
    return np.asarray(joined[mesh.faces])
