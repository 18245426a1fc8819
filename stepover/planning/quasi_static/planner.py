"""The baseline that the paper compares with: stepping over quasi-statically, after Guan et al. ([1], [11]). Sec. II-A.

The projection of the CoM stays inside the support polygon throughout, and everything moves so slowly that the ZMP
stays within epsilon of it: in the shifts from foot to foot the cart's ZMP, Eq. (15), in the swings, where the CoM
rests, the multi-body one. That is what makes it slow: every duration grows with 1 / sqrt(epsilon).
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from stepover.errors import Infeasible, InvalidInput
from stepover.model.course import Course
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.motion.footsteps import LEG_1, LEG_2, Footsteps
from stepover.motion.motion import Motion, obstacle_row
from stepover.planning.checks import require
from stepover.planning.nearest import nearest_crossable
from stepover.planning.quasi_static.balance import balanced, joined
from stepover.planning.quasi_static.path import (
    LEG_1_OVER,
    LEG_2_OVER,
    SEGMENTS,
    SWINGS,
    TO_FRONT,
    CrossingPath,
    pace,
    targets,
)
from stepover.planning.quasi_static.search import find_path
from stepover.planning.quasi_static.timing import durations, zmp_errors
from stepover.planning.request import one_obstacle

ZMP_MULTIPLE = 1.2
"""The multi-body ZMP stays within this multiple of epsilon: the cart, which times the shifts, has no turning links.
Over the paper's obstacle it is 1.08 in the crossing, 1.14 in the shifts before and after it."""
SMALLEST_EPSILON = 1e-5
"""Below this [m] a crossing takes more than seven minutes, which is surely a wrong unit."""
PHASES = {LEG_1_OVER: 1, TO_FRONT: 2, LEG_2_OVER: 3}
"""Phases of Sec. II of the segments that have one."""


@dataclass(frozen=True, eq=False)
class QuasiStaticPlan:
    """A quasi-static motion and how it came about.

    Attributes:
        motion: the result.
        path: its numbers.
        obstacle: with the margins that the motion keeps.
        zmp_errors: (5,) distance of ZMP and CoM projection on each segment, if it took 1 s [m].
        durations: (5,) of the segments: to the rear foot, leg 1, to the front foot, leg 2, to the middle [s].
        refused: why there is no path with the margins that were asked for; None where there is one.
        epsilon: largest distance of ZMP and CoM projection that the durations allow [m], see quasi_static_plan.
    """

    motion: Motion
    path: CrossingPath
    obstacle: Obstacle
    zmp_errors: np.ndarray
    durations: np.ndarray
    refused: str | None
    epsilon: float


def quasi_static_plan(robot: Robot, obstacle: Obstacle | Course, epsilon: float = 0.001) -> Motion:
    """Plan how to step over an obstacle quasi-statically.

    The robot starts with its feet side by side before the obstacle, and ends so behind it. Where no path keeps the
    margins of the obstacle (Remark 1), they shrink to `clearance` in robot.toml; the motion's obstacle row says which
    ones it keeps.

    Args:
        robot: from load_robot.
        obstacle: the obstacle with its margins, or a course that holds one; a distance of None puts it where the step
            over it wants it.
        epsilon: largest distance between the ZMP and the projection of the CoM [m]: the cart's ZMP in the shifts, the
            multi-body one in the swings. In the shifts the multi-body ZMP goes up to ZMP_MULTIPLE times as far.

    Returns:
        The whole-body motion. Its desired ZMP is the projection of the CoM; there is no filter, and so no ZMP before
        it. The key configuration is the one at the beginning of phase 2.

    Raises:
        InvalidInput: no Robot, no Obstacle, several obstacles, or epsilon is no length from SMALLEST_EPSILON to what
            keeps the ZMP on the soles.
        Infeasible: names the phase and the condition, (6), (7) or (8), that cannot be met, and the nearest obstacle
            that can be stepped over.
    """
    return quasi_static_in_detail(robot, obstacle, epsilon).motion


def quasi_static_in_detail(
    robot: Robot, obstacle: Obstacle | Course, epsilon: float = 0.001, *, look_for_nearest: bool = True
) -> QuasiStaticPlan:
    """As quasi_static_plan, and keep how it came about."""
    obstacle = one_obstacle(robot, obstacle)
    _check(robot, epsilon)
    try:
        path, taken, refused = _path_with_margins(robot, obstacle)
    except Infeasible as error:
        error.forget_frames()
        if look_for_nearest:
            error.nearest = _nearest(robot, obstacle)
        raise
    errors = zmp_errors(robot, taken, path)
    times = durations(robot, errors, epsilon)
    motion = _motion(robot, taken, path, times)
    require(robot, motion)
    require(robot, dataclasses.replace(motion, zmp=motion.com[:, :2]))  # the CoM must be inside as well
    return QuasiStaticPlan(motion, path, taken, errors, times, refused, epsilon)


