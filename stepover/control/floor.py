"""Estimate the floor's slope from the stance foot, by IMU and joints, and use it for the next foot.

Without this estimate a swinging foot comes down level, with its toe or heel first. Its height at landing is wrong by
the step length times the slope: 10 mm for 0.4 m at 1.5 degrees.
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
    """Estimate of the floor.

    Attributes:
        slope: (2,) roll and pitch [rad]: positive if the left side is up, and if the floor falls ahead.
    """

    def __init__(self, robot: Robot, planned: Reference, rubber: bool = False) -> None:
        """Start on a level floor; `rubber` states whether there is rubber under the ankles."""
        gains = robot.stabilizer
        self._planned = planned
        self._share = planned.dt / (gains.slope_time + planned.dt)
        self._most = np.radians(gains.slope_max_deg)
        self._soft = 1.0 / robot.sole.tilt_stiffness if rubber else 0.0
        soles = np.stack([patch(robot, side, gains.zmp_inset) for side in SIDES])
        self._low, self._high = soles.min(axis=1), soles.max(axis=1)
        self.slope = np.zeros(2)

    def look(self, sample: int, estimate: Estimate) -> None:
        """Update the slope in single support. The foot lies flat if its centre of pressure is inside the sole.

        Args:
            sample: sample of the estimate.
            estimate: estimate of the robot's state.
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
        """Height of the floor under each planned foot (2,) above that under the CoM [m]."""
        away = self._planned.ankles[sample, :, :2] - self._planned.com[sample, :2]
        return np.asarray(self.slope[0] * away[:, 1] - self.slope[1] * away[:, 0])
