"""The crossing before and after its adaptation: Figs. 5 and 7, and the units that move the waist over the lead knee."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepover.analysis.outline import depth, outline
from stepover.analysis.stages import Stage, lead_knee, postures
from stepover.model.kinematics import Placements
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.motion.footsteps import LEG_1, LEG_2
from stepover.planning.algorithm_1.plan import Plan
from stepover.report.figures.style import (
    FIRST_STAGE,
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
)

STICK_EVERY = 0.1
"""Time between two sticks of Fig. 5 [s]."""
BEFORE = (0.0, (1.0, 1.0))
"""Line style for curves before an adaptation."""


@styled
def stick_diagram(robot: Robot, obstacle: Obstacle, before: Stage, after: Stage) -> Figure:
    """Fig. 5: the rear leg L1 ... L7 over phase 3, before and after FTA. Parts inside the margins are marked."""
    figure, axes = panels(1, 3.05, columns=2, sharey=True)
    for axis, stage in zip(axes[0], (before, after), strict=True):
        found = _sticks(axis, robot, obstacle, stage)
        draw_obstacle(axis, obstacle, 0.0)
        axis.axhline(0.0, color=REFERENCE, lw=1.0)
        axis.set(xlabel="x from the obstacle's front face [m]", xlim=(-0.56, 0.64), ylim=(-0.02, 0.76))
        axis.set_aspect("equal")
        axis.set_title(f"{stage.name}: {found}")
    axes[0, 0].set_ylabel("z [m]")
    lines, names = axes[0, 0].get_legend_handles_labels()
    figure.legend(lines, names, loc="outside lower center", ncols=4)
    return figure


@styled
def before_and_after(planned: Plan, plain: Stage, before: Stage, after: Stage) -> Figure:
    """Fig. 7: waist along the path before and after adaptation, with ZMP and CoM; also the feet and the waist's height.

    Args:
        planned: the finished plan.
        plain: the waist before any adaptation.
        before: input of FTA.
        after: output of FTA.
    """
    motion, time = planned.motion, planned.motion.time
    first, second = (planned.sequence.step(kind) for kind in (LEG_1, LEG_2))
    start, end = time[first.lift_off] - 0.8, time[second.touch_down] + 0.8
    shown = (time >= start) & (time <= end)
    figure, axes = panels(4, 7.6, sharex=True, height_ratios=[1.6, 1.0, 1.0, 0.7])
    along, forward, lift, height = axes[:, 0]
    curves: list[tuple[Axes, np.ndarray, dict[str, object]]] = [
        (along, motion.zmp[:, 0], {"color": PLANNED, "lw": 2.2, "label": "ZMP, multi-body"}),
        (along, motion.zmp_reference[:, 0], {"color": REFERENCE, "ls": "--", "lw": 0.9, "label": "ZMP, desired"}),
        (along, motion.com[:, 0], {"color": FIRST_STAGE, "label": "CoM, after"}),
        (along, plain.waist[:, 0], {"color": WAIST, "ls": BEFORE, "label": "waist, before"}),
        (along, motion.waist[:, 0], {"color": WAIST, "label": "waist, after"}),
        (height, before.waist[:, 2], {"color": WAIST, "ls": BEFORE, "label": "waist, before"}),
        (height, after.waist[:, 2], {"color": WAIST, "label": "waist, after"}),
    ]
    for side, name, colour in ((1, "left foot", LEFT), (-1, "right foot", RIGHT)):
        for axis, column in ((forward, 0), (lift, 2)):
            curves.append((axis, before.feet.foot(side)[:, column], {"color": colour, "ls": BEFORE, "zorder": 3,
                                                                     "label": f"{name}, before"}))  # fmt: skip
            curves.append((axis, after.feet.foot(side)[:, column], {"color": colour, "label": f"{name}, after"}))
    for axis, values, options in curves:
        axis.plot(time[shown], values[shown], **options)  # type: ignore[arg-type]
    front, width, top, _, margin = motion.obstacle[:5]
    for axis in (along, forward):
        axis.axhspan(front, front + width, color=OBSTACLE, alpha=0.45, lw=0, label="obstacle")
        axis.set_ylabel("x [m]")
    lift.axhline(top, color=OBSTACLE, lw=1.2, label="obstacle")
    lift.axhline(top + margin, color=OBSTACLE, lw=0.9, ls="--", label="with margin")
    for axis in (lift, height):
        axis.set_ylabel("z [m]")
    for axis in axes[:, 0]:
        axis.set_xlim(start, end)
        shade_phases(axis, motion, "long" if axis is along else "")
        handles, labels = axis.get_legend_handles_labels()
        own = [k for k, label in enumerate(labels) if axis is not lift or "foot" not in label]
        axis.legend([handles[k] for k in own], [labels[k] for k in own], loc="center left", bbox_to_anchor=(1.0, 0.5))
    height.set_xlabel("time [s]")
    numbered(axes, ["waist and ZMP", "feet, ahead", "feet, above the floor", "waist, above the floor"])
    return figure


@styled
def arms_and_lead_knee(robot: Robot, planned: Plan, stages: list[Stage]) -> Figure:
    """UBMG: p_ref2 of the arms, positive and negative, and the waist's response; waist and lead knee by stage."""
    motion, upper = planned.motion, planned.nominal.upper
    first, second = (planned.sequence.step(kind) for kind in (LEG_1, LEG_2))
    figure, axes = panels(2, 4.8, columns=2)
    (perturbation, knee), (answer, ahead) = axes
    p_ref2 = -1e3 * upper.zmp_change[:, 0]
    perturbation.plot(motion.time, p_ref2, color=REFERENCE, lw=1.0)
    for sign, colour, label in ((1.0, PLANNED, "above zero"), (-1.0, SIMULATED, "below zero")):
        part = np.maximum(sign * p_ref2, 0.0) * sign
        perturbation.fill_between(motion.time, part, color=colour, alpha=0.5, lw=0, label=label)
    answer.plot(motion.time, 1e3 * upper.waist_shift[:, 0], color=WAIST)
    low = 0.0
    colours = [*(SIMULATED, FIRST_STAGE, PLANNED)[: len(stages) - 1], WAIST]
    for stage, colour in zip(stages, colours, strict=True):
        time, angle, beyond = lead_knee(robot, stage)
        knee.plot(time, angle, color=colour, label=stage.name)
        lead = stage.waist[:, 0] - stages[0].waist[:, 0]
        ahead.plot(motion.time, 1e3 * lead, color=colour, label=stage.name)
        gone = np.flatnonzero(beyond > 0.0)
        if len(gone):
            low -= 6.5
            knee.plot(time[gone], np.full(len(gone), low), color=colour, lw=3.0)
            knee.annotate(f"{1e3 * beyond.max():.1f} mm out of reach  ", (time[gone[0]], low), ha="right", va="center",
                          fontsize=8.5)  # fmt: skip
    knee.axhline(robot.checks.knee_margin_deg, color=OBSTACLE, ls="--", lw=1.0)
    knee.axhline(0.0, color=OBSTACLE, lw=1.2)
    knee.text(motion.time[first.touch_down] - 0.6, -1.0, " straight", va="top", fontsize=8.5)
    knee.set_ylim(low - 5.0, 55.0)
    span = {knee: (motion.time[first.touch_down] - 0.6, motion.time[first.touch_down] + 0.02)}
    for axis, label in ((perturbation, "$p^{ref_2}_x$ [mm]"), (answer, "shift of the waist [mm]"),
                        (knee, "from straight [deg]"), (ahead, "x of the waist [mm]")):  # fmt: skip
        axis.set_ylabel(label)
        axis.margins(y=0.1)
        axis.set_xlim(span.get(axis, (motion.time[first.lift_off] - 0.2, motion.time[second.touch_down] + 0.2)))
        shade_phases(axis, motion)
    for axis in (answer, ahead):
        axis.set_xlabel("time [s]")
    titles = ["$p^{ref_2}$ of the arms", "lead knee before it lands", "response of the filter",
              "waist relative to that before adaptation"]  # fmt: skip
    numbered(axes, titles)
    perturbation.legend(loc="upper left")
    lines, names = knee.get_legend_handles_labels()
    figure.legend(lines, names, loc="outside lower center", ncols=2)
    return figure


