"""Which obstacles can be crossed: the plane of heights and widths, planned, and carried out in the physics.

The stored table, figures/obstacle_plane.csv, is a sweep of its own, see sweep.py, made by `make studies`. The hash of
each motion tells whether the planner of today still plans what the table was made from.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from stepover.errors import InvalidInput
from stepover.studies.agreement import CLOSE, NO, agreement
from stepover.studies.study import make_table, read_rows, stored_table
from stepover.studies.sweep import Crossing, Point, cross

NAME = "obstacle_plane"
HEIGHTS = tuple(round(0.05 + 0.025 * k, 3) for k in range(13))
WIDTHS = (0.02, 0.05, 0.08, 0.11, 0.14, 0.17, 0.20, 0.25)
"""The grid [m]."""
CORNERS = ((0.22, 0.07), (0.15, 0.13))
"""Heights and widths beside the grid: together with 0.25 by 0.05 m, what must be crossed and all below it [m]."""
SAMPLE = ((0.10, 0.11), (0.20, 0.05), (0.25, 0.05))
"""Heights and widths that a notebook and a test plan anew."""


def grid(heights: Sequence[float] = HEIGHTS, widths: Sequence[float] = WIDTHS) -> list[Point]:
    """Points of a grid, by height, then by width."""
    return [Point(height, width) for height in heights for width in widths]


def whole_plane() -> list[Point]:
    """Points of the stored table."""
    return grid() + [Point(*corner) for corner in CORNERS]


def study(
    points: Sequence[Point] | None = None, table: Path | None = None, build: Path | None = None,
    workers: int | None = None,
) -> Path:  # fmt: skip
    """Run or resume the study of the whole plane, or of some points, and write its table: see make_table."""
    points = sorted(whole_plane() if points is None else points, key=lambda point: (point.height, point.width))
    return make_table(NAME, points, cross, Crossing, table, build, workers)


def read_table(path: Path | None = None) -> list[Crossing]:
    """Rows of a table, of the stored one unless another is given.

    Raises:
        InvalidInput: there is no such table, or it is not one of this study.
    """
    return read_rows(Crossing, path or stored_table(NAME))


def at(rows: Sequence[Crossing], height: float, width: float) -> Crossing:
    """The row of an obstacle.

    Raises:
        InvalidInput: the table has none.
    """
    for row in rows:
        if abs(row.height - height) < 1e-9 and abs(row.width - width) < 1e-9:
            return row
    raise InvalidInput(f"the table has no obstacle {height:.3f} m high and {width:.3f} m wide")


def again(stored: Crossing, physics: bool = True) -> tuple[Crossing, str]:
    """Plan, and carry out, a row of the table anew: the new row, and how the two agree."""
    new = Crossing(**cross(Point(stored.height, stored.width, stored.robot, physics)))
    if new.motion != stored.motion or (physics and new.crossed != stored.crossed):
        return new, NO
    now, then = new.simulated_clearance, stored.simulated_clearance
    return new, agreement(not physics or now == then, now, then, room=CLOSE)
