"""Trials outside the ideal simulation: one disturbance at a time, and increasing heights with limited servos.

Sec. V: the experiments had servos, rubber under the feet and a stabilizer, and reached 15 cm. `make studies` writes the
stored table, figures/trials.csv. The hash of each motion shows whether today's planner still plans the same motion.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np

from stepover import __version__
from stepover.errors import Infeasible
from stepover.model.obstacle import Obstacle
from stepover.planning.algorithm_1.planner import plan_in_detail
from stepover.simulation.engine import DEFAULT
from stepover.simulation.measurements import Run
from stepover.simulation.run import simulate
from stepover.studies.study import ENGINE, Row, make_table, read_rows, robot_of, rounded, stored_table

NAME = "trials"
HEIGHT, WIDTH = 0.15, 0.05
"""Size of the paper's obstacle [m]."""
HEIGHTS = tuple(round(0.15 + 0.01 * k, 2) for k in range(11))
"""Heights of the obstacles in the search for the limit of the servos [m]."""
UNDISTURBED = "as planned"
PUSHES = {"normal walking": 2.0, "phase 3": 6.0}
"""Start times of the pushes [s]."""
DISTURBED: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        UNDISTURBED: {},
        **{
            f"foothold of leg {leg} {1e3 * h:+.0f} mm": {f"ground_leg_{leg}": h}
            for leg in (1, 2) for h in (0.01, -0.01)
        },
        **{f"first foothold {1e3 * h:+.0f} mm": {"ground_1": h} for h in (0.01, -0.01)},
        **{f"slope {s:+g} degrees ahead": {"slope_ahead": s} for s in (1.5, -1.5)},
        **{f"slope {s:+g} degrees to the left": {"slope_left": s} for s in (1.5, -1.5)},
        "friction 0.4": {"friction": 0.4},
        **{f"{1e2 * m:+.0f} % mass at the chest": {"chest_mass": m} for m in (0.05, -0.05)},
        **{f"chest's CoM {1e3 * x:+.0f} mm ahead": {"chest_com_x": x} for x in (0.01, -0.01)},
        **{
            f"push {f:+.0f} N in {axis}, {name}": {f"push_{axis}": f, "push_time": when}
            for name, when in PUSHES.items() for axis in "xy" for f in (100.0, -100.0)
        },
        **{f"obstacle {1e3 * x:+.0f} mm ahead": {"obstacle_x": x} for x in (0.02, -0.02)},
        "obstacle 20 mm higher": {"obstacle_height": 0.02},
        "5 ms more latency": {"latency": 0.005},
    }
)  # fmt: skip
"""The disturbances of the trials, by name."""


@dataclass(frozen=True)
class Trial:
    """One simulation with servos of limited torque and speed.

    Attributes:
        name: name of the disturbance, a key of DISTURBED.
        height, width: size of the bare obstacle in the plan [m].
        sole, stabilizer: as for simulate.
        speed_limits: as for plan.
        robot: name of the robot.
        engine: of the physics.
    """

    name: str
    height: float = HEIGHT
    width: float = WIDTH
    sole: str = "compliant"
    stabilizer: bool = True
    speed_limits: str = "ignore"
    robot: str = "hrp2"
    engine: str = ENGINE

    @property
    def perturb(self) -> dict[str, float]:
        """The disturbances as simulate takes them."""
        return dict(DISTURBED[self.name])


@dataclass(frozen=True)
class Outcome:
    """The result of one trial: a row of the table. Missing values are None.

    Attributes:
        robot, version: robot, and version of stepover.
        name, height, width, sole, stabilizer, speed_limits: as in Trial.
        perturb: disturbances as JSON.
        motion: hash of the motion; None without a plan.
        crossed: whether the simulated robot crossed.
        clearance: smallest distance from the obstacle at its true place [m].
        zmp_rms_x, zmp_rms_y: deviation of the ZMP from its plan, rms [m].
        waist_error: largest distance of the waist from its planned place [m].
        torque_ratio, torque_joint, torque_time: largest torque (mean over 5 ms) over its limit, and its joint. If a
            torque reaches its limit to 1 %: the joint that does so first, and when [s].
        speed_ratio, speed_joint, speed_time: the same for the speeds.
        reason: why there is no plan, or why the robot did not cross.
        state: hash of all recorded states.
        engine: of the physics.
    """

    robot: str
    version: str
    name: str
    height: float
    width: float
    sole: str
    stabilizer: bool
    speed_limits: str
    perturb: str
    motion: str | None = None
    crossed: bool | None = None
    clearance: float | None = None
    zmp_rms_x: float | None = None
    zmp_rms_y: float | None = None
    waist_error: float | None = None
    torque_ratio: float | None = None
    torque_joint: str | None = None
    torque_time: float | None = None
    speed_ratio: float | None = None
    speed_joint: str | None = None
    speed_time: float | None = None
    reason: str = ""
    state: str | None = None
    engine: str = DEFAULT


