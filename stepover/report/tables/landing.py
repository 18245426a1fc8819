"""The tables of the notebook on the landing: what the force depends on, the closest fit, and the claims. Sec. III-B.

The verdicts do not use the fit. They compare both swings in equal time, with servos, stabilizer and rubber as
published.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from stepover.analysis.landing.force import Landing
from stepover.analysis.landing.settings import BASES, FITTED, VARIATIONS
from stepover.analysis.landing.swings import NAIVE, NEAR_FLOOR, SHAPED, Curves, Profile
from stepover.model.gravity import GRAVITY
from stepover.model.robot import Robot
from stepover.report.tables.table import Table, table
from stepover.studies.landing import LONG, SHORT, Landed, Point, agreement_of, at

PAPER_NAIVE, PAPER_SHAPED = 1200.0, 625.0
"""The paper's landing forces of both swings [N]."""


def profiles_table(profiles: Mapping[str, Profile]) -> Table:
    """Apex and speeds of some swings."""
    return table(
        f"swing of leg 1 | highest [mm] | fastest descent [m/s] | descent at {1e3 * NEAR_FLOOR:.0f} mm [m/s]",
        [
            (name, f"{1e3 * one.height.max():.0f}", f"{-one.speed.min():.3f}", f"{one.speed_near_floor():.3f}")
            for name, one in profiles.items()
        ],
    )


def agreement(rows: Sequence[Landed], anew: Mapping[Point, Landing]) -> Table:
    """Landings that were simulated anew, and whether they agree with the stored table."""
    return table(
        "case | swing | touch-down [N] | peak [N] | agrees with the table",
        [
            (point.variation, f"{point.profile}, {point.swing_time:g} s", _force(one.touch_down), _force(one.peak),
             agreement_of(rows, point, one))
            for point, one in anew.items()
        ],
    )  # fmt: skip


def pair(rows: Sequence[Landed], variation: str, naive_time: float = LONG, value: str = "peak") -> tuple[float, float]:
    """Forces of the naive swing with a swing time and of the shaped swing with its own [N]; NaN for a missing force."""
    both = (at(rows, Point(variation, NAIVE, naive_time)), at(rows, Point(variation, SHAPED, LONG)))
    naive, shaped = (np.nan if row.fell else float(getattr(row, value) or np.nan) for row in both)
    return naive, shaped


def equal_times(rows: Sequence[Landed]) -> Table:
    """Both swings with the same swing time, in both base cases: touch-down and peak."""
    lines = []
    for variation in BASES:
        for time in (LONG, SHORT):
            naive, shaped = (at(rows, Point(variation, profile, time)) for profile in (NAIVE, SHAPED))
            cells = [variation, f"{time:g}"]
            for value in ("touch_down", "peak"):
                forces = [float(getattr(row, value) or np.nan) for row in (naive, shaped)]
                cells += [*map(_force, forces), f"{forces[1] / forces[0]:.2f}"]
            lines.append(tuple(cells))
    header = "case | both in [s] | touch-down, naive [N] | shaped [N] | ratio | peak, naive [N] | shaped [N] | ratio"
    return table(header, lines)


def spread(rows: Sequence[Landed]) -> Table:
    """Ratio of the shaped to the naive peak over all variations of a kind of sole: least, median and largest."""
    lines = []
    for sole in ("compliant", "rigid"):
        kind = [name for name, setting in VARIATIONS.items() if setting.sole == sole and setting.limited]
        for time in (LONG, SHORT):
            pairs = np.array([pair(rows, name, time) for name in kind])
            ratios = pairs[:, 1] / pairs[:, 0]
            ratios = ratios[np.isfinite(ratios)]
            values = (f"{value:.2f}" for value in (ratios.min(), np.median(ratios), ratios.max()))
            lines.append((sole, f"{time:g}", len(ratios), *values))
    return table("soles | naive swing in [s] | variations | least ratio | median | largest", lines)


