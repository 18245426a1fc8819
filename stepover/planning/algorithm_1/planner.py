"""Algorithm 1 of the paper: from the obstacle to a whole-body motion, seven steps in the paper's order."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from stepover.errors import Infeasible, InvalidInput, NoWay, OutOfReach
from stepover.model.course import Course
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.motion.footsteps import Footsteps
from stepover.motion.motion import Motion, obstacle_row
from stepover.planning.algorithm_1.adaptor_ways import raise_waist
from stepover.planning.algorithm_1.beyond_paper import extra_shape, extra_zmp, waist_delay
from stepover.planning.algorithm_1.com_waist import com_and_waist
from stepover.planning.algorithm_1.dynamic_filter import filtered_waist
from stepover.planning.algorithm_1.feasibility import KeyConfiguration, key_configurations
from stepover.planning.algorithm_1.feet_adaptor import adapt_feet
from stepover.planning.algorithm_1.feet_trajectories import FeetTrajectories, feet_trajectories
from stepover.planning.algorithm_1.planned import Effort, Plan
from stepover.planning.algorithm_1.step_sequence import StepSequence, step_sequence
from stepover.planning.algorithm_1.upper_body import moved, upper_body
from stepover.planning.checks import require, require_speeds
from stepover.planning.nearest import nearest_crossable
from stepover.planning.request import one_obstacle

ARMS = ("auto", "on", "off")
SPEED_LIMITS = ("ignore", "respect")
LEAN = 0.6
"""How far a leg leans where it reaches furthest, the way from hip to ankle ahead over that down: 0.5 to 0.7 over 20 to
25 cm. Under 20 cm hardly any attempt fails for want of reach."""


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
            as the tables slow.* of robot.toml say.
        extras: whether what is added beyond the paper may be used where the paper's own methods do not reach.

    Returns:
        The whole-body motion.

    Raises:
        InvalidInput: no Robot, no Obstacle, several obstacles, or an unknown value of arms or speed_limits.
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

    What the paper describes comes first, with the arms at rest while the knees allow it; then UBMG; then what is
    added beyond the paper. For each, of the key configurations in the order of FU the first that works is taken.
    """
    obstacle = one_obstacle(robot, obstacle)
    for name, value, known in (("arms", arms, ARMS), ("speed_limits", speed_limits, SPEED_LIMITS)):
        if value not in known:
            raise InvalidInput(f"{name} = {value!r} must be one of {', '.join(known)}")
    start = time.perf_counter()
    try:
        mover = robot.slowed if speed_limits == "respect" else robot
        keys = key_configurations(mover, obstacle)  # 1: FU
        feasibility_time = time.perf_counter() - start
        found = _first(mover, obstacle, keys, _efforts(mover, arms, extras, speed_limits), speed_limits)
    except Infeasible as error:
        if error.nearest is None and look_for_nearest:
            options: dict[str, Any] = {"arms": arms, "speed_limits": speed_limits, "extras": extras}
            error.nearest = nearest_crossable(obstacle, lambda other: _crossable(robot, other, options), progress)
        raise
    total = time.perf_counter() - start
    times = {"feasibility": feasibility_time, "trajectories": total - feasibility_time, "total": total}
    return dataclasses.replace(found, planning_time=times)


def algorithm_1(robot: Robot, obstacle: Obstacle, key: KeyConfiguration, effort: Effort) -> Plan:
    """Steps 2 to 7 of Algorithm 1, for a key configuration from step 1.

    The filter and FTA take turns until, after a pass of the filter, FTA has nothing left to adapt.

    Raises:
        Infeasible: a sole is out of reach, FTA finds no way, or the motion breaks a limit.
    """
    body, dt = robot.body, robot.walk.sample_time
    sequence = extra_zmp(robot, step_sequence(robot, obstacle, key, robot.rest_zmp()), effort.level)  # 2: FTG
    ftg = feet_trajectories(robot, obstacle, sequence, extra_shape(robot, effort.level))
    first = com_and_waist(robot, sequence, key, waist_delay(robot, effort.level))  # 3: CWTG1
    upper = upper_body(robot, sequence, ftg, first, effort.arms)  # 5: UBMG
    waist, feet, adaptation = moved(first.waist, upper.waist_shift), ftg, None
    zmps: list[np.ndarray] = []
    for _ in range(robot.preview.filter_passes_max):
        try:
            q = whole_body(robot, waist, feet, upper.q, sequence.time)  # 4: IK
        except OutOfReach as error:
            if adaptation is None:
                raise
            raise Infeasible(error.constraint, short=error.short) from error  # not for want of a lower waist alone
        zmps.append(body.zmp(q, dt))
        waist = filtered_waist(robot, waist, sequence.zmp, zmps[-1])  # 6: CWTG2
        flat = waist if adaptation is None else raise_waist(robot, sequence, waist, -adaptation.raised)
        if adaptation is not None and adaptation.still_clear(robot, obstacle, sequence, waist):
            break
        adaptation = adapt_feet(robot, obstacle, sequence, flat, ftg, effort.methods)  # 7: FTA
        if not adaptation.clear:
            raise adaptation.refusal(robot, obstacle, sequence, flat)
        if not adaptation.acted:
            break
        feet, waist = adaptation.feet, raise_waist(robot, sequence, flat, adaptation.raised)
    assert adaptation is not None
    q = whole_body(robot, waist, feet, upper.q, sequence.time)
    placements = body.placements(q)
    motion = Motion(
        time=sequence.time, q=q, joint_names=np.array(body.joint_names),
        left_foot=feet.left, right_foot=feet.right, waist=waist, com=body.com(placements),
        zmp_reference=sequence.zmp, zmp_first_stage=zmps[0], zmp=body.zmp(q, dt),
        support=sequence.support, phase=sequence.phase, footsteps=_footsteps(sequence),
        key_configuration=np.array([key.x_ads, key.x_hds, key.z_hds]),
        obstacles=obstacle_row(obstacle, sequence.front_face)[None],
        robot=robot.name, robot_fingerprint=robot.fingerprint, planner="paper",
    )  # fmt: skip
    require(robot, motion, placements)
    return Plan(motion, key, sequence, ftg, first, upper, adaptation, effort, len(zmps), {})


