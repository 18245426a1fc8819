"""The path of the quasi-static crossing, without time: where CoM, waist and feet go. Sec. II-A, after Guan et al. [1].

Five segments, each from rest to rest: the CoM shifts over the rear foot; leg 1 steps over the obstacle while the CoM
stays; it shifts over the front foot; leg 2 steps over; it shifts between the feet, which stand side by side again. The
waist goes down and turns while leg 1 steps over, its height changes over the obstacle as the legs need it, and it
comes up and turns back while leg 2 steps over.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stepover.model.obstacle import Obstacle
from stepover.model.pose import pose
from stepover.model.robot import Robot
from stepover.planning.quasi_static.balance import Targets
from stepover.planning.splines import clamped_spline

SEGMENTS = TO_REAR, LEG_1_OVER, TO_FRONT, LEG_2_OVER, TO_MIDDLE = tuple(range(5))
"""The segments, in their order. The right leg steps over first."""
NAMES = ("CoM over the rear foot", "leg 1 steps over", "CoM over the front foot", "leg 2 steps over", "CoM between")
"""What happens in each of them."""
SWINGS = {LEG_1_OVER: -1, LEG_2_OVER: 1}
"""The segments with a foot in the air, and the side of it."""


@dataclass(frozen=True)
class CrossingPath:
    """The numbers of a crossing, from the rear ankle, which stands beside the other one at the start. All in m and rad.

    Attributes:
        x_ads: step length.
        front_face: of the bare obstacle.
        com_rear: CoM ahead of the rear ankle while leg 1 steps over.
        com_front: CoM behind the front ankle while leg 2 steps over.
        height_rear, height_front: of the waist at the beginning and the end of the double support, Z_hds.
        raised: how much higher than between these it is in the middle of the double support.
        leg2_pitch: toe-down pitch of the trailing foot over the obstacle.
        leg2_back: how far before the obstacle's margin its toe rises.
    """

    x_ads: float
    front_face: float
    com_rear: float
    com_front: float
    height_rear: float
    height_front: float
    raised: float = 0.0
    leg2_pitch: float = 0.0
    leg2_back: float = 0.0


def smooth(share: np.ndarray) -> np.ndarray:
    """Quintic from 0 to 1 with zero speed and acceleration at both ends; constant beyond them."""
    s = np.clip(share, 0.0, 1.0)
    return np.asarray(s**3 * (10.0 + s * (6.0 * s - 15.0)))


def pace(segment: int, time: np.ndarray) -> np.ndarray:
    """Share (n,) of a segment's path at shares (n,) of its time: shifts on the quintic, swings as their splines are."""
    return time if segment in SWINGS else smooth(time)


def corners(robot: Robot, path: CrossingPath) -> np.ndarray:
    """Where the CoM's projection rests: (6, 2) at the ends of the five segments [m]."""
    beside, rest = robot.posture.feet_apart / 2.0, robot.rest_zmp()
    rear = np.array([path.com_rear, -SWINGS[LEG_1_OVER] * beside])
    front = np.array([path.x_ads - path.com_front, -SWINGS[LEG_2_OVER] * beside])
    return np.array([rest, rear, rear, front, front, rest + np.array([path.x_ads, 0.0])])


def targets(robot: Robot, obstacle: Obstacle, path: CrossingPath, segment: int, share: np.ndarray) -> Targets:
    """What the postures along a segment shall have, at shares (n,) of its path."""
    p, (start, end) = robot.quasi_static, corners(robot, path)[segment : segment + 2]
    normal, yaw = robot.posture.waist_height, np.radians(robot.feasibility.waist_yaw_deg)
    heights = [normal, normal, path.height_rear, path.height_front, normal, normal]
    yaws = [0.0, 0.0, yaw, yaw, 0.0, 0.0]
    since, until = {LEG_1_OVER: (p.lower_from, p.lower_until), LEG_2_OVER: (p.raise_from, p.raise_until)}.get(
        segment, (0.0, 1.0)
    )
    moved = smooth((share - since) / (until - since)) if segment in SWINGS else share
    height, turn = (ends[segment] + moved * (ends[segment + 1] - ends[segment]) for ends in (heights, yaws))
    if segment == TO_FRONT:
        height = height + 4.0 * path.raised * share * (1.0 - share)
    feet = {side: _standing(robot, path, side, segment, len(share)) for side in (1, -1)}
    if segment in SWINGS:
        feet[SWINGS[segment]] = _over(robot, obstacle, path, segment, share)
    return Targets(start + np.outer(share, end - start), height, turn, feet[1], feet[-1])


def _standing(robot: Robot, path: CrossingPath, side: int, segment: int, count: int) -> np.ndarray:
    """Sole poses (count, 7) of a foot on the ground: before its own swing, or after it."""
    own = next(k for k, swinging in SWINGS.items() if swinging == side)
    x = path.x_ads if segment > own else 0.0
    return pose(np.tile([x, side * robot.posture.feet_apart / 2.0, 0.0], (count, 1)))


def _over(robot: Robot, obstacle: Obstacle, path: CrossingPath, segment: int, share: np.ndarray) -> np.ndarray:
    """Sole poses (n, 7) of the foot that steps over the obstacle."""
    shape = _leg_1 if segment == LEG_1_OVER else _leg_2
    x, z, pitch = shape(robot, obstacle, path, share)
    y = np.full_like(x, SWINGS[segment] * robot.posture.feet_apart / 2.0)
    return pose(np.column_stack([x, y, z]), 0.0, pitch)


def _leg_1(
    robot: Robot, obstacle: Obstacle, path: CrossingPath, share: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Up before the obstacle, over it, and straight down behind it: x, z, pitch."""
    p = robot.quasi_static
    top = obstacle.safe_height + p.leg1_extra_lift
    before = path.front_face - obstacle.margin_width - robot.foot.toe - robot.feasibility.foothold_clearance
    x = clamped_spline([(0.0, 0.0), (p.leg1_rise, before), (p.leg1_descent, path.x_ads)], share)
    held = [(p.leg1_rise, top), ((p.leg1_rise + p.leg1_descent) / 2.0, top), (p.leg1_descent, top)]
    return x, clamped_spline([(0.0, 0.0), *held, (1.0, 0.0)], share), np.zeros_like(x)


def _leg_2(
    robot: Robot, obstacle: Obstacle, path: CrossingPath, share: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Back and up, toe down over the obstacle, so that the shank stays upright, and down beside the other foot."""
    p = robot.quasi_static
    top = obstacle.safe_height + robot.foot.toe * np.sin(path.leg2_pitch) + p.leg2_extra_lift
    spare = robot.feasibility.foothold_clearance
    before = path.front_face - obstacle.margin_width - robot.foot.toe - spare - path.leg2_back
    x = clamped_spline([(0.0, 0.0), (p.leg2_rise, before), (p.leg2_over, path.x_ads)], share)
    held = [(float(at), top) for at in np.linspace(p.leg2_rise, p.leg2_descent, 3)]
    pitch = clamped_spline([(p.leg2_pitch_start, 0.0), (p.leg2_pitch_full, path.leg2_pitch)], share)
    pitch -= clamped_spline([(p.leg2_descent, 0.0), (p.leg2_over, path.leg2_pitch)], share)
    return x, clamped_spline([(0.0, 0.0), *held, (1.0, 0.0)], share), pitch
