"""Where a robot's files lie: in data/, beside its robot.toml, anywhere, or in an installed Python package."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

from stepover.errors import InvalidInput
from stepover.locations import require_regular

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
