"""The tables of a study of disturbances: success rates, failures, the disturbances that matter, and repeated runs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stepover.report.tables.table import Table, table
from stepover.studies import breaking_points
from stepover.studies.robustness import Outcome
from stepover.studies.success_rates import EQUIPPED, equipped, influences, nearness, rate


def rates_table(rows: Sequence[Outcome]) -> Table:
    """Success rates and kinds of failure, with and without the stabilizer."""
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
    """The disturbances that make the robot fail, the most important first."""
    lines = [
        (one.measure, one.failed, one.succeeded, f"{one.distance:.2f}", f"{one.p:.1g}")
        for one in influences(equipped(rows, stabilizer))
    ]
    return table(
        "disturbance | median where it failed | where it crossed | distance of the distributions | p",
        lines or [("every draw ended alike", "-", "-", "-", "-")],
    )


def nearness_table(rows: Sequence[Outcome], stabilizer: bool) -> Table:
    """The disturbances that change the clearance of successful crossings, the most important first."""
    lines = [(name, f"{rho:+.2f}", f"{p:.1g}") for name, rho, p in nearness(equipped(rows, stabilizer))]
    return table(
        "disturbance | rank correlation with the clearance | p", lines or [("too few draws crossed", "-", "-")]
    )


def failures_table(rows: Sequence[Outcome]) -> Table:
    """All failures, one in each row."""
    failed = [
        (row.draw, EQUIPPED[row.stabilizer], f"{row.failure_time:.3f}", row.reason) for row in rows if not row.success
    ]
    return table("draw | robot | failed at [s] | reason", failed or [("none", "-", "-", "-")])


def breaking_table(rows: Sequence[breaking_points.Outcome]) -> Table:
    """How much of each disturbance alone the stabilized robot bears."""
    lines = []
    for name, kind in breaking_points.KINDS.items():
        some = [row for row in rows if row.kind == name]
        crossed, most = sum(row.crossed for row in some), f"beyond {kind.end:g}"
        sizes = [breaking_points.borne(some, share) for share in (0.95, 0.5)]
        cells = [most if np.isnan(size) else f"{size:.3g}" for size in sizes]
        failed = sum(row.reason.startswith("hit") for row in some if not row.crossed)
        lines.append((name, kind.unit, f"{crossed} of {len(some)}", *cells, failed, len(some) - crossed - failed))
    return table("disturbance | unit | crossed | 95 % cross at | 50 % cross at | touched the obstacle | fell", lines)


def agreement_table(compared: Sequence[tuple[Outcome, str]]) -> Table:
    """Rows simulated anew, and whether they agree with the stored ones."""
    lines = [
        (row.draw, EQUIPPED[row.stabilizer], "crossed" if row.success else f"failed at {row.failure_time:.3f} s",
         1e3 * row.clearance, row.state[:12], agrees)
        for row, agrees in compared
    ]  # fmt: skip
    return table("draw | robot | now | clearance [mm] | hash of all states, now | agrees with the table", lines)
