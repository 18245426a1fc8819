"""The whole crossing in one picture: the robot from the side, the ZMP and the clearance; or why there is no plan."""

from __future__ import annotations

import textwrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.motion.footsteps import LEG_1, LEG_2
from stepover.planning.algorithm_1.plan import Plan
from stepover.planning.measures import Measures, measure
from stepover.report.figures.adapted import draw_obstacle, leg_links
from stepover.report.figures.planned import support_span
from stepover.report.figures.simulated import EVERY, SHOWN, clearance_over_time
from stepover.report.figures.style import (
    FIRST_STAGE,
    LEFT,
    OBSTACLE,
    PLANNED,
    REFERENCE,
    RIGHT,
    SUPPORT,
    numbered,
    panels,
    shade_phases,
    styled,
)

HEIGHT = 4.1
"""Height of a picture [in]."""
WAY, TALL = 1.3, 2.15
"""Extent of the side view to either side of the obstacle and above the floor, over the height of the waist."""
AROUND = 0.9
"""Time shown before leg 1 lifts off and after leg 2 lands [s]."""
FAINT = 0.4
"""Opacity of the postures in single support."""


@styled
def crossing(robot: Robot, planned: Plan) -> Figure:
    """A plan: three postures and the paths of the soles; ZMP and CoM along the path; distance of the nearest link."""
    motion, found = planned.motion, measure(robot, planned.motion)
    figure, axes = panels(2, HEIGHT, columns=2, width_ratios=[1.25, 1.0])
    zmp, free = axes[:, 1]
    for axis in axes[:, 0]:
        axis.remove()
    side = _side_view(figure.add_subplot(axes[0, 0].get_gridspec()[:, 0]), robot)
    front, width, height, beside, above = motion.obstacle[:5]
    home = np.eye(1, motion.q.shape[1])[0] * front
    for foot, colour in ((motion.left_foot, LEFT), (motion.right_foot, RIGHT)):
        side.plot(foot[:, 0] - front, foot[:, 2], color=colour, lw=0.8, ls="--")
    for sample, share in zip(_moments(planned), (FAINT, 1.0, FAINT), strict=True):
        _posture(side, robot, motion.q[sample] - home, share)
    draw_obstacle(side, Obstacle(height, width, above, beside), 0.0)
    side.legend(loc="upper right")
    time, span = motion.time, support_span(robot, motion)[:, :, 0] - front
    zmp.fill_between(time, span[:, 0], span[:, 1], color=SUPPORT, lw=0, label="support", zorder=0.5)
    zmp.axhspan(0.0, width, color=OBSTACLE, alpha=0.45, lw=0, label="obstacle")
    zmp.plot(time, motion.zmp[:, 0] - front, color=PLANNED, lw=2.0, label="ZMP")
    zmp.plot(time, motion.com[:, 0] - front, color=FIRST_STAGE, label="CoM")
    zmp.set_ylabel("x [m]")
    zmp.legend(loc="upper left", ncols=2, columnspacing=1.0)
    free.plot(time[::EVERY], 1e3 * clearance_over_time(robot, motion, motion.q), color=PLANNED, label="nearest link")
    free.axhline(1e3 * min(beside, above), color=OBSTACLE, ls=":", lw=1.2, label="safety margin")
    free.axhline(0.0, color=OBSTACLE, lw=1.5)
    free.set(ylabel="clearance [mm]", ylim=(-10.0, 1e3 * SHOWN))
    free.legend(loc="upper center")
    for axis, names in ((zmp, "long"), (free, "")):
        axis.set_xlim(time[motion.samples(1).start] - AROUND, time[motion.samples(3).stop] + AROUND)
        shade_phases(axis, motion, names)
    zmp.set_xticklabels([])
    free.set_xlabel("time [s]")
    numbered(np.array([side, zmp, free]), ["leg 1 over it, double support, leg 2 over it", "ahead", "clearance"])
    title = textwrap.fill(f"{_size(height, width)}: {_numbers(robot, planned, found)}", 125)
    figure.suptitle(title, fontsize=9, x=0.01, ha="left")
    return figure


