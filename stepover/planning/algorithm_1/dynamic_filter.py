"""CWTG2, the dynamic filter: a second stage of preview control on the multi-body ZMP. Sec. II-B2 and III-D, Eq. (19).

What the cart model leaves out (swing legs, waist height and yaw, upper body) shows as a difference between the
reference and the ZMP of the full rigid-body dynamics. Preview control of that difference gives a change of the
CoM, which the waist follows.
"""

from __future__ import annotations

import numpy as np

from stepover.model.robot import Robot
from stepover.planning.algorithm_1.preview_control import kajita_gains, track


def filtered_waist(robot: Robot, waist: np.ndarray, zmp_reference: np.ndarray, zmp: np.ndarray) -> np.ndarray:
    """Waist (N, 7) after one pass of the filter: step 6 of Algorithm 1.

    Args:
        robot: the robot.
        waist: (N, 7) before.
        zmp_reference: (N, 2) desired [m].
        zmp: (N, 2) multi-body ZMP of the motion with that waist [m].
    """
    dt = robot.walk.sample_time
    begun = np.clip(np.arange(len(zmp)) * dt / robot.preview.filter_fade, 0.0, 1.0)
    fade = begun**2 * (3.0 - 2.0 * begun)  # at the start nothing can be previewed, and a step would kick
    difference = (zmp_reference - zmp) * fade[:, None]  # p_ref2 of Eq. (19)
    change = track(kajita_gains(robot.preview, dt), difference, robot.preview, dt).position
    moved = waist.copy()
    moved[:, :2] += change
    return moved