def _sticks(axis: Axes, robot: Robot, obstacle: Obstacle, stage: Stage) -> str:
    """Draw sticks of the rear leg over phase 3, the deepest in bold. Returns a title that states the depth."""
    step = stage.sequence.step(LEG_2)
    q, missing = postures(robot, stage, slice(step.lift_off, step.touch_down + 1))
    placed = robot.body.placements(q)
    front = stage.sequence.front_face
    rectangle = obstacle.profile(0.0, margins=True)
    lines = [line - [front, 0.0] for line in outline(robot, placed, step.side)]
    depths = np.max([depth(line, rectangle).max(axis=1) for line in lines], axis=0)
    deepest = int(depths.argmax())
    colour, labelled = LEFT if step.side > 0 else RIGHT, depths.max() > 0.0
    for k in range(0, len(q), round(STICK_EVERY / robot.walk.sample_time)):
        axis.plot(*(leg_links(robot, placed, step.side, k) - [front, 0.0]).T, color=REFERENCE, lw=0.5, alpha=0.35,
                  label="hip, knee, ankle, sole" if k == 0 else None)  # fmt: skip
        for line in lines:
            axis.plot(*line[k].T, color=colour, lw=0.9, label="outline $L_1 \\ldots L_7$"
                      if k == 0 and line is lines[0] else None)  # fmt: skip
            _mark_inside(axis, line[k], rectangle, 1.6)
    for line in lines if labelled else ():
        axis.plot(*line[deepest].T, color=colour, lw=2.6, zorder=4,
                  label="deepest posture" if line is lines[0] else None)  # fmt: skip
        _mark_inside(axis, line[deepest], rectangle, 2.6, "inside the margins" if line is lines[0] else None)
    if missing.max() > 0.0:
        return f"{1e3 * missing.max():.0f} mm out of reach"
    when = stage.sequence.time[step.lift_off + deepest]
    return f"{1e3 * depths.max():.0f} mm inside at {when:.2f} s" if labelled else "free of the margins"


