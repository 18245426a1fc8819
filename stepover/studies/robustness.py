"""Study of robustness: many simulations of a motion with random disturbances, with and without the stabilizer.

Each draw is simulated twice, so that both cases have the same disturbances. A draw depends only on its seed and number,
so a longer study contains the shorter one. `make studies` writes the stored table, figures/robustness.csv; `python -m
stepover study` writes others. study.py explains how a study is interrupted and continued.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from stepover import __version__
from stepover.errors import InvalidInput
from stepover.model.obstacle import Obstacle
from stepover.motion.motion import Motion
from stepover.planning.algorithm_1.planner import plan
from stepover.simulation.engine import DEFAULT
from stepover.simulation.run import simulate
from stepover.studies.agreement import CLOSE, NO, agreement
from stepover.studies.draws import RANGES, Draw, draw
from stepover.studies.parallel import Row, computed
from stepover.studies.study import ENGINE, make_table, read_rows, robot_of, rounded, stored_table

NAME = "robustness"
HEIGHT, WIDTH = 0.15, 0.05
"""Height and width of the paper's obstacle, used for the stored table [m]."""
RUNS, SEED, ACTUATORS, SOLE = 200, 0, "limited", "compliant"
"""Draws, seed, actuators and sole of the stored table."""


@dataclass(frozen=True)
class Point:
    """One simulation of the study: a draw, the robot's equipment, and the hash of the motion."""

    disturbed: Draw
    stabilizer: bool
    actuators: str
    sole: str
    robot: str
    motion: str
    engine: str


@dataclass(frozen=True)
class Outcome(Draw):
    """The result of one simulation: a row of the table, after the values of its draw.

    Attributes:
        stabilizer, actuators, sole: the robot's equipment.
        success: whether the robot finished the motion upright, without touching the obstacle.
        failure_time: time of the fall or of the first contact with the obstacle [s]; None without a failure.
        clearance: smallest distance from the obstacle at its true place, until a fall [m].
        clearance_link: the nearest link.
        reason: the failure in words.
        robot, version, motion: robot, version of stepover, and hash of the motion.
        state: hash of all states. Equal hashes mean the same simulation, to the bit.
        engine: of the physics.
    """

    stabilizer: bool
    actuators: str
    sole: str
    success: bool
    failure_time: float | None
    clearance: float
    clearance_link: str
    reason: str
    robot: str
    version: str
    motion: str
    state: str
    engine: str = DEFAULT


def points(
    motion: Motion,
    runs: int = RUNS,
    seed: int = SEED,
    actuators: str = ACTUATORS,
    sole: str = SOLE,
    robot: str | None = None,
    engine: str = ENGINE,
) -> list[Point]:
    """Simulations of a study: each draw without and with the stabilizer."""
    drawn, carried, robot = [draw(motion, seed, k) for k in range(runs)], motion.hash(), robot or motion.robot_name
    return [
        Point(one, stabilizer, actuators, sole, robot, carried, engine) for one in drawn for stabilizer in (False, True)
    ]


@dataclass(frozen=True)
class Trial:
    """The work of run_study: simulates a motion at a point and returns the row. It is picklable."""

    motion: Motion

    def __call__(self, point: Point) -> Row:
        """Simulate."""
        drawn = point.disturbed
        run = simulate(
            self.motion, actuators=point.actuators, sole=point.sole, stabilizer=point.stabilizer,
            perturb=drawn.perturb, robot=robot_of(point.robot), engine=point.engine,
        )  # fmt: skip
        touched = np.flatnonzero(np.isfinite(run.series.obstacle_depth))[: run.obstacle_contacts][:1]
        times = [*run.series.time[touched].tolist(), *([run.fall_time] if run.fall_time is not None else [])]
        return dataclasses.asdict(drawn) | {
            "stabilizer": point.stabilizer, "actuators": point.actuators, "sole": point.sole,
            "success": run.crossed, "failure_time": rounded(min(times)) if times else None,
            "clearance": rounded(run.clearance_min, 6), "clearance_link": run.clearance_link,
            "reason": run.explanation, "robot": point.robot, "version": __version__, "motion": point.motion,
            "state": run.state_hash, "engine": point.engine,
        }  # fmt: skip


