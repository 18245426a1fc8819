"""FU, the feasibility unit: the key configuration over the obstacle. Sec. III-A, Eq. (22).

The double support over the obstacle is one posture: feet X_ads apart, the waist X_hds = delta_DS X_ads ahead of
the rear foot and Z_hds high, turned so that the leading hip comes forward. The search goes as the paper says:
step length up from the shortest, for each the waist height down from normal walking, and the first posture free
of collision, within joint limits and with bent knees wins. Both legs, thighs and feet are tested, in their
collision shapes, against the obstacle with its margins.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stepover.errors import Infeasible
from stepover.model.obstacle import Obstacle
from stepover.model.pose import pose
from stepover.model.robot import Robot
from stepover.planning.leg_check import LegCheck, check_legs, leg_is_free, leg_shapes

STEPS_AT_ONCE = 20
"""Step lengths that are judged together: enough for arrays to pay, few enough to stop soon."""


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


def key_configurations(robot: Robot, obstacle: Obstacle, leading: int = -1) -> list[KeyConfiguration]:
    """Key configurations in the order of the search, the one to use first: step 1 of Algorithm 1.

    The later ones, with steps up to step_length_more longer, are for a planner whose legs do not reach along the whole
    way: then the waist goes lower (as in Guan et al., Sec. II-A), or the step longer.

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
    all_steps = np.arange(shortest, search.step_length_max + 1e-9, search.step_length_step)
    heights = np.arange(robot.posture.waist_height, search.waist_height_min - 1e-9, -search.waist_height_step)
    yaw = -leading * np.radians(search.waist_yaw_deg)
    found: list[KeyConfiguration] = []
    steps = all_steps
    while len(steps):
        some, steps = steps[:STEPS_AT_ONCE], steps[STEPS_AT_ONCE:]
        x_ads, z_hds = _grid(some, heights)
        good = _good(robot, obstacle, x_ads, search.delta_ds * x_ads, z_hds, yaw)
        pairs = zip(x_ads[good].tolist(), z_hds[good].tolist(), strict=True)
        found += [KeyConfiguration(x, search.delta_ds * x, z, yaw) for x, z in pairs]
        if found:
            longest = found[0].x_ads + search.step_length_more + 1e-9
            found, steps = [key for key in found if key.x_ads <= longest], steps[steps <= longest]
    if not found:
        x_ads, z_hds = _grid(all_steps, heights)
        postures = key_postures(robot, obstacle, x_ads, search.delta_ds * x_ads, z_hds, yaw)
        raise Infeasible(_why_not(robot, postures, yaw, x_ads, z_hds))
    return found


