"""The motion in the physics: planned against simulated, contact forces, clearance, Fig. 10, and failures."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from stepover.model.collision import exact_distance, separation
from stepover.model.gravity import GRAVITY
from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.report.figures.style import (
    AXES,
    LEFT,
    OBSTACLE,
    PLANNED,
    REFERENCE,
    RIGHT,
    SIMULATED,
    WAIST,
    numbered,
    panels,
    shade_phases,
    styled,
    time_axis,
)
from stepover.simulation.engine import NAMES
from stepover.simulation.measurements import Run

BEFORE_FAILURE, AFTER_FAILURE = 1.0, 0.2
"""Time shown in a plot of a failure [s]."""
CAPTION = 0.22
"""Height of the time below a picture, and width of the name of a row [in]."""
EVERY, SHOWN = 4, 0.3
"""Samples between the points of the clearance, and the largest clearance shown [m]."""


@styled
def planned_and_simulated(run: Run) -> Figure:
    """Planned and measured ZMP in x and y, and the distance of the waist from its plan."""
    motion, series = run.motion, run.series
    figure, axes = panels(3, 6.0, sharex=True, height_ratios=[1.1, 1.1, 0.9])
    for axis, name in enumerate("xy"):
        panel = axes[axis, 0]
        panel.plot(series.time, series.zmp[:, axis], color=SIMULATED, lw=1.0, label="ZMP, simulated")
        panel.plot(motion.time, motion.zmp[:, axis], color=PLANNED, lw=1.0, label="ZMP, planned")
        panel.plot(series.time, series.q[:, axis], color=WAIST, lw=2.2, label="waist, simulated")
        panel.plot(motion.time, motion.waist[:, axis], color=REFERENCE, ls="--", lw=0.9, label="waist, planned")
        panel.set_ylabel(f"{name} [m]")
        panel.margins(y=0.12)
        if axis == 0:
            panel.legend(loc="upper left", ncols=2)
    error = 1e3 * (series.q[:, :3] - motion.waist[: len(series.time), :3])
    for axis, (name, colour) in enumerate(AXES.items()):
        axes[2, 0].plot(series.time, error[:, axis], color=colour, lw=1.0, label=name)
    axes[2, 0].set_ylabel("waist error [mm]")
    axes[2, 0].legend(loc="upper left", ncols=3)
    axes[2, 0].margins(y=0.25)
    time_axis(axes[:, 0], motion)
    numbered(axes, ["ahead", "across", "waist, simulated minus planned"])
    return figure


@styled
def contact_forces(robot: Robot, run: Run) -> Figure:
    """Vertical force of the floor on each foot, and the robot's weight."""
    motion, series = run.motion, run.series
    figure, axes = panels(2, 4.2, sharex=True, sharey=True)
    weight = robot.body.mass * GRAVITY
    feet = ((series.left_wrench, LEFT, 1), (series.right_wrench, RIGHT, -1))
    for axis, (wrench, colour, side) in zip(axes[:, 0], feet, strict=True):
        axis.plot(series.time, wrench[:, 2], color=colour, lw=0.9, label="force of the floor")
        axis.axhline(weight, color=REFERENCE, ls="--", lw=0.9, label=f"weight, {weight:.0f} N")
        landed = motion.footsteps.of_side(side).time
        axis.plot(landed, np.zeros_like(landed), color=REFERENCE, marker="^", ls="", ms=5, label="planned touch-down")
        axis.set_ylabel("vertical force [N]")
        axis.set_ylim(-0.08 * weight, 1.3 * max(wrench[:, 2].max() for wrench, _, _ in feet))
        axis.legend(loc="upper left", ncols=3)
    time_axis(axes[:, 0], motion)
    numbered(axes, ["left foot", "right foot"])
    return figure


@styled
def clearance(robot: Robot, run: Run) -> Figure:
    """Distance of the robot from the bare obstacle over time, planned and simulated, and the safety margin."""
    motion, series = run.motion, run.series
    figure, axes = panels(1, 2.8)
    axis = axes[0, 0]
    for name, time, q, colour, width in (
        ("planned", motion.time, motion.q, PLANNED, 2.4),
        ("simulated", series.time, series.q, SIMULATED, 0.9),
    ):
        axis.plot(time[::EVERY], 1e3 * clearance_over_time(robot, motion, q), color=colour, lw=width, label=name)
    margin = 1e3 * min(motion.obstacle[3:5])
    axis.axhline(margin, color=OBSTACLE, ls=":", lw=1.2, label="safety margin")
    axis.axhline(0.0, color=OBSTACLE, lw=1.5, label="obstacle")
    axis.set_ylabel("clearance [mm]")
    time_axis(axes[:, 0], motion)
    axis.set_ylim(min(-10.0, 1e3 * run.clearance_min - 10.0), 1e3 * SHOWN)
    axis.legend(loc="upper right")
    return figure


