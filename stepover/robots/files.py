"""Where a robot's files lie: in data/, beside its robot.toml, anywhere, or in an installed Python package."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

from stepover.errors import InvalidInput

PACKAGE = "package://"


def find_urdf(name: str, folder: Path) -> Path:
    """The URDF that robot.toml names.

    Args:
        name: relative to the folder, absolute, or package://NAME/..., where NAME is an installed Python package.
        folder: where robot.toml lies.

    Raises:
        InvalidInput: there is no such package.
    """
    if not name.startswith(PACKAGE):
        return folder / name
    package, _, rest = name.removeprefix(PACKAGE).partition("/")
    found = find_spec(package) if package.isidentifier() else None
    if found is None or not found.submodule_search_locations:
        raise InvalidInput(
            f"urdf = {name!r}: the Python package {package!r} is not installed (try pip install {package})"
        )
    return Path(found.submodule_search_locations[0]).resolve() / rest


def find_mesh(name: str, urdf: Path) -> Path:
    """A mesh that a URDF names: beside it; with package:// in one of the folders above it, as ROS lays them out.

    Raises:
        InvalidInput: it is in none of them.
    """
    if not name.startswith(PACKAGE):
        return urdf.parent / name.removeprefix("file://")
    rest = name.removeprefix(PACKAGE)
    for folder in urdf.parents:
        if (folder / rest).is_file():
            return folder / rest
    raise InvalidInput(f"{urdf}: {name!r} is in no folder above the URDF")
