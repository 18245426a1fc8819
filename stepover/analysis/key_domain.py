"""The domain in which FU searches: all key configurations of the robot in 3-D, and its frontier. Sec. III-A, III-C3.

FU takes the first key configuration that it meets. Here all of them are judged, with the same legs and the same
obstacle with its margins, X_hds by Eq. (22), over FU's range of X_ads and Z_hds or a wider one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stepover.errors import InvalidInput
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.planning.algorithm_1.feasibility import KeyCandidates, front_face, key_postures

FINER = 11
"""Points of the finer grid between a posture's neighbours."""
FURTHER = 0.03
"""How much higher the finer grid may find an obstacle [m]."""


@dataclass(frozen=True, eq=False)
class KeyGrid:
    """Step lengths (M,) and waist heights (N,) that are tried, at one waist yaw.

    Attributes:
        x_ads, z_hds: both ascending [m].
        yaw_deg: of the waist, that brings the right hip ahead [deg].
    """

    x_ads: np.ndarray
    z_hds: np.ndarray
    yaw_deg: float

    def searched(self, robot: Robot) -> np.ndarray:
        """Where FU looks, (N, M) bool: steps no longer, the waist neither lower nor higher than its search goes."""
        search = robot.feasibility
        rows = (self.z_hds >= search.waist_height_min - 1e-9) & (self.z_hds <= robot.posture.waist_height + 1e-9)
        return np.outer(rows, self.x_ads <= search.step_length_max + 1e-9)


def key_grid(robot: Robot, step: float, yaw_deg: float, x_ads_max: float = 1.0, z_hds_min: float = 0.35) -> KeyGrid:
    """Grid of so many metres a step, up to a given step length, down to a given height from the leg's length.

    One of its heights is that of the waist in half-sitting, where FU starts.

    Raises:
        InvalidInput: a step that is not positive, or nothing between the limits.
    """
    length = robot.leg(1).length
    if not 0.0 < step < np.inf or not 0.0 < z_hds_min < length or not step < x_ads_max < np.inf:
        raise InvalidInput(f"step = {step!r}, x_ads_max = {x_ads_max!r}, z_hds_min = {z_hds_min!r} leave no grid")
    normal = robot.posture.waist_height
    heights = normal + step * np.arange(np.ceil((z_hds_min - normal) / step), (length - normal) / step)
    return KeyGrid(step * np.arange(1, round(x_ads_max / step) + 1), heights, yaw_deg)


def key_domain(robot: Robot, obstacle: Obstacle, grid: KeyGrid) -> np.ndarray:
    """Which key configurations of a grid FU would accept: (N, M) bool, heights by step lengths."""
    x_ads, z_hds = np.meshgrid(grid.x_ads, grid.z_hds)
    return _good(robot, obstacle, _candidates(robot, grid, x_ads.ravel(), z_hds.ravel())).reshape(x_ads.shape)


def first_found(domain: np.ndarray, grid: KeyGrid) -> tuple[float, float] | None:
    """X_ads and Z_hds [m] of the first key configuration in FU's order: step length up, waist height down."""
    if not domain.any():
        return None
    step = int(domain.any(axis=0).argmax())
    return float(grid.x_ads[step]), float(grid.z_hds[np.flatnonzero(domain[:, step])[-1]])


