"""Convert displacements of waist and feet to joint angles, by damped inverse kinematics that stays bounded."""

from __future__ import annotations

import numpy as np

from stepover.control.admittance import bounded
from stepover.control.reference import Reference
from stepover.model.instant import Instant
from stepover.model.robot import Robot

LEVEL = np.zeros(2)
ROUNDS = 3
"""Largest number of Newton steps. They start from the sample before, within a millimetre, so two are enough."""


class LegCommands:
    """Planned joint angles plus the stabilizer's corrections of the legs, which change at most at the speed limits."""

    def __init__(self, robot: Robot, planned: Reference) -> None:
        """Start with the planned joint angles."""
        body = robot.body
        self._planned = planned
        self._instant = Instant(robot)
        self._added = np.zeros(len(body.joint_names))
        self._fastest = body.speed_limits * planned.dt
        self._low = np.minimum(body.lower, planned.joints.min(axis=0))
        self._high = np.maximum(body.upper, planned.joints.max(axis=0))

    def command(
        self, sample: int, waists: np.ndarray, ankles: np.ndarray, heights: np.ndarray, slope: np.ndarray = LEVEL
    ) -> np.ndarray:
        """Joint angles (nq - 7,) [rad].

        Args:
            sample: sample of the plan.
            waists: (2, 5) displacement of the waist for each leg: x, y, z [m], then tilt in roll and pitch [rad].
            ankles: (2, 2) roll and pitch of the feet about their ankles [rad].
            heights: (2,) displacement of the feet in height [m].
            slope: (2,) roll and pitch of the floor [rad]. The feet turn by it as well.
        """
        planned = self._planned
        targets = {}
        for foot, side in enumerate((1, -1)):
            back = (turned(waists[foot, 3:]) @ planned.attitude[sample]).T
            place = planned.ankles[sample, foot] - planned.waist[sample, :3] - waists[foot, :3]
            place[2] += heights[foot]
            targets[side] = back @ turned(ankles[foot] + slope) @ planned.feet[sample, foot], back @ place
        joints = planned.joints[sample]
        wanted = self._instant.legs(targets, joints + self._added, ROUNDS) - joints
        self._added = bounded(wanted, self._added - self._fastest, self._added + self._fastest)
        return bounded(joints + self._added, self._low, self._high)


def turned(angles: np.ndarray) -> np.ndarray:
    """Rotation (3, 3) by roll about the world's x axis, then pitch about its y axis: angles (2,) [rad]."""
    (sr, sp), (cr, cp) = np.sin(angles).tolist(), np.cos(angles).tolist()
    return np.array([[cp, sp * sr, sp * cr], [0.0, cr, -sr], [-sp, cp * sr, cp * cr]])


def tilt(turn: np.ndarray) -> np.ndarray:
    """Roll and pitch (2,) [rad] of a rotation (3, 3): the lean of its vertical axis, independent of its heading."""
    x, y, z = turn[:, 2]
    return np.array([-np.arctan2(y, z), np.arctan2(x, z)])
