"""FTG, the feet trajectory generator: clamped cubic splines over the obstacle. Sec. III-B, Fig. 3.

Leg 1 rises before the obstacle, passes it, and lands behind it from above with a speed that falls linearly to
zero. Leg 2 passes with the toe down, so that the trailing shank stays upright, and its forward speed falls
linearly to zero. Times are shares of the single support; heights include the margin.

When leg 1 comes down is a choice: early, and it lands softly; late, and its knee need not reach so far. The paper asks
for a soft landing (Sec. III-B), so of the later descents the planner takes the earliest with which it finds a plan.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from stepover.model.obstacle import Obstacle
from stepover.model.parameters.planning import SteppingOver
from stepover.model.pose import pose
from stepover.model.robot import Robot
from stepover.motion.footsteps import LEG_1, LEG_2
from stepover.planning.algorithm_1.step_sequence import Crossing, Step
from stepover.planning.splines import clamped_spline, landing
from stepover.planning.trajectories import FeetTrajectories


@dataclass(frozen=True, eq=False)
class Swing:
    """One swing of a foot: sole position and pitch.

    Attributes:
        x, y, z: (n,) of the sole frame [m].
        pitch: (n,) toe-down positive [rad].
    """

    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    pitch: np.ndarray


def feet_trajectories(crossing: Crossing, shape: SteppingOver | None = None) -> FeetTrajectories:
    """Trajectories of both feet: second half of step 2 of Algorithm 1.

    Args:
        crossing: robot, obstacle and steps.
        shape: of the swings over the obstacle; None: the robot's own.
    """
    shape, sequence = shape or crossing.robot.stepping_over, crossing.sequence
    feet = {}
    for side in (1, -1):
        own = [step for step in sequence.steps if step.side == side]
        position = np.zeros((len(sequence.time), 3))
        pitch = np.zeros(len(sequence.time))
        position[:, :2] = own[0].start
        for step in own:
            swing = swing_of(crossing, step, shape)
            position[step.swing] = np.column_stack([swing.x, swing.y, swing.z])
            pitch[step.swing] = swing.pitch
            position[step.touch_down :] = [*step.end, 0.0]
        feet[side] = pose(position, 0.0, pitch)
    return FeetTrajectories(feet[1], feet[-1])


def swing_shape(robot: Robot, late: int, leg_2_late: bool) -> SteppingOver:
    """Shape of the swings over the obstacle.

    Args:
        robot: the robot.
        late: 0: the authors' control points; n: leg 1 comes down at the n-th of the later times, and leg 2 swings late.
        leg_2_late: whether leg 2 swings late in any case.
    """
    own, later = robot.stepping_over, robot.late_swing
    if not late and not leg_2_late:
        return own
    changes: dict[str, Any] = {k: v for k, v in dataclasses.asdict(later).items() if k.startswith("leg2_")}
    if late:
        descent = later.leg1_descent[late - 1]
        changes |= {"leg1_descent": descent, "leg1_top": own.leg1_top * descent / own.leg1_descent}
    return dataclasses.replace(own, **changes)


def swing_of(crossing: Crossing, step: Step, shape: SteppingOver) -> Swing:
    """Swing of one step, at the samples from lift-off to touch-down, both included."""
    if step.kind not in (LEG_1, LEG_2):
        return _normal(crossing.robot, step)
    over = _leg_1 if step.kind == LEG_1 else _leg_2
    return over(crossing, step, shape)


def fourth_order(swing: Swing, share: np.ndarray, apex: float) -> Swing:
    """The swing that the paper improves on: a fourth-order polynomial in height, the foot level. Sec. II-C.

    Height and speed vanish at both ends, which with the apex in the middle leaves one such polynomial:
    z = 16 apex s^2 (1 - s)^2. The planner does not use it; the notebook `landing_impact` does.

    Args:
        swing: whose horizontal path x, y it takes.
        share: (n,) of the swing's time that has passed, 0 to 1.
        apex: height in the middle [m].
    """
    return Swing(swing.x, swing.y, 16.0 * apex * share**2 * (1.0 - share) ** 2, np.zeros_like(share))


def leg_1_heights(obstacle: Obstacle, shape: SteppingOver) -> list[tuple[float, float]]:
    """Control points (share of the swing's time, height [m]) of leg 1's height: Fig. 3."""
    top = obstacle.safe_height
    over = [(shape.leg1_rise, top), (shape.leg1_top, top + shape.leg1_extra_lift), (shape.leg1_descent, top)]
    return [(0.0, 0.0), *over, *landing(shape.leg1_descent, top, 1.0, 0.0, shape.landing_points)]


def _normal(robot: Robot, step: Step) -> Swing:
    """A step on flat ground: up and down, and forward between the rests."""
    share = step.share
    up, ahead = _normal_shape(robot.stepping_over.rest, len(share))
    x = step.start[0] + (step.end[0] - step.start[0]) * ahead
    return Swing(x, np.full_like(share, step.start[1]), robot.walk.lift * up, np.zeros_like(share))


@lru_cache(maxsize=16)
def _normal_shape(rest: float, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Shares (count,) of a normal step's lift and length: the same for all of them, however long they are."""
    share = np.linspace(0.0, 1.0, count)
    up = clamped_spline([(0.0, 0.0), (0.5, 1.0), (1.0, 0.0)], share)
    ahead = clamped_spline([(rest, 0.0), (1.0 - rest, 1.0)], share)
    up.flags.writeable = ahead.flags.writeable = False
    return up, ahead


def _leg_1(crossing: Crossing, step: Step, shape: SteppingOver) -> Swing:
    """The leading leg: above the landing point before it descends, heel first."""
    robot, obstacle, share = crossing.robot, crossing.obstacle, step.share
    front_face, spare = crossing.sequence.front_face, robot.feasibility.foothold_clearance
    before = front_face - obstacle.margin_width - robot.foot.toe - spare
    x = [(shape.rest, step.start[0]), (shape.leg1_rise, before), (shape.leg1_descent, step.end[0])]
    z, pitch = _leg_1_shape(obstacle, shape, len(share))
    return Swing(clamped_spline(x, share), np.full_like(share, step.start[1]), z, pitch)


@lru_cache(maxsize=16)
def _leg_1_shape(obstacle: Obstacle, shape: SteppingOver, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Height and pitch (count,) of leg 1: the same for all lengths of the step, of which the planner tries some."""
    share, heel_first = np.linspace(0.0, 1.0, count), np.radians(shape.leg1_pitch_deg)
    z = clamped_spline(leg_1_heights(obstacle, shape), share)
    pitch = clamped_spline([(shape.leg1_rise, 0.0), (shape.leg1_descent, heel_first)], share)
    flat = 1.0 - shape.rest / 2.0  # before touch-down, or the heel would go through the floor
    pitch += clamped_spline([(1.0 - 2.0 * shape.rest, 0.0), (flat, -heel_first)], share)
    z.flags.writeable = pitch.flags.writeable = False
    return z, pitch


def _leg_2(crossing: Crossing, step: Step, shape: SteppingOver) -> Swing:
    """The trailing leg: toe down from before the front margin to behind the rear one."""
    robot, obstacle, share = crossing.robot, crossing.obstacle, step.share
    front_face, spare = crossing.sequence.front_face, robot.feasibility.foothold_clearance
    before = front_face - obstacle.margin_width - robot.foot.toe - spare
    behind = front_face + obstacle.width + obstacle.margin_width + robot.foot.heel + spare
    x = [(shape.rest, step.start[0]), (shape.leg2_rise, before), (shape.leg2_descent, behind)]
    x += landing(shape.leg2_descent, behind, 1.0 - shape.rest, step.end[0], shape.landing_points)
    z, pitch = _leg_2_shape(robot.foot.toe, obstacle, shape, len(share))
    return Swing(clamped_spline(x, share), np.full_like(share, step.start[1]), z, pitch)


@lru_cache(maxsize=16)
def _leg_2_shape(toe: float, obstacle: Obstacle, shape: SteppingOver, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Height and pitch (count,) of leg 2, for a toe that far ahead of the ankle [m]."""
    share, toe_down = np.linspace(0.0, 1.0, count), np.radians(shape.leg2_pitch_per_height_deg * obstacle.safe_height)
    top = obstacle.safe_height + toe * np.sin(toe_down) + shape.leg2_extra_lift
    low = top - shape.leg2_descent_drop * toe * np.sin(toe_down)  # the toe is past the obstacle by then
    held = np.linspace(shape.leg2_rise, shape.leg2_descent, shape.leg2_held)  # or the spline would swing far higher
    knots = [(0.0, 0.0), *((float(at), top) for at in held[:-1]), (shape.leg2_descent, low)]
    z = clamped_spline([*knots, *landing(shape.leg2_descent, low, 1.0, 0.0, shape.landing_points)], share)
    pitch = clamped_spline([(shape.leg2_pitch_start, 0.0), (shape.leg2_pitch_full, toe_down)], share)
    pitch -= clamped_spline([(shape.leg2_descent, 0.0), (1.0 - shape.rest, toe_down)], share)
    z.flags.writeable = pitch.flags.writeable = False
    return z, pitch
