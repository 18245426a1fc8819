"""The base motion: Algorithm 1's own units with one key configuration, and no adaptation.

The optimiser searches for deviations from it that vanish at both ends of the crossing. So the motion begins and ends
inside Algorithm 1's walk, with its steps, its timing and its ZMP. The base may reach too far or touch the obstacle.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stepover.model.obstacle import Obstacle
from stepover.model.parameters.optimal import Optimal
from stepover.model.robot import Robot
from stepover.motion.footsteps import LEG_1
from stepover.planning.algorithm_1.beyond_paper import extra_zmp
from stepover.planning.algorithm_1.com_waist import com_and_waist
from stepover.planning.algorithm_1.dynamic_filter import filtered_waist
from stepover.planning.algorithm_1.feasibility import KeyConfiguration
from stepover.planning.algorithm_1.feet_trajectories import feet_trajectories, swing_shape
from stepover.planning.algorithm_1.step_sequence import Crossing, Step, StepSequence, step_sequence
from stepover.planning.algorithm_1.upper_body import with_arms
from stepover.planning.optimal.channels import UPPER, euler, upper_joints

PASSES = 3
"""Passes of the dynamic filter: the base need not be exact."""
ERROR = 0.06
"""ZMP error [m] that the filter sees at most, where the base over-reaches."""


@dataclass(frozen=True, eq=False)
class Base:
    """A base motion of N samples.

    Attributes:
        sequence: its steps.
        channels: (N, C).
        upper: (N, nq) configurations with the upper body set.
        key: posture over the obstacle that it was laid out for.
    """

    sequence: StepSequence
    channels: np.ndarray
    upper: np.ndarray
    key: KeyConfiguration

    @property
    def time(self) -> np.ndarray:
        """(N,) [s]."""
        return self.sequence.time

    @cached_property
    def crossing(self) -> list[Step]:
        """The steps that the optimiser changes: the one before the obstacle, leg 1, leg 2, the one after."""
        steps = list(self.sequence.steps)
        first = steps.index(self.sequence.step(LEG_1))
        return steps[max(first - 1, 0) : first + 3]

    @cached_property
    def bearing(self) -> np.ndarray:
        """Foot (N,) that bears, or in double support bore before: +1 left, -1 right."""
        support = self.sequence.support
        single = np.flatnonzero(support)
        last = np.searchsorted(single, np.arange(len(support)), side="right") - 1
        return np.asarray(support[single[np.maximum(last, 0)]])


def base_motion(robot: Robot, obstacle: Obstacle, p: Optimal, leading: int = -1) -> Base:
    """Lay out the base motion for an obstacle.

    Raises:
        Infeasible: the obstacle is nearer than the first step.
    """
    soles = robot.foot.heel + robot.foot.toe + 2.0 * robot.feasibility.foothold_clearance
    longest = robot.feasibility.step_length_max + robot.feasibility.step_length_more
    x_ads = min(max(p.step_length, obstacle.safe_depth + soles), longest)
    yaw = -leading * np.radians(robot.feasibility.waist_yaw_deg)
    key = KeyConfiguration(x_ads, robot.feasibility.delta_ds * x_ads, p.waist_height, yaw)
    low = dataclasses.replace(obstacle, height=min(obstacle.height, p.base_height))
    sequence = extra_zmp(robot, step_sequence(robot, low, key, robot.rest_zmp(), leading), 1)
    feet = feet_trajectories(Crossing(robot, low, sequence), swing_shape(robot, late=0, leg_2_late=True))
    first = com_and_waist(robot, sequence, key)
    upper, waist = with_arms(robot, sequence, first.yaw, 0.0), first.waist
    for _ in range(PASSES):
        q = upper.copy()
        q[:, :7] = waist
        for side in (1, -1):
            q[:, robot.leg(side).columns] = robot.leg(side).attempt(waist, feet.foot(side))[0]
        error = np.clip(robot.body.zmp(q, robot.walk.sample_time) - sequence.zmp, -ERROR, ERROR)
        waist = filtered_waist(robot, waist, sequence.zmp, sequence.zmp + error)
    channels = np.empty((len(waist), UPPER + len(upper_joints(robot))))
    channels[:, :UPPER] = np.column_stack([euler(waist), euler(feet.left), euler(feet.right)])
    channels[:, UPPER:] = upper[:, [robot.body.column(joint) for joint in upper_joints(robot)]]
    return Base(sequence, channels, upper, key)
