"""Where the inputs and, in a checkout, the notebooks and figures lie."""

from __future__ import annotations

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
