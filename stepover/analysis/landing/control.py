"""Landing control: stops the descent of leg 1's foot when it meets the floor. The paper has no such control (II-C).

It wraps the source of the commands, which is the stabilizer or the plan, and uses only the same readings.
"""

from __future__ import annotations

import numpy as np

from stepover.control.estimator import Estimate
from stepover.control.sensors import Sensed
from stepover.model.pose import from_matrices
from stepover.model.robot import Robot
from stepover.motion.footsteps import LEG_1
from stepover.motion.motion import Motion
from stepover.simulation.commands import Controller

THRESHOLD = 50.0
"""Force at which the landing control considers the foot landed [N]: 9 % of HRP-2's weight."""


class AsPlanned:
    """A controller that returns the planned motion unchanged."""

    estimate: Estimate | None = None

    def __init__(self, motion: Motion) -> None:
        """Store the motion."""
        self._joints = motion.q[:, 7:]

    def command(self, sample: int, sensed: Sensed) -> np.ndarray:
        """Planned joint angles (nq - 7,) [rad]. Readings are ignored."""
        return np.asarray(self._joints[sample])


class LandingControl:
    """Stops the descent of leg 1 once its foot bears a load, and later returns the foot to the wrapped controller.

    Otherwise a foot that lands early would push down until the planned touch-down. After the first reading above the
    threshold, the sole keeps its last commanded height, relative to the planned waist. The correction fades linearly
    over the double support, before leg 2 lifts off.

    Attributes:
        stopped: sample of the first held command, or None.
    """

    def __init__(self, robot: Robot, motion: Motion, inner: Controller, threshold: float = THRESHOLD) -> None:
        """Wrap a source of commands, with a threshold [N]."""
        step = motion.footsteps.of_kind(LEG_1)
        self._inner, self._motion, self._threshold, self._side = inner, motion, threshold, int(step.side[0])
        self._touch_down = round((step.time[0] - motion.time[0]) / motion.dt)
        self._from = (motion.samples(1).start + self._touch_down) // 2
        self._leg = robot.leg(self._side)
        self._release = robot.walk.double_support_over / motion.dt
        self.stopped: int | None = None
        self._height = float(motion.foot(self._side)[0, 2])

    @property
    def estimate(self) -> Estimate | None:
        """Estimate of the wrapped controller."""
        return self._inner.estimate

    def command(self, sample: int, sensed: Sensed) -> np.ndarray:
        """Joint angles (nq - 7,) [rad] for one sample: those of the wrapped controller, with the landing foot held."""
        joints = np.array(self._inner.command(sample, sensed))
        columns = np.array(self._leg.columns) - 7
        waist = self._motion.waist[sample, None]
        turns, places = self._leg.sole(waist, joints[None, columns])
        bears = sensed.wrench(self._side)[2] > self._threshold
        if self.stopped is None and self._from < sample <= self._touch_down and bears:
            self.stopped = sample
        elif self.stopped is None:
            self._height = float(places[0, 2])
        lift = self.lift(sample, float(places[0, 2]))
        if lift > 0.0:
            held = from_matrices(turns, places + np.array([0.0, 0.0, lift]))
            joints[columns] = self._leg.attempt(waist, held)[0][0]
        return joints

    def lift(self, sample: int, height: float) -> float:
        """Height of the held sole above its commanded height at a sample [m]."""
        if self.stopped is None:
            return 0.0
        left = 1.0 - max(sample - self._touch_down, 0) / self._release
        return max(self._height - height, 0.0) * max(left, 0.0)
