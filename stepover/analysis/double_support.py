"""The quasi-static conditions (6)-(8) and the dynamic ones (10)-(12) along a planned motion. Sec. II."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stepover.analysis.planar.biped import between_feet, over_front_foot, over_rear_foot
from stepover.errors import InvalidInput
from stepover.model.robot import Robot
from stepover.motion.motion import Motion


@dataclass(frozen=True)
class DoubleSupport:
    """CoM and ZMP in phase 2, x from the rear ankle.

    Attributes:
        x_ads: distance between the ankles [m].
        foot: foot length F_W [m].
        com, zmp: (n,) from the touch-down of leg 1 to the lift-off of leg 2, both included [m].
    """

    x_ads: float
    foot: float
    com: np.ndarray
    zmp: np.ndarray

    def holds(self, x: np.ndarray) -> tuple[bool, bool, bool]:
        """Whether (6), (7), (8) hold for the CoM's x (n,), or (10), (11), (12) for the ZMP's."""
        middle = between_feet(x, self.x_ads, self.foot).all()
        return (
            bool(over_rear_foot(x[0], self.foot)),
            bool(middle),
            bool(over_front_foot(x[-1], self.x_ads, self.foot)),
        )


def double_support(robot: Robot, motion: Motion) -> DoubleSupport:
    """Phase 2 of a motion.

    Raises:
        InvalidInput: the motion has no phase 2.
    """
    if not (motion.phase == 2).any():
        raise InvalidInput("the motion has no double support over an obstacle")
    span = motion.samples(2)
    rear, front = np.sort([motion.left_foot[span.start, 0], motion.right_foot[span.start, 0]]).tolist()
    com, zmp = (x[span.start : span.stop + 1, 0] - rear for x in (motion.com, motion.zmp))
    return DoubleSupport(front - rear, robot.foot.sole_length, com, zmp)
