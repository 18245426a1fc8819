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
from stepover.model.obstacle import Obstacle
from stepover.model.pose import pose
from stepover.model.robot import Robot
from stepover.planning.leg_check import LegCheck, LegLimits, check_legs, leg_is_free
from stepover.planning.trajectories import FeetTrajectories, WaistAndFeet

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

    @property
    def leading(self) -> int:
        """The front leg, whose hip the waist's yaw brings ahead: +1 left, -1 right."""
        return _leading(self.yaw)

    def front_face(self, robot: Robot, obstacle: Obstacle) -> float:
        """Front face of the bare obstacle ahead of the rear ankle [m]."""
        return float(front_face(robot, obstacle, np.asarray(self.x_ads)))


class KeyCandidates(NamedTuple):
    """Key configurations that are judged together.

    Attributes:
        x_ads, x_hds, z_hds: (N,) each, as in KeyConfiguration [m].
        yaw: of the waist [rad]; a positive one brings the right hip ahead: the right leg is the front one then.
    """

    x_ads: np.ndarray
    x_hds: np.ndarray
    z_hds: np.ndarray
    yaw: float

    def at(self, rows: np.ndarray) -> KeyCandidates:
        """Some of them: indices or (N,) bool."""
        return KeyCandidates(self.x_ads[rows], self.x_hds[rows], self.z_hds[rows], self.yaw)

    @property
    def leading(self) -> int:
        """The front leg: +1 left, -1 right."""
        return _leading(self.yaw)