def highest_obstacle(
    robot: Robot, width: float, grid: KeyGrid, where: np.ndarray | None = None, resolution: float = 0.001
) -> float:
    """FU's frontier: height [m] of the highest bare obstacle of a width for which there is a key configuration.

    By bisection over the height, since what is in the way of a lower obstacle is in the way of a higher one: first on
    the grid, then on a finer one around the postures that were left.

    Args:
        robot: the robot.
        width: of the bare obstacle [m]; its margins are the default ones.
        grid: what is tried.
        where: (N, M) bool, the part of the grid that is; None: all of it.
        resolution: of the height [m].

    Returns:
        0 where not even an obstacle as high as the resolution leaves one.
    """
    tried = np.ones((len(grid.z_hds), len(grid.x_ads)), bool) if where is None else where
    coarse = _candidates(robot, grid, *(axis[tried] for axis in np.meshgrid(grid.x_ads, grid.z_hds)))
    coarse_good = coarse.at(_good(robot, Obstacle(resolution, width), coarse))
    if coarse_good.x_ads.size == 0:
        return 0.0
    low, left = _climb(robot, width, coarse_good, (resolution, robot.leg(1).length), resolution)
    offsets = (grid.x_ads[1] - grid.x_ads[0]) * np.linspace(-1.0, 1.0, FINER)
    finer = [
        np.clip((values[:, None] + around.ravel()).ravel(), every.min(), every.max())
        for values, around, every in zip(
            (left.x_ads, left.z_hds), np.meshgrid(offsets, offsets), (coarse.x_ads, coarse.z_hds), strict=True
        )
    ]
    return _climb(robot, width, _candidates(robot, grid, *finer), (low, low + FURTHER), resolution)[0]


def frontier(robot: Robot, widths: np.ndarray, grid: KeyGrid, where: np.ndarray | None = None) -> np.ndarray:
    """Heights (W,) [m] of the highest obstacles of some widths (W,) [m], as highest_obstacle has them."""
    return np.array([highest_obstacle(robot, float(width), grid, where) for width in widths])


def frontiers(robot: Robot, widths: np.ndarray, grids: Sequence[KeyGrid]) -> dict[str, np.ndarray]:
    """The frontier (W,) [m] of each grid, by name: first the whole grid's, then that of the part where FU looks."""
    found = {}
    for grid in grids:
        yaw = f"yaw {grid.yaw_deg:.0f}°"
        found[f"{yaw}, steps to {grid.x_ads[-1]:g} m"] = frontier(robot, widths, grid)
        found[f"{yaw}, FU's search"] = frontier(robot, widths, grid, grid.searched(robot))
    return found


def yaw_gains(limits: Mapping[str, np.ndarray]) -> np.ndarray:
    """What the turned waist gains over the straight one [m], where that one has any, of frontiers with two grids."""
    straight, turned = np.split(np.array(list(limits.values())), 2)
    return np.asarray((turned - straight)[straight > 0.0])


def _candidates(robot: Robot, grid: KeyGrid, x_ads: np.ndarray, z_hds: np.ndarray) -> KeyCandidates:
    """Key configurations of step lengths and waist heights (K,) [m], at the yaw of a grid: X_hds by Eq. (22)."""
    return KeyCandidates(x_ads, robot.feasibility.delta_ds * x_ads, z_hds, float(np.radians(grid.yaw_deg)))


def _climb(
    robot: Robot, width: float, candidates: KeyCandidates, between: tuple[float, float], resolution: float
) -> tuple[float, KeyCandidates]:
    """Bisection between a height [m] that some of the candidates allow and one above it.

    Returns:
        The highest one [m], and the candidates that allow it.
    """
    low, high = between
    while high - low > resolution:
        middle = (low + high) / 2.0
        good = _good(robot, Obstacle(middle, width), candidates)
        if good.any():
            low, candidates = middle, candidates.at(good)
        else:
            high = middle
    return low, candidates


def _good(robot: Robot, obstacle: Obstacle, candidates: KeyCandidates) -> np.ndarray:
    """FU's judgement (K,): the obstacle with its margins before the front heel and beyond the rear toe."""
    search = robot.feasibility
    toe = robot.foot.toe + search.foothold_clearance
    good = np.asarray(front_face(robot, obstacle, candidates.x_ads) - obstacle.margin_width >= toe - 1e-9)
    if good.any():
        good[good] = key_postures(robot, obstacle, candidates.at(good)).good(search.spare)
    return good
