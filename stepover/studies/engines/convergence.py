"""Study of the engines' settings: what changes with the time step, the solver's rounds and the contacts' softness.

A setting is fine enough where a finer one changes nothing that is judged. `make studies` writes the stored table,
figures/convergence.csv. The defaults in model/parameters/physics.py rest on it.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from stepover import __version__
from stepover.model.obstacle import Obstacle
from stepover.planning.algorithm_1.planner import plan
from stepover.simulation.run import simulate
from stepover.studies.study import Row, make_table, read_rows, robot_of, rounded, stored_table

NAME = "convergence"
HEIGHT, WIDTH = 0.15, 0.05
"""Size of the paper's obstacle [m]."""
IDEAL, SERVOS = "ideal", "servos"
"""The robot's equipment: ideal motors, or limited servos on rubber with the stabilizer."""
SETTINGS: Mapping[str, tuple[tuple[str, tuple[float, ...]], ...]] = {
    "pybullet": (("solver_iterations", (50, 100, 200, 400)), ("time_step", (0.001, 0.0005))),
    "mujoco": (
        ("time_step", (0.001, 0.0005, 0.00025)),
        ("contact_time", (0.002, 0.004, 0.008, 0.02)),
        ("friction_stiffness", (1.0, 10.0, 100.0)),
    ),
}
"""Of each engine, the settings that are varied, one at a time, by their names in robot.simulation."""


@dataclass(frozen=True)
class Point:
    """One simulation.

    Attributes:
        engine: of the physics.
        setting, value: what is not at its default.
        equipment: IDEAL or SERVOS.
        robot: name of the robot.
    """

    engine: str
    setting: str
    value: float
    equipment: str
    robot: str = "hrp2"


@dataclass(frozen=True)
class Outcome:
    """The result of one simulation: a row of the table.

    Attributes:
        robot, version: robot, and version of stepover.
        engine, setting, value, equipment: as in Point.
        crossed: whether the simulated robot crossed.
        clearance: smallest distance from the obstacle [m].
        zmp_rms_x, zmp_rms_y: deviation of the ZMP from its plan, rms [m].
        waist_error: largest distance of the waist from its planned place [m].
        landing_first, landing_second: landing forces of both legs [N].
        motion, state: hashes of the motion and of all states.
    """

    robot: str
    version: str
    engine: str
    setting: str
    value: float
    equipment: str
    crossed: bool
    clearance: float
    zmp_rms_x: float
    zmp_rms_y: float
    waist_error: float
    landing_first: float
    landing_second: float
    motion: str
    state: str


def points() -> list[Point]:
    """Points of the stored table."""
    return [
        Point(engine, setting, value, equipment)
        for engine, settings in SETTINGS.items()
        for setting, values in settings
        for value in values
        for equipment in (IDEAL, SERVOS)
    ]


def carry_out(point: Point) -> Row:
    """Plan and simulate one point: a row for run_study."""
    known = robot_of(point.robot)
    kind = type(getattr(known.simulation, point.setting))
    changed: dict[str, Any] = {point.setting: kind(point.value)}
    robot = dataclasses.replace(known, simulation=dataclasses.replace(known.simulation, **changed))
    motion = plan(known, Obstacle(HEIGHT, WIDTH))
    soft = point.equipment == SERVOS
    run = simulate(
        motion, robot=robot, engine=point.engine, actuators="limited" if soft else "ideal",
        sole="compliant" if soft else "rigid", stabilizer=soft,
    )  # fmt: skip
    return dataclasses.asdict(Outcome(
        known.name, __version__, point.engine, point.setting, point.value, point.equipment, run.crossed,
        rounded(run.clearance_min), rounded(run.zmp_rms[0]), rounded(run.zmp_rms[1]), rounded(run.waist_error_max),
        rounded(run.landing_force_peak["first"], 1), rounded(run.landing_force_peak["second"], 1),
        motion.hash(), run.state_hash,
    ))  # fmt: skip


def study(path: Path | None = None, build: Path | None = None, workers: int | None = None) -> Path:
    """Run or resume the study and write its table; see make_table."""
    return make_table(NAME, points(), carry_out, Outcome, path, build, workers)


def read_table(path: Path | None = None) -> list[Outcome]:
    """Rows of a table; default: the stored table."""
    return read_rows(Outcome, path or stored_table(NAME))


def varied(rows: Sequence[Outcome], engine: str, setting: str, equipment: str) -> list[Outcome]:
    """The rows of one engine, setting and equipment, in the order of the values."""
    some = [row for row in rows if (row.engine, row.setting, row.equipment) == (engine, setting, equipment)]
    return sorted(some, key=lambda row: row.value)
