"""The tables of the trials: each disturbance with both soles, with and without stabilizer; and heights with servos."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from stepover.report.tables.table import Table, table
from stepover.simulation.measurements import Run
from stepover.studies.agreement import CLOSE, NO, agreement
from stepover.studies.trials import HEIGHT, UNDISTURBED, Outcome, Trial, carry_out

CONFIGURATIONS = {
    f"{name}, {'with' if stabilizer else 'without'} stabilizer": (sole, stabilizer)
    for sole, name in (("rigid", "rigid soles"), ("compliant", "rubber")) for stabilizer in (False, True)
}  # fmt: skip
"""Sole and stabilizer, by the name of the configuration."""
WORST = ("clearance", "waist_error", "torque_ratio")


def disturbed(rows: Sequence[Outcome]) -> list[Outcome]:
    """The rows for the paper's obstacle, with one disturbance each."""
    return [row for row in rows if row.height == HEIGHT and row.speed_limits == "ignore"]


def disturbed_table(rows: Sequence[Outcome]) -> Table:
    """Effect of each disturbance, by sole and stabilizer: the clearance, or how the robot failed."""
    found = {(row.name, row.sole, row.stabilizer): row for row in disturbed(rows)}
    names = list(dict.fromkeys(name for name, _, _ in found))
    lines = [(name, *(_ended(found[name, *how]) for how in CONFIGURATIONS.values())) for name in names]
    return table(f"disturbance | {' | '.join(CONFIGURATIONS)}", lines)


def survivors_table(rows: Sequence[Outcome]) -> Table:
    """Number of disturbances that each configuration survives, and its worst values."""
    lines = []
    for name, (sole, stabilizer) in CONFIGURATIONS.items():
        some = [row for row in disturbed(rows) if (row.sole, row.stabilizer) == (sole, stabilizer)]
        good = [row for row in some if row.crossed]
        near, far, torque = (np.array([getattr(row, value) for row in good]) for value in WORST)
        worst = (1e3 * near.min(), 1e3 * far.max(), torque.max()) if good else ("-",) * 3
        lines.append((name, f"{len(good)} of {len(some)}", *worst))
    return table(
        "robot | crosses | of these: nearest to the obstacle [mm] | waist from its plan, at most [mm] | "
        "torque over its limit, at most",
        lines,
    )


def runs_table(runs: Mapping[str, Run]) -> Table:
    """Simulations side by side."""
    lines = [
        (
            name, "crosses" if run.crossed else run.explanation.split(";")[0], *(1e3 * x for x in run.zmp_rms),
            1e3 * run.waist_error_max, 1e3 * run.clearance_min, run.torque_ratio_max, run.speed_ratio_max,
            f"{run.landing_force_peak['first']:.0f}",
        )
        for name, run in runs.items()
    ]  # fmt: skip
    return table(
        "robot | outcome | ZMP from its plan, rms, x [mm] | y [mm] | waist, at most [mm] | "
        "nearest to the obstacle [mm] | torque over its limit | speed over its limit | leg 1 lands with [N]",
        lines,
    )


def heights_table(rows: Sequence[Outcome], speed_limits: str, stabilizer: bool = True) -> Table:
    """Heights with servos: the outcome, and the joint that first reaches a limit."""
    lines = [
        (
            f"{1e2 * row.height:.0f}", "rigid" if row.sole == "rigid" else "rubber", _ended(row),
            _joint(row.torque_ratio, row.torque_joint, row.torque_time),
            _joint(row.speed_ratio, row.speed_joint, row.speed_time),
        )
        for row in by_height(rows, speed_limits, stabilizer)
    ]  # fmt: skip
    return table("height [cm] | soles | outcome | torque over its limit | speed over its limit", lines)


def by_height(rows: Sequence[Outcome], speed_limits: str, stabilizer: bool = True) -> list[Outcome]:
    """Undisturbed rows, by sole and height."""
    some = [
        row for row in rows
        if (row.name, row.speed_limits, row.stabilizer) == (UNDISTURBED, speed_limits, stabilizer)
    ]  # fmt: skip
    return sorted(some, key=lambda row: (row.sole != "rigid", row.height))


def highest(rows: Sequence[Outcome], sole: str, speed_limits: str) -> float:
    """The height up to which every undisturbed crossing succeeds [m]; 0 if the lowest one fails."""
    line = [row for row in by_height(rows, speed_limits) if row.sole == sole]
    reached = 0.0
    for row in line:
        if not row.crossed:
            break
        reached = row.height
    return reached


def first_at_speed_limit(rows: Sequence[Outcome], height: float, sole: str) -> str:
    """The joint that first reaches its speed limit at a height [m], or "none". The plan ignores the limits."""
    row = next(row for row in by_height(rows, "ignore") if (row.height, row.sole) == (height, sole))
    return "none" if row.speed_time is None else str(row.speed_joint)


def agreement_table(rows: Sequence[Outcome], trials: Sequence[Trial]) -> Table:
    """Trials simulated anew, and whether they agree with the stored ones."""
    lines = []
    for trial in trials:
        new = Outcome(**carry_out(trial))
        old = next((row for row in rows if _key(row) == _key(new)), None)
        agrees = "not in the table" if old is None else _agreement(new, old)
        lines.append((trial.name, _ended(new), (new.state or "")[:12], agrees))
    return table("trial | now | hash of all states, now | agrees with the table", lines)


def _agreement(new: Outcome, old: Outcome) -> str:
    """Agreement of two rows: by the states, or else by motion, outcome and clearance."""
    if (new.motion, new.crossed) != (old.motion, old.crossed):
        return NO
    return agreement(new.state == old.state, new.clearance, old.clearance, room=CLOSE)


def _key(row: Outcome) -> tuple[object, ...]:
    """The values that identify a row."""
    return row.name, row.height, row.width, row.sole, row.stabilizer, row.speed_limits


def _ended(row: Outcome) -> str:
    """How a trial ended, in a few words."""
    if row.motion is None:
        return "no plan"
    if row.crossed:
        return f"{1e3 * (row.clearance or 0.0):.0f} mm"
    what = "touches" if row.reason.startswith("hit") else "falls"
    return f"{what} at {row.reason.split('t = ')[1].split(' s')[0]} s"


def _joint(ratio: float | None, joint: str | None, when: float | None) -> str:
    """A ratio, its joint, and when the limit was first reached."""
    if ratio is None:
        return "-"
    return f"{ratio:.2f}, {joint}" + ("" if when is None else f" from {when:.2f} s")
