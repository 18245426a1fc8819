"""The feasibility domains of the planar biped over (X_ads, Z_hds). Sec. II-A, Fig. 2.

A pair (X_ads, Z_hds) is feasible if there are an X_hds and a place of the obstacle between the feet that meet the joint
limits (1), keep the legs free of the obstacle (5), and satisfy (6), (7) or (8) for the CoM.

The place needs no search. Only the parts of a leg at or below the obstacle's top can touch it. The rear leg must stay
behind the obstacle and the front leg ahead of it. So a place exists if the gap between the legs is wider than the
obstacle. The extent of a leg depends only on the place of its hip. So one table over the hip's place serves both legs
and every X_ads.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from stepover.analysis.planar.biped import (
    PlanarBiped,
    between_feet,
    leg_lines,
    over_front_foot,
    over_rear_foot,
    planar_biped,
    planar_leg,
)
from stepover.analysis.planar.domains import Domains
from stepover.errors import InvalidInput
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot


@dataclass(frozen=True)
class Reading:
    """Interpretation of II-A where its text is open. The defaults agree best with its statements.

    Attributes:
        outline: True: the legs are the links with the lines L1 ... L7 of Fig. 1; False: the bare links.
        feet: True: the obstacle stands clear of the feet of length F_W; False: anywhere between the ankles.
        ankle_height: True: the ankles have the robot's height; False: they are on the floor, as in (4).
        margins: True: the obstacle has its safety margins; False: it is bare.
        hip_share: share of the mass at the hip; the rest is in the middle of the four links. 1 puts the CoM at the
            hip.
    """

    outline: bool = True
    feet: bool = True
    ankle_height: bool = True
    margins: bool = False
    hip_share: float = 1.0

    def __post_init__(self) -> None:
        """Reject a hip_share outside 0 to 1."""
        if not 0.0 <= self.hip_share <= 1.0:
            raise InvalidInput(f"hip_share = {self.hip_share!r} must lie between 0 and 1")

    def biped(self, robot: Robot) -> PlanarBiped:
        """The robot in this reading."""
        whole = planar_biped(robot)
        height = whole.ankle_height if self.ankle_height else 0.0
        return dataclasses.replace(whole, ankle_height=height, outline=whole.outline if self.outline else ())

    def box(self, obstacle: Obstacle) -> tuple[float, float]:
        """Width and height of the space to keep free [m]."""
        with_margins = obstacle.safe_depth, obstacle.safe_height
        return with_margins if self.margins else (obstacle.width, obstacle.height)


class Taken(NamedTuple):
    """Extent of a leg whose ankle is above x = 0, (...) each.

    Attributes:
        hip: x of the hip [m].
        ahead, behind: extent of foot and leg ahead and behind, at or below the obstacle's top [m].
        centre: mean x of the middles of the two links [m].
        possible: whether the hip is within reach and above the obstacle, and the joints within their limits, Eq. (1).
    """

    hip: np.ndarray
    ahead: np.ndarray
    behind: np.ndarray
    centre: np.ndarray
    possible: np.ndarray


def feasibility_domains(
    robot: Robot,
    obstacle: Obstacle,
    reading: Reading | None = None,
    points: int = 200,
    x_ads_max: float = 1.0,
    z_hds: tuple[float, float] = (0.35, 0.75),
    finer: int = 4,
) -> Domains:
    """Fig. 2: the domains under (6), (7) and (8), and under (7) with X_hds = delta_DS X_ads, Eq. (22).

    Args:
        robot: gives the legs and delta_DS.
        obstacle: the obstacle. `reading` decides whether its margins count.
        reading: interpretation of the paper's text; default: the one that agrees best with its statements.
        points: number of grid points along X_ads, from 0, and along Z_hds.
        x_ads_max: longest X_ads [m].
        z_hds: lowest and highest Z_hds [m].
        finer: number of steps of X_hds in a step of X_ads.

    Raises:
        InvalidInput: fewer than two points, a `finer` below 1, or ranges that are not positive and rising.
    """
    if points < 2 or finer < 1 or not 0.0 < z_hds[0] < z_hds[1] < np.inf or not 0.0 < x_ads_max < np.inf:
        raise InvalidInput("a grid needs two points or more, finer = 1 or more, and rising positive ranges")
    reading = reading or Reading()
    biped, delta = reading.biped(robot), robot.feasibility.delta_ds
    steps, heights = np.linspace(0.0, x_ads_max, points), np.linspace(*z_hds, points)
    fine = x_ads_max / (points - 1) / finer
    reach = int(np.ceil((biped.thigh + biped.shank) / fine))
    table = taken(biped, reading, obstacle, np.arange(-reach, reach + 1) * fine, heights[:, None])
    masks = {equation: np.zeros((points, points), bool) for equation in (6, 7, 8)}
    for i, x_ads in enumerate(steps):
        shift = min(i * finer, 2 * reach + 1)  # in the table: the front leg's hip is less far ahead by X_ads
        rear = Taken(*(part[:, shift:] for part in table))
        front = Taken(*(part[:, : 2 * reach + 1 - shift] for part in table))
        for equation, good in feasible(biped, reading, obstacle, x_ads, rear, front).items():
            masks[equation][:, i] = good.any(axis=1)
    rear, front = (taken(biped, reading, obstacle, part * steps, heights[:, None]) for part in (delta, delta - 1.0))
    masks[22] = feasible(biped, reading, obstacle, steps, rear, front)[7]
    return Domains(steps, heights, masks)


def taken(biped: PlanarBiped, reading: Reading, obstacle: Obstacle, ahead: np.ndarray, height: np.ndarray) -> Taken:
    """Extent of a leg, given how far its hip is ahead of its ankle and above the floor (...) [m]."""
    leg, top = planar_leg(biped, ahead, height), reading.box(obstacle)[1]
    x = leg.points[..., 0]
    back, front = np.zeros((2, *x.shape[:-1]))
    for line in leg_lines(biped, leg):
        for k in range(line.shape[-2] - 1):
            least, largest = _below(line[..., k, :], line[..., k + 1, :], top)
            back, front = np.fmin(back, least), np.fmax(front, largest)
    foot = biped.foot / 2.0 if reading.feet else 0.0
    centre = (x[..., 0] + 2.0 * x[..., 1] + x[..., 2]) / 4.0
    return Taken(x[..., 2], np.maximum(front, foot), np.maximum(-back, foot), centre, leg.possible & (height > top))


def feasible(
    biped: PlanarBiped, reading: Reading, obstacle: Obstacle, x_ads: np.ndarray | float, rear: Taken, front: Taken
) -> dict[int, np.ndarray]:
    """Postures that satisfy (1), (5) and, by number, (6), (7) or (8): (...) bool each.

    X_hds is the hip ahead of the rear ankle. The hip is ahead of the front ankle by X_ads less.
    """
    gap = x_ads - front.behind - rear.ahead
    free = rear.possible & front.possible & (gap > reading.box(obstacle)[0])
    x_ads = np.broadcast_to(x_ads, free.shape)[free]  # the place of the CoM only matters there
    links = (rear.centre[free] + x_ads + front.centre[free]) / 2.0
    com = reading.hip_share * rear.hip[free] + (1.0 - reading.hip_share) * links
    masks = {equation: np.zeros_like(free) for equation in (6, 7, 8)}
    masks[6][free] = over_rear_foot(com, biped.foot)
    masks[7][free] = between_feet(com, x_ads, biped.foot)
    masks[8][free] = over_front_foot(com, x_ads, biped.foot)
    return masks


def _below(a: np.ndarray, b: np.ndarray, top: float) -> tuple[np.ndarray, np.ndarray]:
    """Least and largest x of the parts of segments from a to b (..., 2) at or below a height; NaN if there are none."""
    (x, z), (other_x, other_z) = np.moveaxis(a, -1, 0), np.moveaxis(b, -1, 0)
    rise = np.where(z == other_z, np.inf, other_z - z)
    at_top = x + np.clip((top - z) / rise, 0.0, 1.0) * (other_x - x)
    ends = np.where(z <= top, x, at_top), np.where(other_z <= top, other_x, at_top)
    above = np.minimum(z, other_z) > top
    return np.where(above, np.nan, np.minimum(*ends)), np.where(above, np.nan, np.maximum(*ends))