@styled
def refused(robot: Robot, obstacle: Obstacle, reason: str) -> Figure:
    """An obstacle that cannot be crossed: the robot before it, and the planner's reason."""
    figure, axes = panels(1, HEIGHT)
    side = _side_view(axes[0, 0], robot)
    q = robot.half_sitting().copy()
    q[0] -= obstacle.margin_width + robot.foot.toe + 0.1
    _posture(side, robot, q)
    draw_obstacle(side, obstacle, 0.0)
    why = f"{_size(obstacle.height, obstacle.width)}: cannot be crossed. {reason}".replace(" = ", "\u00a0=\u00a0")
    figure.suptitle(textwrap.fill(why, 125), fontsize=9, x=0.01, ha="left")
    return figure


def _size(height: float, width: float) -> str:
    """An obstacle in a title."""
    return f"{1e2 * height:.3g} cm high, {1e2 * width:.3g} cm wide"


def _numbers(robot: Robot, planned: Plan, found: Measures) -> str:
    """Numbers of a plan for a title. It names adaptations only if there are any."""
    lowered = robot.posture.waist_height - planned.motion.waist[:, 2].min()
    arms, back = np.degrees(planned.nominal.upper.arm_swing), planned.adaptation.shift
    done = {
        f"waist down by {1e3 * lowered:.0f} mm": lowered > 5e-4,
        f"arms back by {arms:.0f}°": arms > 0.5,
        f"trailing foot held back by {1e3 * back:.0f} mm": back > 5e-4,
    }
    return (
        ", ".join([f"step {1e2 * planned.key.x_ads:.1f} cm", *(name for name, so in done.items() if so)]) + ", "
        f"clearance {1e3 * found.clearance_min:.1f} mm, ZMP inside the support polygon by "
        f"{1e3 * found.zmp_margin_min:.0f} mm at least"
    )


def _moments(planned: Plan) -> list[int]:
    """Three samples: leg 1 above the obstacle's middle, the double support, leg 2 above the middle."""
    motion, steps = planned.motion, [planned.sequence.step(kind) for kind in (LEG_1, LEG_2)]
    middle = motion.obstacle[0] + motion.obstacle[1] / 2.0
    above = []
    for step in steps:
        way = motion.foot(step.side)[step.lift_off : step.touch_down, 0]
        above.append(step.lift_off + int(np.searchsorted(way, middle)))
    return [above[0], (steps[0].touch_down + steps[1].lift_off) // 2, above[1]]


def _side_view(side: Axes, robot: Robot) -> Axes:
    """Axes for the floor around the obstacle and the robot above it, with one scale for both directions."""
    way, tall = (share * robot.posture.waist_height for share in (WAY, TALL))
    side.axhline(0.0, color=REFERENCE, lw=1.0)
    side.set(xlabel="x from the obstacle's front face [m]", ylabel="z [m]", xlim=(-way, way), ylim=(-0.03, tall))
    side.set_aspect("equal")
    side.grid(visible=False)
    return side


def _posture(axis: Axes, robot: Robot, q: np.ndarray, share: float = 1.0) -> None:
    """Draw a configuration (nq,) from the side as sticks from joint to joint, with an opacity."""
    placed, body = robot.body.placements(q[None]), robot.body
    places, legs = placed.positions[0][:, [0, 2]], {*robot.legs.left, *robot.legs.right}
    left, right = (leg_links(robot, placed, side, 0) for side in (1, -1))
    above = [
        np.array([places[1 if parent == "root_joint" else body.index(parent)], places[body.index(joint)]])
        for joint in body.joint_names if joint not in legs for parent in [body.origin(joint)[2]]
    ]  # fmt: skip
    sticks = [(left, LEFT, 2.2, "left leg"), *((ends, REFERENCE, 1.4, "") for ends in above),
              (right, RIGHT, 2.2, "right leg")]  # fmt: skip
    for ends, colour, width, name in sticks:  # the left leg is behind the right one
        paler = 1.0 - share * (1.0 - np.array(to_rgb(colour)))
        axis.plot(*ends.T, color=paler, lw=width, marker="o", ms=2.0, zorder=2.0 + share,
                  label=name if name and share == 1.0 else None)  # fmt: skip