def quasi_static_crossable(robot: Robot, obstacle: Obstacle) -> bool:
    """Whether there is a quasi-static path over an obstacle, be it with less than its margins."""
    try:
        find_path(robot, _with_clearance(robot, obstacle))
    except Infeasible:
        return False
    return True


def largest_epsilon(robot: Robot) -> float:
    """Largest epsilon [m] that keeps the ZMP on the soles: so near to the edge of the foot the CoM may be."""
    p, (heel, toe) = robot.quasi_static, robot.foot.contact_x
    return float(min(toe - p.com_ahead, -heel - p.com_behind))


def _check(robot: Robot, epsilon: float) -> None:
    """Refuse an epsilon that is no length, with which the ZMP might leave the soles, or the motion would not end."""
    largest = largest_epsilon(robot)
    number = isinstance(epsilon, int | float) and not isinstance(epsilon, bool)
    if not number or not SMALLEST_EPSILON <= epsilon <= largest:
        raise InvalidInput(
            f"epsilon = {epsilon!r} must be a length of {SMALLEST_EPSILON:.5f} to {largest:.3f} m: "
            "with a larger one the ZMP might leave the soles, with a smaller one the crossing takes many minutes"
        )


def _path_with_margins(robot: Robot, obstacle: Obstacle) -> tuple[CrossingPath, Obstacle, str | None]:
    """The path, the obstacle with the margins that it keeps, and why it does not keep those that were asked for."""
    try:
        return find_path(robot, obstacle), obstacle, None
    except Infeasible as error:
        small = _with_clearance(robot, obstacle)
        if small == obstacle:
            raise
        return find_path(robot, small), small, str(error)


def _with_clearance(robot: Robot, obstacle: Obstacle) -> Obstacle:
    """The obstacle with no more margin than the least clearance of robot.toml."""
    least = robot.quasi_static.clearance
    high, wide = min(obstacle.margin_height, least), min(obstacle.margin_width, least)
    return dataclasses.replace(obstacle, margin_height=high, margin_width=wide)


def _nearest(robot: Robot, obstacle: Obstacle) -> Obstacle | None:
    """The nearest obstacle for which there is a path: lower or narrower, or else at another distance."""
    found = nearest_crossable(obstacle, lambda other: quasi_static_crossable(robot, other))
    if found is None and obstacle.distance is not None:
        try:
            path = find_path(robot, _with_clearance(robot, dataclasses.replace(obstacle, distance=None)))
        except Infeasible:
            return None
        return dataclasses.replace(obstacle, distance=round(path.front_face, 3))
    return found


def _motion(robot: Robot, obstacle: Obstacle, path: CrossingPath, times: np.ndarray) -> Motion:
    """The whole-body motion along a path, each segment in its time: quintics from rest to rest."""
    body, dt = robot.body, robot.walk.sample_time
    counts = np.round(times / dt).astype(int)
    parts = [targets(robot, obstacle, path, k, pace(k, np.arange(counts[k]) / counts[k])) for k in SEGMENTS]
    wanted = joined([*parts, targets(robot, obstacle, path, SEGMENTS[-1], np.ones(1))])
    q = balanced(robot, wanted, robot.quasi_static.rounds)
    zmp, ends = body.zmp(q, dt), np.cumsum(counts)
    support, phase = np.zeros((2, len(q)), dtype=int)
    for segment, number in PHASES.items():
        phase[ends[segment] - counts[segment] : ends[segment]] = number
    for segment, side in SWINGS.items():
        support[ends[segment] - counts[segment] : ends[segment]] = -side
    beside = robot.posture.feet_apart / 2.0
    landings = ((LEG_1_OVER, LEG_1), (LEG_2_OVER, LEG_2))
    steps = [[ends[k] * dt, SWINGS[k], path.x_ads, SWINGS[k] * beside, 0.0, kind] for k, kind in landings]
    return Motion(
        time=np.arange(len(q)) * dt, q=q, joint_names=np.array(body.joint_names),
        left_foot=wanted.left, right_foot=wanted.right, waist=q[:, :7], com=body.com(body.placements(q)),
        zmp_reference=wanted.com, zmp=zmp, support=support, phase=phase,
        footsteps=Footsteps.from_rows(np.array(steps)),
        key_configuration=np.array([path.x_ads, q[ends[LEG_1_OVER], 0], path.height_rear]),
        obstacles=obstacle_row(obstacle, path.front_face)[None],
        robot=robot.name, robot_fingerprint=robot.fingerprint, planner="quasi-static",
    )  # fmt: skip
