"""How robust a planned motion is: many simulations with disturbances drawn at random, with and without stabilizer.

Each draw is carried out twice, so that the two are compared under the same disturbances. A draw depends on its seed
and its number alone: a longer study contains the shorter one. The stored table, figures/robustness.csv, is made by
`make studies`, others by `python -m stepover study`; studies.py says how it is interrupted and continued.
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
from stepover.simulation.run import simulate
from stepover.studies.agreement import CLOSE, NO, agreement
from stepover.studies.draws import RANGES, Draw, draw
from stepover.studies.parallel import Row, computed
from stepover.studies.study import make_table, read_rows, robot_of, rounded, stored_table

NAME = "robustness"
HEIGHT, WIDTH = 0.15, 0.05
"""Of the paper's obstacle, which the stored table is about [m]."""
RUNS, SEED, ACTUATORS, SOLE = 200, 0, "limited", "compliant"
"""Of the stored table."""


@dataclass(frozen=True)
class Point:
    """One simulation of the study: a draw, how the robot was equipped, and the hash of the motion."""

    disturbed: Draw
    stabilizer: bool
    actuators: str
    sole: str
    robot: str
    motion: str


@dataclass(frozen=True)
class Outcome(Draw):
    """What became of one simulation; a row of the table, after the values of its draw.

    Attributes:
        stabilizer, actuators, sole: how the robot was equipped.
        success: crossed to the end of the motion, upright, without touching the obstacle.
        failure_time: of the fall, or of the first contact with the obstacle [s]; None where there is neither.
        clearance: smallest distance from the obstacle where it really stood, until a fall [m].
        clearance_link: which link came so near.
        reason: what went wrong, in words.
        robot, version, motion: what was carried out, by its hash.
        state: hash of all states: two equal ones are the same simulation, to the bit.
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


def points(
    motion: Motion,
    runs: int = RUNS,
    seed: int = SEED,
    actuators: str = ACTUATORS,
    sole: str = SOLE,
    robot: str | None = None,
) -> list[Point]:
    """Simulations of a study: each draw without and with the stabilizer."""
    drawn, carried, robot = [draw(motion, seed, k) for k in range(runs)], motion.hash(), robot or motion.robot_name
    return [Point(one, stabilizer, actuators, sole, robot, carried) for one in drawn for stabilizer in (False, True)]


@dataclass(frozen=True)
class Trial:
    """Carries a motion out at a point, and gives the row: the work of run_study, which a process can be handed."""

    motion: Motion

    def __call__(self, point: Point) -> Row:
        """Simulate."""
        drawn = point.disturbed
        run = simulate(
            self.motion, actuators=point.actuators, sole=point.sole, stabilizer=point.stabilizer,
            perturb=drawn.perturb, robot=robot_of(point.robot),
        )  # fmt: skip
        touched = np.flatnonzero(np.isfinite(run.series.obstacle_depth))[: run.obstacle_contacts][:1]
        times = [*run.series.time[touched].tolist(), *([run.fall_time] if run.fall_time is not None else [])]
        return dataclasses.asdict(drawn) | {
            "stabilizer": point.stabilizer, "actuators": point.actuators, "sole": point.sole,
            "success": run.crossed, "failure_time": rounded(min(times)) if times else None,
            "clearance": rounded(run.clearance_min, 6), "clearance_link": run.clearance_link,
            "reason": run.explanation, "robot": point.robot, "version": __version__, "motion": point.motion,
            "state": run.state_hash,
        }  # fmt: skip


def study(
    motion: Motion | None = None, runs: int = RUNS, seed: int = SEED, *, actuators: str = ACTUATORS, sole: str = SOLE,
    robot: str | None = None, table: Path | None = None, build: Path | None = None, workers: int | None = None,
) -> Path:  # fmt: skip
    """Run or resume a study, and write its table: that of the repository unless told otherwise.

    Args:
        motion: carried out; that of the paper's obstacle unless given.
        runs: draws; each is simulated twice.
        seed: of the draws.
        actuators: as for simulate.
        sole: as for simulate.
        robot: its name, or the path of its robot.toml; the motion's unless given.
        table: where it goes; figures/ unless given.
        build: folder of the part file; build/ unless given.
        workers: processes; one a core unless given.

    Raises:
        InvalidInput: the motion is for a robot that is not known here, or not for that robot.
    """
    motion = motion or plan(robot_of(robot or "hrp2"), Obstacle(HEIGHT, WIDTH))
    robot = robot or motion.robot_name
    if list(motion.joint_names) != robot_of(robot).body.joint_names:
        raise InvalidInput(f"the motion's joints are not those of {robot!r}")
    work, name = points(motion, runs, seed, actuators, sole, robot), table.stem if table else NAME
    more = RANGES, motion.hash(), seed, actuators, sole
    return make_table(name, work, Trial(motion), Outcome, table, build, workers, more)


def read_table(path: Path | None = None) -> list[Outcome]:
    """Rows of a table, of the stored one unless another is given.

    Raises:
        InvalidInput: there is no such table, or it is not one of this study.
    """
    return read_rows(Outcome, path or stored_table(NAME))


def require_current(rows: Sequence[Outcome], motion: Motion) -> None:
    """Refuse a table that was made from another motion, or drawn from other ranges.

    Raises:
        InvalidInput: which of the two; what makes a new one.
    """
    advice = "'python -m stepover study' makes a new one, 'make studies' that of the repository"
    if not rows or {row.motion for row in rows} != {motion.hash()}:
        raise InvalidInput(f"the table is of another motion, not of {motion.hash()[:12]}...; {advice}")
    names = [field.name for field in dataclasses.fields(Draw)]
    for row in rows:
        if Draw(*(getattr(row, name) for name in names)) != draw(motion, row.seed, row.draw):
            raise InvalidInput(f"draw {row.draw} of the table comes from other ranges than today's; {advice}")


def again(stored: Sequence[Outcome], motion: Motion, workers: int | None = None) -> list[tuple[Outcome, str]]:
    """Simulate rows of a table anew: the new rows, and how they agree with the old ones.

    Args:
        stored: rows of the table.
        motion: what was carried out.
        workers: processes; one a core unless given.
    """
    of = [
        Point(draw(motion, row.seed, row.draw), row.stabilizer, row.actuators, row.sole, motion.robot, motion.hash())
        for row in stored
    ]
    found = {point: Outcome(**row) for point, row in computed(of, Trial(motion), workers)}
    new = [found[point] for point in of]
    return [(now, _agreement(now, then)) for now, then in zip(new, stored, strict=True)]


def _agreement(now: Outcome, then: Outcome) -> str:
    """In everything, or else in motion, outcome and the clearance where it crossed."""
    if (now.motion, now.success) != (then.motion, then.success):
        return NO
    same = replace(now, version=then.version) == then
    return agreement(same, now.clearance * now.success, then.clearance * then.success, room=CLOSE)
