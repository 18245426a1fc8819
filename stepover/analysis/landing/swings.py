"""Swings of leg 1, shaped or by a fourth-order polynomial, and whole motions with them. Sec. II-C, III-B, Fig. 3.

The paper gives no formula for the polynomial. Here it begins and ends at rest on the floor and is as low as the margins
allow. The foot stays level and moves ahead as in the shaped swing. With another swing, inverse kinematics and the
dynamic filter run again.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import KroghInterpolator

from stepover.errors import InvalidInput
from stepover.model.obstacle import Obstacle
from stepover.model.pose import pose
from stepover.model.robot import Robot
from stepover.motion.footsteps import LEG_1
from stepover.motion.motion import Motion
from stepover.planning.algorithm_1.feet_trajectories import Swing, fourth_order, leg_1_heights, swing_of
from stepover.planning.algorithm_1.plan import Options, Plan
from stepover.planning.algorithm_1.planner import algorithm_1, filter_pass, plan_in_detail, whole_body
from stepover.planning.algorithm_1.step_sequence import Crossing
from stepover.planning.splines import clamped_spline
from stepover.planning.trajectories import FeetTrajectories, WaistAndFeet

SHAPED, NAIVE, SAME_APEX = "shaped", "naive", "naive, apex of the shaped"
PROFILES = (SHAPED, NAIVE, SAME_APEX)
"""Swings of leg 1: clamped spline; fourth order, as low as the margins allow; fourth order, with the spline's apex."""
NEAR_FLOOR = 0.010
"""Height at which the speeds of descent are compared [m]."""


@dataclass(frozen=True, eq=False)
class Profile:
    """Leg 1's swing over time, n samples from lift-off to touch-down.

    Attributes:
        name: one of PROFILES.
        time: (n,) since lift-off [s].
        height: (n,) height of the sole [m].
        speed: (n,) vertical speed of the sole [m/s].
        pitch: (n,) pitch, positive with the toe down [rad].
    """

    name: str
    time: np.ndarray
    height: np.ndarray
    speed: np.ndarray
    pitch: np.ndarray

    def speed_near_floor(self, height: float = NEAR_FLOOR) -> float:
        """Speed of descent at a height above the floor [m/s], positive downwards."""
        down = slice(int(self.height.argmax()), None)
        return float(-np.interp(height, self.height[down][::-1], self.speed[down][::-1]))


def planned_in(robot: Robot, obstacle: Obstacle, swing_time: float | None = None) -> Plan:
    """The plan with another swing time for leg 1 and the steps before and after, and the same key configuration.

    Args:
        robot: the robot.
        obstacle: the obstacle.
        swing_time: single support of leg 1 and of the steps before and after [s]; None: the robot's own.
    """
    found = plan_in_detail(robot, obstacle, look_for_nearest=False)
    if swing_time is None or swing_time == robot.walk.single_support_over:
        return found
    walk = dataclasses.replace(robot.walk, single_support_over=swing_time)
    return algorithm_1(dataclasses.replace(robot, walk=walk), obstacle, found.key, Options(found.options.arms))


def leg_1_swing(crossing: Crossing, profile: str) -> Swing:
    """Leg 1's swing in one of the PROFILES.

    Raises:
        InvalidInput: an unknown profile.
    """
    if profile not in PROFILES:
        raise InvalidInput(f"profile {profile!r} must be one of {', '.join(PROFILES)}")
    step = crossing.sequence.step(LEG_1)
    shaped = swing_of(crossing, step, crossing.robot.stepping_over)
    if profile == SHAPED:
        return shaped
    apex = lowest_apex(crossing, shaped.x, step.share) if profile == NAIVE else float(shaped.z.max())
    return fourth_order(shaped, step.share, apex)


def lowest_apex(crossing: Crossing, x: np.ndarray, share: np.ndarray) -> float:
    """Least apex of a fourth-order swing that keeps a level sole out of the margins [m].

    Args:
        crossing: robot, obstacle and steps.
        x: (n,) forward coordinate of the sole frame [m].
        share: (n,) share of the swing's time.
    """
    foot = crossing.robot.foot
    back, front, _, top = crossing.limits.rectangle
    above = (x + foot.toe > back + 1e-9) & (x - foot.heel < front - 1e-9)
    return float((top / (16.0 * share[above] ** 2 * (1.0 - share[above]) ** 2)).max())


