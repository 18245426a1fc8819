"""Text that is generated into a file that people write: it stands between two comments."""

from __future__ import annotations

from pathlib import Path

from stepover.errors import InvalidInput


def marks(name: str) -> tuple[str, str]:
    """The comments before and after a block."""
    return f"<!-- {name} -->", f"<!-- /{name} -->"


def with_block(path: Path, name: str, block: str) -> str:
    """A file's text with a block in the place of what stands between its marks.

    Raises:
        InvalidInput: the file cannot be read, or has not each mark once, in their order.
    """
    start, end = marks(name)
    try:
        text = path.read_text()
    except OSError as error:
        raise InvalidInput(f"{path} cannot be read: {error.strerror}") from error
    if text.count(start) != 1 or text.count(end) != 1 or text.index(start) > text.index(end):
        raise InvalidInput(f"{path} must hold {start} and {end}, once each, around what is generated")
    before, after = text.split(start)[0], text.split(end)[1]
    return f"{before}{start}\n{block}\n{end}{after}"
