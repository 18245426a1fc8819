"""Quasi-static against dynamic: paths of CoM and ZMP, duration over epsilon, and the heights that each one crosses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepover.model.robot import Robot
from stepover.model.support import corners_on_floor
from stepover.motion.motion import Motion
from stepover.report.figures.planned import support_span
from stepover.report.figures.style import (
    FIRST_STAGE,
    LEFT,
    OBSTACLE,
    PHASES,
    PLANNED,
    REFERENCE,
    RIGHT,
    SIMULATED,
    SUPPORT,
    WAIST,
    numbered,
    panels,
    styled,
)
from stepover.studies.strategies import Crossed

COM, ZMP = FIRST_STAGE, PLANNED
AROUND = 0.35
"""Length of path shown before and behind the step over the obstacle [m]."""


@styled
def ways_from_above(robot: Robot, motions: Mapping[str, Motion]) -> Figure:
    """Soles, obstacle, CoM and ZMP from above, with a panel for each motion. x starts at the rear ankle."""
    figure, axes = panels(len(motions), 2.75 * len(motions) + 0.3, sharex=True)
    for axis, motion in zip(axes[:, 0], motions.values(), strict=True):
        first, between, second = (motion.samples(phase) for phase in (1, 2, 3))
        origin = _rear_ankle(motion)
        front, width = motion.obstacle[:2]
        axis.axvspan(front - origin, front + width - origin, color=OBSTACLE, alpha=0.45, lw=0, label="obstacle")
        for side, colour, name in ((1, LEFT, "left sole"), (-1, RIGHT, "right sole")):
            for place in _standing_places(motion, side):
                corners = corners_on_floor(robot, side, place) - [origin, 0.0]
                axis.fill(*corners.T, color=colour, alpha=0.30, lw=0.6, label=name)
                name = ""
        axis.plot(motion.zmp[:, 0] - origin, motion.zmp[:, 1], color=ZMP, lw=2.6, label="ZMP, multi-body")
        axis.plot(motion.com[:, 0] - origin, motion.com[:, 1], color=COM, lw=1.2, label="CoM")
        for sample, marker, filled, name in (
            (first.start, "^", False, "leg 1 lifts off"), (between.start, "o", True, "leg 1 lands"),
            (between.stop, "s", False, "leg 2 lifts off"), (second.stop, "D", True, "leg 2 lands"),
        ):  # fmt: skip
            look = {"ms": 4.0} if filled else {"ms": 9.0, "mfc": "none", "mew": 1.1}
            place = motion.com[sample, :2] - [origin, 0.0]
            axis.plot(*place, color=REFERENCE, marker=marker, ls="", label=name, zorder=5, **look)
        axis.set(ylabel="y [m]", ylim=(-0.20, 0.20), xlim=(-AROUND, _step_length(motion) + AROUND))
        axis.set_aspect("equal")
        axis.grid(visible=False)
    axes[-1, 0].set_xlabel("x from the rear ankle [m]")
    numbered(axes, list(motions))
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=5)
    return figure


@styled
def ways_over_time(robot: Robot, motions: Mapping[str, Motion]) -> Figure:
    """CoM and ZMP along the path with the support polygon, each in its own time; below, their distance.

    Time 0 is the lift-off of leg 1. The numbers are the phases of Sec. II. The lower panel has one scale for all.
    """
    count = len(motions)
    figure, grid = panels(2, 5.0, columns=count, height_ratios=[1.2, 1.0])
    for axis in grid[1]:
        axis.remove()
    below = figure.add_subplot(grid[0, 0].get_gridspec()[1, :])
    shades = (SIMULATED, WAIST)
    for column, (name, motion) in enumerate(motions.items()):
        axis, origin = grid[0, column], _rear_ankle(motion)
        time = motion.time - motion.time[motion.samples(1).start]
        span = support_span(robot, motion)[:, :, 0] - origin
        axis.fill_between(time, span[:, 0], span[:, 1], color=SUPPORT, lw=0, label="support", zorder=0.5)
        axis.plot(time, motion.zmp[:, 0] - origin, color=ZMP, lw=2.6, label="ZMP, multi-body")
        axis.plot(time, motion.com[:, 0] - origin, color=COM, lw=1.2, label="CoM")
        lasting = (motion.samples(3).stop - motion.samples(1).start) * motion.dt
        axis.set(xlim=(max(time[0], -0.35 * lasting), min(time[-1], 1.35 * lasting)), xlabel="time [s]")
        axis.set_ylim(-0.35, _step_length(motion) + 0.45)
        _shade(axis, motion, time)
        axis.set_ylabel("x from the rear ankle [m]" if column == 0 else "")
        shown = (time >= -0.35 * lasting) & (time <= 1.35 * lasting)
        apart = 1e3 * np.linalg.norm(motion.zmp - motion.com[:, :2], axis=1)
        below.plot(time[shown], np.maximum(apart[shown], 1e-3), color=shades[column % 2], label=name)
    grid[0, 0].legend(loc="upper left")
    below.set(yscale="log", xlabel="time [s]", ylabel="ZMP from CoM [mm]", ylim=(2e-2, 1e3))
    below.legend(loc="upper right", ncols=count)
    numbered(np.array([*grid[0], below]), [*motions, "distance of the ZMP from the CoM's projection, same scale"])
    return figure


@styled
def duration_over_epsilon(
    epsilons: np.ndarray,
    durations: Mapping[str, np.ndarray],
    marks: Mapping[str, tuple[float, float]],
    rows: Sequence[Crossed],
    largest: float,
) -> Figure:
    """Durations over epsilon, the paper's numbers on the curves, and the crossings that succeeded in the physics.

    Args:
        epsilons: (n,) [m].
        durations: curves (n,) [s] by name: whole motion, lift-off to landing, double support.
        marks: the paper's numbers: epsilon [m] and duration [s] by name.
        rows: crossings of this obstacle.
        largest: largest epsilon with a plan [m]. Beyond it the ZMP may leave the soles.
    """
    figure, axes = panels(1, 3.4)
    axis = axes[0, 0]
    crossed = [row for row in rows if row.crossed and row.epsilon is not None]
    measured = [(row.epsilon, time) for row in crossed for time in (row.duration, row.over, row.double_support)]
    for (name, curve), colour in zip(durations.items(), (PLANNED, SIMULATED, WAIST), strict=True):
        axis.plot(1e3 * epsilons, curve, color=colour, label=name)
    axis.plot(*(np.array(measured, float).reshape(-1, 2) * [1e3, 1.0]).T, color=REFERENCE, marker="o", ms=4.5,
              mfc="white", ls="", label="crossed in the physics")  # fmt: skip
    axis.axvspan(
        1e3 * largest, 1e3 * epsilons[-1], color=OBSTACLE, alpha=0.15, lw=0, label="the ZMP may leave the soles"
    )
    for (name, (epsilon, duration)), marker in zip(marks.items(), "*sD^", strict=True):
        size, label = (9.0 if marker == "*" else 5.5), f"{name}: {1e3 * epsilon:.{2 if epsilon < 0.01 else 0}f} mm"
        axis.plot(1e3 * epsilon, duration, color=REFERENCE, marker=marker, ms=size, ls="", label=label, zorder=5)
    axis.set(xscale="log", yscale="log", xlabel="epsilon, ZMP from CoM at most [mm]", ylabel="duration [s]")
    axis.set(xlim=(0.9e3 * epsilons[0], 1e3 * epsilons[-1]))
    ticks = [tick for tick in (0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0) if tick <= 1.2e3 * epsilons.max()]
    axis.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axis.set_yticks([1, 2, 4, 10, 20, 40, 60], ["1", "2", "4", "10", "20", "40", "60"])
    axis.minorticks_off()
    axis.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0))
    return figure


@styled
def strategies_by_height(robot: Robot, lines: Mapping[str, Sequence[Crossed]]) -> Figure:
    """Clearance and knee torque in the physics by the obstacle's height. A cross marks a failed crossing.

    Args:
        robot: gives the torque limit of the knees.
        lines: rows by strategy.
    """
    figure, axes = panels(1, 3.1, columns=2)
    distance, torque = axes[0]
    for (name, rows), colour, marker in zip(lines.items(), (SIMULATED, WAIST), "os", strict=True):
        good = [row for row in rows if row.crossed]
        heights = 1e2 * np.array([row.height for row in good])
        planned, measured = (
            1e3 * np.array([getattr(row, key) for row in good], float)
            for key in ("planned_clearance", "simulated_clearance")
        )
        distance.plot(heights, planned, color=colour, ls="--", lw=1.0, label=f"{name}, planned")
        distance.plot(heights, measured, color=colour, marker=marker, ms=3.5, label=f"{name}, in the physics")
        torque.plot(heights, [row.knee_torque for row in good], color=colour, marker=marker, ms=3.5)
        failed = 1e2 * np.array([row.height for row in rows if not row.crossed])
        distance.plot(failed, np.full(len(failed), 1.5 if marker == "o" else 4.0), color=colour, marker="x", ms=4.5,
                      ls="", label=f"{name}: refused")  # fmt: skip
    margins = {row.margin for rows in lines.values() for row in rows if row.margin is not None}
    for k, margin in enumerate(sorted(margins)):
        distance.axhline(1e3 * margin, color=OBSTACLE, ls=":", lw=1.2, label="" if k else _margins(lines))
    limit = min(robot.body.effort_limits[robot.body.column(knee) - 7] for knee in robot.legs.knee)
    torque.axhline(limit, color=OBSTACLE, ls="--", lw=1.2)
    torque.text(0.02, limit, "limit of the model", transform=torque.get_yaxis_transform(), ha="left",
                va="bottom", fontsize=8.5)  # fmt: skip
    distance.set(ylabel="distance from obstacle [mm]", ylim=(0.0, 62.0))
    torque.set(ylabel="largest knee torque [N m]", ylim=(0.0, None))
    for axis in axes[0]:
        axis.set(xlabel="height of the bare obstacle [cm]")
        axis.margins(x=0.03)
    handles, names = distance.get_legend_handles_labels()
    order = [0, 1, 2, 6, 3, 4, 5][: len(names)]  # a column for each strategy
    figure.legend([handles[k] for k in order], [names[k] for k in order], loc="outside lower center", ncols=2)
    numbered(axes, ["clearance", "knees"])
    return figure


def _margins(lines: Mapping[str, Sequence[Crossed]]) -> str:
    """The margins kept by each strategy's plans, for a legend."""
    kept = {name: sorted({1e3 * row.margin for row in rows if row.margin is not None}) for name, rows in lines.items()}
    return "margin kept: " + ", ".join(
        f"{name} {' or '.join(f'{margin:g}' for margin in margins)} mm" for name, margins in kept.items()
    )


