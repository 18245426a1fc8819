"""Algorithm 1 of the paper: from the obstacle to a whole-body motion, seven steps in the paper's order."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from stepover import __version__
from stepover.errors import Infeasible, InvalidInput
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.motion import FORMAT, Motion, obstacle_row
from stepover.units.com_waist import ComWaist, com_and_waist
from stepover.units.dynamic_filter import filtered_waist
from stepover.units.feasibility import KeyConfiguration, key_configurations
from stepover.units.feet_trajectories import FeetTrajectories, feet_trajectories
from stepover.units.step_sequence import StepSequence, step_sequence
from stepover.units.upper_body import upper_body
from stepover.verdict import require


@dataclass(frozen=True, eq=False)
class Plan:
    """A motion and how it came about.

    Attributes:
        motion: the result.
        key: key configuration.
        sequence: the steps.
        feet: trajectories of the feet.
        first_stage: CoM and waist before the dynamic filter.
        q_first_stage: configurations (N, nq) before the dynamic filter.
        adaptations: what FTA and UBMG did, and how often the filter ran.
        planning_time: feasibility, trajectories and total [s].
    """

    motion: Motion
    key: KeyConfiguration
    sequence: StepSequence
    feet: FeetTrajectories
    first_stage: ComWaist
    q_first_stage: np.ndarray
    adaptations: dict[str, object]
    planning_time: dict[str, float]


def plan(robot: Robot, obstacle: Obstacle) -> Motion:
    """Plan how to step over an obstacle dynamically.

    Args:
        robot: from load_robot.
        obstacle: the obstacle with its margins.

    Returns:
        The whole-body motion.

    Raises:
        Infeasible: names the constraint that cannot be met and the nearest obstacle that can be stepped over.
    """
    return plan_in_detail(robot, obstacle).motion


def plan_in_detail(robot: Robot, obstacle: Obstacle, look_for_nearest: bool = True) -> Plan:
    """As plan, and keep what the units handed to each other.

    The key configurations are tried in the order in which FU finds them: the first one whose whole motion keeps
    all limits is taken.
    """
    start = time.perf_counter()
    try:
        keys = key_configurations(robot, obstacle)  # 1: FU
        feasibility_time = time.perf_counter() - start
        found = _first(robot, obstacle, keys)
    except Infeasible as error:
        if error.nearest is None and look_for_nearest:
            error.nearest = nearest_crossable(robot, obstacle)
        raise
    total = time.perf_counter() - start
    times = {"feasibility": feasibility_time, "trajectories": total - feasibility_time, "total": total}
    found.planning_time.update(times)
    return found


def _first(robot: Robot, obstacle: Obstacle, keys: list[KeyConfiguration]) -> Plan:
    """The plan for the first key configuration that works; the first one's error where none does."""
    first_error: Infeasible | None = None
    for key in keys:
        try:
            return algorithm_1(robot, obstacle, key)
        except Infeasible as error:
            first_error = first_error or error
            if error.nearest is not None:
                break
    raise first_error or InvalidInput("there is no key configuration to plan with")


def algorithm_1(robot: Robot, obstacle: Obstacle, key: KeyConfiguration) -> Plan:
    """Steps 2 to 7 of Algorithm 1, for a key configuration from step 1.

    Raises:
        Infeasible: a sole is out of reach, or the motion breaks a limit.
    """
    dt, body = robot.walk.sample_time, robot.body
    rest = body.com(body.placements(robot.half_sitting()[None]))[0, :2]
    sequence = step_sequence(robot, obstacle, key, rest)  # 2: FTG
    feet = feet_trajectories(robot, obstacle, sequence)
    first = com_and_waist(robot, sequence, key)  # 3: CWTG1
    upper = upper_body(robot, first.yaw)  # 5: UBMG
    q = whole_body(robot, first.waist, feet, upper, sequence.time)  # 4: IK
    zmp = body.zmp(q, dt)
    waist, q_filtered, zmp_filtered = first.waist, q, zmp
    for _ in range(robot.preview.filter_passes):  # 6: CWTG2
        waist = filtered_waist(robot, waist, sequence.zmp, zmp_filtered)
        q_filtered = whole_body(robot, waist, feet, upper, sequence.time)
        zmp_filtered = body.zmp(q_filtered, dt)
    motion = Motion(
        time=sequence.time, q=q_filtered, joint_names=np.array(body.joint_names),
        left_foot=feet.left, right_foot=feet.right, waist=waist, com=body.com(body.placements(q_filtered)),
        zmp_reference=sequence.zmp, zmp_first_stage=zmp, zmp=zmp_filtered,
        support=sequence.support, phase=sequence.phase, footsteps=_footsteps(sequence),
        key_configuration=np.array([key.x_ads, key.x_hds, key.z_hds]),
        obstacle=obstacle_row(obstacle, sequence.front_face), robot=robot.name, format=FORMAT, version=__version__,
    )  # fmt: skip
    require(robot, obstacle, motion)
    adaptations: dict[str, object] = {"filter_passes": robot.preview.filter_passes}
    return Plan(motion, key, sequence, feet, first, q, adaptations, {})


def whole_body(
    robot: Robot, waist: np.ndarray, feet: FeetTrajectories, upper: np.ndarray, time: np.ndarray
) -> np.ndarray:
    """Configurations (N, nq): waist (N, 7), upper body as in upper (N, nq), legs by inverse kinematics.

    Raises:
        Infeasible: a sole is out of reach.
    """
    q = upper.copy()
    q[:, :7] = waist
    for side in (1, -1):
        leg = robot.leg(side)
        q[:, leg.columns] = leg.inverse(waist, feet.foot(side), time)
    return q


def nearest_crossable(robot: Robot, obstacle: Obstacle) -> Obstacle | None:
    """Obstacle nearest to the given one, in height and width, that can be planned; None if none is found.

    Looks straight down in height, straight down in width, and on the way to a small obstacle, by bisection to
    1 mm; what it returns was really planned.
    """
    small = np.array([0.02, 0.02])
    here = np.array([obstacle.height, obstacle.width])
    best: Obstacle | None = None
    gap = np.inf
    for goal in ([small[0], here[1]], [here[0], small[1]], small):
        way = np.minimum(goal, here) - here
        found = _farthest(robot, obstacle, here, way)
        if found is not None:
            distance = float(np.hypot(found.height - here[0], found.width - here[1]))
            if distance < gap:
                best, gap = found, distance
    return best


def _farthest(robot: Robot, obstacle: Obstacle, here: np.ndarray, way: np.ndarray) -> Obstacle | None:
    """First obstacle on a way down in height and width that can be planned, by bisection to 1 mm."""

    def at(share: float) -> Obstacle:
        height, width = np.floor((here + share * way) * 1e3 + 1e-6) / 1e3
        return Obstacle(float(height), float(width), obstacle.margin_height, obstacle.margin_width, obstacle.distance)

    def works(share: float) -> bool:
        try:
            plan_in_detail(robot, at(share), look_for_nearest=False)
        except Infeasible:
            return False
        return True

    low, high = 0.0, 1.0
    if not np.any(way) or not works(high):
        return None
    while (high - low) * np.abs(way).max() > 1e-3:
        middle = (low + high) / 2.0
        low, high = (low, middle) if works(middle) else (middle, high)
    return at(high)


def _footsteps(sequence: StepSequence) -> np.ndarray:
    """Touch-down time, side, x, y, yaw and kind of each step (K, 6)."""
    time = sequence.time
    return np.array([[time[s.touch_down], s.side, *s.end, 0.0, s.kind] for s in sequence.steps])
