"""The landing of leg 1: Fig. 3, spline and polynomial, the vertical force, and the quantities it depends on."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepover.analysis.landing.force import AVERAGED, TOUCH_DOWN, Landing
from stepover.analysis.landing.settings import NOISY, VARIATIONS
from stepover.analysis.landing.swings import NAIVE, NEAR_FLOOR, SHAPED, Curves, Profile
from stepover.model.gravity import GRAVITY
from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.report.figures.style import (
    FIRST_STAGE,
    LEFT,
    OBSTACLE,
    PHASES,
    PLANNED,
    REFERENCE,
    SIMULATED,
    WAIST,
    numbered,
    panels,
    shade_phases,
    styled,
)
from stepover.studies.landing import Landed, Point

COLOURS = (PLANNED, SIMULATED, FIRST_STAGE, WAIST, LEFT)
"""Shaped, naive, and others."""
NOISY_PEAKS = "peaks of the contact solver"
DASHES = ("-", "-", "--", ":", "-.")


@styled
def leg_1_landing(profiles: Mapping[str, Profile], motion: Motion) -> Figure:
    """Fig. 3: height, vertical speed and pitch of leg 1 by swing, and the end of the descent enlarged.

    Args:
        profiles: swings by their names in the legend.
        motion: gives the shaded phases. Time zero is its touch-down of leg 1.
    """
    figure, axes = panels(3, 5.8, columns=2)
    landed = dataclasses.replace(motion, time=motion.time - motion.time[motion.samples(1).stop])
    last, speeds, empty = axes[:, 1]
    for (name, profile), colour, dashes in zip(profiles.items(), COLOURS, DASHES, strict=False):
        time, down = profile.time - profile.time[-1], int(profile.height.argmax())
        own = {"color": colour, "ls": dashes, "label": name}
        for axis, values in zip(axes[:, 0], (profile.height, profile.speed, np.degrees(profile.pitch)), strict=True):
            axis.plot(time, values, **own)
        last.plot(1e3 * time[down:], 1e3 * profile.height[down:], **own)
        speeds.plot(1e3 * profile.height[down:], -profile.speed[down:], **own)
        near = profile.speed_near_floor()
        speeds.plot(1e3 * NEAR_FLOOR, near, color=colour, marker="o", ms=4.5, ls="", label=f"{near:.3f} m/s")
    for axis, label in zip(axes[:, 0], ("height [m]", "speed [m/s]", "pitch [deg]"), strict=True):
        axis.set(ylabel=label, xlim=(landed.time[motion.samples(1).start] - 0.05, 0.15))
        axis.margins(y=0.1)
        shade_phases(axis, landed, "short" if axis is axes[0, 0] else "")
    axes[2, 0].set_xlabel("time from touch-down [s]")
    last.set(xlim=(-250, 0), ylim=(0, 60), xlabel="time from touch-down [ms]", ylabel="height [mm]")
    speeds.axvline(1e3 * NEAR_FLOOR, color=OBSTACLE, ls=":", lw=1.0)
    fastest = max(profile.speed_near_floor(0.03) for profile in profiles.values())
    speeds.set(xlim=(0, 30), ylim=(0, 1.1 * fastest), xlabel="height above the floor [mm]", ylabel="descent [m/s]")
    handles, labels = speeds.get_legend_handles_labels()
    empty.legend([*handles[0::2], *handles[1::2]], [*labels[0::2], *labels[1::2]], loc="center", ncols=2,
                 title=f"swing of leg 1, and its descent at {1e3 * NEAR_FLOOR:.0f} mm")  # fmt: skip
    empty.axis("off")
    titles = ["height", "the last 60 mm", "vertical speed", "speed of the descent", "pitch, toe down: > 0"]
    numbered(axes.ravel()[:5], titles)
    return figure


@styled
def spline_and_polynomial(curves: Mapping[int, Curves], shown: int) -> Figure:
    """III-B: both curves through the same control points, and the overshoot of each.

    Args:
        curves: curves by the number of control points of the landing.
        shown: the number that the left panel shows.
    """
    figure, axes = panels(1, 2.9, columns=2, width_ratios=[1.15, 1.0])
    left, right = axes[0]
    one = curves[shown]
    left.plot(one.share, one.polynomial, color=SIMULATED, label="polynomial")
    left.plot(one.share, one.spline, color=PLANNED, label="clamped cubic spline")
    left.plot(*one.knots.T, color=REFERENCE, marker="o", mfc="white", ms=4.5, ls="", label="control points")
    left.set(xlabel="share of the swing's time", ylabel="height [m]")
    left.margins(y=0.08)
    left.legend(loc="best")
    for name, colour, marker in (("polynomial", SIMULATED, "s"), ("spline", PLANNED, "o")):
        over = [1e3 * curve.overshoot(getattr(curve, name)) for curve in curves.values()]
        right.plot(list(curves), over, color=colour, marker=marker, ms=4.0)
    right.set(yscale="log", xlabel="control points of the landing", ylabel="overshoot [mm]")
    right.set_xticks(list(curves))
    right.margins(x=0.04)
    numbered(axes, [f"{shown} control points in the landing", "overshoot beyond the control points"])
    return figure


@styled
def landing_forces(robot: Robot, landings: Mapping[Point, Landing], paper: Sequence[float]) -> Figure:
    """The vertical force on leg 1's foot around the planned touch-down, with a column for each variation.

    Args:
        robot: gives the weight and the duration of the double support.
        landings: landings by simulated point.
        paper: the paper's forces [N].
    """
    variations = list(dict.fromkeys(point.variation for point in landings))
    swings = list(dict.fromkeys((point.profile, point.swing_time) for point in landings))
    both = 1e3 * robot.walk.double_support_over
    figure, axes = panels(1, 3.4, columns=len(variations), sharey=True)
    for axis, variation in zip(axes[0], variations, strict=True):
        axis.axvspan(0.0, both, color=PHASES[2], alpha=0.12, lw=0, zorder=0, label="double support")
        for point, landing in landings.items():
            if point.variation == variation:
                look = swings.index((point.profile, point.swing_time))
                time, name = 1e3 * landing.time, f"{point.profile}, {point.swing_time:g} s"
                axis.plot(time, landing.raw, color=COLOURS[look], lw=0.4, alpha=0.4)
                axis.plot(time, landing.force, color=COLOURS[look], ls=DASHES[look], label=name)
        _levels(axis, robot, paper)
        if variation == NOISY:
            axis.text(
                0.97,
                0.97,
                "motors do not yield:\n" + NOISY_PEAKS,
                transform=axis.transAxes,
                ha="right",
                va="top",
                fontsize=8.5,
            )
        axis.set(xlim=(-150, 250), xlabel="time from touch-down [ms]")
    highest = max(float(landing.force.max()) for landing in landings.values())
    axes[0, 0].set(ylim=(0, 1.1 * max(highest, *paper)), ylabel="vertical force [N]")
    said = f"force of the floor, mean over {1e3 * AVERAGED:.0f} ms, no other filter; thin: each step of the physics"
    figure.legend(*axes[0, -1].get_legend_handles_labels(), loc="outside lower center", ncols=6, title=said,
                  title_fontsize=9, columnspacing=1.0, handlelength=1.5)  # fmt: skip
    numbered(axes, [name if name == NOISY else f"{name}, servos" for name in variations])
    return figure


@styled
def landing_sensitivity(robot: Robot, rows: Sequence[Landed], paper: Sequence[float]) -> Figure:
    """The forces at touch-down and the peaks of each variation, by swing.

    Args:
        robot: gives the weight.
        rows: rows of the stored table.
        paper: the paper's forces [N].
    """
    names = list(dict.fromkeys(row.variation for row in rows))
    swings = list(dict.fromkeys((row.profile, row.swing_time) for row in rows))
    swings.sort(key=lambda swing: swing[0] not in (SHAPED, NAIVE))
    figure, axes = panels(1, 0.22 * len(names) + 1.2, columns=2, sharey=True)
    for axis, value in zip(axes[0], ("touch_down", "peak"), strict=True):
        for number, (swing, colour, marker) in enumerate(zip(swings, COLOURS, "osD^v", strict=True)):
            mine = [row for row in rows if (row.profile, row.swing_time) == swing and not row.fell]
            forces = [getattr(row, value) or np.nan for row in mine]
            places = [names.index(row.variation) + 0.16 * (number - 1.5) for row in mine]
            inside = colour if swing[0] == SHAPED else "white"
            axis.plot(forces, places, color=colour, marker=marker, ms=4.5, mfc=inside, ls="",
                      label=f"{swing[0]}, {swing[1]:g} s")  # fmt: skip
        _levels(axis, robot, paper, vertical=True)
        for row, (name, before) in enumerate(zip(names[1:], names, strict=False)):
            if VARIATIONS[name].sole != VARIATIONS[before].sole or name == NOISY:
                axis.axhline(row + 0.5, color=REFERENCE, lw=0.8)
        axis.grid(axis="y", visible=False)
        axis.set(xlabel="vertical force [N]", xlim=(0, 1.05 * axis.dataLim.x1))
    axes[0, 0].set_yticks(range(len(names)), names)
    axes[0, 0].set_ylim(len(names) - 0.5, -0.5)
    axes[0, 1].text(
        0.98,
        0.006,
        NOISY_PEAKS,
        transform=axes[0, 1].transAxes,
        ha="right",
        va="bottom",
        fontsize=8.5,
    )
    figure.legend(*axes[0, 1].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    numbered(axes, [f"touch-down: first {1e3 * TOUCH_DOWN:.0f} ms", "peak"])
    return figure


def _levels(axis: Axes, robot: Robot, paper: Sequence[float], vertical: bool = False) -> None:
    """Lines at the weight and at the paper's forces."""
    weight = robot.body.mass * GRAVITY
    line = axis.axvline if vertical else axis.axhline
    line(weight, color=REFERENCE, ls="--", lw=0.9, label=f"weight: {weight:.0f} N", zorder=1)
    said = "paper: " + ", ".join(f"{force:.0f}" for force in paper) + " N"
    for force in paper:
        line(force, color=OBSTACLE, ls=":", lw=1.2, zorder=1, label=said if force == paper[0] else None)