def _rear_ankle(motion: Motion) -> float:
    """Forward coordinate x of the rear ankle while leg 1 steps over [m]."""
    start = motion.samples(1).start
    return float(motion.foot(int(motion.support[start]))[start, 0])


def _step_length(motion: Motion) -> float:
    """X_ads [m]: from the rear ankle to the front one while both feet stand around the obstacle."""
    front = motion.samples(2).start
    return float(abs(motion.left_foot[front, 0] - motion.right_foot[front, 0]))


def _standing_places(motion: Motion, side: int) -> np.ndarray:
    """Sole poses (P, 7) at which a foot stands."""
    steps = motion.footsteps.of_side(side)
    landed = np.round((steps.time - motion.time[0]) / motion.dt).astype(int)
    return motion.foot(side)[[0, *landed]]


def _shade(axis: Axes, motion: Motion, time: np.ndarray) -> None:
    """Shade the phases and number them at the bottom of an axis, for times (N,) [s]."""
    for phase, colour in PHASES.items():
        samples = motion.samples(phase)
        start, end = time[samples.start], time[samples.stop]
        axis.axvspan(start, end, color=colour, alpha=0.06 if phase == 2 else 0.16, lw=0, zorder=0)
        axis.text((start + end) / 2.0, -0.33, str(phase), ha="center", va="bottom", fontsize=8.5)
