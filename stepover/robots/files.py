"""Where a robot's files lie, URDF and meshes alike, and what may be read of them."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

from stepover.errors import InvalidInput
from stepover.locations import require_regular

PACKAGE = "package://"


def find_file(name: str, folder: Path) -> Path:
    """The file that a robot.toml or a URDF names.

    Args:
        name: relative to the folder, absolute, a `file://` address, or `package://NAME/...`, where NAME is a ROS
            package or an installed Python package.
        folder: where the naming file lies.

    Raises:
        InvalidInput: no such package holds the file; the message says where it was looked for.
    """
    if not name.startswith(PACKAGE):
        return folder / name.removeprefix("file://")
    package, _, rest = name.removeprefix(PACKAGE).partition("/")
    for place in _package_folders(package, folder):
        if (place / rest).is_file():
            return place / rest
    raise InvalidInput(
        f"{name!r} is not found: looked for the package {package!r} in the folders above {folder}, "
        "in ROS_PACKAGE_PATH and among the installed Python packages"
    )


def _package_folders(package: str, start: Path) -> Iterator[Path]:
    """Folders that may be a package: by their name, or by the name in their package.xml."""
    for folder in (start.resolve(), *start.resolve().parents):
        yield folder / package
        if _package_name(folder) == package:
            yield folder
    for entry in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep):
        root = Path(entry)
        if not entry or not root.is_dir():
            continue
        yield root / package
        for folder in (root, *sorted(path for path in root.iterdir() if path.is_dir())):
            if folder.name == package or _package_name(folder) == package:
                yield folder
    found = find_spec(package) if package.isidentifier() else None
    for place in (found.submodule_search_locations or []) if found else []:
        yield Path(place).resolve()
        yield Path(place).resolve().parent


def _package_name(folder: Path) -> str:
    """Name of a ROS package in its package.xml; empty where there is none."""
    try:
        return (ET.parse(folder / "package.xml").getroot().findtext("name") or "").strip()
    except (OSError, ET.ParseError):
        return ""


def require_readable(path: Path, most: int) -> None:
    """Refuse what is no regular file, or is larger than some bytes.

    Raises:
        InvalidInput: no such file, not a regular one, or too large.
    """
    try:
        require_regular(path, most)
    except OSError as error:
        raise InvalidInput(f"{path} cannot be read: {error.strerror}") from error


def read_text(path: Path, most: int) -> str:
    """The text of a file in UTF-8, with or without a byte order mark.

    Raises:
        InvalidInput: it cannot be read, is no regular file, is too large, or is not UTF-8.
    """
    require_readable(path, most)
    try:
        return path.read_bytes().decode("utf-8-sig")
    except OSError as error:
        raise InvalidInput(f"{path} cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise InvalidInput(
            f"{path} is not in UTF-8: byte {error.start + 1} is {error.object[error.start]:#04x}"
        ) from error
