"""Success over each disturbance, with and without the stabilizer."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepover.report.figures.style import PLANNED, REFERENCE, SIMULATED, numbered, panels, styled
from stepover.studies import breaking_points
from stepover.studies.robustness import Outcome
from stepover.studies.success_rates import EQUIPPED, MEASURES, Rate, binned, equipped, influences, rate

COLOURS, MARKERS = {False: SIMULATED, True: PLANNED}, {False: "s", True: "o"}
BINS = 5
"""Number of bins for each disturbance."""
PANELS = 8
"""Number of disturbances shown. They are those that matter most."""
AIM = 0.95
"""Target success rate with the stabilizer."""


@styled
def robustness(rows: Sequence[Outcome]) -> Figure:
    """The success rate of all draws, then over the disturbances that matter most, with 95 % Wilson intervals."""
    figure, grid = panels(3, 5.6, columns=3, sharey=True)
    axes, shown = grid.ravel(), most_influential(rows)
    for place, (stabilizer, name) in enumerate(EQUIPPED.items()):
        total = rate(equipped(rows, stabilizer))
        _bar(axes[0], place, total, stabilizer, f"{name}, {total.of} draws")
        axes[0].text(
            place + 0.12, total.share, f"{1e2 * total.share:.0f} %", ha="left", va="center",
            bbox={"facecolor": "white", "lw": 0, "pad": 1.0},
        )  # fmt: skip
    axes[0].set_xticks([0, 1], [name.split()[0] for name in EQUIPPED.values()])
    axes[0].tick_params(axis="x", length=0)
    axes[0].set(xlim=(-0.5, 1.6), xlabel="stabilizer")
    for axis, measure in zip(axes[1:], shown, strict=True):
        values = [MEASURES[measure](row) for row in rows]
        edges = np.linspace(min(values), max(values), BINS + 1)
        for stabilizer, shift in ((False, -0.07), (True, 0.07)):
            found = binned(equipped(rows, stabilizer), measure, edges)
            x = np.array([value for value, _ in found]) + shift * (edges[1] - edges[0])
            axis.plot(x, [each.share for _, each in found], color=COLOURS[stabilizer], lw=0.9, alpha=0.6)
            for at, (_, each) in zip(x, found, strict=True):
                _bar(axis, float(at), each, stabilizer)
        axis.set(xlabel=measure)
        axis.margins(x=0.06)
    for axis in axes:
        axis.axhline(AIM, color=REFERENCE, lw=0.7, ls=":", label="target, 95 %" if axis is axes[0] else None)
        axis.set_ylim(-0.04, 1.04)
        axis.set_yticks([0.0, 0.25, 0.5, 0.75, 1.0], ["0", "25", "50", "75", "100"])
    for row in grid:
        row[0].set_ylabel("success [%]")
    numbered(axes, ["all draws", *[""] * len(shown)])
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=3,
                  title="bars: 95 % Wilson intervals", title_fontsize=9)  # fmt: skip
    return figure


@styled
def breaking(rows: Sequence[breaking_points.Outcome]) -> Figure:
    """Outcomes over the size of each disturbance alone, with the share of successes that fits them best."""
    figure, grid = panels(2, 4.2, columns=4, sharey=True)
    for axis, (name, kind) in zip(grid.ravel(), breaking_points.KINDS.items(), strict=True):
        some = [row for row in rows if row.kind == name]
        for crossed, colour, marker in ((True, PLANNED, "o"), (False, SIMULATED, "x")):
            sizes = [row.size for row in some if row.crossed is crossed]
            axis.plot(sizes, [float(crossed)] * len(sizes), color=colour, marker=marker, ms=3.5, ls="")
        if not all(row.crossed for row in some):
            middle, width = breaking_points.success_over_size(some)
            shown = np.linspace(min(kind.begin, kind.end), max(kind.begin, kind.end), 200)
            axis.plot(shown, 1.0 / (1.0 + np.exp((shown - middle) / width)), color=REFERENCE, lw=0.8)
        for share in (0.5, AIM):
            axis.axhline(share, color=REFERENCE, lw=0.5, ls=":")
        label = textwrap.fill(f"{name} [{kind.unit}]" if kind.unit else name, 20)
        axis.set(xlabel=label, xlim=(kind.begin, kind.end), ylim=(-0.06, 1.06))
        axis.set_yticks([0.0, 0.5, 1.0], ["fails", "50 %", "crosses"])
    return figure


def most_influential(rows: Sequence[Outcome]) -> list[str]:
    """The disturbances that matter most, with or without the stabilizer; ties keep the order of MEASURES."""
    least = dict.fromkeys(MEASURES, 1.0)
    for stabilizer in EQUIPPED:
        for one in influences(equipped(rows, stabilizer)):
            least[one.measure] = min(least[one.measure], one.p)
    return sorted(MEASURES, key=least.__getitem__)[:PANELS]


def _bar(axis: Axes, x: float, found: Rate, stabilizer: bool, label: str | None = None) -> None:
    """A rate with its interval."""
    low, high = found.interval
    colour = COLOURS[stabilizer]
    axis.plot([x, x], [low, high], color=colour, lw=1.0)
    axis.plot(x, found.share, color=colour, marker=MARKERS[stabilizer], ms=4.0, ls="", label=label)