def key_configurations(robot: Robot, obstacle: Obstacle, leading: int = -1) -> list[KeyConfiguration]:
    """Key configurations in the order of the search, the one to use first: step 1 of Algorithm 1.

    The later ones have steps up to step_length_more longer. They are for the case that the legs do not reach along the
    whole path: then the waist goes lower (as in Guan et al., Sec. II-A), or the step gets longer.

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
            f"from ankle to ankle, the longest is {search.step_length_max:.3f} m"
        )
    all_steps = np.arange(shortest, search.step_length_max + 1e-9, search.step_length_step)
    yaw = -leading * np.radians(search.waist_yaw_deg)
    found: list[KeyConfiguration] = []
    steps = all_steps
    while len(steps):
        some, steps = steps[:STEPS_AT_ONCE], steps[STEPS_AT_ONCE:]
        candidates = _candidates(robot, some, yaw)
        good = candidates.at(_good(robot, obstacle, candidates))
        columns = (values.tolist() for values in (good.x_ads, good.x_hds, good.z_hds))
        found += [KeyConfiguration(x_ads, x_hds, z_hds, yaw) for x_ads, x_hds, z_hds in zip(*columns, strict=True)]
        if found:
            longest = found[0].x_ads + search.step_length_more + 1e-9
            found, steps = [key for key in found if key.x_ads <= longest], steps[steps <= longest]
    if not found:
        candidates = _candidates(robot, all_steps, yaw)
        raise Infeasible(_why_not(robot, candidates, key_postures(robot, obstacle, candidates)))
    return found


def _candidates(robot: Robot, steps: np.ndarray, yaw: float) -> KeyCandidates:
    """Each step length (S,) [m] with each waist height of the search, in the order of the search."""
    search = robot.feasibility
    heights = np.arange(robot.posture.waist_height, search.waist_height_min - 1e-9, -search.waist_height_step)
    x_ads = np.repeat(steps, len(heights))
    return KeyCandidates(x_ads, search.delta_ds * x_ads, np.tile(heights, len(steps)), yaw)


def _good(robot: Robot, obstacle: Obstacle, candidates: KeyCandidates) -> np.ndarray:
    """Which key configurations both legs can take, (N,) bool: first the trailing one, which fails more often."""
    poses, limits = _stance(robot, candidates), _limits(robot, obstacle, candidates)
    good = np.ones(len(poses.waist), dtype=bool)
    for side in (-candidates.leading, candidates.leading):
        if good.any():
            good[good] = leg_is_free(robot, side, poses.at(good), limits.at(good), robot.feasibility.spare)
    return good


def key_postures(robot: Robot, obstacle: Obstacle, candidates: KeyCandidates) -> LegCheck:
    """Judge key configurations, the rear ankle at x = 0: separations up to the spare of robot.toml."""
    poses, limits = _stance(robot, candidates), _limits(robot, obstacle, candidates)
    return check_legs(robot, poses, limits, up_to=robot.feasibility.spare)


def _limits(robot: Robot, obstacle: Obstacle, candidates: KeyCandidates) -> LegLimits:
    """What the legs must keep: the obstacle with its margins stands elsewhere for each step length."""
    ahead = np.outer(front_face(robot, obstacle, candidates.x_ads), [1.0, 1.0, 0.0, 0.0])
    knee_margin = np.radians(robot.feasibility.knee_margin_deg)
    return LegLimits(obstacle.profile(0.0, margins=True) + ahead, knee_margin)


def _stance(robot: Robot, candidates: KeyCandidates) -> WaistAndFeet:
    """Waist and soles of key configurations."""
    x_ads, x_hds, z_hds, yaw = candidates
    zero = np.zeros_like(x_ads)
    soles = {
        side: pose(np.column_stack([x, zero + side * robot.posture.feet_apart / 2.0, zero]))
        for side, x in ((candidates.leading, x_ads), (-candidates.leading, zero))
    }
    return WaistAndFeet(pose(np.column_stack([x_hds, zero, z_hds]), yaw), FeetTrajectories(soles[1], soles[-1]))


def _leading(yaw: float) -> int:
    """The side whose hip a yaw of the waist brings ahead: +1 left, -1 right."""
    return -1 if yaw >= 0.0 else 1


def front_face(robot: Robot, obstacle: Obstacle, x_ads: np.ndarray) -> np.ndarray:
    """Front face of the bare obstacle ahead of the rear ankle [m]: the front heel lands at the rear margin."""
    heel = robot.foot.heel + robot.feasibility.foothold_clearance
    return x_ads - heel - obstacle.margin_width - obstacle.width


def _why_not(robot: Robot, candidates: KeyCandidates, check: LegCheck) -> str:
    """Name the constraint that binds at the posture that comes nearest to feasible."""
    able = (check.reach <= 0.0) & (check.limit >= 0.0)
    if not able.any():
        why = _tightest(robot, candidates, check)
        return f"no key configuration: no step of {candidates.x_ads[0]:.3f} m or more: {why}"
    best = int(np.argmax(np.where(able, check.separation, -np.inf)))
    link = robot.shapes[check.shape[best]].link
    depth = 1e3 * (robot.feasibility.spare - check.separation[best])
    return (
        f"no key configuration: at the best posture (X_ads {candidates.x_ads[best]:.3f} m, "
        f"Z_hds {candidates.z_hds[best]:.3f} m) {link} is {depth:.1f} mm too near to the obstacle with its margins"
    )


def _tightest(robot: Robot, candidates: KeyCandidates, check: LegCheck) -> str:
    """Name the joint that is past its limit, or its margin from straight, where the legs come nearest to it."""
    if (check.reach > 0.0).all():
        return f"out of reach down to a waist height of {candidates.z_hds.min():.3f} m"
    best = int(np.argmax(np.where(check.reach <= 0.0, check.limit, -np.inf)))
    poses = _stance(robot, candidates.at(np.array([best])))
    worst: list[tuple[float, str]] = []
    for side in (candidates.leading, -candidates.leading):
        leg = robot.leg(side)
        angles, columns = leg.attempt(poses.waist, poses.feet.foot(side))[0][0], np.array(leg.columns) - 7
        left = np.minimum(angles - robot.body.lower[columns], robot.body.upper[columns] - angles)
        worst += list(zip(left.tolist(), leg.joints, strict=True))
    least, joint = min(worst)
    if least >= 0.0:
        return f"a knee is nearer to straight than {robot.feasibility.knee_margin_deg:g} degrees"
    return f"{joint} is {-np.degrees(least):.1f} degrees past its limit at the best posture"
