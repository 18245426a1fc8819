"""Study of how robust the optimiser's motions are, beside one of Algorithm 1: the draws of studies/robustness.py.

The robot has servos, rubber soles and the stabilizer. `make frontier` writes the stored table, figures/disturbed.csv.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from stepover.model.obstacle import Obstacle
from stepover.motion.motion import Motion
from stepover.planning.planner import find_planner
from stepover.studies.draws import RANGES, draw
from stepover.studies.robustness import ACTUATORS, SOLE, Outcome, Trial
from stepover.studies.robustness import Point as Simulated
from stepover.studies.study import ENGINE, Row, make_table, read_rows, robot_of, stored_table

NAME = "disturbed"
CASES = (("paper", 0.25), ("optimal", 0.25), ("optimal", 0.40), ("optimal", 0.45))
"""Planners, and heights of obstacles 5 cm wide [m]."""
WIDTH, RUNS, SEED = 0.05, 100, 0
"""Width of the obstacles [m], number of draws of each case, and their seed."""


@dataclass(frozen=True)
class Point:
    """One simulation: a planner, the obstacle's height [m], and the number of the draw."""

    planner: str
    height: float
    number: int
    robot: str = "hrp2"


@dataclass(frozen=True)
class Disturbed(Outcome):
    """The result of one simulation: a row of the table; `planner` and `height` [m] say which motion."""

    planner: str = ""
    height: float = 0.0


@lru_cache(maxsize=len(CASES))
def motion_of(robot: str, planner: str, height: float) -> Motion:
    """The motion, planned once in each process."""
    return find_planner(planner)(robot_of(robot), Obstacle(height, WIDTH))


def carry_out(point: Point) -> Row:
    """Simulate one draw: a row for run_study."""
    motion = motion_of(point.robot, point.planner, point.height)
    drawn = draw(motion, SEED, point.number)
    row = Trial(motion)(Simulated(drawn, True, ACTUATORS, SOLE, point.robot, motion.hash(), ENGINE))
    return row | {"planner": point.planner, "height": point.height}


def study(path: Path | None = None, build: Path | None = None, workers: int | None = None) -> Path:
    """Run or resume the study and write its table; see make_table."""
    points = [Point(*case, number) for case in CASES for number in range(RUNS)]
    return make_table(NAME, points, carry_out, Disturbed, path, build, workers, (RANGES, SEED))


def read_table(path: Path | None = None) -> list[Disturbed]:
    """Rows of a table; default: the stored table."""
    return read_rows(Disturbed, path or stored_table(NAME))
