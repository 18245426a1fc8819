"""Mesh files: their corners, and what makes them useless."""

from __future__ import annotations

import re
from pathlib import Path

import coal
import numpy as np
from scipy.spatial import ConvexHull, QhullError

from stepover.errors import InvalidInput
from stepover.robots.files import require_readable

MOST_BYTES = 200_000_000
"""Largest mesh file that is read: finer ones than that serve no planner."""
FLAT = 1e-6
"""m: a hull that is thinner is flat."""


def corners_of_mesh(path: Path) -> np.ndarray:
    """Corners (V, 3) of a mesh [m], in the unit that its file states.

    Raises:
        InvalidInput: it is missing, no mesh, empty, flat, or only the pointer of Git LFS.
    """
    require_readable(path, MOST_BYTES)
    with open(path, "rb") as file:
        head = file.read(64_000)
    if head.startswith(b"version https://git-lfs"):
        raise InvalidInput(f"{path} is a pointer of Git LFS, not the mesh: 'git lfs pull' fetches it")
    try:
        mesh = coal.MeshLoader().load(str(path), np.full(3, _unit(path, head)))
        corners = np.array(mesh.vertices())
    except (ValueError, RuntimeError) as error:
        raise InvalidInput(f"{path} cannot be read as a mesh") from error
    if not np.isfinite(corners).all():
        raise InvalidInput(f"{path} holds corners that are not finite")
    return corners


def _unit(path: Path, head: bytes) -> float:
    """The unit of a COLLADA file [m]; other formats state none, and are in m."""
    found = re.search(rb'<unit\b[^>]*\bmeter\s*=\s*"([^"]+)"', head) if path.suffix.lower() == ".dae" else None
    try:
        return float(found.group(1)) if found else 1.0
    except ValueError:
        return 1.0


def require_solid(corners: np.ndarray, name: str) -> None:
    """Refuse corners (V, 3) whose hull has no volume.

    Raises:
        InvalidInput: it names the shape.
    """
    try:
        volume = ConvexHull(corners).volume if len(corners) >= 4 else 0.0
    except QhullError:
        volume = 0.0
    if volume <= FLAT**3:
        raise InvalidInput(f"{name} is flat or empty: a shape to collide with needs a volume")