def _grid(steps: np.ndarray, heights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Each step length with each waist height, (N,) each [m]: in the order of the search."""
    return np.repeat(steps, len(heights)), np.tile(heights, len(steps))


def _good(
    robot: Robot, obstacle: Obstacle, x_ads: np.ndarray, x_hds: np.ndarray, z_hds: np.ndarray, yaw: float
) -> np.ndarray:
    """Which key configurations both legs can take, (N,) bool: first the trailing one, whose knee is in the way."""
    waist, soles, rectangles, knee_margin = _asked(robot, obstacle, x_ads, x_hds, z_hds, yaw)
    good = np.ones(len(waist), dtype=bool)
    for side, sole in reversed(soles.items()):
        if good.any():
            there = waist[good], sole[good], rectangles[good]
            good[good] = leg_is_free(robot, side, *there, knee_margin, robot.feasibility.spare)
    return good


def key_postures(
    robot: Robot, obstacle: Obstacle, x_ads: np.ndarray, x_hds: np.ndarray, z_hds: np.ndarray, yaw: float
) -> LegCheck:
    """Judge key configurations, (N,) each of x_ads, x_hds, z_hds [m], at one yaw [rad]: separations up to spare.

    The rear ankle stands at x = 0. A positive yaw brings the right hip ahead: the right leg is the front one then.
    """
    waist, soles, rectangles, knee_margin = _asked(robot, obstacle, x_ads, x_hds, z_hds, yaw)
    return check_legs(robot, waist, soles[1], soles[-1], rectangles, knee_margin, up_to=robot.feasibility.spare)


def _asked(
    robot: Robot, obstacle: Obstacle, x_ads: np.ndarray, x_hds: np.ndarray, z_hds: np.ndarray, yaw: float
) -> tuple[np.ndarray, dict[int, np.ndarray], np.ndarray, float]:
    """Waist (N, 7), sole (N, 7) of each side, what must stay free (N, 4), and the knees' margin from straight [rad]."""
    waist, soles = _stance(robot, x_ads, x_hds, z_hds, yaw)
    ahead = np.outer(front_face(robot, obstacle, x_ads), [1.0, 1.0, 0.0, 0.0])
    rectangles = obstacle.profile(0.0, margins=True) + ahead
    return waist, soles, rectangles, np.radians(robot.feasibility.knee_margin_deg)


def _stance(
    robot: Robot, x_ads: np.ndarray, x_hds: np.ndarray, z_hds: np.ndarray, yaw: float
) -> tuple[np.ndarray, dict[int, np.ndarray]]:
    """Waist (N, 7) and sole (N, 7) of each side, the leading one first, for key configurations, (N,) each."""
    leading = -1 if yaw >= 0.0 else 1
    zero = np.zeros_like(x_ads)
    soles = {
        side: pose(np.column_stack([x, zero + side * robot.posture.feet_apart / 2.0, zero]))
        for side, x in ((leading, x_ads), (-leading, zero))
    }
    return pose(np.column_stack([x_hds, zero, z_hds]), yaw), soles


def front_face(robot: Robot, obstacle: Obstacle, x_ads: np.ndarray) -> np.ndarray:
    """Front face of the bare obstacle ahead of the rear ankle [m]: the front heel lands at the rear margin."""
    heel = robot.foot.heel + robot.feasibility.foothold_clearance
    return x_ads - heel - obstacle.margin_width - obstacle.width


def _why_not(robot: Robot, postures: LegCheck, yaw: float, x_ads: np.ndarray, z_hds: np.ndarray) -> str:
    """Name the constraint that binds at the posture that comes nearest to feasible."""
    search = robot.feasibility
    able = (postures.reach <= 0.0) & (postures.limit >= 0.0)
    if not able.any():
        why = _tightest(robot, postures, yaw, x_ads, z_hds)
        return f"no key configuration: no step of {x_ads[0]:.3f} m or more: {why}"
    best = int(np.argmax(np.where(able, postures.separation, -np.inf)))
    link = leg_shapes(robot)[postures.shape[best]].link
    depth = 1e3 * (search.spare - postures.separation[best])
    return (
        f"no key configuration: at the best posture (X_ads {x_ads[best]:.3f} m, Z_hds {z_hds[best]:.3f} m) "
        f"{link} is {depth:.1f} mm too near to the obstacle with its margins"
    )


def _tightest(robot: Robot, postures: LegCheck, yaw: float, x_ads: np.ndarray, z_hds: np.ndarray) -> str:
    """Name the joint that is past its limit, or its margin from straight, where the legs come nearest to it."""
    search = robot.feasibility
    if (postures.reach > 0.0).all():
        return f"out of reach down to a waist height of {z_hds.min():.3f} m"
    best = int(np.argmax(np.where(postures.reach <= 0.0, postures.limit, -np.inf)))
    x, z = x_ads[[best]], z_hds[[best]]
    waist, soles = _stance(robot, x, search.delta_ds * x, z, yaw)
    worst: list[tuple[float, str]] = []
    for side, sole in soles.items():
        leg = robot.leg(side)
        angles, columns = leg.attempt(waist, sole)[0][0], np.array(leg.columns) - 7
        left = np.minimum(angles - robot.body.lower[columns], robot.body.upper[columns] - angles)
        worst += list(zip(left.tolist(), leg.joints, strict=True))
    least, joint = min(worst)
    if least >= 0.0:
        return f"a knee is nearer to straight than {search.knee_margin_deg:g} degrees"
    return f"{joint} is {-np.degrees(least):.1f} degrees past its limit at the best posture"
