"""The key configuration as a posture of the whole robot, for figures and measures. Fig. 1, Sec. III-A."""

from __future__ import annotations

import numpy as np

from stepover.model.pose import pose
from stepover.model.robot import Robot
from stepover.planning.algorithm_1.feasibility import KeyConfiguration


def key_posture(robot: Robot, key: KeyConfiguration) -> np.ndarray:
    """Configuration (nq,) of a key configuration: rear ankle at x = 0, upper body ahead, arms in half-sitting."""
    q = robot.half_sitting()
    waist = pose(np.array([[key.x_hds, 0.0, key.z_hds]]), key.yaw)
    q[:7] = waist[0]
    q[robot.body.column(robot.upper_body.chest_yaw)] = -key.yaw
    for side in (1, -1):
        x = key.x_ads if side == key.leading else 0.0
        sole = pose(np.array([[x, side * robot.posture.feet_apart / 2.0, 0.0]]))
        q[robot.leg(side).columns] = robot.leg(side).inverse(waist, sole)[0]
    return q


def knees_from_straight(robot: Robot, q: np.ndarray) -> np.ndarray:
    """Knee angles (..., knees) from the straight leg [deg], for configurations (..., nq)."""
    return np.degrees(np.abs(q[..., [robot.body.column(knee) for knee in robot.legs.knee]]))
