"""The planned motion: the key configuration of Fig. 1, Figs. 8 and 9, and the two forms of preview control."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepover.model.robot import Robot
from stepover.model.support import corners_on_floor
from stepover.motion.motion import Motion
from stepover.planning.algorithm_1.preview_control import CartMotion
from stepover.report.figures.style import (
    AXES,
    FIRST_STAGE,
    LEFT,
    OBSTACLE,
    PLANNED,
    REFERENCE,
    RIGHT,
    SIMULATED,
    SUPPORT,
    WAIST,
    numbered,
    panels,
    styled,
    time_axis,
)


@styled
def walking_direction(motion: Motion) -> Figure:
    """Fig. 8: ZMP and waist along the path, and the feet ahead and above the floor."""
    figure, axes = panels(3, 6.0, sharex=True, height_ratios=[1.2, 1.0, 1.0])
    time, (front, width, height) = motion.time, motion.obstacle[:3]
    above, forward, lift = axes[:, 0]
    above.plot(time, motion.waist[:, 0], color=WAIST, label="waist")
    above.plot(time, motion.zmp[:, 0], color=PLANNED, lw=2.4, label="ZMP, multi-body")
    above.plot(time, motion.zmp_reference[:, 0], color=REFERENCE, ls="--", lw=0.9, label="ZMP, desired")
    for name, foot, colour in (("left", motion.left_foot, LEFT), ("right", motion.right_foot, RIGHT)):
        forward.plot(time, foot[:, 0], color=colour, label=f"{name} foot")
        lift.plot(time, foot[:, 2], color=colour, label=f"{name} foot")
    for axis in (above, forward):
        axis.axhspan(front, front + width, color=OBSTACLE, alpha=0.45, lw=0, label="obstacle")
        axis.set_ylabel("x [m]")
    lift.axhline(height, color=OBSTACLE, lw=1.2)
    lift.axhline(height + motion.obstacle[4], color=OBSTACLE, lw=0.9, ls=":")
    lift.text(time[-1], height, "obstacle ", ha="right", va="top", fontsize=8.5)
    lift.text(time[-1], height + motion.obstacle[4], "with margin ", ha="right", va="bottom", fontsize=8.5)
    lift.set_ylabel("z [m]")
    time_axis(axes[:, 0], motion)
    numbered(axes, ["ZMP and waist", "feet, ahead", "feet, above the floor"])
    for axis in axes[:, 0]:
        axis.legend(loc="upper left")
    return figure


@styled
def lateral_direction(robot: Robot, motion: Motion) -> Figure:
    """Fig. 9: ZMP and waist across the path; below, the ZMP after the first and the second preview stage."""
    figure, axes = panels(3, 6.0, sharex=True, sharey=True)
    time, span = motion.time, 1e3 * support_span(robot, motion)
    for axis in axes[:, 0]:
        axis.fill_between(time, span[:, 0, 1], span[:, 1, 1], color=SUPPORT, lw=0, label="support", zorder=0.5)
        axis.set_ylabel("y [mm]")
    curves: list[tuple[Axes, np.ndarray, str, str]] = [
        (axes[0, 0], motion.waist, WAIST, "waist"),
        (axes[0, 0], motion.zmp, PLANNED, "ZMP, multi-body"),
        (axes[2, 0], motion.zmp, PLANNED, "ZMP after the second stage"),
    ]
    if motion.zmp_first_stage is not None:
        curves.append((axes[1, 0], motion.zmp_first_stage, FIRST_STAGE, "ZMP after the first stage"))
    for axis, values, colour, label in curves:
        axis.plot(time, 1e3 * values[:, 1], color=colour, lw=1.3 if values is motion.waist else 2.4, label=label)
    for axis in axes[:, 0]:
        axis.plot(time, 1e3 * motion.zmp_reference[:, 1], color=REFERENCE, ls="--", lw=0.9, label="ZMP, desired")
        axis.legend(loc="lower right", ncols=4)
        axis.set_ylim(-295, 190)
    time_axis(axes[:, 0], motion)
    numbered(axes, ["ZMP and waist", "cart model alone (CWTG1)", "with the dynamic filter (CWTG2)"])
    return figure


@styled
def preview_forms(motion: Motion, kajita: CartMotion, wieber: CartMotion) -> Figure:
    """Kajita's form and Eqs. (16)-(18) with the same reference: the differences of their ZMPs and CoMs."""
    figure, axes = panels(2, 5.0, columns=2, width_ratios=[1.3, 1.0])
    time, reference = motion.time, motion.zmp_reference
    forms = [("Kajita [13]", kajita, PLANNED, 3), ("Eqs. (16)-(18)", wieber, SIMULATED, 2)]
    apart = np.abs(kajita.zmp - wieber.zmp)
    sample, axis_of = np.unravel_index(apart.argmax(), apart.shape)
    near = slice(max(0, sample - 60), min(len(time), sample + 60))
    zoom = axes[0, 1]
    for name, form, colour, order in forms:
        error = 1e3 * (form.zmp - reference)
        axes[0, 0].plot(time, error[:, 0], color=colour, lw=1.0, zorder=order, label=name)
        axes[1, 0].plot(time, error[:, 1], color=colour, lw=1.0, zorder=order, label=name)
        zoom.plot(time[near], 1e3 * form.zmp[near, axis_of], color=colour, label=name)
    zoom.plot(time[near], 1e3 * reference[near, axis_of], color=REFERENCE, ls="--", lw=0.9, label="desired")
    zoom.set_ylabel(f"ZMP, {'xy'[axis_of]} [mm]")
    for axis, name in enumerate("xy"):
        difference = 1e3 * (wieber.position - kajita.position)[:, axis]
        axes[1, 1].plot(time, difference, color=AXES[name], lw=1.0, label=name)
    axes[0, 0].set_ylabel("ZMP error, x [mm]")
    axes[1, 0].set_ylabel("ZMP error, y [mm]")
    axes[1, 1].set_ylabel("Eqs. (16)-(18) \N{MINUS SIGN} Kajita [mm]")
    for axis in (axes[0, 0], axes[1, 0], axes[1, 1]):
        time_axis(np.array([axis]), motion, names="short")
    zoom.set_xlabel("time [s]")
    titles = ["error of the ZMP, x", "where they differ most", "error of the ZMP, y", "CoM"]
    numbered(axes, titles)
    for axis in axes.ravel():
        axis.margins(y=0.25 if axis is not zoom else 0.05)
        axis.legend(loc="upper left" if axis is zoom else "upper right", ncols=1 if axis is zoom else 2)
    return figure


def support_span(robot: Robot, motion: Motion) -> np.ndarray:
    """Least and largest x and y of the support polygon: (N, 2, 2), [:, 0] least, [:, 1] largest [m]."""
    changes = np.flatnonzero(np.diff(motion.support)) + 1
    span = np.empty((len(motion.time), 2, 2))
    for first, last in zip([0, *changes], [*changes, len(motion.time)], strict=True):
        sides = [side for side in (1, -1) if motion.support[first] in (0, side)]
        corners = np.vstack([corners_on_floor(robot, side, motion.foot(side)[first]) for side in sides])
        span[first:last] = corners.min(axis=0), corners.max(axis=0)
    return span
