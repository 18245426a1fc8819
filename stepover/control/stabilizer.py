"""The stabilizer: joint angles that keep a disturbed robot on its motion, after Kajita (2010) and Caron (2019).

The DCM's deviation from the plan gives a desired ZMP. It is distributed between the feet. Ankles, feet and CoM move
until the sensors read this ZMP. Readings are compared with the plan at the sample at which they were taken.
"""

from __future__ import annotations

import numpy as np

from stepover.control.dcm_feedback import DcmFeedback
from stepover.control.estimator import Estimate, Estimator
from stepover.control.feet_control import FeetControl
from stepover.control.floor import Floor
from stepover.control.leg_commands import LegCommands
from stepover.control.reference import reference
from stepover.control.sensors import Sensed
from stepover.control.waist_control import WaistControl
from stepover.model.parameters.planning import samples
from stepover.model.robot import Robot
from stepover.motion.motion import Motion


class Stabilizer:
    """Called once a period with older readings; robot.stabilizer.age is their age.

    Attributes:
        estimate: estimate of the last call, or None.
        floor: estimate of the floor.
    """

    def __init__(self, robot: Robot, motion: Motion, rubber: bool = False) -> None:
        """Prepare for a motion. The stabilizer starts at rest.

        Args:
            robot: robot with the gains.
            motion: motion to carry out.
            rubber: whether there is rubber under the ankles, as described by robot.sole.
        """
        planned = reference(robot, motion)
        give = 1.0 / robot.sole.vertical_stiffness if rubber else 0.0
        self._age = samples(robot.stabilizer.age, motion.dt)
        self._estimator = Estimator(robot, planned, give)
        self._feedback = DcmFeedback(robot, motion, planned)
        self._feet = FeetControl(robot, planned, rubber)
        self.floor = Floor(robot, planned, rubber)
        self._waist = WaistControl(robot, planned)
        self._legs = LegCommands(robot, planned)
        self.estimate: Estimate | None = None

    def command(self, sample: int, sensed: Sensed) -> np.ndarray:
        """Joint angles (nq - 7,) [rad] for one sample.

        Args:
            sample: sample of the angles.
            sensed: readings taken `age` samples earlier.
        """
        then = max(sample - self._age, 0)
        self.estimate = self._estimator.update(then, sensed)
        desired = self._feedback.desired(then, self.estimate)
        self.floor.look(then, self.estimate)
        self._feet.give_way(sample, then, self.estimate, desired.shared)
        rise = float(self.estimate.weights @ self.floor.rises(then))
        waists = self._waist.move(sample, then, self.estimate, desired.zmp, rise)
        heights = self._feet.heights + self.floor.rises(sample)
        return self._legs.command(sample, waists, self._feet.turns, heights, self.floor.slope)
