"""Fig. 2: the planar biped and its feasibility domains; the domains by the obstacle's height; FU's own domain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from stepover.analysis.key_domain import KeyGrid, first_found
from stepover.analysis.planar.biped import leg_lines, planar_biped, planar_leg
from stepover.analysis.planar.domains import Domains
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.planning.algorithm_1.feasibility import KeyConfiguration
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
    styled,
)

FEASIBLE, INFEASIBLE = SIMULATED, RIGHT
"""The paper's red and blue, in shades that also differ in lightness."""
NAMES = {
    6: "Eq. (6), end of phase 1",
    7: "Eq. (7), throughout phase 2",
    8: "Eq. (8), start of phase 3",
    22: "Eq. (7) with Eq. (22)",
}
LINES = {7: (REFERENCE, "-", 2.6), 6: (FIRST_STAGE, "-", 2.0), 8: (PLANNED, "--", 1.3), 22: (WAIST, "-", 1.3)}
"""Colour, dashes and width of each domain's edge, in the order in which they are drawn."""
SHADES = ("#D6E6F4", "#ABCFE5", "#6AAED6", "#3787C0", "#105BA4", "#08306B")


@styled
def feasibility_domains(robot: Robot, obstacle: Obstacle, domains: Domains, key: KeyConfiguration) -> Figure:
    """Fig. 2: the planar biped, the domains under (6), (7) and (8), and that under (22) with a key configuration."""
    figure, axes = panels(2, 4.9, columns=3)
    _draw_biped(axes[0, 0], robot, obstacle, key)
    for axis, equation in zip(axes.ravel()[1:5], NAMES, strict=True):
        colours = ListedColormap([INFEASIBLE, FEASIBLE])
        x, z = domains.x_ads, domains.z_hds
        axis.pcolormesh(x, z, domains.masks[equation], cmap=colours, vmin=0, vmax=1, rasterized=True)
        _mark(axis, key)
        _plane(axis, domains)
    _overlay(axes[1, 2], domains)
    _mark(axes[1, 2], key)
    numbered(axes, ["planar biped", *NAMES.values(), "edges of all four"])
    handles: list[Artist] = [
        Patch(color=FEASIBLE, label="feasible"),
        Patch(color=INFEASIBLE, label="not feasible"),
        Line2D([], [], color=REFERENCE, marker="P", ms=7, mec="white", ls="", label="FU's key configuration"),
        *_edges({equation: f"({equation})" for equation in NAMES} | {22: "(7) with (22)"}),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), columnspacing=1.2)
    return figure


@styled
def domains_overlaid(domains: Domains, title: str) -> Figure:
    """The edges of the four domains in one plane, for use with a slider."""
    figure, axes = panels(1, 3.4)
    _overlay(axes[0, 0], domains)
    axes[0, 0].legend(handles=_edges(NAMES), loc="upper right")
    axes[0, 0].set_title(title)
    return figure


@styled
def areas_by_height(heights: np.ndarray, swept: Mapping[str, Sequence[Domains]]) -> Figure:
    """Areas of the domains over the obstacle's height (H,) [m], with a panel for each name."""
    figure, axes = panels(1, 2.7, columns=len(swept), sharey=True)
    for axis, line in zip(axes[0], swept.values(), strict=True):
        for equation, name in NAMES.items():
            colour, dashes, _ = LINES[equation]
            values = [domains.area(equation) for domains in line]
            axis.plot(1e2 * heights, values, color=colour, ls=dashes, label=name)
        axis.set(xlabel="height of the bare obstacle [cm]", ylim=(0.0, None))
    axes[0, 0].set_ylabel("area of the domain [m²]")
    axes[0, -1].legend(loc="upper right")
    numbered(axes, [f"obstacle, {name}" for name in swept])
    return figure


