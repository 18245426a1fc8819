"""DCM feedback: a ZMP inside the support polygon that removes the DCM's deviation. Caron et al. (2019), Sec. III.

The DCM moves away from the ZMP: xi' = omega (xi - z). With the ZMP z = z_plan + (1 + k_p / omega) e + (k_i / omega)
int e, its deviation e decays with the rate k_p.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stepover.control.admittance import Integral
from stepover.control.estimator import SIDES, Estimate
from stepover.control.force_distribution import Distribution, distribute
from stepover.control.reference import Reference
from stepover.control.support_region import patch, regions
from stepover.model.robot import Robot
from stepover.motion.motion import Motion


@dataclass(frozen=True, eq=False)
class DesiredZmp:
    """The desired ZMP at one sample.

    Attributes:
        zmp: (2,) desired ZMP inside the support region [m].
        cut: (2,) the part of the feedback that lies beyond the region [m].
        shared: distribution of the force between the feet.
    """

    zmp: np.ndarray
    cut: np.ndarray
    shared: Distribution


class DcmFeedback:
    """Proportional and integral feedback of the DCM."""

    def __init__(self, robot: Robot, motion: Motion, planned: Reference) -> None:
        """Start without a deviation."""
        gains = robot.stabilizer
        self._planned = planned
        self._proportional = 1.0 + gains.dcm_proportional / planned.omega
        self._integral_gain = gains.dcm_integral / planned.omega
        most = gains.dcm_integral_max / self._integral_gain
        self.integral = Integral(gains.dcm_leak, most, planned.dt)
        self._regions = regions(robot, motion, gains.zmp_inset)
        soles = np.stack([patch(robot, side, gains.zmp_inset) for side in SIDES])
        self._low, self._high = soles.min(axis=1), soles.max(axis=1)

    def desired(self, sample: int, estimate: Estimate) -> DesiredZmp:
        """The desired ZMP for one period.

        Args:
            sample: sample of the estimate.
            estimate: estimate of the robot's state.
        """
        planned = self._planned
        error = estimate.dcm - planned.dcm[sample]
        asked = planned.zmp[sample] + self._proportional * error + self._integral_gain * self.integral.value
        soles = estimate.soles[:, :2]
        standing = [foot for foot, side in enumerate(SIDES) if planned.support[sample] in (0, side)]
        moved = (soles - planned.soles[sample, :, :2])[standing].mean(axis=0)  # the feet may stand elsewhere
        zmp = self._regions[sample].nearest(asked - moved) + moved
        self.integral.add(error, asked - zmp)
        return DesiredZmp(zmp, asked - zmp, self._share(zmp, soles, standing))

    def _share(self, zmp: np.ndarray, soles: np.ndarray, standing: list[int]) -> Distribution:
        """Distribute the force between both feet, or give all of it to the only standing foot."""
        if len(standing) == 2:
            return distribute(zmp, soles, self._low, self._high)
        shares, cops = np.zeros(2), np.zeros((2, 2))
        shares[standing], cops[standing] = 1.0, zmp - soles[standing]
        return Distribution(shares, cops)
