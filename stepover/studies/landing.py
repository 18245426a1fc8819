"""Study of the landing force and what it depends on. Sec. III-B.

`make studies` writes the stored table, figures/landing.csv: three swings of leg 1 for each variation of motors, soles,
floor and control, in MuJoCo. The hash of each motion shows whether today's planner still plans the same motion.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from stepover import __version__
from stepover.analysis.landing.force import Landing
from stepover.analysis.landing.settings import BASES, VARIATIONS
from stepover.analysis.landing.swings import NAIVE, SAME_APEX, SHAPED, landing_motion
from stepover.model.obstacle import Obstacle
from stepover.motion.motion import Motion
from stepover.studies.agreement import NO, agreement
from stepover.studies.study import ENGINE, Row, make_table, read_rows, robot_of, rounded, stored_table

NAME = "landing"
HEIGHT, WIDTH = 0.15, 0.05
"""Height and width of the paper's obstacle [m]."""
LONG, SHORT = 1.5, 0.78
"""Swing times of leg 1 and of a normal step (Sec. V) [s]."""
SWINGS = ((SHAPED, LONG), (NAIVE, LONG), (NAIVE, SHORT))
"""Swings for every variation."""
MORE_SWINGS = ((SAME_APEX, LONG), (SHAPED, SHORT))
"""Additional swings for both base cases."""

MEASURED = ("contact", "speed", "touch_down", "peak", "peak_time")
"""Values of a Landing that a row stores."""


@dataclass(frozen=True)
class Point:
    """One landing of the study.

    Attributes:
        variation: one of VARIATIONS.
        profile, swing_time: as in landing_motion.
        robot: name of the robot.
        height, width: size of the obstacle [m]; in the stored table, that of the paper.
        engine: of the physics.
    """

    variation: str
    profile: str
    swing_time: float
    robot: str = "hrp2"
    height: float = HEIGHT
    width: float = WIDTH
    engine: str = ENGINE

    @property
    def motion(self) -> Motion:
        """That is to land."""
        return _motion(self.robot, self.profile, self.swing_time, self.height, self.width)


@dataclass(frozen=True)
class Landed:
    """The result of one landing: a row of the table. Missing values are None.

    Attributes:
        robot, version, variation, profile, swing_time: the simulated case.
        motion: hash of the motion.
        contact: first contact, after the planned touch-down [s].
        speed: descent of the ankle just before [m/s].
        touch_down, peak: forces, means over 5 ms [N]; see analysis.landing.force.Landing.
        peak_time: time of the peak, after the planned touch-down [s].
        fell: why the robot counts as fallen.
        engine: of the physics.
    """

    robot: str
    version: str
    variation: str
    profile: str
    swing_time: float
    motion: str
    contact: float | None = None
    speed: float | None = None
    touch_down: float | None = None
    peak: float | None = None
    peak_time: float | None = None
    fell: str = ""
    engine: str = ENGINE


def points() -> list[Point]:
    """Points of the stored table."""
    every = [Point(name, *swing) for name in VARIATIONS for swing in SWINGS]
    return every + [Point(name, *swing) for name in BASES for swing in MORE_SWINGS]


@lru_cache(maxsize=8)
def _motion(robot: str, profile: str, swing_time: float, height: float, width: float) -> Motion:
    """The motion, computed once in each process."""
    return landing_motion(robot_of(robot), Obstacle(height, width), profile, swing_time)


def landing_of(point: Point) -> Landing:
    """Simulate the landing of a point."""
    return VARIATIONS[point.variation].land(robot_of(point.robot), point.motion, point.engine)


def row_of(point: Point, landing: Landing) -> Landed:
    """The row of a point and its landing."""
    made = __version__, point.variation, point.profile, point.swing_time
    row = Landed(point.robot, *made, point.motion.hash(), engine=point.engine)
    values = {name: rounded(getattr(landing, name)) for name in MEASURED}
    known = {name: value for name, value in values.items() if not np.isnan(value)}
    return dataclasses.replace(row, fell=landing.fell, **known)  # type: ignore[arg-type]


def carry_out(point: Point) -> Row:
    """Simulate one landing: a row for run_study."""
    return dataclasses.asdict(row_of(point, landing_of(point)))


def study(path: Path | None = None, build: Path | None = None, workers: int | None = None) -> Path:
    """Run or resume the study and write its table; see make_table."""
    return make_table(NAME, points(), carry_out, Landed, path, build, workers)


def read_table(path: Path | None = None) -> list[Landed]:
    """Rows of a table; default: the stored table."""
    return read_rows(Landed, path or stored_table(NAME))


def at(rows: Sequence[Landed], point: Point) -> Landed:
    """The row of a point.

    Raises:
        KeyError: the table has no such row.
    """
    for row in rows:
        if (row.variation, row.profile, row.swing_time) == (point.variation, point.profile, point.swing_time):
            return row
    raise KeyError(point)


def agreement_of(rows: Sequence[Landed], point: Point, landing: Landing) -> str:
    """How a repeated landing agrees with the stored row: in all values, or else in its peak."""
    new, then = row_of(point, landing), at(rows, point)
    if (new.motion, new.fell) != (then.motion, then.fell):
        return NO
    same = all(getattr(new, name) == getattr(then, name) for name in MEASURED)
    return agreement(same, new.peak, then.peak, share=0.02)
