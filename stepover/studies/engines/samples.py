"""Study of how far the two engines agree: a named sample of every other study, in both.

The long studies run in one engine. Here some of their points run in each. `make studies` writes the stored table,
figures/engines.csv.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from stepover import __version__
from stepover.model.obstacle import Obstacle
from stepover.planning.algorithm_1.planner import plan
from stepover.simulation.run import simulate
from stepover.studies import obstacle_plane as plane
from stepover.studies.draws import draw
from stepover.studies.study import Row, make_table, read_rows, robot_of, rounded, stored_table
from stepover.studies.trials import DISTURBED, UNDISTURBED

NAME = "engines"
BOTH = ("pybullet", "mujoco")
"""The engines that are compared."""
IDEAL: Mapping[str, Any] = {}
RIGID: Mapping[str, Any] = {"actuators": "limited", "stabilizer": True}
RUBBER: Mapping[str, Any] = {**RIGID, "sole": "compliant"}
"""Ideal motors; servos and stabilizer, on rigid soles or on rubber."""
SOLES = {"rigid": RIGID, "rubber": RUBBER}
HEIGHTS = (0.15, 0.20, 0.25)
"""Heights with servos [m]."""
DRAWS = 4
"""The first draws of the study of robustness, each with the stabilizer."""
TRIALS = ("friction 0.4", "foothold of leg 2 -10 mm", "push +100 N in y, phase 3", "slope +1.5 degrees to the left")
"""Single disturbances, on rubber."""


@dataclass(frozen=True)
class Case:
    """What is simulated in both engines.

    Attributes:
        study: the study that it is a sample of.
        name: of the case.
        height, width: size of the obstacle [m].
        how: options of simulate.
        number: of the draw, where it is one.
    """

    study: str
    name: str
    height: float = 0.15
    width: float = 0.05
    how: Mapping[str, Any] = field(default_factory=dict)
    number: int | None = None


def cases() -> list[Case]:
    """All cases, by study."""
    crossings = (*plane.SAMPLE, *plane.CORNERS)
    return [
        *(Case(plane.NAME, f"{1e2 * h:g} x {1e2 * w:g} cm", h, w) for h, w in ((0.15, 0.05), *crossings)),
        *(
            Case("trials", f"{1e2 * h:g} cm, servos, {sole}", h, how=how)
            for sole, how in SOLES.items() for h in HEIGHTS
        ),
        *(Case("trials", name, how={**RUBBER, "perturb": dict(DISTURBED[name])}) for name in TRIALS),
        Case("trials", f"{UNDISTURBED}, rubber, no stabilizer", how={**RUBBER, "stabilizer": False}),
        *(Case("robustness", f"draw {k}", how=RUBBER, number=k) for k in range(DRAWS)),
    ]  # fmt: skip


@dataclass(frozen=True)
class Point:
    """One simulation: a case by its study and name, in one engine."""

    study: str
    name: str
    engine: str
    robot: str = "hrp2"


@dataclass(frozen=True)
class Outcome:
    """The result of one simulation: a row of the table.

    Attributes:
        robot, version: robot, and version of stepover.
        study, name, engine: as in Point.
        crossed: whether the simulated robot crossed.
        clearance: smallest distance from the obstacle at its true place, until a fall [m].
        zmp_rms_x, zmp_rms_y: deviation of the ZMP from its plan, rms [m].
        waist_error: largest distance of the waist from its planned place [m].
        reason: why it did not cross.
        motion, state: hashes of the motion and of all states.
    """

    robot: str
    version: str
    study: str
    name: str
    engine: str
    crossed: bool
    clearance: float
    zmp_rms_x: float
    zmp_rms_y: float
    waist_error: float
    reason: str
    motion: str
    state: str


def carry_out(point: Point) -> Row:
    """Plan and simulate one point: a row for run_study."""
    case = next(case for case in cases() if (case.study, case.name) == (point.study, point.name))
    robot = robot_of(point.robot)
    motion, how = plan(robot, Obstacle(case.height, case.width)), dict(case.how)
    if case.number is not None:
        how["perturb"] = draw(motion, 0, case.number).perturb
    run = simulate(motion, robot=robot, engine=point.engine, **how)
    return dataclasses.asdict(Outcome(
        robot.name, __version__, point.study, point.name, point.engine, run.crossed, rounded(run.clearance_min),
        rounded(run.zmp_rms[0]), rounded(run.zmp_rms[1]), rounded(run.waist_error_max), run.explanation,
        motion.hash(), run.state_hash,
    ))  # fmt: skip


def study(path: Path | None = None, build: Path | None = None, workers: int | None = None) -> Path:
    """Run or resume the study and write its table; see make_table."""
    points = [Point(case.study, case.name, engine) for case in cases() for engine in BOTH]
    return make_table(NAME, points, carry_out, Outcome, path, build, workers)


def read_table(path: Path | None = None) -> list[Outcome]:
    """Rows of a table; default: the stored table."""
    return read_rows(Outcome, path or stored_table(NAME))


def pairs(rows: Sequence[Outcome]) -> list[tuple[Outcome, Outcome]]:
    """The rows of each case, in the order of BOTH."""
    found = {(row.study, row.name, row.engine): row for row in rows}
    first, second = BOTH
    return [(found[study, name, first], found[study, name, second]) for study, name, engine in found if engine == first]


def agree(pair: tuple[Outcome, Outcome]) -> bool:
    """Whether the robot crosses in both engines, or in neither."""
    return pair[0].crossed == pair[1].crossed
