"""How long Algorithm 1 takes on this machine, and in sweeps of the rigid-body dynamics, which no machine changes much.

A batch computes all samples at once. A robot that plans while it walks computes one: `online_tick` is that.
"""

from __future__ import annotations

import timeit
from collections.abc import Callable

import numpy as np

from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.motion.footsteps import LEG_2
from stepover.motion.motion import Motion
from stepover.planning.algorithm_1.feasibility import key_configurations
from stepover.planning.algorithm_1.feet_trajectories import feet_trajectories
from stepover.planning.algorithm_1.plan import Plan
from stepover.planning.algorithm_1.planner import whole_body
from stepover.planning.algorithm_1.preview_control import cart, kajita_gains
from stepover.planning.algorithm_1.step_sequence import Crossing, step_sequence
from stepover.planning.leg_check import LegLimits, check_legs
from stepover.planning.trajectories import FeetTrajectories, WaistAndFeet


def planning_times(robot: Robot, obstacle: Obstacle, motion: Motion, whole: float, repeats: int) -> list[float]:
    """Computing time of Algorithm 1 on this machine, from medians.

    Args:
        robot: the robot.
        obstacle: the obstacle.
        motion: the motion over the obstacle.
        whole: computing time of the whole of Algorithm 1 [s].
        repeats: number of repetitions of each measurement.

    Returns:
        Times of steps 1 and 2, and of steps 3 to 7 per sample [s]; the former over the time of one sweep of the
        rigid-body dynamics over the whole motion, the latter over that of one sample.
    """

    def planning() -> None:
        sequence = step_sequence(robot, obstacle, key_configurations(robot, obstacle)[0], robot.rest_zmp())
        feet_trajectories(Crossing(robot, obstacle, sequence))

    first = _median_time(planning, repeats)
    dynamics = _median_time(lambda: robot.body.contact_wrench(motion.q, motion.dt), repeats)
    return [first, (whole - first) / len(motion.time), first / dynamics, (whole - first) / dynamics]


def online_tick(robot: Robot, planned: Plan, repeats: int) -> tuple[float, float]:
    """One iteration of steps 3 to 7 for one sample in the middle of leg 2's swing, as a controller would run it.

    Two updates of preview control over their windows, two inverse kinematics (before and after the filter), the
    multi-body ZMP from the last three postures, and FTA's test of one posture.

    Returns:
        Its median time [s], and that over the time of the rigid-body dynamics of one sample, as part of a sweep.
    """
    motion, dt = planned.motion, planned.motion.dt
    at = (planned.sequence.step(LEG_2).lift_off + planned.sequence.step(LEG_2).touch_down) // 2
    gains, (state, command, _) = kajita_gains(robot.preview, dt), cart(dt, robot.preview.com_height)
    reference = np.resize(motion.zmp_reference[at:], (len(gains.preview), 2))
    cart_state, last = np.zeros((3, 2)), motion.q[at - 1 : at + 2]
    feet = FeetTrajectories(motion.left_foot, motion.right_foot)
    poses = WaistAndFeet(motion.waist, feet).at(slice(at, at + 1))
    limits = LegLimits(motion.profile(0, margins=True), 0.0)

    def tick() -> None:
        for _ in range(2):  # steps 3 and 6
            jerk = gains.preview @ reference - gains.state @ cart_state
            state @ cart_state + np.outer(command, jerk)
            whole_body(robot, poses, motion.q[at : at + 1], motion.time[at : at + 1])  # step 4
        robot.body.zmp(last, dt)
        check_legs(robot, poses, limits)  # step 7

    dynamics = _median_time(robot.body.dynamics_sweep(motion.q, dt), repeats) / len(motion.time)
    one = float(np.median(timeit.repeat(tick, number=20, repeat=repeats + 1)[1:])) / 20.0
    return one, one / dynamics


def _median_time(work: Callable[[], object], repeats: int) -> float:
    """Median duration of a call [s]. A first call is not counted."""
    times = timeit.repeat(work, number=1, repeat=repeats + 1)[1:]
    return float(np.median(times))
