"""The obstacles of a sweep: a grid of heights and widths, or a list in a file."""

from __future__ import annotations

import csv
import math
from collections import Counter
from collections.abc import Sequence
from itertools import product
from pathlib import Path

from stepover.errors import InvalidInput
from stepover.locations import require_regular

MOST = 1_000_000
"""Largest number of obstacles in one sweep. More are taken for a typing error."""
LARGEST_FILE = 100_000_000
"""Largest list that is read, in bytes."""
Sizes = tuple[float, float]
"""Height and width of a bare obstacle [m]."""


def axis(text: str, name: str) -> list[float]:
    """Values of one axis of a grid [m]: first:last:step, including both ends, or values separated by commas.

    Args:
        text: a text such as 0.05:0.25:0.05 or 0.1,0.15.
        name: name of the option, for the error message.

    Raises:
        InvalidInput: the text has neither form, does not rise, or gives too many values.
    """
    try:
        parts = [float(part) for part in text.replace(":", ",").split(",")]
    except ValueError:
        parts = []
    if not parts or not all(math.isfinite(part) for part in parts) or (":" in text and text.count(":") != 2):
        raise InvalidInput(f"{name} {text!r} must be first:last:step in metres, such as 0.05:0.25:0.05, or one value "
                           "or several with commas between")  # fmt: skip
    if ":" not in text:
        return parts
    if "," in text:
        raise InvalidInput(f"{name} {text!r} mixes first:last:step with commas; give one of the two")
    first, last, step = parts
    if step <= 0.0 or last < first:
        raise InvalidInput(f"{name} {text!r} must rise: a step above 0, and a last value that is not below the first")
    count = (last - first) / step
    if count >= MOST:
        raise InvalidInput(f"{name} {text!r} has more than {MOST} values; make the step larger")
    return [round(first + step * k, 9) for k in range(math.floor(count + 1e-6) + 1)]


def grid(heights: Sequence[float], widths: Sequence[float]) -> list[Sizes]:
    """Sizes [m] of a grid, by height, then by width.

    Raises:
        InvalidInput: the grid has too many obstacles, or one of them twice.
    """
    if len(heights) * len(widths) > MOST:
        raise InvalidInput(f"the grid has {len(heights) * len(widths)} obstacles; at most {MOST} are swept at once")
    return _each_once(list(product(heights, widths)))


def read_list(path: Path) -> list[Sizes]:
    """Sizes [m] in a table with the columns height and width. Other columns are ignored.

    Raises:
        InvalidInput: there is no such file, it is not a regular file or too large, it lacks a column or has no rows, a
            value is not a number, or an obstacle occurs twice.
    """
    try:
        require_regular(path, LARGEST_FILE)
        with open(path, newline="", encoding="utf-8-sig") as file:
            lines = csv.DictReader(file)
            if not {"height", "width"} <= set(lines.fieldnames or ()):
                raise InvalidInput(f"{path} must begin with a line that names the columns height and width")
            sizes = [_sizes(path, lines.line_num, line["height"], line["width"]) for line in lines]
    except OSError as error:
        raise InvalidInput(f"{path} cannot be read: {error.strerror}") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise InvalidInput(f"{path} is not a table with commas between its columns: {error}") from error
    if not sizes:
        raise InvalidInput(f"{path} names no obstacle; each line is one, height and width in metres")
    return _each_once(sizes)


def _each_once(sizes: list[Sizes]) -> list[Sizes]:
    """Reject an obstacle that occurs twice."""
    for (height, width), count in Counter(sizes).items():
        if count > 1:
            raise InvalidInput(f"the obstacle {height:g} m high and {width:g} m wide is given {count} times")
    return sizes


def _sizes(path: Path, line: int, height: str | None, width: str | None) -> Sizes:
    """Height and width in a line."""
    try:
        return float(height or ""), float(width or "")
    except ValueError:
        raise InvalidInput(f"{path}, line {line}: height {height!r} and width {width!r} must be numbers") from None
