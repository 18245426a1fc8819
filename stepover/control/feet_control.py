"""Control of the feet: ankle damping and foot-force difference control, after Kajita et al. (2010), Sec. IV.

With rubber soles, an ankle's moment first bends the rubber. So the foot is also turned in advance by the bend that the
wanted moment will cause. Then the sole stays flat and the body upright. The rubber is a spring k with a damper d:
d x' + k x = moment.
"""

from __future__ import annotations

import numpy as np

from stepover.control.admittance import damped
from stepover.control.estimator import Estimate
from stepover.control.force_distribution import Distribution
from stepover.control.reference import Reference
from stepover.model.robot import Robot


class FeetControl:
    """Displacements of both feet, left and right.

    Attributes:
        heights: (2,) [m].
    """

    def __init__(self, robot: Robot, planned: Reference, rubber: bool = False) -> None:
        """Start with the planned feet; `rubber` states whether there is rubber under the ankles."""
        self._gains, self._planned, self._rubber = robot.stabilizer, planned, robot.sole if rubber else None
        self._damped, self._ahead = np.zeros((2, 2)), np.zeros((2, 2))
        self.heights = np.zeros(2)

    @property
    def turns(self) -> np.ndarray:
        """Roll and pitch (2, 2) about the ankles [rad]."""
        return self._damped + self._ahead

    def give_way(self, sample: int, then: int, estimate: Estimate, shared: Distribution) -> None:
        """One period.

        A foot turns as the floor turns it, until the centre of pressure is at its desired place: toe down for a centre
        further ahead, left edge down for one further left. A foot that bears too much rises, and the other foot comes
        down by the same distance, so that the waist stays in place. A foot that meets the floor early stops its
        descent.

        Args:
            sample: sample of the new command.
            then: sample of the estimate.
            estimate: estimate of the robot's state.
            shared: desired load of each foot and its centre of pressure.
        """
        gains, dt, loads = self._gains, self._planned.dt, estimate.loads
        most = np.radians(gains.ankle_max_deg)
        lack = _moments(loads, shared.cops - estimate.cops)
        self._damped = damped(self._damped, lack, gains.ankle_admittance, gains.ankle_return, most, dt)
        if self._rubber is not None:
            stiffness, damping = self._rubber.tilt_stiffness, self._rubber.tilt_damping
            wanted = _moments(loads, shared.cops)
            self._ahead = damped(self._ahead, wanted, 1.0 / damping, damping / stiffness, most, dt)
        excess = loads - shared.shares * loads.sum()
        apart = 0.5 * (excess - excess[::-1])
        descent = self._planned.ankles[max(sample - 1, 0), :, 2] - self._planned.ankles[sample, :, 2]
        held = np.where(self._planned.landing[then] & (loads > 0.0), np.maximum(descent, 0.0), 0.0)
        self.heights = damped(
            self.heights + held, apart, gains.force_admittance, gains.force_return, gains.force_max, dt
        )


def _moments(loads: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Moments on the feet (2, 2), roll and pitch [N m], of loads (2,) at places (2, 2). Ahead means toe down."""
    return np.column_stack([-loads * places[:, 1], loads * places[:, 0]])
