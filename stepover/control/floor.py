"""A floor that slopes: how the stance foot lies on it, by IMU and joints, is how the next one will.

Without this a swinging foot comes down level, with its toe or heel first, and too early or too late by the step's
length times the slope: 10 mm for 0.4 m at 1.5 degrees.
"""

from __future__ import annotations

import numpy as np

from stepover.control.admittance import bounded
from stepover.control.estimator import SIDES, Estimate
from stepover.control.leg_commands import tilt
from stepover.control.reference import Reference
from stepover.control.support_region import patch
from stepover.model.robot import Robot


class Floor:
    """What is known of the floor.

    Attributes:
        slope: (2,) roll and pitch: positive where the left side is up, and where it falls ahead [rad].
    """

    def __init__(self, robot: Robot, planned: Reference, rubber: bool = False) -> None:
        """Begin on a level floor; say whether there is rubber under the ankles."""
        gains = robot.stabilizer
        self._planned = planned
        self._share = planned.dt / (gains.slope_time + planned.dt)
        self._most = np.radians(gains.slope_max_deg)
        self._soft = 1.0 / robot.sole.tilt_stiffness if rubber else 0.0
        soles = np.stack([patch(robot, side, gains.zmp_inset) for side in SIDES])
        self._low, self._high = soles.min(axis=1), soles.max(axis=1)
        self.slope = np.zeros(2)

    def look(self, sample: int, estimate: Estimate) -> None:
        """Learn from a foot that stands alone, with its pressure inside the sole: then it lies flat.

        Args:
            sample: that the estimate is of.
            estimate: of the robot.
        """
        support = self._planned.support[sample]
        foot = 0 if support > 0 else 1
        place, load = estimate.cops[foot], estimate.loads[foot]
        alone = support != 0 and load > 0.0 and estimate.loads[1 - foot] == 0.0
        if not alone or (place < self._low[foot]).any() or (place > self._high[foot]).any():
            return
        bent = self._soft * load * np.array([-place[1], place[0]])  # the rubber lets the foot lean to its pressure
        seen = tilt(estimate.feet[foot] @ self._planned.feet[sample, foot].T) - bent
        self.slope = bounded(self.slope + self._share * (seen - self.slope), -self._most, self._most)

    def rises(self, sample: int) -> np.ndarray:
        """How much higher the floor is under each planned foot (2,) than under the CoM [m]."""
        away = self._planned.ankles[sample, :, :2] - self._planned.com[sample, :2]
        return np.asarray(self.slope[0] * away[:, 1] - self.slope[1] * away[:, 0])
