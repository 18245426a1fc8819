"""FU, the feasibility unit: the key configuration over the obstacle. Sec. III-A, Eq. (22).

The double support over the obstacle is one posture: feet X_ads apart, the waist X_hds = delta_DS X_ads ahead of
the rear foot and Z_hds high, turned so that the leading hip comes forward. The search goes as the paper says:
step length up from the shortest, for each the waist height down from normal walking, and the first posture free
of collision, within joint limits and with bent knees wins. Both legs, thighs and feet are tested, in their
collision shapes, against the obstacle with its margins.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from stepover.errors import Infeasible
from stepover.model.collision import Shape, separation
from stepover.model.obstacle import Obstacle
from stepover.model.pose import pose
from stepover.model.robot import Robot


@dataclass(frozen=True)
class KeyConfiguration:
    """The posture over the obstacle (Fig. 1).

    Attributes:
        x_ads: step length, rear ankle to front ankle [m].
        x_hds: rear ankle to waist [m].
        z_hds: waist height [m].
        yaw: waist yaw that brings the leading hip ahead [rad], for a leading right leg.
    """

    x_ads: float
    x_hds: float
    z_hds: float
    yaw: float

    def front_face(self, robot: Robot, obstacle: Obstacle) -> float:
        """Front face of the bare obstacle ahead of the rear ankle [m]."""
        return float(front_face(robot, obstacle, np.asarray(self.x_ads)))


class Postures(NamedTuple):
    """What a grid of key configurations comes to, (N,) each.

    Attributes:
        reach: how far a sole is out of reach [m], 0 if none is.
        limit: smallest distance to a joint limit, or to the knee's margin from straight [rad].
        separation: smallest signed separation of the legs from the obstacle with its margins [m].
        link: index of the shape that has it.
    """

    reach: np.ndarray
    limit: np.ndarray
    separation: np.ndarray
    link: np.ndarray

    @property
    def feasible(self) -> np.ndarray:
        """Which of them the robot can take, (N,) bool."""
        return (self.reach <= 0.0) & (self.limit >= 0.0) & (self.separation >= 0.0)


def key_configurations(robot: Robot, obstacle: Obstacle, leading: int = -1) -> list[KeyConfiguration]:
    """All key configurations in the order of the search, the one to use first: step 1 of Algorithm 1.

    The later ones are for a planner whose legs do not reach along the whole way: then the waist goes lower (as in
    Guan et al., Sec. II-A), or the step longer.

    Args:
        robot: the robot.
        obstacle: the obstacle with its margins.
        leading: the side that steps over first, +1 left, -1 right.

    Raises:
        Infeasible: no posture in the range of robot.toml; names the constraint that binds at the best one.
    """
    search = robot.feasibility
    shortest = obstacle.safe_depth + robot.foot.heel + robot.foot.toe + 2.0 * search.foothold_clearance
    if shortest > search.step_length_max:
        raise Infeasible(
            f"no key configuration: {obstacle.width:.3f} m of width need a step of {shortest:.3f} m "
            f"from toe to heel, the longest is {search.step_length_max:.3f} m"
        )
    steps = np.arange(shortest, search.step_length_max + 1e-9, search.step_length_step)
    heights = np.arange(robot.posture.waist_height, search.waist_height_min - 1e-9, -search.waist_height_step)
    x_ads, z_hds = (axis.ravel() for axis in np.meshgrid(steps, heights, indexing="ij"))
    yaw = -leading * np.radians(search.waist_yaw_deg)
    postures = key_postures(robot, obstacle, x_ads, search.delta_ds * x_ads, z_hds, yaw)
    if not postures.feasible.any():
        raise Infeasible(_why_not(postures, robot.shapes, x_ads, z_hds, search.knee_margin_deg))
    found = zip(x_ads[postures.feasible].tolist(), z_hds[postures.feasible].tolist(), strict=True)
    return [KeyConfiguration(x, search.delta_ds * x, z, yaw) for x, z in found]


def key_configuration_q(
    robot: Robot, x_ads: np.ndarray, x_hds: np.ndarray, z_hds: np.ndarray, yaw: float
) -> tuple[np.ndarray, np.ndarray]:
    """Configurations (N, nq) of the posture, rear ankle at x = 0, and how far soles are out of reach (N,) [m].

    A positive yaw brings the right hip ahead, so the right leg is the front one then.
    """
    leading = -1 if yaw >= 0.0 else 1
    q = np.tile(robot.half_sitting(), (len(x_ads), 1))
    zero = np.zeros_like(x_ads)
    waist = pose(np.column_stack([x_hds, zero, z_hds]), yaw)
    q[:, :7] = waist
    q[:, robot.body.column(robot.upper_body.chest_yaw)] = -yaw
    reach = zero
    for side, x in ((leading, x_ads), (-leading, zero)):
        leg = robot.leg(side)
        sole = pose(np.column_stack([x, zero + side * robot.posture.feet_apart / 2.0, zero]))
        q[:, leg.columns], excess = leg.attempt(waist, sole)
        reach = np.maximum(reach, excess)
    return q, reach


def key_postures(
    robot: Robot,
    obstacle: Obstacle,
    x_ads: np.ndarray,
    x_hds: np.ndarray,
    z_hds: np.ndarray,
    yaw: float,
) -> Postures:
    """Judge key configurations, (N,) each of x_ads, x_hds, z_hds [m], at one yaw [rad]."""
    q, reach = key_configuration_q(robot, x_ads, x_hds, z_hds, yaw)
    body = robot.body
    angles = q[:, 7:]
    margin = np.minimum(angles - body.lower, body.upper - angles)
    for knee in robot.legs.knee:
        k = body.column(knee) - 7
        margin[:, k] = np.minimum(margin[:, k], np.abs(angles[:, k]) - np.radians(robot.feasibility.knee_margin_deg))
    rectangles = obstacle.profile(0.0, margins=True) + np.outer(
        front_face(robot, obstacle, x_ads), [1.0, 1.0, 0.0, 0.0]
    )
    placements = body.placements(q)
    distances = np.array([separation(shape, placements, rectangles) for shape in robot.shapes])
    return Postures(reach, margin.min(axis=1), distances.min(axis=0), distances.argmin(axis=0))


def front_face(robot: Robot, obstacle: Obstacle, x_ads: np.ndarray) -> np.ndarray:
    """Front face of the bare obstacle ahead of the rear ankle [m]: the front heel lands at the rear margin."""
    heel = robot.foot.heel + robot.feasibility.foothold_clearance
    return x_ads - heel - obstacle.margin_width - obstacle.width


def _why_not(postures: Postures, shapes: list[Shape], x_ads: np.ndarray, z_hds: np.ndarray, knee_deg: float) -> str:
    """Name the constraint that binds at the posture that comes nearest to feasible."""
    able = (postures.reach <= 0.0) & (postures.limit >= 0.0)
    if not able.any():
        step = f"no step of {x_ads[0]:.3f} m or more"
        return f"no key configuration: {step} with knees {knee_deg:.0f} degrees from straight"
    best = int(np.argmax(np.where(able, postures.separation, -np.inf)))
    link, depth = shapes[postures.link[best]].link, -1e3 * postures.separation[best]
    return (
        f"no key configuration: at the best posture (X_ads {x_ads[best]:.3f} m, Z_hds {z_hds[best]:.3f} m) "
        f"{link} is {depth:.1f} mm inside the obstacle with its margins"
    )
