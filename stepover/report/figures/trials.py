"""Figures of the trials: the robot without and with the stabilizer, and the heights that it crosses with servos."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepover.report.figures.style import (
    AXES,
    OBSTACLE,
    PLANNED,
    REFERENCE,
    SIMULATED,
    numbered,
    panels,
    styled,
    time_axis,
)
from stepover.report.tables.trials import by_height
from stepover.simulation.measurements import Run
from stepover.studies.trials import Outcome

SETTLED = 0.1
"""Time after the start at which the robot has settled on its soles [s]."""
SOLES = {"rigid": ("rigid soles", PLANNED, "s"), "compliant": ("rubber", SIMULATED, "o")}


@styled
def stabilized(without: Run, with_it: Run) -> Figure:
    """ZMP and waist over time, without and with the stabilizer on the same soles. Triangles: curve leaves the axes."""
    figure, axes = panels(3, 5.6, sharex=True)
    motion, runs = with_it.motion, ((without, SIMULATED, "without stabilizer"), (with_it, PLANNED, "with it"))
    for axis, column, name in ((axes[0, 0], 0, "x"), (axes[1, 0], 1, "y")):
        for run, colour, label in runs:
            _clipped(axis, run.series.time, 1e3 * run.series.zmp_error[:, column], (-130.0, 130.0), colour, label)
        axis.axhline(0.0, color=REFERENCE, lw=0.6)
        axis.set_ylabel(f"ZMP error {name} [mm]")
    for run, colour, label in runs:
        _clipped(axes[2, 0], run.series.time, 1e3 * run.series.waist_error, (0.0, 110.0), colour, label)
        for axis in axes[:, 0] if run.fall_time is not None else ():
            axis.axvline(run.fall_time, color=colour, lw=0.9, ls=":", label=f"{label}: falls")
    axes[2, 0].set_ylabel("waist from plan [mm]")
    numbered(axes, ["ZMP minus its plan, ahead", "ZMP minus its plan, sideways", "waist"])
    time_axis(axes[:, 0], motion, names="short")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


@styled
def estimated(run: Run) -> Figure:
    """Estimated minus true place of the waist. The title states how much the CoM's error differs from it.

    A triangle marks the first value, which lies outside the figure: the robot has not yet settled on its soles.
    """
    figure, axes = panels(1, 2.6)
    axis, series = axes[0, 0], run.series
    settled = 1e3 * series.waist_believed_error[series.time > SETTLED]
    shown = 1.15 * float(np.nanmin(settled)), 1.15 * float(np.nanmax(settled))
    for errors, (name, colour) in zip(series.waist_believed_error.T, AXES.items(), strict=True):
        _clipped(axis, series.time, 1e3 * errors, shown, colour, name)
    axis.axhline(0.0, color=REFERENCE, lw=0.6)
    axis.set_ylabel("error [mm]")
    apart = np.nanmax(np.abs(series.com_believed_error - series.waist_believed_error))
    axis.set_title(f"waist, estimated minus true; the CoM's error is within {np.ceil(1e5 * apart) / 1e2:g} mm of it")
    time_axis(axes[:, 0], run.motion, names="")
    figure.legend(*axis.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


@styled
def heights_with_servos(rows: Sequence[Outcome]) -> Figure:
    """Clearance, torque and speed by the obstacle's height, with servos and stabilizer."""
    figure, axes = panels(1, 3.1, 3)
    values = ("clearance", "torque_ratio", "speed_ratio")
    for speed_limits, said in (("ignore", ""), ("respect", ", the plan respects speed limits")):
        for sole, (name, colour, marker) in SOLES.items():
            some = [row for row in by_height(rows, speed_limits) if row.sole == sole and row.motion]
            look = {"color": colour, "marker": marker, "label": name + said, "ls": "", "ms": 6.5, "mfc": "none"}
            if not said:
                look |= {"ls": "-", "ms": 3.5, "mfc": colour}
            for axis, value in zip(axes[0], values, strict=True):
                _by_height(axis, some, value, look)
    for axis in axes[0, 1:]:
        axis.axhline(1.0, color=OBSTACLE, lw=0.8)
    axes[0, 0].plot([], [], color=REFERENCE, marker="x", ls="", label="failed")
    axes[0, 0].set(ylabel="distance from the obstacle [mm]")
    axes[0, 1].set(ylabel="share of the limit", ylim=(0.0, 1.1))
    axes[0, 2].set(ylabel="share of the limit", ylim=(0.0, None))
    for axis in axes[0]:
        axis.set(xlabel="height [cm]", xlim=(14.5, 25.5), xticks=range(15, 26, 2))
    numbered(axes, ["clearance", "largest torque", "largest speed"])
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


def _by_height(axis: Axes, rows: Sequence[Outcome], value: str, look: Mapping[str, Any]) -> None:
    """Draw one line, with a cross where the robot failed."""
    scale = 1e3 if value == "clearance" else 1.0
    heights = 1e2 * np.array([row.height for row in rows])
    levels = scale * np.array([getattr(row, value) for row in rows], dtype=float)
    failed = np.array([not row.crossed for row in rows])
    axis.plot(heights, levels, lw=1.1, **look)
    axis.plot(heights[failed], levels[failed], color=REFERENCE, marker="x", ls="", ms=4.0)


def _clipped(axis: Axes, time: np.ndarray, values: np.ndarray, shown: tuple[float, float], colour: str,
             label: str) -> None:  # fmt: skip
    """Draw a curve (N,) between two values, with a triangle at the edge where it leaves them."""
    low, high = shown
    axis.plot(time, values, color=colour, lw=0.9, label=label)
    axis.set_ylim(low, high)
    for sign, edge, marker in ((1.0, high, "^"), (-1.0, low, "v")):
        beyond = np.flatnonzero(sign * (values - edge) > 0.0)
        for gone in np.split(beyond, np.flatnonzero(np.diff(beyond) > 1) + 1) if len(beyond) else ():
            axis.plot(time[gone[0]], edge, color=colour, marker=marker, ms=4.5, ls="", clip_on=False, zorder=5)