def trials() -> list[Trial]:
    """Trials of the stored table."""
    disturbed = [
        Trial(name, sole=sole, stabilizer=stabilizer)
        for sole in ("rigid", "compliant") for stabilizer in (True, False) for name in DISTURBED
    ]  # fmt: skip
    higher = [
        Trial(UNDISTURBED, height, sole=sole, speed_limits=speed_limits)
        for height in HEIGHTS for speed_limits in ("ignore", "respect") for sole in ("rigid", "compliant")
    ]  # fmt: skip
    return disturbed + [trial for trial in higher if trial not in disturbed]


def carry_out(trial: Trial) -> Row:
    """Plan and simulate one trial: a row for run_study."""
    robot = robot_of(trial.robot)
    row = Outcome(
        robot.name, __version__, trial.name, trial.height, trial.width, trial.sole, trial.stabilizer,
        trial.speed_limits, json.dumps(trial.perturb), engine=trial.engine,
    )  # fmt: skip
    obstacle = Obstacle(trial.height, trial.width)
    try:
        found = plan_in_detail(robot, obstacle, speed_limits=trial.speed_limits, look_for_nearest=False)
    except Infeasible as error:
        return dataclasses.asdict(dataclasses.replace(row, reason=error.constraint))
    run = simulate(
        found.motion, actuators="limited", sole=trial.sole, stabilizer=trial.stabilizer, perturb=trial.perturb,
        robot=robot, engine=trial.engine,
    )  # fmt: skip
    return dataclasses.asdict(judged(row, run))


def judged(row: Outcome, run: Run) -> Outcome:
    """A row with the results of a run."""
    body, series = robot_of(row.robot).body, run.series
    end = len(series.time) if run.fall_time is None else int(np.searchsorted(series.time, run.fall_time)) + 1
    torque = _first(np.abs(series.torque[:end]) / body.effort_limits, series.time, body.joint_names)
    speed = _first(np.abs(series.dq[:end]) / body.speed_limits, series.time, body.joint_names)
    return dataclasses.replace(
        row, motion=run.motion.hash(), crossed=run.crossed, clearance=rounded(run.clearance_min),
        zmp_rms_x=rounded(run.zmp_rms[0]), zmp_rms_y=rounded(run.zmp_rms[1]), waist_error=rounded(run.waist_error_max),
        torque_ratio=torque[0], torque_joint=torque[1], torque_time=torque[2], speed_ratio=speed[0],
        speed_joint=speed[1], speed_time=speed[2], reason=run.explanation, state=run.state_hash,
    )  # fmt: skip


def _first(ratios: np.ndarray, time: np.ndarray, names: list[str]) -> tuple[float, str, float | None]:
    """Largest ratio (M, joints), and its joint. If a limit is reached: the joint that does so first, and when."""
    sample, joint = np.unravel_index(ratios.argmax(), ratios.shape)
    at_limit = np.argwhere(ratios >= 0.99)
    if len(at_limit):
        sample, joint = at_limit[0]
    when = round(float(time[sample]), 3) if len(at_limit) else None
    return rounded(ratios.max(), 3), names[joint], when


def study(path: Path | None = None, build: Path | None = None, workers: int | None = None) -> Path:
    """Run or resume the study and write its table; see make_table."""
    return make_table(NAME, trials(), carry_out, Outcome, path, build, workers)


def read_table(path: Path | None = None) -> list[Outcome]:
    """Rows of a table; default: the stored table."""
    return read_rows(Outcome, path or stored_table(NAME))