def nearest_pairs(rows: Sequence[Landed], count: int = 5) -> Table:
    """The variations whose peaks are nearest to the paper's pair of forces. This is a fit: the pair is known.

    Variations with another time step are left out. So are those with a landing control, which the paper does not have.
    """
    found = []
    for variation, setting in VARIATIONS.items():
        if setting.control or setting.time_step != 1.0:
            continue
        for time in (LONG, SHORT):
            naive, shaped = pair(rows, variation, time)
            off = max(abs(naive / PAPER_NAIVE - 1.0), abs(shaped / PAPER_SHAPED - 1.0))
            if np.isfinite(off):
                assumed = setting.assumptions + (time != LONG)
                found.append((off, (variation, f"{time:g}", assumed, _force(naive), _force(shaped),
                                    f"{shaped / naive:.2f}", f"{1e2 * off:.0f} %")))  # fmt: skip
    found.sort(key=lambda line: line[0])
    return table("variation | naive swing in [s] | assumptions | naive [N] | shaped, 1.5 s [N] | ratio | "
                 "largest deviation from the paper", [line for _, line in found[:count]])  # fmt: skip


def controlled(rows: Sequence[Landed]) -> Table:
    """Touch-down and peak without and with a control that stops the descent at contact."""
    cases = ((BASES[0], "rubber, landing control"), (FITTED, "the same, landing control"),
             (BASES[1], "rigid, landing control"))  # fmt: skip
    lines = []
    for without, control in cases:
        for profile, time in ((SHAPED, LONG), (NAIVE, LONG), (NAIVE, SHORT)):
            plain, stopped = (at(rows, Point(name, profile, time)) for name in (without, control))
            change = [f"{_force(getattr(plain, value))} to {_force(getattr(stopped, value))}"
                      for value in ("touch_down", "peak")]  # fmt: skip
            lines.append((without, f"{profile}, {time:g} s", *change))
    return table("case | swing | touch-down [N] | peak [N]", lines)


def measured(
    robot: Robot,
    rows: Sequence[Landed],
    anew: Mapping[str, Mapping[Point, Landing]],
    profiles: Sequence[Profile],
    curves: Curves,
) -> list[tuple[str, float | dict[str, float], str]]:
    """The claims of II-C and III-B: id, measured value, in each engine for a force, and what the value depends on.

    Args:
        robot: gives the weight.
        rows: rows of the stored table; they show what a value depends on.
        anew: landings simulated anew, by engine. They include both swings with the same swing time on the published
            rubber.
        profiles: shaped and naive swing with the same swing time.
        curves: curves through the control points of leg 1.
    """
    weight = robot.body.mass * GRAVITY
    naive, shaped = ({engine: _peak(some, profile) for engine, some in anew.items()} for profile in (NAIVE, SHAPED))
    ratio, own = {engine: shaped[engine] / naive[engine] for engine in anew}, next(iter(shaped.values()))
    down = [f"{profile.speed_near_floor():.2f}" for profile in profiles]
    fitted = pair(rows, FITTED, SHORT)
    early, rigid = pair(rows, BASES[0], value="touch_down"), pair(rows, BASES[1])
    over = [1e3 * curves.overshoot(curve) for curve in (curves.polynomial, curves.spline)]
    same = f"in equal time both swings descend alike, {down[0]} and {down[1]} m/s at {1e3 * NEAR_FLOOR:.0f} mm"
    return [
        ("impact-naive", naive, f"{same}; a swing in {SHORT:g} s and a fitted rubber give {_force(fitted[0])} N"),
        ("impact-shaped", shaped, f"the body sways onto lightly damped rubber, {own / weight:.2f} times its weight "
                                  f"with either swing; touch-down alone {_force(early[1])} N; fitted rubber "
                                  f"{_force(fitted[1])} N"),
        ("impact-ratio", ratio, f"touch-down alone {early[1] / early[0]:.2f}; rigid soles "
                                         f"{rigid[1] / rigid[0]:.2f}, fitted rubber and a faster naive swing "
                                         f"{fitted[1] / fitted[0]:.2f}"),
        ("spline-vs-polynomial", over[0] / over[1], f"furthest outside the range of the same control points: "
                                                    f"{over[0]:.2g} mm against {over[1]:.1f} mm"),
    ]  # fmt: skip


def _peak(landings: Mapping[Point, Landing], profile: str) -> float:
    """Peak of a swing in the long time on the published rubber [N]."""
    return next(
        one.peak for point, one in landings.items()
        if (point.variation, point.profile, point.swing_time) == (BASES[0], profile, LONG)
    )  # fmt: skip


def _force(force: float | None) -> str:
    """A force for a table [N]; a dash if the robot fell or the foot did not meet the floor in the window."""
    return "-" if force is None or np.isnan(force) else f"{force:.0f}"
