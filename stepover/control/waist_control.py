"""Where the waist is told to be: CoM admittance, posture, and the waist that a swinging leg hangs on.

A robot's joints give way under load, so that the waist is not where it is told to be. A standing leg needs the
commanded waist, with which the sagging one comes right; a swinging leg bears nothing, and its foot lands where it
shall only if it is moved from where the waist is in truth.
"""

from __future__ import annotations

import numpy as np

from stepover.control.admittance import Swaying, damped
from stepover.control.estimator import SIDES, Estimate
from stepover.control.leg_commands import tilt, turned
from stepover.control.reference import Reference
from stepover.model.robot import Robot


class WaistControl:
    """Displacement of the waist, for each leg its own.

    Attributes:
        sway: of the CoM admittance.
        posture: (2,) roll and pitch that are added to the waist's command [rad].
        height: () that is added to it [m].
    """

    def __init__(self, robot: Robot, planned: Reference) -> None:
        """Begin as planned."""
        self._gains, self._planned = robot.stabilizer, planned
        gains = self._gains
        self.sway = Swaying(gains.com_admittance, gains.com_return, gains.com_max, planned.dt)
        self.posture, self.height = np.zeros(2), np.zeros(())
        self._following = np.zeros((2, 5))

    def move(self, sample: int, then: int, estimate: Estimate, zmp: np.ndarray, rise: float = 0.0) -> np.ndarray:
        """One period: displacements (2, 5) x, y, z [m], roll and pitch [rad] of the waist, for the left and right leg.

        Args:
            sample: that they are for.
            then: the sample that the estimate is of.
            estimate: of the robot.
            zmp: (2,) desired [m].
            rise: by which the floor is higher under the loaded foot than under the CoM [m].
        """
        gains, planned = self._gains, self._planned
        self.sway.add(estimate.zmp - zmp)
        lean = tilt(estimate.attitude @ planned.attitude[then].T)
        most = np.radians(gains.posture_max_deg)
        self.posture = damped(self.posture, -lean, gains.posture_gain, gains.posture_return, most, planned.dt)
        place = estimate.waist + np.array([0.0, 0.0, rise])
        sunk = planned.waist[then, 2] - place[2]
        back, high = gains.height_return, gains.height_max
        self.height = damped(self.height, sunk, gains.height_gain, back, high, planned.dt)
        arm = planned.waist[sample, :3] - planned.com[sample]
        told = np.zeros(5)
        told[:3], told[3:] = turned(self.posture) @ arm - arm, self.posture  # the waist turns about the CoM
        told[:2] += self.sway.offset
        told[2] += self.height
        true = np.concatenate([place - planned.waist[then, :3], lean])
        for foot, side in enumerate(SIDES):
            touching = planned.landing[then, foot] and estimate.loads[foot] > 0.0
            swings = planned.support[sample] == -side and not touching
            wanted, time = (true - told, gains.swing_follow) if swings else (np.zeros(5), gains.stance_follow)
            self._following[foot] += (wanted - self._following[foot]) * planned.dt / (time + planned.dt)
        return np.asarray(told + self._following)
