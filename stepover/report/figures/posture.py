"""Fig. 1: the key configuration, with the outline L1 ... L7 of both legs, the obstacle, and the dimensions."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.spatial import ConvexHull

from stepover.analysis.key_posture import key_posture
from stepover.model.collision import profile
from stepover.model.kinematics import Placements
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.planning.algorithm_1.feasibility import KeyConfiguration
from stepover.report.figures.style import LEFT, OBSTACLE, REFERENCE, RIGHT, panels, styled


@styled
def key_configuration(robot: Robot, obstacle: Obstacle, key: KeyConfiguration) -> Figure:
    """Fig. 1: the posture of the double support over the obstacle, seen from the right."""
    placed = robot.body.placements(key_posture(robot, key)[None])
    figure, axes = panels(1, 6.2)
    axis = axes[0, 0]
    _draw_obstacle(axis, obstacle, key.front_face(robot, obstacle))
    leading = key.leading
    for side in (1, -1):  # the left leg is behind the right one
        _draw_leg(axis, robot, placed, side, "front leg" if side == leading else "rear leg", side != leading)
    _dimensions(axis, key)
    axis.plot(key.x_hds, key.z_hds, color=REFERENCE, marker="P", ms=7, ls="", label="waist", zorder=5)
    axis.plot([-0.28, 0.72], [0.0, 0.0], color=REFERENCE, lw=1.0)
    axis.set(xlabel="x from the rear ankle [m]", ylabel="z [m]", xlim=(-0.28, 0.72), ylim=(-0.17, 0.82))
    axis.set_aspect("equal")
    axis.legend(loc="upper right")
    return figure


def _draw_leg(axis: Axes, robot: Robot, placed: Placements, side: int, label: str, named: bool) -> None:
    """Collision shapes, outline and links of one leg."""
    colour = LEFT if side > 0 else RIGHT
    joints = robot.legs.left if side > 0 else robot.legs.right
    indices = [robot.body.index(joint) for joint in joints]
    knee = next(robot.body.index(joint) for joint in robot.legs.knee if joint in joints)
    for shape in robot.shapes:
        if shape.joint in indices:
            _fill(axis, profile(shape, placed)[0], colour, edged=shape.joint != knee)
    centres = placed.positions[0, indices][:, [0, 2]]
    sole = centres[-1] - [0.0, robot.foot.ankle_height]
    axis.plot(*np.vstack([centres, sole]).T, color=colour, lw=1.0, ls=":", marker="o", ms=3)
    rotation, centre = placed.rotations[0, knee][np.ix_([0, 2], [0, 2])], placed.positions[0, knee, [0, 2]]
    name = f"{label} ({'left' if side > 0 else 'right'}), outline $L_1 \\ldots L_7$"
    number = 0
    for line in (robot.outline.front, robot.outline.rear):
        points = np.array(line) @ rotation.T + centre
        axis.plot(*points.T, color=colour, lw=2.2, marker="o", ms=4, mec="white", mew=0.5, label=name)
        name = ""
        outward = np.sign(points.mean(axis=0)[0] - centre[0]) * 8.0
        for point in points:
            number += 1
            if named:
                axis.annotate(f"$L_{number}$", point, (outward, 2), textcoords="offset points",
                              ha="left" if outward > 0 else "right", fontsize=9)  # fmt: skip


def _fill(axis: Axes, points: np.ndarray, colour: str, edged: bool) -> None:
    """The convex outline of points (V, 2), filled lightly."""
    corners = points[ConvexHull(points).vertices]
    axis.fill(*corners.T, color=colour, alpha=0.22, lw=0, aa=edged)
    if edged:
        axis.fill(*corners.T, fill=False, edgecolor=colour, lw=0.6, alpha=0.7)


def _draw_obstacle(axis: Axes, obstacle: Obstacle, front: float) -> None:
    """The bare obstacle O1 ... O4 and the box of its margins."""
    x_min, x_max, _, z_max = obstacle.profile(front, margins=False)
    axis.fill([x_min, x_min, x_max, x_max], [0.0, z_max, z_max, 0.0], color=OBSTACLE, alpha=0.8, label="obstacle")
    left, right, _, top = obstacle.profile(front, margins=True)
    axis.plot([left, left, right, right], [0.0, top, top, 0.0], color=REFERENCE, lw=1.0, ls="--", label="with margins")
    corners = [(x_min, 0.0), (x_min, z_max), (x_max, z_max), (x_max, 0.0)]
    for number, (x, z) in enumerate(corners, start=1):
        outside = (-1.5 if x == x_min else 1.5, 2 if z == 0.0 else -1)
        axis.annotate(f"$O_{number}$", (x, z), outside, textcoords="offset points", fontsize=8,
                      ha="right" if x == x_min else "left", va="bottom" if z == 0.0 else "top")  # fmt: skip


def _dimensions(axis: Axes, key: KeyConfiguration) -> None:
    """X_ads and X_hds under the floor, Z_hds beside the waist."""
    for length, depth, name in ((key.x_hds, -0.05, "hds"), (key.x_ads, -0.11, "ads")):
        _arrow(axis, (0.0, depth), (length, depth))
        axis.text(length / 2.0, depth - 0.008, f"$X_{{{name}}}$ = {length:.3f} m", ha="center", va="top")
        axis.plot([length, length], [depth - 0.015, 0.0], color=REFERENCE, lw=0.5)
    axis.plot([0.0, 0.0], [-0.125, 0.0], color=REFERENCE, lw=0.5)
    at = -0.2
    _arrow(axis, (at, 0.0), (at, key.z_hds))
    axis.plot([at - 0.015, key.x_hds], [key.z_hds, key.z_hds], color=REFERENCE, lw=0.5)
    axis.text(at - 0.01, key.z_hds / 2.0, f"$Z_{{hds}}$ = {key.z_hds:.3f} m", rotation=90, ha="right", va="center")


def _arrow(axis: Axes, start: tuple[float, float], end: tuple[float, float]) -> None:
    """A dimension line with two heads."""
    axis.annotate("", end, start, arrowprops={"arrowstyle": "<->", "lw": 0.8, "shrinkA": 0, "shrinkB": 0})
