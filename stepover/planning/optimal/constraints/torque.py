"""Joint torques in single support: |tau - J' w| <= r tau_max, with the whole wrench of the floor on the bearing foot.

Inverse dynamics by RNEA (Featherstone, Rigid Body Dynamics Algorithms, ch. 5); its derivatives after Carpentier and
Mansard, RSS 2018, by pinocchio. The 40 ms of double support are checked in the finished motion (torques.py).
"""

from __future__ import annotations

import numpy as np

from stepover.planning.optimal.constraints.group import Group, Local
from stepover.planning.optimal.instants import Instants


def torque(seen: Instants) -> Group:
    """Torques of all joints that move, as shares of their limits, both ways."""
    channels, body = seen.scene.channels, seen.scene.robot.body
    limits = body.effort_limits[np.array(channels.full_columns) - 7]
    share, names = seen.wrench.torques / limits, channels.dynamics.joints
    values = np.hstack([share, -share]) - seen.scene.parameters.torque_share
    values[seen.scene.support == 0] = -1.0

    def gradient(rows: np.ndarray, columns: np.ndarray) -> Local:
        joint = columns % len(limits)
        sign = np.where(columns < len(limits), 1.0, -1.0) / limits[joint]
        return Local(motion=sign[:, None] * seen.wrench_by[1][rows, joint])

    return Group("joint torque", values, [*names, *names], 1.0, "of its limit", gradient)