def profile_of(crossing: Crossing, name: str) -> Profile:
    """One of the PROFILES over time."""
    swing = leg_1_swing(crossing, name)
    time = crossing.robot.walk.sample_time * np.arange(len(swing.z))
    return Profile(name, time, swing.z, np.gradient(swing.z, time, edge_order=2), swing.pitch)


def landing_motion(robot: Robot, obstacle: Obstacle, profile: str, swing_time: float | None = None) -> Motion:
    """The whole motion with one of the PROFILES for leg 1. See planned_in for the swing time.

    Raises:
        InvalidInput: an unknown profile.
        Infeasible: the legs do not reach, or the shaped motion with this swing time exceeds a limit.
    """
    planned = planned_in(robot, obstacle, swing_time)
    nominal = planned.nominal
    swing = leg_1_swing(nominal.crossing, profile)
    if profile == SHAPED:
        return planned.motion
    step = planned.sequence.step(LEG_1)
    feet = {side: nominal.feet.foot(side).copy() for side in (1, -1)}
    feet[step.side][step.swing] = pose(np.column_stack([swing.x, swing.y, swing.z]), 0.0, swing.pitch)
    return with_feet(planned, FeetTrajectories(feet[1], feet[-1]))


def with_feet(planned: Plan, feet: FeetTrajectories) -> Motion:
    """A plan's motion with other feet: runs steps 4 and 6 of Algorithm 1 again, with as many passes of the filter.

    The footholds must be the same. Adaptations by FTA are not repeated.
    """
    crossing, waist, upper = planned.nominal.crossing, planned.nominal.waist, planned.nominal.upper.q
    zmps = []
    for _ in range(planned.filter_passes):
        waist, zmp = filter_pass(crossing, WaistAndFeet(waist, feet), upper)
        zmps.append(zmp)
    body = crossing.robot.body
    q = whole_body(crossing.robot, WaistAndFeet(waist, feet), upper, crossing.sequence.time)
    return dataclasses.replace(
        planned.motion, q=q, left_foot=feet.left, right_foot=feet.right, waist=waist,
        com=body.com(body.placements(q)), zmp_first_stage=zmps[0], zmp=body.zmp(q, planned.motion.dt),
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Curves:
    """Two curves through the control points of leg 1's height. Both are at rest at their ends.

    Attributes:
        knots: (K, 2) share of the swing's time, height [m].
        share: (n,) share of the swing's time.
        spline: (n,) clamped cubic spline [m].
        polynomial: (n,) single polynomial through all control points [m].
    """

    knots: np.ndarray
    share: np.ndarray
    spline: np.ndarray
    polynomial: np.ndarray

    def overshoot(self, curve: np.ndarray) -> float:
        """Largest distance of a curve (n,) outside the range of its two neighbouring control points [m]."""
        after = np.clip(np.searchsorted(self.knots[:, 0], self.share), 1, len(self.knots) - 1)
        ends = np.sort(np.stack([self.knots[after - 1, 1], self.knots[after, 1]]), axis=0)
        return float(np.maximum(ends[0] - curve, curve - ends[1]).max())


def through_control_points(robot: Robot, obstacle: Obstacle, landing_points: int | None = None) -> Curves:
    """Spline and polynomial through leg 1's control points: Sec. III-B.

    Args:
        robot: gives the shape of the swing.
        obstacle: gives the height with its margin.
        landing_points: number of control points of the landing; None: the robot's own.
    """
    shape = robot.stepping_over
    if landing_points is not None:
        shape = dataclasses.replace(shape, landing_points=landing_points)
    knots = np.array(leg_1_heights(obstacle, shape))
    share = np.linspace(0.0, 1.0, 2001)
    nodes = np.concatenate([knots[:1], knots, knots[-1:]])  # each end appears twice: its value, then its derivative
    values = nodes[:, 1].copy()
    values[[1, -1]] = 0.0
    polynomial = KroghInterpolator(nodes[:, 0], values)(share)
    return Curves(knots, share, clamped_spline([(float(at), float(z)) for at, z in knots], share), polynomial)
