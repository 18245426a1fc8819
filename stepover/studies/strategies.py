"""Study of both strategies over obstacles of increasing height, planned and simulated. Sec. I, II-A.

`make studies` writes the stored table, figures/strategies.csv: dynamic crossings, quasi-static crossings at the default
epsilon, and at 15 cm also at other values. The hash of each motion shows whether today's planner still plans the same.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stepover import __version__
from stepover.analysis.strategies import strategy
from stepover.errors import Infeasible
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.planning.algorithm_1.planner import plan_in_detail
from stepover.planning.measures import measure
from stepover.planning.quasi_static.planner import quasi_static_in_detail
from stepover.simulation.run import simulate
from stepover.studies.agreement import CLOSE, NO, agreement
from stepover.studies.study import ENGINE, Row, make_table, read_rows, robot_of, rounded, stored_table

NAME = "strategies"
HEIGHTS = tuple(round(0.05 + 0.01 * k, 2) for k in range(23))
WIDTH, HEIGHT, EPSILON = 0.05, 0.15, 0.001
"""Size of the paper's obstacle, and default epsilon of quasi_static_plan [m]."""
EPSILONS = (0.0005, 0.002, 0.005, 0.01, 0.02)
"""Other values of epsilon for the paper's obstacle [m]."""
QUICK = 0.02
"""Epsilon with which the crossing takes 10 s instead of 44 s, short enough to repeat the simulation [m]."""


@dataclass(frozen=True)
class Point:
    """One crossing of the study.

    Attributes:
        height, width: size of the bare obstacle [m].
        epsilon: epsilon of the quasi-static strategy [m]; None for the dynamic strategy.
        robot: name of the robot.
        physics: whether planned motions are simulated.
    """

    height: float
    width: float = WIDTH
    epsilon: float | None = None
    robot: str = "hrp2"
    physics: bool = True


@dataclass(frozen=True)
class Crossed:
    """The result of one crossing: a row of the table. Missing values are None.

    Attributes:
        robot, version: robot, and version of stepover.
        height, width, epsilon: as in Point [m].
        margin_height, margin_width: requested margins [m].
        planned: whether there is a plan.
        margin: margin that the plan keeps [m].
        x_ads, z_hds: key configuration [m].
        duration, over, double_support: whole motion, lift-off of leg 1 to touch-down of leg 2, phase 2 [s].
        apart: largest distance of the ZMP from the CoM's projection, from lift-off to touch-down [m].
        planned_clearance: smallest distance from the bare obstacle [m].
        not_with_margins: why the plan does not keep the requested margins; empty if it does.
        motion: hash of the motion.
        crossed: whether the simulated robot crossed.
        simulated_clearance: smallest distance in the physics [m].
        zmp_rms: simulated ZMP against its plan [m].
        waist_error: largest distance of the waist from its planned place [m].
        knee_torque: largest torque of a knee in the physics, a mean over 5 ms [N m].
        engine: of the physics.
        reason: why there is no plan, or why the robot did not cross.
    """

    robot: str
    version: str
    height: float
    width: float
    epsilon: float | None
    margin_height: float
    margin_width: float
    planned: bool
    margin: float | None = None
    x_ads: float | None = None
    z_hds: float | None = None
    duration: float | None = None
    over: float | None = None
    double_support: float | None = None
    apart: float | None = None
    planned_clearance: float | None = None
    not_with_margins: str = ""
    motion: str | None = None
    crossed: bool | None = None
    simulated_clearance: float | None = None
    zmp_rms: float | None = None
    waist_error: float | None = None
    knee_torque: float | None = None
    engine: str = ENGINE
    reason: str = ""


def points() -> list[Point]:
    """Points of the stored table. The longest motions come first, so that all cores finish at about the same time."""
    by_epsilon = [Point(HEIGHT, epsilon=epsilon) for epsilon in EPSILONS]
    return by_epsilon + [Point(height, epsilon=epsilon) for epsilon in (EPSILON, None) for height in HEIGHTS]


def cross(point: Point) -> Row:
    """Plan one crossing and, if there is a plan, simulate it: a row for run_study."""
    robot, obstacle = robot_of(point.robot), Obstacle(point.height, point.width)
    row = Crossed(robot.name, __version__, point.height, point.width, point.epsilon, obstacle.margin_height,
                  obstacle.margin_width, planned=True)  # fmt: skip
    try:
        motion, refused = _plan(robot, obstacle, point.epsilon)
    except Infeasible as error:
        return dataclasses.asdict(dataclasses.replace(row, planned=False, reason=error.constraint))
    found, key = strategy(robot, motion), motion.key_configuration
    assert key is not None, "both planners have one"
    row = dataclasses.replace(
        row, margin=rounded(motion.obstacle[3:5].min()), x_ads=rounded(key[0]),
        z_hds=rounded(key[2]), duration=rounded(found.whole, 3), over=rounded(found.over, 3),
        double_support=rounded(found.double_support, 3), apart=rounded(found.apart, 6),
        planned_clearance=rounded(measure(robot, motion).clearance_min), not_with_margins=refused,
        motion=motion.hash(),
    )  # fmt: skip
    if point.physics:
        run = simulate(motion, robot=robot, engine=ENGINE)
        knees = run.series.torque[:, [robot.body.column(knee) - 7 for knee in robot.legs.knee]]
        row = dataclasses.replace(
            row, crossed=run.crossed, simulated_clearance=rounded(run.clearance_min),
            zmp_rms=rounded(float(np.linalg.norm(run.zmp_rms))), waist_error=rounded(run.waist_error_max),
            knee_torque=rounded(np.abs(knees).max(), 2), reason=run.explanation,
        )  # fmt: skip
    return dataclasses.asdict(row)


def study(path: Path | None = None, build: Path | None = None, workers: int | None = None) -> Path:
    """Run or resume the study and write its table; see make_table."""
    return make_table(NAME, points(), cross, Crossed, path, build, workers)


def read_table(path: Path | None = None) -> list[Crossed]:
    """Rows of a table; default: the stored table."""
    return read_rows(Crossed, path or stored_table(NAME))


def again(rows: Sequence[Crossed], point: Point) -> tuple[Crossed, str]:
    """Plan and simulate a crossing anew. Returns the row and how it agrees with the stored one."""
    new = Crossed(**cross(point))
    for row in rows:
        if (row.robot, row.height, row.width, row.epsilon) == (new.robot, new.height, new.width, new.epsilon):
            if new.motion != row.motion or (point.physics and new.crossed != row.crossed):
                return new, NO
            now, then = new.simulated_clearance, row.simulated_clearance
            return new, agreement(not point.physics or now == then, now, then, room=CLOSE)
    return new, "not in the table"


def over(rows: Sequence[Crossed], height: float, width: float) -> list[Crossed]:
    """The crossings of an obstacle: quasi-static by epsilon, then dynamic."""
    found = [row for row in rows if (row.height, row.width) == (height, width)]
    return sorted(found, key=lambda row: row.epsilon or np.inf)


def speed_ups(rows: Sequence[Crossed]) -> dict[float, float]:
    """Duration of each quasi-static crossing of an obstacle over that of the dynamic one, by epsilon [m].

    The duration is from the lift-off of leg 1 to the landing of leg 2. The rows are those of `over`.
    """
    dynamic = [row.over for row in rows if row.epsilon is None and row.over]
    return {row.epsilon: row.over / dynamic[0] for row in rows if row.epsilon and row.over and dynamic}


def by_height(rows: Sequence[Crossed], epsilon: float | None) -> list[Crossed]:
    """The quasi-static crossings at an epsilon [m], or the dynamic ones, by the obstacle's height."""
    return sorted((row for row in rows if row.epsilon == epsilon), key=lambda row: row.height)


def _plan(robot: Robot, obstacle: Obstacle, epsilon: float | None) -> tuple[Motion, str]:
    """The motion of one strategy, and why it does not keep the margins."""
    if epsilon is None:
        return plan_in_detail(robot, obstacle, look_for_nearest=False).motion, ""
    found = quasi_static_in_detail(robot, obstacle, epsilon, look_for_nearest=False)
    return found.motion, found.refused or ""