@styled
def strip(frames: Sequence[np.ndarray], times: np.ndarray, columns: int = 4, names: Sequence[str] = ()) -> Figure:
    """Figs. 6 and 10: K frames (H, W, 3), row by row, with times (K,) [s] below. Each row may have a name."""
    rows = -(-len(frames) // columns)
    height = (7.16 - (CAPTION if names else 0.0)) / columns * frames[0].shape[0] / frames[0].shape[1]
    figure, axes = panels(rows, rows * (height + CAPTION), columns=columns)
    figure.get_layout_engine().set(w_pad=0.015, h_pad=0.015, wspace=0.0, hspace=0.0)  # type: ignore[union-attr,call-arg]
    for axis in axes.ravel():
        axis.set_axis_off()
    for axis, name in zip(axes[:, 0], names, strict=False):
        axis.text(-0.04, 0.5, name, transform=axis.transAxes, rotation=90, ha="right", va="center")
    for axis, frame, time in zip(axes.ravel(), frames, times, strict=False):
        axis.imshow(frame)
        axis.set_anchor("N")
        axis.text(0.5, -0.02, f"{time:.2f} s", transform=axis.transAxes, ha="center", va="top")
    return figure


@styled
def failure(robot: Robot, run: Run) -> Figure:
    """The last second before the robot falls or touches the obstacle: ZMP margin, clearance, waist, foot forces."""
    series = run.series
    sample = _failing_sample(run)
    start, end = series.time[sample] - BEFORE_FAILURE, series.time[sample] + AFTER_FAILURE
    near = (series.time >= start) & (series.time <= end)
    figure, axes = panels(4, 6.6, sharex=True)
    margin, distance, waist, forces = axes[:, 0]
    margin.plot(series.time[near], 1e3 * series.zmp_margin[near], color=SIMULATED, label="ZMP")
    distance.plot(series.time[near], 1e3 * series.clearance[near], color=SIMULATED, label="nearest link")
    error = 1e3 * (series.q[:, :3] - run.motion.waist[: len(series.time), :3])[near]
    for axis, (name, colour) in enumerate(AXES.items()):
        waist.plot(series.time[near], error[:, axis], color=colour, label=name)
    for name, wrench, colour in (("left", series.left_wrench, LEFT), ("right", series.right_wrench, RIGHT)):
        forces.plot(series.time[near], wrench[near, 2], color=colour, label=f"{name} foot")
    forces.axhline(robot.body.mass * GRAVITY, color=REFERENCE, ls="--", lw=0.9, label="weight")
    for axis, unit in zip(axes[:, 0], ("distance [mm]", "distance [mm]", "error [mm]", "force [N]"), strict=True):
        axis.set_xlim(start, end)
        shade_phases(axis, run.motion, "long" if axis is margin else "")
        axis.axvline(series.time[sample], color=REFERENCE, lw=1.2)
        axis.set_ylabel(unit)
        axis.margins(y=0.1)
        axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    for axis in (margin, distance):
        axis.axhline(0.0, color=OBSTACLE, lw=1.2)
    forces.set_xlabel("time [s]")
    numbered(
        axes, ["ZMP inside the support polygon", "clearance", "waist, simulated minus planned", "forces on the feet"]
    )
    figure.suptitle(textwrap.fill(run.explanation, 125), fontsize=9, x=0.01, ha="left")
    return figure


def clearance_over_time(robot: Robot, motion: Motion, q: np.ndarray) -> np.ndarray:
    """Exact signed distance (n,) [m] of the robot from the bare obstacle, at every EVERYth configuration of (N, nq)."""
    placements, obstacle = robot.body.placements(q[::EVERY]), motion.bare_obstacle
    bounds = np.array([separation(shape, placements, obstacle) for shape in robot.shapes])
    nearest = np.full(bounds.shape[1], np.inf)
    for sample, order in enumerate(bounds.argsort(axis=0).T):
        for which in order[: np.searchsorted(bounds[order, sample], 1.5 * SHOWN)]:
            if bounds[which, sample] > nearest[sample]:
                break
            distance = exact_distance(robot.shapes[which], placements, sample, obstacle)
            nearest[sample] = min(nearest[sample], distance)
    return nearest


def _failing_sample(run: Run) -> int:
    """Sample of the first contact with the obstacle or of the fall, whichever came first; else the last one."""
    found = np.flatnonzero(np.isfinite(run.series.obstacle_depth))[:1].tolist()
    if run.fall_time is not None:
        found.append(int(np.searchsorted(run.series.time, run.fall_time)))
    return min(found, default=len(run.series.time) - 1)


@styled
def two_engines(runs: Mapping[str, Mapping[str, Run]]) -> Figure:
    """ZMP error, waist error, force on leg 1's foot and clearance over time in both engines; a column a robot."""
    figure, grid = panels(4, 7.0, len(runs), sharex=True, sharey="row")
    for column, (equipment, each) in zip(grid.T, runs.items(), strict=True):
        motion = next(iter(each.values())).motion
        looks = {"color": SIMULATED, "lw": 2.0, "alpha": 0.6}, {"color": PLANNED, "lw": 0.7}
        for (engine, run), look in zip(each.items(), looks, strict=True):
            series, foot = run.series, "left" if motion.footsteps.of_kind(2).side[0] > 0 else "right"
            force = getattr(series, f"{foot}_wrench")[:, 2]
            curves = 1e3 * series.zmp_error[:, 0], 1e3 * series.waist_error, force, 1e3 * series.clearance
            for axis, curve in zip(column, curves, strict=True):
                axis.plot(series.time, curve, label=NAMES[engine], **look)
        column[0].set_title(equipment)
        column[3].set_ylim(0.0, 1e3 * SHOWN / 2.0)
        time_axis(column, motion, names="")
    names = ("ZMP error, x [mm]", "waist from plan [mm]", "force on leg 1 [N]", "clearance [mm]")
    for axis, name in zip(grid[:, 0], names, strict=True):
        axis.set_ylabel(name)
    figure.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure
