"""Results of a study of disturbances: success rates with Wilson intervals, and the disturbances that matter."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import binomtest, ks_2samp, spearmanr

from stepover.studies.robustness import Outcome

CONFIDENCE = 0.95
"""Confidence level of the intervals."""
EQUIPPED = {False: "without stabilizer", True: "with stabilizer"}
"""The robot's equipment, in the order of tables and figures."""


def _steps(row: Outcome) -> np.ndarray:
    """Height (K,) of each foothold above the one before it, or above the start for the first one [mm]."""
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
    "obstacle off its place [mm]": lambda row: 1e3 * abs(row.obstacle_x),
    "push [N]": lambda row: float(np.hypot(row.push_x, row.push_y)),
    "push ahead [N]": lambda row: row.push_x,
    "push to the left [N]": lambda row: row.push_y,
    "time of the push [s]": lambda row: row.push_time,
    "latency, beside one period [ms]": lambda row: 1e3 * row.latency,
}
"""Each disturbance as one number of a draw, or as two if both its size and its direction may matter."""


@dataclass(frozen=True)
class Rate:
    """A number of successes out of a number of simulations."""

    good: int
    of: int

    @property
    def share(self) -> float:
        """Share of successes, 0 to 1."""
        return self.good / self.of

    @property
    def interval(self) -> tuple[float, float]:
        """Wilson interval of the true success rate."""
        ends = binomtest(self.good, self.of).proportion_ci(CONFIDENCE, method="wilson")
        return float(ends.low), float(ends.high)

    def __str__(self) -> str:
        """The rate and its interval as text."""
        low, high = self.interval
        return f"{self.good} of {self.of}, {1e2 * self.share:.1f} % ({1e2 * low:.1f} to {1e2 * high:.1f} %)"


@dataclass(frozen=True)
class Influence:
    """How much the distribution of a disturbance differs between failures and successes.

    Attributes:
        measure: name of the disturbance in MEASURES.
        failed, succeeded: its medians.
        distance: Kolmogorov-Smirnov distance between the two distributions, 0 to 1.
        p: probability of at least this distance if the disturbance had no influence.
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
    """The success rate of some simulations."""
    return Rate(sum(row.success for row in rows), len(rows))


def binned(rows: Sequence[Outcome], measure: str, edges: np.ndarray) -> list[tuple[float, Rate]]:
    """Success rates in the bins between edges (n,) of a disturbance: its mean and the rate in each non-empty bin."""
    values = np.array([MEASURES[measure](row) for row in rows])
    bins = np.clip(np.searchsorted(edges, values, side="right"), 1, len(edges) - 1)
    return [
        (float(values[bins == k].mean()), rate([row for row, at in zip(rows, bins, strict=True) if at == k]))
        for k in np.unique(bins)
    ]


def influences(rows: Sequence[Outcome]) -> list[Influence]:
    """All disturbances, the most important first; empty if all simulations ended alike."""
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


def nearness(rows: Sequence[Outcome]) -> list[tuple[str, float, float]]:
    """Spearman's correlation of the clearance with each disturbance over the successful draws, and its p.

    The strongest correlation comes first. The result is empty if fewer than three draws crossed.
    """
    crossed = [row for row in rows if row.success]
    if len(crossed) < 3:
        return []
    clearance, found = [row.clearance for row in crossed], []
    for name, of in MEASURES.items():
        values = [of(row) for row in crossed]
        test = spearmanr(values, clearance)
        found.append((name, float(test.statistic), float(test.pvalue)))
    return sorted(found, key=lambda one: one[2])


def study_to_json(rows: Sequence[Outcome]) -> dict[str, Any]:
    """The values that `study --json` prints."""
    first, result = rows[0], {}
    for stabilizer, name in ((False, "without_stabilizer"), (True, "with_stabilizer")):
        some = equipped(rows, stabilizer)
        found = rate(some)
        result[name] = {"crossed": found.good, "runs": found.of, "share": found.share, "wilson": list(found.interval),
                        "clearance_min": min(row.clearance for row in some)}  # fmt: skip
    return {
        "robot": first.robot, "motion": first.motion, "actuators": first.actuators, "sole": first.sole,
        "engine": first.engine, "seed": first.seed, "runs": result["with_stabilizer"]["runs"], **result,
    }  # fmt: skip


def study_summary(rows: Sequence[Outcome]) -> list[tuple[str, str]]:
    """The summary that `study` prints, as names and values."""
    first = rows[0]
    return [
        ("set-up", f"{first.actuators} actuators, {first.sole} soles, engine {first.engine}"),
        ("motion", f"{first.motion[:12]}, seed {first.seed}"),
        *((name, f"crossed {rate(equipped(rows, stabilizer))}") for stabilizer, name in EQUIPPED.items()),
    ]
