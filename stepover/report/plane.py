"""Which obstacles can be crossed: the plane of heights and widths, planned, and carried out in the physics.

The stored table, figures/obstacle_plane.csv, is made by `make studies`. The hash of each motion tells whether the
planner of today still plans what the table was made from.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stepover import __version__
from stepover.errors import Infeasible, InvalidInput
from stepover.model.obstacle import Obstacle
from stepover.planner import plan_in_detail
from stepover.report.studies import Row, make_table, read_rows, robot_of, rounded, stored_table
from stepover.simulation.run import simulate
from stepover.verdict import measure

NAME = "obstacle_plane"
HEIGHTS = tuple(round(0.05 + 0.025 * k, 3) for k in range(13))
WIDTHS = (0.02, 0.05, 0.08, 0.11, 0.14, 0.17, 0.20, 0.25)
"""The grid [m]."""
CORNERS = ((0.22, 0.07), (0.15, 0.13))
"""Heights and widths beside the grid: together with 0.25 by 0.05 m, what must be crossed and all below it [m]."""
SAMPLE = ((0.10, 0.11), (0.20, 0.05), (0.25, 0.05))
"""Heights and widths that a notebook and a test plan anew."""


@dataclass(frozen=True)
class Point:
    """One obstacle of the study.

    Attributes:
        height, width: of the bare obstacle [m].
        robot: its name.
        physics: whether what plans is simulated.
    """

    height: float
    width: float
    robot: str = "hrp2"
    physics: bool = True


@dataclass(frozen=True)
class Crossing:
    """What became of one obstacle; a row of the table. Values that do not exist are None.

    Attributes:
        robot, version: what planned.
        height, width, margin_height, margin_width: of the obstacle [m].
        planned: whether there is a plan.
        beyond_paper_level: how much of what is added beyond the paper it takes.
        arm_swing_deg: UBMG [deg].
        foot_back, waist_raised, ankle_pushed: FTA's methods (1), (2), (3) [m].
        x_ads, z_hds: key configuration [m].
        planned_clearance: smallest distance from the bare obstacle [m].
        zmp_margin: smallest distance of the ZMP from the edge of the support polygon [m].
        joint_speed_ratio: largest joint speed over its limit.
        motion: hash of the motion.
        crossed: whether the simulated robot crossed.
        simulated_clearance: smallest distance in the physics [m].
        reason: the binding constraint where there is no plan; what went wrong where it did not cross.
    """

    robot: str
    version: str
    height: float
    width: float
    margin_height: float
    margin_width: float
    planned: bool
    beyond_paper_level: int | None = None
    arm_swing_deg: float | None = None
    foot_back: float | None = None
    waist_raised: float | None = None
    ankle_pushed: float | None = None
    x_ads: float | None = None
    z_hds: float | None = None
    planned_clearance: float | None = None
    zmp_margin: float | None = None
    joint_speed_ratio: float | None = None
    motion: str | None = None
    crossed: bool | None = None
    simulated_clearance: float | None = None
    reason: str = ""


def grid(heights: Sequence[float] = HEIGHTS, widths: Sequence[float] = WIDTHS) -> list[Point]:
    """Points of a grid, by height, then by width."""
    return [Point(height, width) for height in heights for width in widths]


def whole_plane() -> list[Point]:
    """Points of the stored table."""
    return grid() + [Point(*corner) for corner in CORNERS]


def cross(point: Point) -> Row:
    """Plan one obstacle and, where that works, carry it out: a row for run_study."""
    robot, obstacle = robot_of(point.robot), Obstacle(point.height, point.width)
    known = {"robot": robot.name, "version": __version__, "height": point.height, "width": point.width,
             "margin_height": obstacle.margin_height, "margin_width": obstacle.margin_width}  # fmt: skip
    try:
        planned = plan_in_detail(robot, obstacle, look_for_nearest=False)
    except Infeasible as error:
        return dataclasses.asdict(Crossing(planned=False, reason=error.constraint, **known))  # type: ignore[arg-type]
    found, feet = measure(robot, planned.motion), planned.adaptation
    row = Crossing(
        planned=True, beyond_paper_level=planned.effort.level,
        arm_swing_deg=rounded(np.degrees(planned.upper.arm_swing), 2), foot_back=rounded(feet.shift),
        waist_raised=rounded(feet.raised), ankle_pushed=rounded(feet.pushed), x_ads=rounded(planned.key.x_ads),
        z_hds=rounded(planned.key.z_hds), planned_clearance=rounded(found.clearance_min),
        zmp_margin=rounded(found.zmp_margin_min), joint_speed_ratio=rounded(found.joint_speed_ratio_max, 3),
        motion=planned.motion.hash(), **known,  # type: ignore[arg-type]
    )  # fmt: skip
    if point.physics:
        run = simulate(planned.motion, robot=robot)
        row = dataclasses.replace(
            row, crossed=run.crossed, simulated_clearance=rounded(run.clearance_min), reason=run.explanation
        )
    return dataclasses.asdict(row)


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


def again(stored: Crossing, physics: bool = True) -> tuple[Crossing, bool]:
    """Plan, and carry out, a row of the table anew: the new row, and whether the two agree."""
    new = Crossing(**cross(Point(stored.height, stored.width, stored.robot, physics)))
    compared = ["planned", "motion"] + (["crossed", "simulated_clearance"] if physics else [])
    return new, all(getattr(new, name) == getattr(stored, name) for name in compared)