def whole_body(
    robot: Robot, waist: np.ndarray, feet: FeetTrajectories, upper: np.ndarray, time: np.ndarray
) -> np.ndarray:
    """Configurations (N, nq), with the legs by inverse kinematics: step 4 of Algorithm 1.

    Args:
        robot: the robot.
        waist: (N, 7).
        feet: trajectories of the feet.
        upper: (N, nq) configurations with the upper body set.
        time: (N,) [s], for the message where a sole is out of reach.

    Raises:
        Infeasible: a sole is out of reach.
    """
    q = upper.copy()
    q[:, :7] = waist
    for side in (1, -1):
        leg = robot.leg(side)
        q[:, leg.columns] = leg.inverse(waist, feet.foot(side), time)
    return q


def _efforts(robot: Robot, arms: str, extras: bool, speed_limits: str) -> list[Effort]:
    """What to try, in this order; where speed limits are to be kept, all that is allowed at once."""
    first = [Effort("off")] if arms == "auto" else []
    levels = range(1, len(robot.beyond_paper.zmp_toe) + 1) if extras else ()
    efforts = [*first, Effort(arms), *(Effort(arms, level=level) for level in levels)]
    return efforts[-1:] if speed_limits == "respect" else efforts


def _first(
    robot: Robot,
    obstacle: Obstacle,
    keys: list[KeyConfiguration],
    efforts: list[Effort],
    speed_limits: str,
) -> Plan:
    """The plan for the first effort and key configuration that work; else what the last effort lacks least.

    An adapted leg that still collides came further than one that does not reach.
    Where a sole is out of reach by some length, only a waist that is lower by more is tried; where FTA finds no way,
    for want of reach as well, only a lower one. A longer step needs a lower one still. So where FTA finds no way, the
    next step length waits for the one after it, which may rule it out.
    """
    apart = robot.feasibility.step_length_more_step
    for effort in efforts:
        left = [key for key in keys if _whole((key.x_ads - keys[0].x_ads) / apart)]
        found, errors, beyond = None, [], 0.0
        while left:
            key = next((key for key in left if key.x_ads > beyond), left[0])
            before, beyond = left[: left.index(key)], 0.0
            try:
                attempt = algorithm_1(robot, obstacle, key, effort)
                if speed_limits == "respect":
                    require_speeds(robot, attempt.motion)
                found, left = attempt, before
            except Infeasible as error:
                if error.nearest is not None:
                    raise
                errors.append(error)
                left.remove(key)
                if isinstance(error, (OutOfReach, NoWay)):
                    lower = np.hypot(1.0, LEAN) * error.short if isinstance(error, OutOfReach) else 0.0
                    left = [other for other in left if _demand(other) < _demand(key) - lower]
                if isinstance(error, NoWay):
                    beyond = key.x_ads + 1.5 * apart
        if found is not None:
            return found
    explained = [error.explain() if isinstance(error, NoWay) else error for error in errors]
    raise min(explained, key=lambda error: (isinstance(error, OutOfReach), error.short))


def _demand(key: KeyConfiguration) -> float:
    """What a key configuration asks of a leg's reach, as a height of the waist [m].

    A longer step takes the waist half as much further from either foot, which a leaning leg makes up for by going down.
    """
    return key.z_hds + LEAN * key.x_ads / 2.0


def _crossable(robot: Robot, obstacle: Obstacle, options: dict[str, Any]) -> bool:
    """Whether the obstacle can be planned."""
    try:
        plan_in_detail(robot, obstacle, **options, look_for_nearest=False)
    except Infeasible:
        return False
    return True


def _whole(number: float) -> bool:
    """Whether a number is whole, but for rounding."""
    return abs(number - round(number)) < 1e-6


def _footsteps(sequence: StepSequence) -> Footsteps:
    """Where the feet come down and when."""
    time = sequence.time
    return Footsteps.from_rows(np.array([[time[s.touch_down], s.side, *s.end, 0.0, s.kind] for s in sequence.steps]))
