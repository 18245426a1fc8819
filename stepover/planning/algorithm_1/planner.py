"""Algorithm 1 of the paper: from the obstacle to a whole-body motion, seven steps in the paper's order."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable
from functools import partial

import numpy as np

from stepover.errors import Infeasible, InvalidInput, OutOfReach
from stepover.model.course import Course
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.motion.footsteps import Footsteps
from stepover.motion.motion import Motion, obstacle_row
from stepover.planning.algorithm_1.beyond_paper import extra_shape, extra_zmp, waist_delay
from stepover.planning.algorithm_1.com_waist import com_and_waist
from stepover.planning.algorithm_1.dynamic_filter import filtered_waist
from stepover.planning.algorithm_1.feasibility import KeyConfiguration, key_configurations
from stepover.planning.algorithm_1.feet_adaptor import adapt_feet
from stepover.planning.algorithm_1.feet_trajectories import feet_trajectories
from stepover.planning.algorithm_1.plan import Nominal, Options, Plan
from stepover.planning.algorithm_1.search import first_plan, options_in_order, plannable
from stepover.planning.algorithm_1.shift_and_raise import raise_waist
from stepover.planning.algorithm_1.step_sequence import Crossing, StepSequence, step_sequence
from stepover.planning.algorithm_1.upper_body import moved, upper_body
from stepover.planning.checks import require, require_speeds
from stepover.planning.nearest import nearest_crossable
from stepover.planning.request import one_obstacle
from stepover.planning.trajectories import WaistAndFeet

ARMS = ("auto", "on", "off")
SPEED_LIMITS = ("ignore", "respect")
SEARCH = 150
"""Attempts that the search for the nearest obstacle may make: about 6 s. Most searches make 30."""


def plan(
    robot: Robot,
    obstacle: Obstacle | Course,
    *,
    arms: str = "auto",
    speed_limits: str = "ignore",
    extras: bool = True,
) -> Motion:
    """Plan how to step over an obstacle dynamically.

    Args:
        robot: from load_robot.
        obstacle: the obstacle with its margins, or a course that holds one.
        arms: UBMG: "auto" swings the arms back where the lead knee needs it, "on" always, "off" never.
        speed_limits: "ignore" the joints' speed limits, as the paper's simulation does, or "respect" them by moving
            by the slow parameters (model.parameters.slow).
        extras: whether what is added beyond the paper may be used where the paper's own methods do not reach.

    Returns:
        The whole-body motion.

    Raises:
        InvalidInput: no Robot, no Obstacle, several obstacles, or an unknown value of an option.
        Infeasible: names the constraint that cannot be met and the nearest obstacle that can be stepped over.
    """
    return plan_in_detail(robot, obstacle, arms=arms, speed_limits=speed_limits, extras=extras).motion


def plan_in_detail(
    robot: Robot,
    obstacle: Obstacle | Course,
    *,
    arms: str = "auto",
    speed_limits: str = "ignore",
    extras: bool = True,
    look_for_nearest: bool = True,
    progress: Callable[[float], None] | None = None,
) -> Plan:
    """As plan, and keep what the units handed to each other.

    After a refusal, progress is called with the share done of the search for the nearest obstacle.

    Key configurations and options are tried in the order of algorithm_1.search; the first that works is taken.
    """
    obstacle = one_obstacle(robot, obstacle)
    for name, value, known in (("arms", arms, ARMS), ("speed_limits", speed_limits, SPEED_LIMITS)):
        if value not in known:
            raise InvalidInput(f"{name} = {value!r} must be one of {', '.join(known)}")
    if not isinstance(extras, bool):
        raise InvalidInput(f"extras = {extras!r} must be True or False")
    start = time.perf_counter()
    mover = robot.slowed if speed_limits == "respect" else robot
    options = options_in_order(mover, arms, extras, speed_limits)

    def attempt(obstacle: Obstacle, key: KeyConfiguration, options: Options) -> Plan:
        found = algorithm_1(mover, obstacle, key, options)
        if speed_limits == "respect":
            require_speeds(mover, found.motion)
        return found

    left = iter(range(SEARCH))

    def search_attempt(other: Obstacle, key: KeyConfiguration, options: Options) -> Plan:
        if next(left, None) is None:
            raise Infeasible("the search for the nearest obstacle ends", walking=True)
        return attempt(other, key, options)

    def crossable(other: Obstacle) -> bool:
        try:
            return plannable(mover, key_configurations(mover, other), options, partial(search_attempt, other))
        except Infeasible:
            return False

    try:
        keys = key_configurations(mover, obstacle)  # 1: FU
        feasibility_time = time.perf_counter() - start
        found = first_plan(mover, keys, options, partial(attempt, obstacle))
    except Infeasible as error:
        error.forget_frames()
        if error.nearest is None and look_for_nearest and not error.walking:
            error.nearest = nearest_crossable(obstacle, crossable, progress)
        raise
    total = time.perf_counter() - start
    times = {"feasibility": feasibility_time, "trajectories": total - feasibility_time, "total": total}
    return dataclasses.replace(found, planning_time=times)


def algorithm_1(robot: Robot, obstacle: Obstacle, key: KeyConfiguration, options: Options) -> Plan:
    """Steps 2 to 7 of Algorithm 1, for a key configuration from step 1.

    The filter and FTA take turns until, after a pass of the filter, FTA has nothing left to adapt.

    Raises:
        Infeasible: a sole is out of reach, FTA cannot free the trailing leg, or the motion breaks a limit.
    """
    nominal = nominal_trajectories(robot, obstacle, key, options)  # 2: FTG, 3: CWTG1, 5: UBMG
    crossing, sequence, upper = nominal.crossing, nominal.crossing.sequence, nominal.upper
    waist, feet, adaptation = nominal.waist, nominal.feet, None
    zmps: list[np.ndarray] = []
    for _ in range(robot.preview.filter_passes_max):
        try:
            waist, zmp = filter_pass(crossing, WaistAndFeet(waist, feet), upper.q)  # 4: IK, 6: CWTG2
        except OutOfReach as error:
            if adaptation is None:
                raise
            raise Infeasible(error.constraint, short=error.short) from error  # not for want of a lower waist alone
        zmps.append(zmp)
        flat = waist if adaptation is None else raise_waist(robot, sequence, waist, -adaptation.raised)
        if adaptation is not None and adaptation.still_clear(crossing, waist):
            break
        adaptation = adapt_feet(crossing, WaistAndFeet(flat, nominal.feet), options.methods)  # 7: FTA
        if not adaptation.clear:
            raise adaptation.refusal(crossing, flat)
        if not adaptation.acted:
            break
        feet, waist = adaptation.feet, raise_waist(robot, sequence, flat, adaptation.raised)
    assert adaptation is not None
    q = whole_body(robot, WaistAndFeet(waist, feet), upper.q, sequence.time)
    placements = robot.body.placements(q)
    motion = Motion(
        time=sequence.time, q=q, joint_names=np.array(robot.body.joint_names),
        left_foot=feet.left, right_foot=feet.right, waist=waist, com=robot.body.com(placements),
        zmp_reference=sequence.zmp, zmp_first_stage=zmps[0], zmp=robot.body.zmp(q, robot.walk.sample_time),
        support=sequence.support, phase=sequence.phase, footsteps=_footsteps(sequence),
        key_configuration=np.array([key.x_ads, key.x_hds, key.z_hds]),
        obstacles=obstacle_row(obstacle, sequence.front_face)[None],
        robot=robot.name, robot_fingerprint=robot.fingerprint, planner="paper",
    )  # fmt: skip
    require(robot, motion, placements)
    return Plan(motion, key, nominal, adaptation, options, len(zmps), {})


def nominal_trajectories(robot: Robot, obstacle: Obstacle, key: KeyConfiguration, options: Options) -> Nominal:
    """Steps 2, 3 and 5: feet, waist and upper body before the dynamics of all links are known.

    Raises:
        Infeasible: the obstacle is nearer than the first step.
    """
    level = options.level
    sequence = extra_zmp(robot, step_sequence(robot, obstacle, key, robot.rest_zmp()), level)  # 2: FTG
    crossing = Crossing(robot, obstacle, sequence)
    ftg = feet_trajectories(crossing, extra_shape(robot, level))
    first = com_and_waist(robot, sequence, key, waist_delay(robot, level))  # 3: CWTG1
    upper = upper_body(robot, sequence, ftg, first, options.arms)  # 5: UBMG
    return Nominal(crossing, ftg, first, upper, moved(first.waist, upper.waist_shift))


def filter_pass(crossing: Crossing, poses: WaistAndFeet, upper: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Steps 4 and 6: one pass of the filter.

    Args:
        crossing: robot, obstacle and steps.
        poses: waist and feet before.
        upper: (N, nq) configurations with the upper body set.

    Returns:
        Waist (N, 7) after it, and the multi-body ZMP (N, 2) before it [m].

    Raises:
        OutOfReach: a sole is out of reach.
    """
    robot, sequence = crossing.robot, crossing.sequence
    q = whole_body(robot, poses, upper, sequence.time)  # 4: IK
    zmp = robot.body.zmp(q, robot.walk.sample_time)
    return filtered_waist(robot, poses.waist, sequence.zmp, zmp), zmp  # 6: CWTG2


def whole_body(robot: Robot, poses: WaistAndFeet, upper: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Configurations (N, nq), with the legs by inverse kinematics: step 4 of Algorithm 1.

    Args:
        robot: the robot.
        poses: waist and feet.
        upper: (N, nq) configurations with the upper body set.
        time: (N,) [s], for the message where a sole is out of reach.

    Raises:
        OutOfReach: a sole is out of reach.
    """
    q = upper.copy()
    q[:, :7] = poses.waist
    for side in (1, -1):
        leg = robot.leg(side)
        q[:, leg.columns] = leg.inverse(poses.waist, poses.feet.foot(side), time)
    return q


def _footsteps(sequence: StepSequence) -> Footsteps:
    """Where the feet come down and when."""
    time = sequence.time
    return Footsteps.from_rows(np.array([[time[s.touch_down], s.side, *s.end, 0.0, s.kind] for s in sequence.steps]))
