"""The optimising planner beside Algorithm 1: what each can cross, and how much of the joints' limits each needs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from stepover.model.robot import Robot
from stepover.model.support import zmp_margin
from stepover.motion.motion import Motion
from stepover.planning.optimal.torques import torques
from stepover.report.figures.style import PLANNED, REFERENCE, SIMULATED, WAIST, panels, styled, time_axis
from stepover.studies.optimal.frontier import Found
from stepover.studies.sweep import Crossing

COLOURS = (SIMULATED, PLANNED, WAIST)
ENOUGH = 0.02
"""Clearance with real motors that counts as a crossing with room to spare [m]."""


@styled
def frontier(paper: Sequence[Crossing], found: Sequence[Found]) -> Figure:
    """Which obstacles both planners cross, by height and width."""
    figure, axes = panels(1, 4.4)
    axis = axes[0, 0]
    known = [(row.width, row.height) for row in paper if row.planned and row.crossed]
    axis.scatter(*_cm(known), s=64, marker="s", color=SIMULATED, alpha=0.35, lw=0, label="Algorithm 1 crosses")
    real = [row for row in found if row.planned and (row.mujoco_real or 0.0) >= ENOUGH]
    near = [row for row in found if row.planned and 0.0 <= (row.mujoco_real or 0.0) < ENOUGH]
    failed = [row for row in found if row.planned and (row.mujoco_real or 0.0) < 0.0]
    refused = [row for row in found if not row.planned]
    for rows, style, label in (
        (real, {"marker": "o", "color": PLANNED}, "optimiser crosses, real motors too"),
        (near, {"marker": "o", "facecolor": "white", "edgecolor": PLANNED}, "the same, by less than 20 mm"),
        (failed, {"marker": "v", "color": SIMULATED}, "it falls or touches with real motors"),
        (refused, {"marker": "x", "color": REFERENCE}, "optimiser refuses"),
    ):
        if rows:
            axis.scatter(*_cm([(row.width, row.height) for row in rows]), s=20, label=label, **style)
    axis.set(xlabel="width [cm]", ylabel="height [cm]", xlim=(0.0, 32.0), ylim=(0.0, 53.0))
    figure.legend(loc="outside upper center", ncols=2)
    return figure


@styled
def limits_used(robot: Robot, motions: Mapping[str, Motion]) -> Figure:
    """How much of the speed and torque limits the joint that needs most takes, and the ZMP's margin, over time."""
    figure, axes = panels(3, 5.6, sharex=True)
    speed, torque, margin = axes[:, 0]
    for colour, (name, motion) in zip(COLOURS, motions.items(), strict=False):
        moving = np.gradient(motion.q[:, 7:], motion.dt, axis=0) / robot.body.speed_limits
        needed = torques(robot, motion) / robot.body.effort_limits
        apart = zmp_margin(robot, motion.zmp, motion.support, motion.left_foot, motion.right_foot)
        for axis, values in (
            (speed, np.abs(moving).max(axis=1)),
            (torque, np.abs(needed).max(axis=1)),
            (margin, apart),
        ):
            axis.plot(motion.time, 1e3 * values if axis is margin else values, color=colour, label=name)
    for axis, text in ((speed, "largest speed\nover its limit"), (torque, "largest torque\nover its limit")):
        axis.axhline(1.0, color=REFERENCE, lw=0.9, ls="--", label="limit" if axis is speed else None)
        axis.set_ylabel(text)
    margin.set_ylabel("ZMP to the support's\nedge [mm]")
    time_axis(axes[:, 0], next(iter(motions.values())))
    figure.legend(*speed.get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


def _cm(sizes: Sequence[tuple[float, float]]) -> tuple[np.ndarray, np.ndarray]:
    """Widths and heights [cm]."""
    width, height = 1e2 * np.array(sizes).reshape(-1, 2).T
    return width, height
