"""What a study of disturbances comes to: success rates with their Wilson intervals, and which disturbance matters."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import binomtest, ks_2samp

from stepover.report.robustness import Outcome
from stepover.report.tables import Table, table

CONFIDENCE = 0.95
"""Of the intervals."""
EQUIPPED = {False: "without stabilizer", True: "with stabilizer"}
"""How the robot was equipped, in the order of tables and figures."""


def _steps(row: Outcome) -> np.ndarray:
    """How much higher (K,) each foothold is than the one before it, the first one than the start [mm]."""
    return 1e3 * np.diff([0.0, *row.heights])


MEASURES: Mapping[str, Callable[[Outcome], float]] = {
    "highest step up [mm]": lambda row: float(_steps(row).max(initial=0.0)),
    "deepest step down [mm]": lambda row: float(-_steps(row).min(initial=0.0)),
    "slope ahead [deg]": lambda row: row.slope_ahead,
    "slope to the left [deg]": lambda row: row.slope_left,
    "friction": lambda row: row.friction,
    "mass on the chest [%]": lambda row: 1e2 * row.chest_mass,
    "chest's CoM ahead [mm]": lambda row: 1e3 * row.chest_com_x,
    "obstacle further ahead [mm]": lambda row: 1e3 * row.obstacle_x,
    "push [N]": lambda row: float(np.hypot(row.push_x, row.push_y)),
    "push ahead [N]": lambda row: row.push_x,
    "push to the left [N]": lambda row: row.push_y,
    "time of the push [s]": lambda row: row.push_time,
    "latency, beside one period [ms]": lambda row: 1e3 * row.latency,
}
"""Each disturbance as one number of a draw."""


@dataclass(frozen=True)
class Rate:
    """So many successes of so many simulations."""

    good: int
    of: int

    @property
    def share(self) -> float:
        """Of the successes, 0 to 1."""
        return self.good / self.of

    @property
    def interval(self) -> tuple[float, float]:
        """Wilson's interval of the share that would come out in the long run."""
        ends = binomtest(self.good, self.of).proportion_ci(CONFIDENCE, method="wilson")
        return float(ends.low), float(ends.high)

    def __str__(self) -> str:
        """For people."""
        low, high = self.interval
        return f"{self.good} of {self.of}, {1e2 * self.share:.1f} % ({1e2 * low:.1f} to {1e2 * high:.1f} %)"


@dataclass(frozen=True)
class Influence:
    """How differently a disturbance is distributed where the robot failed and where it did not.

    Attributes:
        measure: which disturbance, of MEASURES.
        failed, succeeded: its medians.
        distance: of Kolmogorov and Smirnov, between the two distributions, 0 to 1.
        p: how likely so large a distance is, were the disturbance of no influence.
    """

    measure: str
    failed: float
    succeeded: float
    distance: float
    p: float


def equipped(rows: Sequence[Outcome], stabilizer: bool) -> list[Outcome]:
    """The simulations with the stabilizer, or without it."""
    return [row for row in rows if row.stabilizer is stabilizer]


def rate(rows: Sequence[Outcome]) -> Rate:
    """How often it worked."""
    return Rate(sum(row.success for row in rows), len(rows))


def binned(rows: Sequence[Outcome], measure: str, edges: np.ndarray) -> list[tuple[float, Rate]]:
    """Success rates between edges (n,) of a disturbance: its mean and the rate in each bin that is not empty."""
    values = np.array([MEASURES[measure](row) for row in rows])
    bins = np.clip(np.searchsorted(edges, values, side="right"), 1, len(edges) - 1)
    return [
        (float(values[bins == k].mean()), rate([row for row, at in zip(rows, bins, strict=True) if at == k]))
        for k in np.unique(bins)
    ]


def influences(rows: Sequence[Outcome]) -> list[Influence]:
    """All disturbances, the one that matters most first; none where every simulation ended alike."""
    good = np.array([row.success for row in rows], dtype=bool)
    if good.all() or not good.any():
        return []
    found = []
    for name, of in MEASURES.items():
        values = np.array([of(row) for row in rows])
        test = ks_2samp(values[~good], values[good])
        medians = float(np.median(values[~good])), float(np.median(values[good]))
        found.append(Influence(name, *medians, float(test.statistic), float(test.pvalue)))
    return sorted(found, key=lambda one: one.p)


def rates_table(rows: Sequence[Outcome]) -> Table:
    """Success rates, and what went wrong, with and without the stabilizer."""
    lines = []
    for stabilizer, name in EQUIPPED.items():
        some = equipped(rows, stabilizer)
        crossed, failures = rate(some), [row for row in some if not row.success]
        low, high = crossed.interval
        touched = sum(row.reason.startswith("hit") for row in failures)
        lines.append((name, f"{crossed.good} of {crossed.of}", f"{1e2 * crossed.share:.1f}",
                      f"{1e2 * low:.1f} to {1e2 * high:.1f}", touched, len(failures) - touched,
                      f"{1e3 * min(row.clearance for row in some):.1f}"))  # fmt: skip
    return table(
        "robot | crossed | % | Wilson interval, 95 % | touched the obstacle | fell | nearest to the obstacle [mm]",
        lines,
    )


def influence_table(rows: Sequence[Outcome], stabilizer: bool) -> Table:
    """The disturbances, the one that matters most first."""
    return table(
        "disturbance | median where it failed | where it crossed | distance of the distributions | p",
        [(one.measure, one.failed, one.succeeded, f"{one.distance:.2f}", f"{one.p:.1g}")
         for one in influences(equipped(rows, stabilizer))],
    )  # fmt: skip


def failures_table(rows: Sequence[Outcome]) -> Table:
    """What went wrong, a failure a row."""
    failed = [
        (row.draw, EQUIPPED[row.stabilizer], f"{row.failure_time:.3f}", row.reason) for row in rows if not row.success
    ]
    return table("draw | robot | failed at [s] | reason", failed)


def agreement_table(compared: Sequence[tuple[Outcome, bool]]) -> Table:
    """Rows made anew, and whether they agree with the stored ones."""
    lines = [
        (row.draw, EQUIPPED[row.stabilizer], "crossed" if row.success else f"failed at {row.failure_time:.3f} s",
         1e3 * row.clearance, row.state[:12], "yes" if agrees else "no")
        for row, agrees in compared
    ]  # fmt: skip
    return table("draw | robot | now | clearance [mm] | hash of all states, now | agrees with the table", lines)


def study_to_json(rows: Sequence[Outcome]) -> dict[str, Any]:
    """What `study --json` prints."""
    first, result = rows[0], {}
    for stabilizer, name in ((False, "without_stabilizer"), (True, "with_stabilizer")):
        some = equipped(rows, stabilizer)
        found = rate(some)
        result[name] = {"crossed": found.good, "runs": found.of, "share": found.share, "wilson": list(found.interval),
                        "clearance_min": min(row.clearance for row in some)}  # fmt: skip
    return {
        "robot": first.robot, "motion": first.motion, "actuators": first.actuators, "sole": first.sole,
        "seed": first.seed, "runs": result["with_stabilizer"]["runs"], **result,
    }  # fmt: skip


def study_summary(rows: Sequence[Outcome]) -> list[tuple[str, str]]:
    """What `study` prints for people, as names and values."""
    first = rows[0]
    return [
        ("set-up", f"{first.actuators} actuators, {first.sole} soles"),
        ("motion", f"{first.motion[:12]}, seed {first.seed}"),
        *((name, f"crossed {rate(equipped(rows, stabilizer))}") for stabilizer, name in EQUIPPED.items()),
    ]
