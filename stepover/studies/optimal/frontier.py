"""Study of what the optimising planner can cross: chosen obstacles, a plane of them, and random ones between.

Each motion is simulated with ideal motors, and with servos, rubber soles and the stabilizer ("real"). `make frontier`
writes the stored table, figures/frontier.csv.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from stepover import __version__
from stepover.errors import Infeasible
from stepover.model.obstacle import Obstacle
from stepover.planning.measures import measure
from stepover.planning.optimal.planner import optimal_in_detail
from stepover.simulation.run import simulate
from stepover.studies.study import Row, make_table, read_rows, robot_of, rounded, stored_table

NAME = "frontier"
CORNERS = (
    *((round(0.15 + 0.05 * k, 2), 0.05) for k in range(7)),
    (0.22, 0.12), (0.15, 0.25),
)  # fmt: skip
"""Heights and widths that must be crossed in both engines [m]."""
HIGHER = ((0.475, 0.05), (0.50, 0.05))
"""How high it goes [m]."""
HEIGHTS, WIDTHS = tuple(round(0.10 + 0.05 * k, 2) for k in range(8)), (0.10, 0.20, 0.30)
"""A grid, to see how wide it goes at each height [m]."""
RANDOM, SEED = 60, 0
"""Number of random obstacles, and their seed."""
EDGE = ((0.15, 0.25), (0.22, 0.12), (0.45, 0.05))
"""Heights with the greatest widths of random obstacles [m]; straight lines between them."""
NARROWEST = 0.05
"""Least width of random obstacles [m]."""
BOTH, ONE = ("pybullet", "mujoco"), ("mujoco",)
"""The engines for the chosen obstacles, and for all others."""
IDEAL, REAL = "ideal", "real"
EQUIPMENT: dict[str, dict[str, Any]] = {
    IDEAL: {},
    REAL: {"actuators": "limited", "sole": "compliant", "stabilizer": True},
}
"""Options of simulate."""


@dataclass(frozen=True)
class Point:
    """One obstacle: why it is in the table, its size [m], and the engines."""

    group: str
    height: float
    width: float
    engines: tuple[str, ...] = ONE
    robot: str = "hrp2"


@dataclass(frozen=True)
class Found:
    """The result for one obstacle: a row of the table. Missing values are None.

    Attributes:
        robot, version: robot, and version of stepover.
        group, height, width: as in Point.
        planned: whether there is a plan.
        reason: why not.
        clearance: planned distance from the obstacle [m].
        zmp_margin: of the planned ZMP from the support polygon's edge [m].
        speed_ratio, torque_ratio: largest planned joint speed and torque over their limits.
        own_links: least planned distance of the robot's own links [m].
        iterations: of the SQP.
        motion: hash of the motion.
        *_ideal, *_real: by engine and equipment, the smallest clearance [m], negative without a crossing.
        *_saturated: with real motors, how often a servo gives all that it can, in samples of 5 ms, all joints added up.
        samples: of the motion.
        *_speed: with real motors, largest joint speed over its limit.
    """

    robot: str
    version: str
    group: str
    height: float
    width: float
    planned: bool
    reason: str = ""
    clearance: float | None = None
    zmp_margin: float | None = None
    speed_ratio: float | None = None
    torque_ratio: float | None = None
    own_links: float | None = None
    iterations: int | None = None
    motion: str | None = None
    samples: int | None = None
    pybullet_ideal: float | None = None
    pybullet_real: float | None = None
    pybullet_saturated: int | None = None
    pybullet_speed: float | None = None
    mujoco_ideal: float | None = None
    mujoco_real: float | None = None
    mujoco_saturated: int | None = None
    mujoco_speed: float | None = None


def widest(height: float) -> float:
    """Width of the region of random obstacles at a height [m]."""
    heights, widths = zip(*EDGE, strict=True)
    return float(np.interp(height, heights, widths))


def random_obstacles(count: int = RANDOM, seed: int = SEED) -> list[tuple[float, float]]:
    """Heights and widths [m], evenly over the region that the corners span, to the millimetre."""
    random, found = np.random.default_rng(seed), list[tuple[float, float]]()
    while len(found) < count:
        height, width = random.uniform(EDGE[0][0], EDGE[-1][0]), random.uniform(NARROWEST, EDGE[0][1])
        if width <= widest(height):
            found.append((round(height, 3), round(width, 3)))
    return found


def points() -> list[Point]:
    """Points of the stored table."""
    chosen = [Point("corner", *size, BOTH) for size in CORNERS]
    chosen += [Point("higher", *size, BOTH) for size in HIGHER]
    grid = [Point("plane", height, width) for height in HEIGHTS for width in WIDTHS]
    return chosen + grid + [Point("random", *size) for size in random_obstacles()]


def carry_out(point: Point) -> Row:
    """Plan and simulate one point: a row for run_study."""
    robot = robot_of(point.robot)
    row = Found(robot.name, __version__, point.group, point.height, point.width, planned=False)
    try:
        plan = optimal_in_detail(robot, Obstacle(point.height, point.width), look_for_nearest=False)
    except Infeasible as error:
        return dataclasses.asdict(dataclasses.replace(row, reason=error.constraint))
    motion, measured, found = plan.motion, measure(robot, plan.motion), dict[str, Any]()
    for engine in point.engines:
        for name, equipment in EQUIPMENT.items():
            run = simulate(motion, robot=robot, engine=engine, **equipment)
            found[f"{engine}_{name}"] = rounded(run.clearance_min if run.crossed else -1.0)
            if name == REAL:
                found[f"{engine}_saturated"] = sum(run.torque_saturated_samples.values())
                found[f"{engine}_speed"] = rounded(run.speed_ratio_max, 3)
    return dataclasses.asdict(dataclasses.replace(
        row, planned=True, clearance=rounded(measured.clearance_min), zmp_margin=rounded(measured.zmp_margin_min),
        speed_ratio=rounded(measured.joint_speed_ratio_max, 3), torque_ratio=rounded(plan.torque.ratio, 3),
        own_links=rounded(plan.self_clearance), iterations=plan.iterations, motion=motion.hash(),
        samples=len(motion.time), **found,
    ))  # fmt: skip


def study(
    chosen: Sequence[Point] | None = None, path: Path | None = None, build: Path | None = None,
    workers: int | None = None,
) -> Path:  # fmt: skip
    """Run or resume the study, whole or some points, and write its table; see make_table."""
    return make_table(NAME, points() if chosen is None else chosen, carry_out, Found, path, build, workers)


def read_table(path: Path | None = None) -> list[Found]:
    """Rows of a table; default: the stored table."""
    return read_rows(Found, path or stored_table(NAME))
