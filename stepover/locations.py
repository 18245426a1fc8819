"""Where the inputs and, in a checkout, the notebooks and figures lie; and what may be read."""

from __future__ import annotations

import stat
from pathlib import Path

from stepover.errors import InvalidInput


def data_folder() -> Path:
    """Folder of the inputs: data/ of a checkout, or the copy that the wheel carries."""
    package = Path(__file__).resolve().parent
    inside = package / "data"
    return inside if inside.is_dir() else package.parent / "data"


def checkout() -> Path:
    """Top folder of the checkout that this package is imported from.

    Raises:
        InvalidInput: it has no notebooks, because stepover is an installed package.
    """
    top = Path(__file__).resolve().parents[1]
    if not (top / "notebooks").is_dir():
        raise InvalidInput(f"no notebooks in {top}: reproduce needs a checkout of stepover, not an installed package")
    return top


def require_regular(path: Path, most: int) -> None:
    """Refuse what is no regular file of a sensible size: a pipe or a device might never end.

    Args:
        path: of the file.
        most: its largest size [bytes].

    Raises:
        InvalidInput: it is a folder, a pipe or a device, it is too large, or the path makes no sense.
        OSError: there is no such file.
    """
    try:
        status = path.stat()
    except ValueError as error:  # a NUL in it
        raise InvalidInput(f"{str(path)!r} is no path") from error
    if not stat.S_ISREG(status.st_mode):
        raise InvalidInput(f"{path} is not a regular file, but a folder, a pipe or a device")
    if status.st_size > most:
        raise InvalidInput(f"{path} has {status.st_size:,} bytes; {most:,} are read at most")