@styled
def key_domains(
    robot: Robot,
    grids: Sequence[KeyGrid],
    domains: Sequence[Mapping[float, np.ndarray]],
    widths: np.ndarray,
    frontiers: Mapping[str, np.ndarray],
) -> Figure:
    """FU's domain in 3-D by the obstacle's height, at two yaws, and the highest obstacle by its width.

    Args:
        robot: gives the limits of FU's own search.
        grids: one grid for each yaw.
        domains: for each grid, masks by height of the obstacle [m], ascending.
        widths: (W,) widths of the bare obstacle [m].
        frontiers: (W,) heights [m] by name, in pairs with the same colour. The second of each pair is dashed.
    """
    figure, axes = panels(1, 3.3, columns=3)
    longest, lowest = robot.feasibility.step_length_max, robot.feasibility.waist_height_min
    highest = robot.posture.waist_height
    for axis, grid, masks in zip(axes[0, :2], grids, domains, strict=True):
        for shade, mask in zip(SHADES, masks.values(), strict=False):
            if mask.any():
                axis.contourf(grid.x_ads, grid.z_hds, mask.astype(float), levels=[0.5, 1.5], colors=[shade])
            found = first_found(mask & grid.searched(robot), grid)
            if found is not None:
                axis.plot(*found, color=shade, marker="o", ms=5.5, mec=REFERENCE, mew=0.7, ls="", zorder=5)
        axis.plot([0.0, longest, longest, 0.0], [lowest, lowest, highest, highest], color=FEASIBLE, lw=1.1, ls="--")
        axis.set(xlabel="$X_{ads}$ [m]", ylabel="$Z_{hds}$ [m]", xlim=(0.3, 1.0), ylim=(0.4, 0.7))
    handles: list[Artist] = [
        Patch(color=shade, label=f"{1e2 * height:.0f} cm") for shade, height in zip(SHADES, domains[0], strict=False)
    ]
    handles.append(Line2D([], [], color=FEASIBLE, lw=1.1, ls="--", label="FU's search"))
    handles.append(Line2D([], [], color="white", marker="o", ms=5.5, mec=REFERENCE, ls="", label="found first"))
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), columnspacing=1.2)
    ended = False
    for number, (name, heights) in enumerate(frontiers.items()):
        colour, possible = (PLANNED, SIMULATED)[number // 2 % 2], np.where(heights > 0.0, heights, np.nan)
        axes[0, 2].plot(1e2 * widths, 1e2 * possible, color=colour, ls="--" if number % 2 else "-", label=name)
        last = int(np.isfinite(possible).sum()) - 1
        if 0 <= last < len(widths) - 1:
            axes[0, 2].plot(1e2 * widths[last], 1e2 * possible[last], color=colour, marker="x", ms=5.0, ls="")
            ended = True
    if ended:
        axes[0, 2].plot([], [], color=REFERENCE, marker="x", ms=5.0, ls="", label="widest feasible")
    axes[0, 2].set(xlabel="width of the bare obstacle [cm]", ylabel="highest obstacle [cm]")
    axes[0, 2].set(xlim=(0.0, None), ylim=(0.0, 60.0))
    axes[0, 2].legend(loc="upper right", fontsize=8)
    numbered(axes, [*(f"waist yaw {grid.yaw_deg:.0f}°" for grid in grids), "frontier of FU"])
    return figure


def _plane(axis: Axes, domains: Domains) -> None:
    """The plane of Fig. 2."""
    axis.set(xlabel="$X_{ads}$ [m]", ylabel="$Z_{hds}$ [m]")
    axis.set(xlim=(domains.x_ads[0], domains.x_ads[-1]), ylim=(domains.z_hds[0], domains.z_hds[-1]))


def _mark(axis: Axes, key: KeyConfiguration) -> None:
    """A key configuration as a cross."""
    axis.plot(key.x_ads, key.z_hds, color=REFERENCE, marker="P", ms=7, mec="white", mew=0.8, ls="", zorder=5)


def _overlay(axis: Axes, domains: Domains) -> None:
    """Edges of all domains in one plane."""
    x, z = domains.x_ads, domains.z_hds
    for equation, (colour, dashes, width) in LINES.items():
        mask = domains.masks[equation].astype(float)
        if mask.any():
            axis.contour(x, z, mask, levels=[0.5], colors=colour, linestyles=dashes, linewidths=width)
    _plane(axis, domains)


def _edges(names: Mapping[int, str]) -> list[Line2D]:
    """Entries of a legend for the domains' edges, by equation."""
    styles = {equation: LINES[equation] for equation in names}
    return [Line2D([], [], color=c, ls=d, lw=w, label=names[e]) for e, (c, d, w) in styles.items()]


def _draw_biped(axis: Axes, robot: Robot, obstacle: Obstacle, key: KeyConfiguration) -> None:
    """Fig. 2, top left: links, joints, points, outline and feet in a key configuration over the obstacle."""
    biped = planar_biped(robot)
    x_min, x_max, _, top = obstacle.profile(key.front_face(robot, obstacle), margins=False)
    axis.fill([x_min, x_min, x_max, x_max], [0.0, top, top, 0.0], color=OBSTACLE, alpha=0.8)
    corners = [(x_min, 0.0), (x_min, top), (x_max, top), (x_max, 0.0)]
    for number, (x, z) in enumerate(corners, start=1):
        side, away = ("right", -3) if x == x_min else ("left", 3)
        axis.annotate(f"$o_{number}$", (x, z), (away, -3), textcoords="offset points", ha=side, va="top", fontsize=8)
    for start, hip, colour in ((0.0, key.x_hds, LEFT), (key.x_ads, key.x_hds - key.x_ads, PLANNED)):
        lines = leg_lines(biped, planar_leg(biped, np.asarray(hip), np.asarray(key.z_hds)))
        links, *outline = (line + np.array([start, 0.0]) for line in lines)
        for line in outline:
            axis.plot(*line.T, color=colour, lw=0.9)
        axis.plot(*links.T, color=colour, lw=2.2, marker="o", ms=4, mfc="white")
        axis.plot([start, start], [0.0, biped.ankle_height], color=colour, lw=1.0, ls=":")
        axis.plot([start - biped.foot / 2.0, start + biped.foot / 2.0], [0.0, 0.0], color=colour, lw=3.5)
        rear = start == 0.0
        names = (
            {"x_1, q_1": (-6, 0), "x_2, q_2": (-21, 7), "x_3, q_3": (0, 6)}
            if rear
            else {"x_5": (7, 0), "x_4, q_4": (21, 5)}
        )
        for (name, shift), point in zip(names.items(), links, strict=False):
            side = "right" if shift[0] < 0 else "left" if shift[0] > 0 else "center"
            far = {"arrowstyle": "-", "lw": 0.5, "shrinkA": 0, "shrinkB": 2.5} if abs(shift[0]) > 10 else None
            axis.annotate(f"${name}$", point, shift, textcoords="offset points", fontsize=8, ha=side,
                          va="center" if shift[0] else "bottom", arrowprops=far)  # fmt: skip
        for number, middle in zip((1, 2) if rear else (4, 3), (links[:-1] + links[1:]) / 2.0, strict=True):
            axis.annotate(
                f"$l_{number}$", middle, (5, 2) if number == 3 else (3, -4), textcoords="offset points", fontsize=8
            )
    axis.plot([-0.22, 0.72], [0.0, 0.0], color=REFERENCE, lw=0.8)
    axis.set_aspect("equal")
    axis.set(xlim=(-0.22, 0.72), ylim=(-0.11, 0.77), xlabel="x [m]", ylabel="z [m]")
