"""A generated block inside a file that people write. Two comments mark its place."""

from __future__ import annotations

from pathlib import Path

from stepover.errors import InvalidInput


def marks(name: str) -> tuple[str, str]:
    """The comments before and after a block."""
    return f"<!-- {name} -->", f"<!-- /{name} -->"


def with_block(path: Path, name: str, block: str) -> str:
    """The text of a file with a new block between its marks.

    Raises:
        InvalidInput: the file cannot be read, or does not contain each mark once and in order.
    """
    start, end = marks(name)
    try:
        text = path.read_text()
    except OSError as error:
        raise InvalidInput(f"{path} cannot be read: {error.strerror}") from error
    if text.count(start) != 1 or text.count(end) != 1 or text.index(start) > text.index(end):
        raise InvalidInput(f"{path} must hold {start} and {end}, once each, around its generated block")
    before, after = text.split(start)[0], text.split(end)[1]
    return f"{before}{start}\n{block}\n{end}{after}"
