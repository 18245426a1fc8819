"""CWTG1, the CoM and waist trajectory generator. Sec. III-C.

Waist height and yaw are cubics with zero end speeds: down and turned while leg 1 steps over, held in the double
support, back while leg 2 steps over. The horizontal CoM comes from preview control; the waist keeps the place
under it that it has in half-sitting, and the dynamic filter corrects what this leaves out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from stepover.model.pose import pose
from stepover.model.robot import Robot
from stepover.motion.footsteps import LEG_1, LEG_2
from stepover.planning.algorithm_1.feasibility import KeyConfiguration
from stepover.planning.algorithm_1.preview_control import CartMotion, kajita_gains, track
from stepover.planning.algorithm_1.step_sequence import StepSequence


@dataclass(frozen=True, eq=False)
class ComWaist:
    """CoM of the cart model and the waist that carries it.

    Attributes:
        com: motion of the cart model, horizontal.
        waist: (N, 7) poses of the root.
        yaw: (N,) of the waist [rad].
    """

    com: CartMotion
    waist: np.ndarray
    yaw: np.ndarray


def com_and_waist(robot: Robot, sequence: StepSequence, key: KeyConfiguration, delay: float = 0.0) -> ComWaist:
    """CoM and waist trajectories: step 3 of Algorithm 1.

    Args:
        robot: the robot.
        sequence: the steps.
        key: key configuration.
        delay: of the waist's lowest height behind the double support [s].
    """
    dt = robot.walk.sample_time
    com = track(kajita_gains(robot.preview, dt), sequence.zmp, robot.preview, dt)
    normal = robot.half_sitting()[:3]
    to_waist = normal[:2] - sequence.zmp[0]
    height = over_and_back(sequence, normal[2], key.z_hds, delay)
    yaw = over_and_back(sequence, 0.0, key.yaw)
    return ComWaist(com, pose(np.column_stack([com.position + to_waist, height]), yaw), yaw)


def over_and_back(sequence: StepSequence, normal: float, over: float, delay: float = 0.0) -> np.ndarray:
    """Cubics (N,) from a normal value to the one over the obstacle, during leg 1, and back; held delay [s] later."""
    first, second = sequence.step(LEG_1), sequence.step(LEG_2)
    corners = [first.lift_off, first.touch_down, second.lift_off, second.touch_down]
    times = sequence.time[corners] + [0.0, delay, delay, 0.0]
    curve = CubicHermiteSpline(times, [normal, over, over, normal], np.zeros(4))
    return np.asarray(curve(np.clip(sequence.time, times[0], times[-1])))
