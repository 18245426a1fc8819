"""Commands for the waist: CoM admittance, posture, and a separate waist for a swinging leg.

A robot's joints yield under load, so the true waist differs from the commanded one. A standing leg uses the commanded
waist, which corrects for the sag. A swinging leg bears no load. Its foot only lands at the right place if the leg uses
the true waist.
"""

from __future__ import annotations

import numpy as np

from stepover.control.admittance import Swaying, damped
from stepover.control.estimator import SIDES, Estimate
from stepover.control.leg_commands import tilt, turned
from stepover.control.reference import Reference
from stepover.model.robot import Robot


class WaistControl:
    """Displacement of the waist, separately for each leg.

    Attributes:
        sway: state of the CoM admittance.
        posture: (2,) roll and pitch added to the waist's command [rad].
        height: () height added to the waist's command [m].
    """

    def __init__(self, robot: Robot, planned: Reference) -> None:
        """Start with the planned waist."""
        self._gains, self._planned = robot.stabilizer, planned
        gains = self._gains
        self.sway = Swaying(gains.com_admittance, gains.com_return, gains.com_max, planned.dt)
        self.posture, self.height = np.zeros(2), np.zeros(())
        self._following = np.zeros((2, 5))

    def move(self, sample: int, then: int, estimate: Estimate, zmp: np.ndarray, rise: float = 0.0) -> np.ndarray:
        """Displacements (2, 5) of the waist for the left and right leg: x, y, z [m], roll and pitch [rad].

        Args:
            sample: sample of the displacements.
            then: sample of the estimate.
            estimate: estimate of the robot's state.
            zmp: (2,) desired ZMP [m].
            rise: height of the floor under the loaded foot above that under the CoM [m].
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
