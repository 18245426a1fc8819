"""Small tables for notebooks."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Table:
    """A table that a notebook renders and a terminal prints.

    Attributes:
        header: names of the columns.
        rows: cells as text, as many as the header has.
    """

    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def _repr_markdown_(self) -> str:
        """The table as Markdown, for Jupyter."""
        lines = [self.header, ("---",) * len(self.header), *self.rows]
        return "\n".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |" for line in lines)

    def __str__(self) -> str:
        """The table with aligned columns, for a terminal."""
        lines = [self.header, *self.rows]
        widths = [max(len(line[column]) for line in lines) for column in range(len(self.header))]
        return "\n".join(
            "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip() for line in lines
        )


def table(header: str, rows: Iterable[tuple[object, ...]]) -> Table:
    """A table from a header "name | name | ..." and rows of any values; floats get three digits.

    Raises:
        ValueError: a row has more or fewer cells than the header.
    """
    names = tuple(name.strip() for name in header.split("|"))
    cells = tuple(tuple(f"{x:.3g}" if isinstance(x, float) else str(x) for x in row) for row in rows)
    for row in cells:
        if len(row) != len(names):
            raise ValueError(f"{row} has {len(row)} cells, the header {len(names)}")
    return Table(names, cells)
