"""Study of how much of each disturbance the stabilized robot bears: one at a time, from nothing to far too much.

The robot has servos and rubber under the feet. From the outcomes over the size of a disturbance follow the sizes at
which 95 % and 50 % of the draws cross. `make studies` writes the stored table, figures/breaking_points.csv.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import minimize

from stepover import __version__
from stepover.model.obstacle import Obstacle
from stepover.motion.motion import Motion
from stepover.planning.algorithm_1.planner import plan
from stepover.simulation.run import simulate
from stepover.studies.study import ENGINE, Row, make_table, read_rows, robot_of, rounded, stored_table

NAME = "breaking_points"
HEIGHT, WIDTH = 0.15, 0.05
"""Size of the paper's obstacle [m]."""
DRAWS = 20
"""Draws of each disturbance, their sizes evenly spaced."""
SEED = 0
Perturb = dict[str, float]


@dataclass(frozen=True)
class Kind:
    """A disturbance of growing size.

    Attributes:
        begin, end: sizes between which it is drawn; at the first one it hardly disturbs.
        unit: of the size.
        of: the disturbance as simulate takes it, from its size, a random generator and the motion.
    """

    begin: float
    end: float
    unit: str
    of: Callable[[float, np.random.Generator, Motion], Perturb]


def _push(size: float, random: np.random.Generator, motion: Motion) -> Perturb:
    """In any horizontal direction, at any time from which the motion still goes on for a second."""
    direction, when = random.uniform(0.0, 2.0 * np.pi), random.uniform(motion.time[0], motion.time[-1] - 1.0)
    return {"push_x": size * np.cos(direction), "push_y": size * np.sin(direction), "push_time": when}


def _slope(size: float, random: np.random.Generator, motion: Motion) -> Perturb:
    """Up in any direction."""
    direction = random.uniform(0.0, 2.0 * np.pi)
    return {"slope_ahead": size * np.cos(direction), "slope_left": size * np.sin(direction)}


def _ground(size: float, random: np.random.Generator, motion: Motion) -> Perturb:
    """Each foothold up or down by the size."""
    signs = random.choice([-1.0, 1.0], len(motion.footsteps))
    return {f"ground_{k}": 1e-3 * size * sign for k, sign in enumerate(signs, 1)}


def _either_way(name: str, scale: float) -> Callable[[float, np.random.Generator, Motion], Perturb]:
    """A value with any sign."""
    return lambda size, random, motion: {name: scale * size * random.choice([-1.0, 1.0])}


KINDS: Mapping[str, Kind] = {
    "push": Kind(0.0, 400.0, "N", _push),
    "slope": Kind(0.0, 6.0, "degrees", _slope),
    "footholds up or down": Kind(0.0, 30.0, "mm", _ground),
    "friction": Kind(0.6, 0.05, "", lambda size, random, motion: {"friction": size}),
    "mass at the chest": Kind(0.0, 50.0, "%", lambda size, random, motion: {"chest_mass": 1e-2 * size}),
    "chest's CoM ahead or behind": Kind(0.0, 90.0, "mm", _either_way("chest_com_x", 1e-3)),
    "obstacle nearer or farther": Kind(0.0, 60.0, "mm", _either_way("obstacle_x", 1e-3)),
    "latency": Kind(0.0, 40.0, "ms", lambda size, random, motion: {"latency": 1e-3 * size}),
}
"""All disturbances by name."""


@dataclass(frozen=True)
class Point:
    """One simulation: a disturbance, and the number of the draw."""

    kind: str
    draw: int
    robot: str = "hrp2"
    engine: str = ENGINE

    @property
    def size(self) -> float:
        """Of the disturbance, in its unit."""
        kind = KINDS[self.kind]
        return rounded(kind.begin + (kind.end - kind.begin) * (self.draw + 0.5) / DRAWS, 6)

    def perturb(self, motion: Motion) -> Perturb:
        """The disturbance as simulate takes it."""
        random = np.random.default_rng([SEED, list(KINDS).index(self.kind), self.draw])
        return {name: rounded(value, 6) for name, value in KINDS[self.kind].of(self.size, random, motion).items()}


@dataclass(frozen=True)
class Outcome:
    """The result of one simulation: a row of the table.

    Attributes:
        robot, version, engine: robot, version of stepover, and engine of the physics.
        kind, draw, size: as in Point.
        perturb: the disturbance as JSON.
        crossed: whether the simulated robot crossed.
        clearance: smallest distance from the obstacle at its true place, until a fall [m].
        reason: why it did not cross.
        motion, state: hashes of the motion and of all states.
    """

    robot: str
    version: str
    engine: str
    kind: str
    draw: int
    size: float
    perturb: str
    crossed: bool
    clearance: float
    reason: str
    motion: str
    state: str


def carry_out(point: Point) -> Row:
    """Plan and simulate one point: a row for run_study."""
    robot = robot_of(point.robot)
    motion = plan(robot, Obstacle(HEIGHT, WIDTH))
    perturb = point.perturb(motion)
    run = simulate(
        motion, actuators="limited", sole="compliant", stabilizer=True, perturb=perturb, robot=robot,
        engine=point.engine,
    )  # fmt: skip
    return dataclasses.asdict(Outcome(
        robot.name, __version__, point.engine, point.kind, point.draw, point.size, json.dumps(perturb), run.crossed,
        rounded(run.clearance_min), run.explanation, motion.hash(), run.state_hash,
    ))  # fmt: skip


def study(path: Path | None = None, build: Path | None = None, workers: int | None = None) -> Path:
    """Run or resume the study and write its table; see make_table."""
    points = [Point(kind, draw) for kind in KINDS for draw in range(DRAWS)]
    return make_table(NAME, points, carry_out, Outcome, path, build, workers, (DRAWS, SEED))


def read_table(path: Path | None = None) -> list[Outcome]:
    """Rows of a table; default: the stored table."""
    return read_rows(Outcome, path or stored_table(NAME))


def success_over_size(rows: Sequence[Outcome]) -> tuple[float, float]:
    """Middle and width of the logistic curve that fits the outcomes of one disturbance best, in its unit.

    The share of successes at a size x is 1 / (1 + exp((x - middle) / width)). Widths below half the spacing of the
    sizes cannot be told apart. A middle beyond the largest size says that too few draws fail.
    """
    size, crossed = np.array([row.size for row in rows]), np.array([row.crossed for row in rows])
    begin, end = size.min(), size.max()
    towards = 1.0 if KINDS[rows[0].kind].end > KINDS[rows[0].kind].begin else -1.0
    least = 0.5 * (end - begin) / (len(rows) - 1)

    def unlikely(values: np.ndarray) -> float:
        exponent = towards * (size - values[0]) / (least + np.exp(values[1]))
        return float(np.logaddexp(0.0, np.where(crossed, exponent, -exponent)).sum())

    span = end - begin
    starts = [(begin + share * span, np.log(span / 20.0)) for share in np.linspace(0.0, 1.5, 16)]
    best = min((minimize(unlikely, start, method="Nelder-Mead") for start in starts), key=lambda one: one.fun)
    return float(best.x[0]), towards * float(least + np.exp(best.x[1]))


def borne(rows: Sequence[Outcome], share: float) -> float:
    """Size of one disturbance at which a share of the draws crosses; NaN if it is beyond the sizes that were tried."""
    if all(row.crossed for row in rows):
        return float("nan")
    middle, width = success_over_size(rows)
    size = middle + width * np.log(1.0 / share - 1.0)
    kind = KINDS[rows[0].kind]
    return float(size) if min(kind.begin, kind.end) <= size <= max(kind.begin, kind.end) else float("nan")
