"""UBMG, the upper body motion generator. Sec. III-C3 and III-D.

The chest turns against the waist, so that the upper body keeps looking ahead while the hips clear the way; the
arms keep their half-sitting posture.
"""

from __future__ import annotations

import numpy as np

from stepover.model.robot import Robot


def upper_body(robot: Robot, waist_yaw: np.ndarray) -> np.ndarray:
    """Configurations (N, nq) with the upper body set and the rest in half-sitting: step 5 of Algorithm 1.

    Args:
        robot: the robot.
        waist_yaw: (N,) [rad].
    """
    q = np.tile(robot.half_sitting(), (len(waist_yaw), 1))
    q[:, robot.body.column(robot.upper_body.chest_yaw)] = -waist_yaw
    return q
