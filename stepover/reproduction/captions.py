"""The captions of the figures: what each one shows, and which notebook draws it.

data/figures.toml holds one table a figure. `make reproduce` turns it into docs/figures.md.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

from stepover.errors import InvalidInput

SUFFIXES = ".png", ".gif"
"""Endings of the files that need a caption."""


@dataclass(frozen=True)
class Caption:
    """The caption of one figure.

    Attributes:
        file: name under figures/.
        notebook: name of the notebook that draws it.
        caption: what to see, in markdown; links are relative to docs/.
    """

    file: str
    notebook: str
    caption: str


def read_captions(top: Path) -> list[Caption]:
    """The captions of all figures of a checkout, in the order of data/figures.toml.

    Raises:
        InvalidInput: the file is damaged, or a figure has no caption, or a caption no figure.
    """
    path = top / "data" / "figures.toml"
    files = {file.stem: file.name for file in sorted((top / "figures").glob("*")) if file.suffix in SUFFIXES}
    try:
        rows = tomllib.loads(path.read_text()) if path.is_file() else {}
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InvalidInput(f"{path} is not valid TOML: {error}") from error
    for name in [*(set(rows) ^ set(files))]:
        lacking = "has no caption in data/figures.toml" if name in files else "has a caption but no file"
        raise InvalidInput(f"figure {name!r} {lacking}")
    try:
        return [Caption(file=files[name], **row) for name, row in rows.items()]
    except TypeError as error:
        raise InvalidInput(f"{path}: each figure needs 'notebook' and 'caption' and nothing else") from error
