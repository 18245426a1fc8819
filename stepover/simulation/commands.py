"""What the motors are told from one sample of the motion to the next: the plan, or what a controller makes of it."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from stepover.control.estimator import Estimate
from stepover.control.sensors import Sensed
from stepover.model.parameters.planning import samples
from stepover.motion.motion import Motion
from stepover.simulation.engine import Engine
from stepover.simulation.sensing import Senses
from stepover.simulation.touch import Touch
from stepover.simulation.trajectory import JointTrajectory, spline, steps_a_sample, straight


class Controller(Protocol):
    """What makes joint angles out of readings once a sample, as the stabilizer does."""

    @property
    def estimate(self) -> Estimate | None:
        """Of the robot, where the controller makes one."""

    def command(self, sample: int, sensed: Sensed) -> np.ndarray:
        """Joint angles (J,) for a sample [rad]."""


class Commands(Protocol):
    """Where the loop gets the motors' commands from."""

    def trajectory(self, sample: int) -> JointTrajectory:
        """From the sample before to this one."""

    def sense(self, touch: Touch) -> None:
        """A sample has been reached, the first one included: read the sensors."""

    @property
    def estimate(self) -> Estimate | None:
        """A controller's last estimate of the robot, where there is one."""


class OpenLoop:
    """The motion as it is; nothing is sensed."""

    estimate: Estimate | None = None

    def __init__(self, motion: Motion, steps: int) -> None:
        """Interpolate the motion, with so many time steps from one sample to the next."""
        self._whole, self._steps = spline(motion, steps), steps

    def trajectory(self, sample: int) -> JointTrajectory:
        """Along the spline."""
        return self._whole.part((sample - 1) * self._steps, self._steps)

    def sense(self, touch: Touch) -> None:
        """Nothing is sensed."""


class ClosedLoop:
    """A controller, which sees what the senses read and nothing else.

    In the time until the next sample the motors go straight to a command; the rest of robot.stabilizer.age it takes to
    work it out. So the command for a sample rests on what was sensed that much earlier, plus extra latency.
    """

    def __init__(self, controller: Controller, senses: Senses, motion: Motion, steps: int, delay: float) -> None:
        """Begin where the motion does.

        Args:
            controller: makes the commands.
            senses: what it reads.
            motion: where it begins, and its sample time.
            steps: time steps from one sample to the next.
            delay: age of the readings that a command is worked out from [s].
        """
        self._controller, self._senses, self._delay = controller, senses, delay
        self._steps, self._period, self._command = steps, motion.dt, motion.q[0, 7:]

    @property
    def estimate(self) -> Estimate | None:
        """The controller's last one."""
        return self._controller.estimate

    def trajectory(self, sample: int) -> JointTrajectory:
        """From the last command to a new one."""
        before = self._command
        self._command = self._controller.command(sample, self._senses.late(self._delay))
        return straight(before, self._command, self._steps, self._period)

    def sense(self, touch: Touch) -> None:
        """Read the sensors."""
        self._senses.read(touch)


def commands_of(controller: Controller | None, motion: Motion, engine: Engine) -> Commands:
    """A motion under a controller, or open loop without one.

    Raises:
        InvalidInput: the motion's sample time is no multiple of the engine's time step.
    """
    robot = engine.scene.robot
    steps = steps_a_sample(motion, robot.simulation.time_step)
    if controller is None:
        return OpenLoop(motion, steps)
    delay = (samples(robot.stabilizer.age, motion.dt) - 1) * motion.dt
    return ClosedLoop(controller, Senses(engine, motion.dt), motion, steps, delay)
