"""What turns a planned motion into motor commands, step by step. Here: the ideal motors of the paper's simulation."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from stepover.errors import InvalidInput
from stepover.model.physics_parameters import Simulation
from stepover.motion import Motion
from stepover.simulation.world import World


class IdealMotors:
    """Position-controlled motors that follow the planned joint angles, without any limit that they could reach.

    Attributes:
        steps: time steps from one sample of the motion to the next.
        angles: (S + 1, nq - 7) joint angles at every time step, by cubic splines through the samples [rad].
        speeds: (S, nq - 7) from each time step to the next [rad/s].
    """

    def __init__(self, motion: Motion, parameters: Simulation) -> None:
        """Interpolate the motion.

        Raises:
            InvalidInput: its sample time is no multiple of the time step.
        """
        self._parameters = parameters
        step = parameters.time_step
        self.steps = round(motion.dt / step)
        if self.steps < 1 or abs(self.steps * step - motion.dt) > 1e-9:
            raise InvalidInput(f"the motion's sample time, {motion.dt:g} s, is no multiple of the time step {step:g} s")
        samples = np.arange(len(motion.time)) * self.steps
        spline = CubicSpline(samples, motion.q[:, 7:], bc_type="clamped")
        self.angles = spline(np.arange(samples[-1] + 1))
        self.speeds = np.diff(self.angles, axis=0) / step

    def drive(self, world: World, step: int) -> None:
        """Command one time step."""
        torque, correction = self._parameters.ideal_motor_torque, self._parameters.ideal_motor_correction
        world.command(self.angles[step], self.speeds[step], torque, correction)
