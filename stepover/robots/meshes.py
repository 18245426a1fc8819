"""Mesh files: where they lie, and their convex hulls."""

from __future__ import annotations

import os
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import coal
import numpy as np
from scipy.spatial import ConvexHull, QhullError

from stepover.errors import InvalidInput
from stepover.robots.files import PACKAGE, require_readable

MOST_BYTES = 200_000_000
"""Largest mesh file that is read: finer ones than that serve no planner."""
FLAT = 1e-6
"""m: a hull that is thinner is flat."""


def find_mesh(name: str, urdf: Path) -> Path:
    """The file of a mesh that a URDF names.

    Args:
        name: relative to the URDF, absolute, a `file://` address, or `package://NAME/...`
        urdf: the URDF.

    Raises:
        InvalidInput: there is no such file or package; the message says where it was looked for.
    """
    if not name.startswith(PACKAGE):
        return urdf.parent / name.removeprefix("file://")
    package, _, rest = name.removeprefix(PACKAGE).partition("/")
    folders = [folder for folder in _package_folders(package, urdf) if (folder / rest).is_file()]
    if not folders:
        raise InvalidInput(
            f"{name!r} is not found: looked for the package {package!r} in the folders above the URDF, "
            "in ROS_PACKAGE_PATH and among the installed Python packages"
        )
    return folders[0] / rest


def _package_folders(package: str, urdf: Path) -> Iterator[Path]:
    """Folders that may be a ROS package: by their name, or by the name in their package.xml."""
    for folder in urdf.resolve().parents:
        yield folder / package
        if _named(folder) == package:
            yield folder
    for entry in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep):
        root = Path(entry)
        if not entry or not root.is_dir():
            continue
        yield root / package
        for folder in (root, *sorted(path for path in root.iterdir() if path.is_dir())):
            if folder.name == package or _named(folder) == package:
                yield folder
    found = find_spec(package) if package.isidentifier() else None
    for place in (found.submodule_search_locations or []) if found else []:
        yield Path(place).resolve()
        yield Path(place).resolve().parent


def _named(folder: Path) -> str:
    """Name of a ROS package in its package.xml; empty where there is none."""
    try:
        return (ET.parse(folder / "package.xml").getroot().findtext("name") or "").strip()
    except (OSError, ET.ParseError):
        return ""


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