def _mark_inside(axis: Axes, line: np.ndarray, rectangle: np.ndarray, width: float, label: str | None = None) -> None:
    """Mark the part of a line (P, 2) that lies inside a rectangle."""
    inside = np.where(depth(line, rectangle)[:, None] > 0.0, line, np.nan)
    axis.plot(*inside.T, color=SIMULATED, lw=width, zorder=5, label=label)


def leg_links(robot: Robot, placed: Placements, side: int, sample: int) -> np.ndarray:
    """Hip, knee, ankle, heel and toe of a leg: (5, 2) [m]."""
    joints = robot.legs.left if side > 0 else robot.legs.right
    knee = next(joint for joint in robot.legs.knee if joint in joints)
    indices = [robot.body.index(joint) for joint in (joints[2], knee, joints[-1])]
    chain = placed.positions[sample, indices][:, [0, 2]]
    down = robot.foot.ankle_height
    sole = np.array([[0.0, 0.0, -down], [-robot.foot.heel, 0.0, -down], [robot.foot.toe, 0.0, -down]])
    foot = sole @ placed.rotations[sample, indices[-1]].T + placed.positions[sample, indices[-1]]
    return np.vstack([chain, foot[:, [0, 2]]])


def draw_obstacle(axis: Axes, obstacle: Obstacle, front: float) -> None:
    """The bare obstacle and its margins."""
    x_min, x_max, _, top = obstacle.profile(front, margins=False)
    axis.fill([x_min, x_min, x_max, x_max], [0.0, top, top, 0.0], color=OBSTACLE, alpha=0.8, zorder=3)
    left, right, _, high = obstacle.profile(front, margins=True)
    axis.plot([left, left, right, right], [0.0, high, high, 0.0], color=REFERENCE, lw=1.0, ls="--", zorder=3)
