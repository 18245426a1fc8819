"""What a study of disturbances comes to: success rates with their Wilson intervals, and which disturbance matters."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import binomtest, ks_2samp, spearmanr

from stepover.studies.robustness import Outcome

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
    "obstacle off its place [mm]": lambda row: 1e3 * abs(row.obstacle_x),
    "push [N]": lambda row: float(np.hypot(row.push_x, row.push_y)),
    "push ahead [N]": lambda row: row.push_x,
    "push to the left [N]": lambda row: row.push_y,
    "time of the push [s]": lambda row: row.push_time,
    "latency, beside one period [ms]": lambda row: 1e3 * row.latency,
}
"""Each disturbance as a number of a draw, or as two where both its size and its direction may matter."""


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


def nearness(rows: Sequence[Outcome]) -> list[tuple[str, float, float]]:
    """How the clearance of the draws that crossed goes with each disturbance: Spearman's correlation and its p.

    The disturbance that goes with it most comes first; none where fewer than three crossed.
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