def study(
    motion: Motion | None = None, runs: int = RUNS, seed: int = SEED, *, actuators: str = ACTUATORS, sole: str = SOLE,
    engine: str = ENGINE, robot: str | None = None, table: Path | None = None, build: Path | None = None,
    workers: int | None = None,
) -> Path:  # fmt: skip
    """Run or resume a study and write its table; default: the stored table of the repository.

    Args:
        motion: the motion; default: the plan for the paper's obstacle.
        runs: number of draws. Each is simulated twice.
        seed: seed of the draws.
        actuators: as for simulate.
        sole: as for simulate.
        engine: of the physics.
        robot: name of the robot, or the path of its robot.toml; default: the one named in the motion.
        table: path of the table; default: in figures/.
        build: folder of the part file; default: build/.
        workers: number of processes; default: one for each core.

    Raises:
        InvalidInput: the motion's robot is unknown, or the motion is for another robot.
    """
    motion = motion or plan(robot_of(robot or "hrp2"), Obstacle(HEIGHT, WIDTH))
    robot = robot or motion.robot_name
    if list(motion.joint_names) != robot_of(robot).body.joint_names:
        raise InvalidInput(f"the motion's joints are not those of {robot!r}")
    work, name = points(motion, runs, seed, actuators, sole, robot, engine), table.stem if table else NAME
    more = RANGES, motion.hash(), seed, actuators, sole, engine
    return make_table(name, work, Trial(motion), Outcome, table, build, workers, more)


def read_table(path: Path | None = None) -> list[Outcome]:
    """Rows of a table; default: the stored table.

    Raises:
        InvalidInput: there is no such table, or it belongs to another study.
    """
    return read_rows(Outcome, path or stored_table(NAME))


def require_current(rows: Sequence[Outcome], motion: Motion) -> None:
    """Reject a table that was made from another motion or from other ranges.

    Raises:
        InvalidInput: the table differs. The message names the difference and the command that writes a new table.
    """
    advice = "'python -m stepover study' makes a new one, 'make studies' that of the repository"
    if not rows or {row.motion for row in rows} != {motion.hash()}:
        raise InvalidInput(f"the table is of another motion, not of {motion.hash()[:12]}...; {advice}")
    names = [field.name for field in dataclasses.fields(Draw)]
    for row in rows:
        if Draw(*(getattr(row, name) for name in names)) != draw(motion, row.seed, row.draw):
            raise InvalidInput(f"draw {row.draw} of the table comes from other ranges than today's; {advice}")


def again(stored: Sequence[Outcome], motion: Motion, workers: int | None = None) -> list[tuple[Outcome, str]]:
    """Simulate rows of a table anew. Returns the new rows and how they agree with the old ones.

    Args:
        stored: rows of the table.
        motion: the motion of the table.
        workers: number of processes; default: one for each core.
    """
    at, carried = [draw(motion, row.seed, row.draw) for row in stored], (motion.robot, motion.hash())
    of = [
        Point(one, row.stabilizer, row.actuators, row.sole, *carried, row.engine)
        for one, row in zip(at, stored, strict=True)
    ]
    found = {point: Outcome(**row) for point, row in computed(of, Trial(motion), workers)}
    new = [found[point] for point in of]
    return [(now, _agreement(now, then)) for now, then in zip(new, stored, strict=True)]


def _agreement(now: Outcome, then: Outcome) -> str:
    """How two rows agree: in all values, or else in motion, outcome and, for a crossing, the clearance."""
    if (now.motion, now.success) != (then.motion, then.success):
        return NO
    same = replace(now, version=then.version) == then
    return agreement(same, now.clearance * now.success, then.clearance * then.success, room=CLOSE)
