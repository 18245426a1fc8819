"""The contribution of each unit, the highest obstacles with and without yaw, and the plane of obstacles."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from stepover.analysis.stages import Contribution
from stepover.report.figures.style import FIRST_STAGE, OBSTACLE, PLANNED, REFERENCE, SIMULATED, WAIST, panels, styled
from stepover.studies.obstacle_plane import HEIGHTS, WIDTHS
from stepover.studies.sweep import Crossing

METHODS = (
    "FTA: (1) trailing foot held back, (2) waist raised, (3) ankle pushed away; UBMG: arms back.\n"
    "Zero is the safety margin. Plans above it that are refused fail at the lead knee."
)
"""Meaning of the abbreviations under the bars."""
BARS = (WAIST, PLANNED, SIMULATED, FIRST_STAGE)
CROSSED, CROSSED_BEYOND, FAILED, NOT_PLANNED = WAIST, PLANNED, SIMULATED, OBSTACLE
"""Colours of the outcomes."""
READING = (
    "Numbers: clearance in the physics [mm]. FU: no key configuration. "
    "path: a key configuration, but no complete motion.\n"
    "Circles: obstacles between the grid values. Rows and columns are evenly spaced, not to scale."
)
IN_BRACKETS = " In brackets: planned, not simulated."


@styled
def clearance_by_units(results: Mapping[float, Sequence[Contribution]]) -> Figure:
    """Distance of the legs from the safety margins in phase 3, by combination of units, for some heights [m]."""
    figure, axes = panels(1, 3.4)
    axis = axes[0, 0]
    units = [one.units for one in next(iter(results.values()))]
    width = 0.8 / len(results)
    for group, found in enumerate(results.values()):
        for place, one in enumerate(found):
            x = place + (group - (len(results) - 1) / 2.0) * width
            value, colour = 1e3 * one.free, BARS[group % len(BARS)]
            axis.bar(x, value, 0.92 * width, color=to_rgba(colour, 0.35) if one.reason else colour, edgecolor=colour,
                     hatch="////" if one.reason else None, lw=0.8)  # fmt: skip
            above, text = value >= 0.0, f"{value:.0f}".replace("-", "\u2212")
            axis.text(
                x, value + (0.6 if above else -0.8), text, ha="center", va="bottom" if above else "top", fontsize=8
            )
    axis.axhline(0.0, color=REFERENCE, lw=1.0)
    axis.set_xticks(range(len(units)), [textwrap.fill(name, 14) for name in units])
    axis.tick_params(axis="x", length=0)
    axis.set(xlim=(-0.6, len(units) - 0.4), ylabel="distance from the margins [mm]")
    axis.margins(y=0.12)
    axis.grid(visible=False, axis="x")
    named = [Patch(color=BARS[k % len(BARS)], label=f"{1e2 * height:g} cm") for k, height in enumerate(results)]
    named.append(Patch(facecolor="white", edgecolor=REFERENCE, hatch="////", label="refused by Algorithm 1"))
    figure.legend(handles=named, loc="outside upper center", ncols=len(named))
    figure.supxlabel(METHODS, fontsize=8.5)
    return figure


@styled
def highest_with_and_without_yaw(widths: np.ndarray, without: np.ndarray, turned: np.ndarray, yaw_deg: float) -> Figure:
    """The highest obstacles (n,) [m] over which FU finds a key configuration, by width (n,) [m]."""
    figure, axes = panels(1, 2.9)
    axis = axes[0, 0]
    axis.plot(
        1e2 * widths, 1e2 * turned, color=PLANNED, marker="o", ms=3.5, label=f"waist turned by {yaw_deg:g} degrees"
    )
    axis.plot(1e2 * widths, 1e2 * without, color=SIMULATED, marker="s", ms=3.5, label="waist not turned")
    axis.fill_between(1e2 * widths, 1e2 * without, 1e2 * turned, color=PLANNED, alpha=0.15, lw=0)
    axis.set(
        xlabel="width [cm]",
        ylabel="highest obstacle [cm]",
        ylim=(0.0, 42.0),
        xlim=(1e2 * widths[0] - 0.5, 1e2 * widths[-1] + 0.5),
    )
    axis.legend(loc="upper right")
    return figure


@styled
def obstacle_plane(rows: Sequence[Crossing]) -> Figure:
    """The outcome for each obstacle of the study, as a tile with the clearance in the physics [mm]."""
    figure, axes = panels(1, 5.0)
    axis = axes[0, 0]
    tiles = [row for row in rows if row.height in HEIGHTS and row.width in WIDTHS]
    for row in tiles:
        x, y = WIDTHS.index(row.width), HEIGHTS.index(row.height)
        axis.add_patch(_tile(x, y, _fate(row)))
        axis.text(
            x, y, _clearance(row), ha="center", va="center", fontsize=8.5, color="white" if row.planned else "0.25"
        )
    for row in (row for row in rows if row not in tiles):
        place = np.interp(row.width, WIDTHS, range(len(WIDTHS))), np.interp(row.height, HEIGHTS, range(len(HEIGHTS)))
        axis.plot(*place, marker="o", ms=17, color=_fate(row), mec="white", mew=1.2)
        axis.text(*place, _clearance(row), ha="center", va="center", fontsize=8.5, color="white")
    axis.set_xticks(range(len(WIDTHS)), [f"{1e2 * width:g}" for width in WIDTHS])
    axis.set_yticks(range(len(HEIGHTS)), [f"{1e2 * height:g}" for height in HEIGHTS])
    axis.set(xlabel="width [cm]", ylabel="height [cm]", xlim=(-0.5, len(WIDTHS) - 0.5), ylim=(-0.5, len(HEIGHTS) - 0.5))
    axis.grid(visible=False)
    axis.tick_params(length=0)
    for side in ("left", "bottom"):
        axis.spines[side].set_visible(False)
    named = ((CROSSED, "crossed, the paper's methods"), (CROSSED_BEYOND, "crossed, with methods beyond the paper"),
             (FAILED, "planned, but fell or touched"), (NOT_PLANNED, "refused by the planner"))  # fmt: skip
    found = {_fate(row) for row in rows}
    handles = [Patch(facecolor=_shade(colour), lw=0, label=text) for colour, text in named if colour in found]
    figure.legend(handles=handles, loc="outside upper center", ncols=3)
    figure.supxlabel(
        READING + (IN_BRACKETS if any(row.planned and row.crossed is None for row in rows) else ""), fontsize=8.5
    )
    return figure


def _tile(x: float, y: float, colour: str) -> Patch:
    """A tile of the plane."""
    return Rectangle((x - 0.48, y - 0.46), 0.96, 0.92, facecolor=_shade(colour), lw=0)


def _shade(colour: str) -> tuple[float, float, float, float]:
    """The colour of a tile: obstacles without a plan are lighter."""
    return to_rgba(colour, 0.35 if colour == NOT_PLANNED else 1.0)


def _fate(row: Crossing) -> str:
    """Colour of an obstacle's outcome."""
    if not row.planned:
        return NOT_PLANNED
    if row.crossed is False:
        return FAILED
    return CROSSED_BEYOND if row.beyond_paper_level else CROSSED


def _clearance(row: Crossing) -> str:
    """Clearance in the physics, or the reason of the planner in short."""
    if row.simulated_clearance is not None:
        return f"{1e3 * row.simulated_clearance:.0f}"
    if row.planned_clearance is not None:
        return f"({1e3 * row.planned_clearance:.0f})"
    return "FU" if row.reason.startswith("no key configuration") else "path"
