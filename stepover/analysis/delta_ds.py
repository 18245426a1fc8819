"""The look-up table of III-A: delta_DS = X_hds / X_ads, measured from the preview control. Sec. III-A, Eq. (22).

At the middle of a double support, X_hds is the distance of the waist from the rear ankle, and X_ads that between the
ankles. CWTG1 keeps the waist at its offset from the CoM in half-sitting, so the CoM's share is given as well.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stepover.errors import InvalidInput
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.motion.footsteps import LEG_1, LEG_2
from stepover.planning.algorithm_1.com_waist import com_and_waist
from stepover.planning.algorithm_1.feasibility import KeyConfiguration
from stepover.planning.algorithm_1.preview_control import kajita_gains, track
from stepover.planning.algorithm_1.step_sequence import step_sequence


class Share(NamedTuple):
    """Places of the waist (delta_DS) and the CoM between the ankles, from 0 at the rear one to 1 at the front one."""

    waist: float
    com: float


def delta_ds_walking(robot: Robot, step_length: float, steps: int = 10) -> Share:
    """delta_DS in the middle of a walk with equal step lengths [m] and the timing of normal steps.

    Raises:
        InvalidInput: a step length that is not a positive finite number.
    """
    _require_length(step_length)
    walk, dt = robot.walk, robot.walk.sample_time
    single, double = round(walk.single_support / dt), round(walk.double_support / dt)
    first = round(walk.standing / dt) + np.arange(steps + 1) * (single + double)  # samples in single support
    feet, knots = step_length * np.arange(steps + 1), np.column_stack([first, first + single]).ravel()
    zmp = np.interp(np.arange(knots[-1] + round(walk.standing / dt)), knots, np.repeat(feet, 2))
    com = track(kajita_gains(robot.preview, dt), zmp[:, None], robot.preview, dt).position[:, 0]
    rear = steps // 2
    to_waist = robot.half_sitting()[0] - robot.rest_zmp()[0]
    return _share(com, to_waist, first[rear + 1] - double / 2.0, feet[rear], feet[rear + 1])


def delta_ds_stepping_over(robot: Robot, obstacle: Obstacle, x_ads: float) -> Share:
    """delta_DS in the double support over an obstacle, for a step length over it [m] (CWTG1).

    The waist's height and yaw have no influence, since the cart model does not contain them.

    Raises:
        InvalidInput: a step length that is not a positive finite number.
        Infeasible: the obstacle is nearer than the first step.
    """
    _require_length(x_ads)
    key = KeyConfiguration(x_ads, robot.feasibility.delta_ds * x_ads, robot.posture.waist_height, 0.0)
    sequence = step_sequence(robot, obstacle, key, robot.rest_zmp())
    com = com_and_waist(robot, sequence, key).com.position[:, 0]
    leg_1, leg_2 = sequence.step(LEG_1), sequence.step(LEG_2)
    to_waist = robot.half_sitting()[0] - robot.rest_zmp()[0]
    return _share(com, to_waist, (leg_1.touch_down + leg_2.lift_off) / 2.0, leg_2.start[0], leg_1.end[0])


def _share(com: np.ndarray, to_waist: float, sample: float, rear: float, front: float) -> Share:
    """Shares at a sample, or between two samples, of a CoM (N,) and a waist ahead of it by to_waist [m]."""
    at = float(np.interp(sample, np.arange(len(com)), com))
    return Share((at + to_waist - rear) / (front - rear), (at - rear) / (front - rear))


def _require_length(step_length: float) -> None:
    """Reject an invalid step length."""
    if not 0.0 < step_length < np.inf:
        raise InvalidInput(f"step length {step_length!r} must be a positive finite number of metres")
