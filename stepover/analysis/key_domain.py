"""All key configurations of the robot in 3-D, which FU searches, and the frontier of FU. Sec. III-A, III-C3.

FU takes the first key configuration that it finds. Here all of them are checked, with the same legs, the same obstacle
with its margins, and X_hds from Eq. (22), over FU's range of X_ads and Z_hds or a wider one.
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
"""Largest gain in obstacle height from the finer grid [m]."""


@dataclass(frozen=True, eq=False)
class KeyGrid:
    """Grid of step lengths (M,) and waist heights (N,) at one waist yaw.

    Attributes:
        x_ads, z_hds: both ascending [m].
        yaw_deg: yaw of the waist, positive with the right hip ahead [deg].
    """

    x_ads: np.ndarray
    z_hds: np.ndarray
    yaw_deg: float

    def searched(self, robot: Robot) -> np.ndarray:
        """The part of the grid that FU searches, (N, M) bool: within its step lengths and waist heights."""
        search = robot.feasibility
        rows = (self.z_hds >= search.waist_height_min - 1e-9) & (self.z_hds <= robot.posture.waist_height + 1e-9)
        return np.outer(rows, self.x_ads <= search.step_length_max + 1e-9)


def key_grid(robot: Robot, step: float, yaw_deg: float, x_ads_max: float = 1.0, z_hds_min: float = 0.35) -> KeyGrid:
    """Grid with a given step [m], up to a step length, and from the leg's length down to a waist height.

    The heights include that of the waist in half-sitting, where FU starts.

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
    """Key configurations of a grid that FU accepts: (N, M) bool, heights by step lengths."""
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
    """FU's frontier: height of the highest bare obstacle of a width that has a key configuration [m].

    Found by bisection over the height, since a posture that collides with a lower obstacle also collides with a higher
    one. The search uses the grid first, then a finer grid around the remaining postures.

    Args:
        robot: the robot.
        width: width of the bare obstacle [m]. The margins are the default ones.
        grid: grid of key configurations.
        where: (N, M) bool, the part of the grid to use; None: all of it.
        resolution: resolution of the height [m].

    Returns:
        The height [m]; 0 if not even an obstacle as high as the resolution has a key configuration.
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
    """Heights (W,) [m] of the highest obstacles of some widths (W,) [m]; see highest_obstacle."""
    return np.array([highest_obstacle(robot, float(width), grid, where) for width in widths])


def frontiers(robot: Robot, widths: np.ndarray, grids: Sequence[KeyGrid]) -> dict[str, np.ndarray]:
    """The frontiers (W,) [m] of each grid by name: first of the whole grid, then of the part that FU searches."""
    found = {}
    for grid in grids:
        yaw = f"yaw {grid.yaw_deg:.0f}°"
        found[f"{yaw}, steps to {grid.x_ads[-1]:g} m"] = frontier(robot, widths, grid)
        found[f"{yaw}, FU's search"] = frontier(robot, widths, grid, grid.searched(robot))
    return found


def yaw_gains(limits: Mapping[str, np.ndarray]) -> np.ndarray:
    """Gains in height by turning the waist [m], from the frontiers of two grids, if the straight waist has one."""
    straight, turned = np.split(np.array(list(limits.values())), 2)
    return np.asarray((turned - straight)[straight > 0.0])


def _candidates(robot: Robot, grid: KeyGrid, x_ads: np.ndarray, z_hds: np.ndarray) -> KeyCandidates:
    """Key configurations of step lengths and waist heights (K,) [m] at the yaw of a grid, with X_hds from Eq. (22)."""
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
    """FU's check (K,): whether the obstacle with its margins fits between the rear toe and the front heel."""
    search = robot.feasibility
    toe = robot.foot.toe + search.foothold_clearance
    good = np.asarray(front_face(robot, obstacle, candidates.x_ads) - obstacle.margin_width >= toe - 1e-9)
    if good.any():
        good[good] = key_postures(robot, obstacle, candidates.at(good)).good(search.spare)
    return good
