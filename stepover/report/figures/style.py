"""Style of all figures: pyplot, the style sheet, colours with a meaning, and shaded phases."""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any, ParamSpec

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import blended_transform_factory

from stepover.motion.motion import Motion
from stepover.output import write_whole

STYLE = Path(__file__).parents[1] / "paper.mplstyle"
# The colours of Okabe and Ito, which colour-blind readers can tell apart. Each has one meaning in all figures.
REFERENCE = "#000000"
PLANNED = "#0072B2"
SIMULATED = "#D55E00"
FIRST_STAGE = "#E69F00"
WAIST = "#009E73"
LEFT, RIGHT = "#CC79A7", "#56B4E9"
OBSTACLE = "#7F7F7F"
AXES = {"x": PLANNED, "y": FIRST_STAGE, "z": WAIST}
"""Colours of the x, y and z components in one panel."""
SUPPORT = "#00000020"
PHASES = {1: "#56B4E9", 2: "#000000", 3: "#F0E442"}

P = ParamSpec("P")


def styled(draw: Callable[P, Figure]) -> Callable[P, Figure]:
    """Draw in our style, then close the figure in pyplot. So a notebook shows it only if a cell returns it."""

    @functools.wraps(draw)
    def drawn(*args: P.args, **kwargs: P.kwargs) -> Figure:
        with plt.style.context(["default", STYLE]):
            figure = draw(*args, **kwargs)
        plt.close(figure)
        return figure

    return drawn


def panels(rows: int, height: float, columns: int = 1, **options: Any) -> tuple[Figure, np.ndarray]:
    """A figure as wide as two columns of the paper, and its axes (rows, columns); height in inches."""
    figure, axes = plt.subplots(rows, columns, figsize=(7.16, height), squeeze=False, **options)
    return figure, axes


def save(figure: Figure, path: str | Path, name: str = "") -> Figure:
    """Write a PNG without date or version, so that the same figure gives the same bytes.

    Args:
        figure: the figure.
        path: the file, or its folder.
        name: file name in the folder, without ".png".

    Raises:
        InvalidInput: the folder does not exist or cannot be written to.
    """
    target = Path(path) / f"{name}.png" if name else Path(path)
    write_whole(target, lambda file: figure.savefig(file, format="png", metadata={"Software": None}))
    return figure


def shade_phases(axes: Axes, motion: Motion, names: str = "") -> None:
    """Shade the visible phases 1 to 3 of Sec. II. `names` sets the names above them: "long", "short" or ""."""
    left, right = axes.get_xlim()
    for phase, colour in PHASES.items():
        samples = motion.samples(phase)
        start, end = max(left, motion.time[samples.start]), min(right, motion.time[samples.stop])
        if end <= start:
            continue
        axes.axvspan(start, end, color=colour, alpha=0.5 if phase == 2 else 0.16, lw=0, zorder=0)
        if names:
            above = blended_transform_factory(axes.transData, axes.transAxes)
            text = f"phase {phase}" if names == "long" and phase != 2 else str(phase)
            axes.text((start + end) / 2.0, 1.015, text, transform=above, ha="center", va="bottom", fontsize=8.5)


def time_axis(axes: np.ndarray, motion: Motion, names: str = "long") -> None:
    """Label the lowest axes of a column with time, shade the phases on all axes, and name them above the top one."""
    for axis in axes:
        axis.set_xlim(motion.time[0], motion.time[-1])
        shade_phases(axis, motion, names if axis is axes[0] else "")
    axes[-1].set_xlabel("time [s]")


def numbered(axes: np.ndarray, titles: list[str]) -> None:
    """Number the axes (a), (b), ... and give each a title."""
    for letter, axis, title in zip("abcdefghi", axes.ravel(), titles, strict=False):
        axis.set_title(f"({letter}) {title}")
