"""What stays the same while the optimiser searches: robot, base motion, obstacle, and the samples looked at."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stepover.model.obstacle import Obstacle
from stepover.model.parameters.optimal import Optimal
from stepover.model.robot import Robot
from stepover.motion.footsteps import LEG_1
from stepover.planning.optimal.base import Base
from stepover.planning.optimal.channels import SIDES, WAIST, Channels


@dataclass(frozen=True, eq=False)
class Scene:
    """What stays the same while the optimiser searches.

    Attributes:
        channels: from channels to postures.
        base: the base motion.
        obstacle: with its margins.
        parameters: reserves and weights.
        samples: (n,) samples at which constraints are kept.
    """

    channels: Channels
    base: Base
    obstacle: Obstacle
    parameters: Optimal
    samples: np.ndarray

    @property
    def robot(self) -> Robot:
        """The robot."""
        return self.channels.robot

    @property
    def dt(self) -> float:
        """Sample time [s]."""
        return self.robot.walk.sample_time

    @property
    def time(self) -> np.ndarray:
        """(n,) [s]."""
        return self.base.time[self.samples]

    @cached_property
    def support(self) -> np.ndarray:
        """(n,) 0 double, +1 left, -1 right."""
        return self.base.sequence.support[self.samples]

    @cached_property
    def landed(self) -> np.ndarray:
        """(n,) bool: just after leg 1 has landed, where rubber and stabilizer need reserves."""
        landing = self.base.sequence.step(LEG_1).touch_down
        last = landing + round(self.parameters.landed / self.dt)
        return np.asarray((self.samples >= landing) & (self.samples <= last))

    @cached_property
    def bearing(self) -> np.ndarray:
        """(n,) foot in whose frame the forces of the floor are told: +1 left, -1 right."""
        return self.base.bearing[self.samples]

    @cached_property
    def bearing_joints(self) -> list[str]:
        """Last joint of that foot's leg, for each sample."""
        last = {side: self.robot.leg(side).joints[-1] for side in SIDES}
        return [last[side] for side in self.bearing.tolist()]

    @cached_property
    def moved_by(self) -> np.ndarray:
        """(J, C) bool: which coordinates q move a joint of Placements."""
        supports, columns = self.robot.body.model.supports, self.channels.full_columns
        found = np.zeros((len(supports), self.channels.count), dtype=bool)
        found[1:, WAIST] = True
        for joint in range(2, len(supports)):
            chain = set(supports[joint])
            found[joint, 6:] = [column - 5 in chain for column in columns]
        return found
