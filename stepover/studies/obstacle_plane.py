"""Study of which obstacles can be crossed: a plane of heights and widths, planned and simulated.

The stored table, figures/obstacle_plane.csv, is a sweep (see sweep.py) that `make studies` runs. The hash of each
motion shows whether today's planner still plans the same motion.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from stepover.errors import InvalidInput
from stepover.simulation.engine import DEFAULT
from stepover.studies.agreement import CLOSE, NO, agreement
from stepover.studies.study import ENGINE, make_table, read_rows, stored_table
from stepover.studies.sweep import Crossing, Point, cross

NAME = "obstacle_plane"
HEIGHTS = tuple(round(0.05 + 0.025 * k, 3) for k in range(13))
WIDTHS = (0.02, 0.05, 0.08, 0.11, 0.14, 0.17, 0.20, 0.25)
"""The grid [m]."""
CORNERS = ((0.22, 0.07), (0.15, 0.13))
"""Heights and widths beside the grid [m]. The robot must cross these, 0.25 by 0.05 m, and all smaller ones."""
SAMPLE = ((0.10, 0.11), (0.20, 0.05), (0.25, 0.05))
"""Heights and widths that a notebook and a test plan anew."""


def grid(heights: Sequence[float] = HEIGHTS, widths: Sequence[float] = WIDTHS) -> list[Point]:
    """Points of a grid, ordered by height, then by width."""
    return [Point(height, width, engine=ENGINE) for height in heights for width in widths]


def whole_plane() -> list[Point]:
    """Points of the stored table."""
    return grid() + [Point(*corner, engine=ENGINE) for corner in CORNERS]


def study(
    points: Sequence[Point] | None = None, table: Path | None = None, build: Path | None = None,
    workers: int | None = None,
) -> Path:  # fmt: skip
    """Run or resume the study of the whole plane or of some points, and write its table; see make_table."""
    points = sorted(whole_plane() if points is None else points, key=lambda point: (point.height, point.width))
    return make_table(NAME, points, cross, Crossing, table, build, workers)


def read_table(path: Path | None = None) -> list[Crossing]:
    """Rows of a table; default: the stored table.

    Raises:
        InvalidInput: there is no such table, or it belongs to another study.
    """
    return read_rows(Crossing, path or stored_table(NAME))


def at(rows: Sequence[Crossing], height: float, width: float) -> Crossing:
    """The row of an obstacle.

    Raises:
        InvalidInput: the table has no such row.
    """
    for row in rows:
        if abs(row.height - height) < 1e-9 and abs(row.width - width) < 1e-9:
            return row
    raise InvalidInput(f"the table has no obstacle {height:.3f} m high and {width:.3f} m wide")


def again(stored: Crossing, physics: bool = True) -> tuple[Crossing, str]:
    """Plan and simulate a row of the table anew. Returns the new row and how it agrees with the stored one."""
    new = Crossing(**cross(Point(stored.height, stored.width, stored.robot, physics, engine=stored.engine or DEFAULT)))
    if new.motion != stored.motion or (physics and new.crossed != stored.crossed):
        return new, NO
    now, then = new.simulated_clearance, stored.simulated_clearance
    return new, agreement(not physics or now == then, now, then, room=CLOSE)
