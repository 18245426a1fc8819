"""Fingerprint of all that the rows of a study depend on: the code that computes them, and the robot's files."""

from __future__ import annotations

import ast
import hashlib
import sys
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from stepover.locations import data_folder
from stepover.robots.files import find_file
from stepover.robots.loading import load_robot

PACKAGE = "stepover"
FOLDER = Path(__file__).resolve().parents[1]
"""Folder of the package."""


def fingerprint(work: Callable[..., Any], robot: str, *more: object) -> str:
    """Twelve digits that change with the code, the robot's files, or any further value given.

    Args:
        work: the function or callable object that computes the rows.
        robot: name of the robot, or the path of its robot.toml.
        more: further values that the rows depend on.
    """
    digest = hashlib.sha256(repr(more).encode())
    for path in [*sources(work.__module__), *robot_files(robot)]:
        digest.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()[:12]


@cache
def sources(module: str) -> tuple[Path, ...]:
    """Files of a module and of all modules of this package that it imports, directly or indirectly.

    Imports inside functions count. So do modules named in a text, as in the registry of engines, but not those named in
    the package's own __init__. Imports for type checking only do not count.
    """
    found, waiting = dict[str, Path](), [module]
    while waiting:
        name = waiting.pop()
        path = _file_of(name)
        if name in found or path is None:
            continue
        found[name] = path
        tree = ast.parse(path.read_bytes())
        waiting += [name.rpartition(".")[0], *_imported(tree), *([] if name == PACKAGE else _named(tree))]
    return tuple(found[name] for name in sorted(found))


def _file_of(module: str) -> Path | None:
    """The file of a module of this package, or of a loaded module outside it; None if the name is not a module."""
    top, *parts = module.split(".")
    if top == PACKAGE:
        place = FOLDER.joinpath(*parts)
        candidates = [place / "__init__.py", place.with_suffix(".py")]
        return next((path for path in candidates if path.is_file()), None)
    file = getattr(sys.modules.get(module), "__file__", None)
    return Path(file) if file else None


def _imported(node: ast.AST) -> Iterator[str]:
    """Possible names of modules of this package, from all import statements under a node."""
    if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
        for other in node.orelse:
            yield from _imported(other)
        return
    names = []
    if isinstance(node, ast.Import):
        names = [alias.name for alias in node.names]
    elif isinstance(node, ast.ImportFrom) and node.module:
        names = [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
    yield from (name for name in names if name.partition(".")[0] == PACKAGE)
    for child in ast.iter_child_nodes(node):
        yield from _imported(child)


def _named(tree: ast.AST) -> Iterator[str]:
    """Texts that may be names of modules of this package."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and str(node.value).startswith(f"{PACKAGE}."):
            yield str(node.value)


def robot_files(robot: str) -> list[Path]:
    """The robot.toml, the URDF, and its collision meshes."""
    toml = Path(robot) if Path(robot).suffix == ".toml" else data_folder() / robot / "robot.toml"
    urdf = load_robot(robot).urdf_path
    named = {mesh.get("filename", "") for mesh in ElementTree.parse(urdf).iterfind("link/collision/geometry/mesh")}
    return [toml, urdf, *(find_file(name, urdf.parent) for name in sorted(named))]
