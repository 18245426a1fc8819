"""The tables of the notebook on feasibility domains: the numbers computed there, and verdicts on them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from stepover.analysis.delta_ds import Share
from stepover.analysis.double_support import DoubleSupport
from stepover.analysis.key_domain import KeyGrid, first_found
from stepover.analysis.planar.domains import Domains
from stepover.model.robot import Robot
from stepover.report.tables.table import Table, table

REMARK_2 = 0.47
"""Remark 2: the range of X_ads widens down to this Z_hds [m]."""


def remark_1(domains: Domains, coarse: Domains, fine: Domains) -> Table:
    """Areas of all domains, as shares of (7), and on a coarser and a finer grid."""
    rows = []
    for equation in domains.masks:
        here, less, more = (one.area(equation) for one in (domains, coarse, fine))
        smaller = "-" if equation not in (6, 8) else "holds" if here < domains.area(7) else "differs"
        share = here / domains.area(7) if domains.area(7) else np.nan
        changes = [f"{100 * (b / a - 1):+.1f} %" if a else "-" for a, b in ((less, here), (here, more))]
        rows.append((f"({equation})", f"{here:.4f}", f"{share:.2f}", smaller, f"{less:.4f}", f"{more:.4f}", *changes))
    points = [len(one.x_ads) for one in (domains, coarse, fine)]
    grids = f"{points[1]} points | {points[2]} | {points[1]} to {points[0]} | {points[0]} to {points[2]}"
    return table(f"condition | area [m²], {points[0]} points | of (7) | Remark 1 | {grids}", rows)


def remark_2(domains: Domains, heights: Sequence[float]) -> Table:
    """Range of X_ads at some heights under (7), with X_hds free or from Eq. (22), and where the trend ends."""
    conditions = (7, 22)
    rows = [(f"{z:.2f}", *(_range(domains.limits(e, z)) for e in conditions)) for z in heights]
    trends = [domains.trend(e) for e in conditions]
    for k, name in enumerate(("highest feasible Z_hds", "the range widens down to", "it is widest at")):
        rows.append((name, *(f"{trend[k]:.3f}" for trend in trends)))
    rows.append((f"Remark 2, down to {REMARK_2} m", *(_trend_verdict(domains, e) for e in conditions)))
    return table("Z_hds [m] | X_ads [m] under (7) | the same with X_hds = delta_DS X_ads", rows)


def readings(found: Mapping[str, tuple[Domains, Domains]]) -> Table:
    """Results of other readings of the paper, each with the domains for the obstacle and for a higher one."""
    rows = []
    for name, (one, higher) in found.items():
        areas = [one.area(e) for e in (6, 7, 8)]
        shortest = one.x_ads[one.masks[7].any(axis=0)][:1].tolist()
        top, end, _ = one.trend(7)
        left = f"{higher.area(7) / areas[1]:.2f}" if areas[1] else "-"
        rows.append((name, *(f"{area:.4f}" for area in areas), *(f"{x:.3f}" for x in shortest or [np.nan]),
                     f"{top:.3f}", f"{end:.3f}", _trend_verdict(one, 7), left))  # fmt: skip
    return table("reading | (6) [m²] | (7) | (8) | shortest X_ads [m] | top Z_hds [m] | X_ads widens down to [m] | "
                 "Remark 2 | left of (7), higher obstacle", rows)  # fmt: skip


def conditions(over: DoubleSupport) -> Table:
    """(6) to (8) for the CoM and (10) to (12) for the ZMP of a motion."""
    half = over.foot / 2.0
    allowed = (-half, half), (-half, over.x_ads + half), (over.x_ads - half, over.x_ads + half)
    names = "(6), (10): end of phase 1", "(7), (11): throughout phase 2", "(8), (12): start of phase 3"
    columns: list[tuple[str, ...]] = []
    for x in (over.com, over.zmp):
        columns.append((f"{x[0]:.3f}", _range((x.min(), x.max())), f"{x[-1]:.3f}"))
        columns.append(tuple("holds" if good else "does not hold" for good in over.holds(x)))
    rows = zip(names, map(_range, allowed), *columns, strict=True)
    return table("condition | allowed [m] | CoM [m] | (6) to (8) | ZMP [m] | (10) to (12)", rows)


def highest(heights: np.ndarray, swept: Mapping[str, Sequence[Domains]], here: Mapping[str, Domains]) -> Table:
    """The highest of some obstacles (H,) [m] with a non-empty domain, and with a step that (6) and (8) share."""
    rows = []
    for name, line in swept.items():
        tests = [[bool(one.masks[e].any()) for one in line] for e in line[0].masks]
        tests.append([len(one.common_steps()) > 0 for one in line])
        last = [f"{1e2 * heights[np.flatnonzero(test)[-1]]:.0f}" if any(test) else "none" for test in tests]
        steps = here[name].common_steps()
        rows.append((name, *last, _range((steps[0], steps[-1])) if len(steps) else "none"))
    return table("highest [cm] under | (6) | (7) | (8) | (22) | (6) and (8), the same X_ads | "
                 "which X_ads, for this obstacle [m]", rows)  # fmt: skip


def key_postures(robot: Robot, grids: Sequence[KeyGrid], domains: Sequence[Mapping[float, np.ndarray]]) -> Table:
    """FU's domain by the obstacle's height [m], at two yaws: areas, and the posture that the search finds first."""
    rows = []
    for height in domains[0]:
        row = [f"{1e2 * height:.0f} cm high"]
        for grid, masks in zip(grids, domains, strict=True):
            cell = (grid.x_ads[1] - grid.x_ads[0]) * (grid.z_hds[1] - grid.z_hds[0])
            first = first_found(masks[height] & grid.searched(robot), grid)
            row += [f"{masks[height].sum() * cell:.4f}", "none" if first is None else "{:.3f}, {:.3f}".format(*first)]
        rows.append(tuple(row))
    names = [f"area, yaw {grid.yaw_deg:.0f}° [m²] | found first: X_ads, Z_hds [m]" for grid in grids]
    return table(" | ".join(["obstacle", *names]), rows)


def frontiers(widths: np.ndarray, heights: Mapping[str, np.ndarray], shown: Sequence[float]) -> Table:
    """The highest obstacle [cm] at some widths.

    Args:
        widths: (W,) widths of the obstacles [m].
        heights: (W,) heights [m] by name: first with the waist straight ahead, then, in the same order, turned.
        shown: widths to show [m].
    """
    lines, half, rows = list(heights.values()), len(heights) // 2, []
    for k in [int(np.abs(widths - width).argmin()) for width in shown]:
        cells = [f"{1e2 * line[k]:.1f}" if line[k] else "none" for line in lines]
        gains = [turned[k] > ahead[k] for ahead, turned in zip(lines[:half], lines[half:], strict=True) if ahead[k]]
        rows.append((f"{1e2 * widths[k]:.0f} cm wide", *cells, "holds" if all(gains) else "differs"))
    return table(" | ".join(["highest obstacle [cm]", *heights, "turning allows more"]), rows)


def look_up(shares: Mapping[float, tuple[Share, Share]]) -> Table:
    """delta_DS by step length [m], for walking and for stepping over, with the CoM's share."""
    rows = [
        (f"{x:.2f}", *(f"{v:.3f}" for v in (walk.waist, over.waist, over.waist - walk.waist, walk.com, over.com)))
        for x, (walk, over) in shares.items()
    ]
    return table("X_ads [m] | delta_DS, walking | stepping over | difference | "
                 "the CoM's share, walking | stepping over", rows)  # fmt: skip


def _trend_verdict(domains: Domains, equation: int) -> str:
    """Whether Remark 2 holds, to one step of the grid."""
    return "holds" if domains.trend(equation)[1] <= REMARK_2 + domains.cell[1] else "differs"


def _range(ends: tuple[float, float]) -> str:
    """Two lengths as text."""
    return "none" if np.isnan(ends).any() else "{:.3f} to {:.3f}".format(*ends)
