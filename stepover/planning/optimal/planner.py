"""The optimising planner: obstacle in, a motion that keeps every limit of the robot out."""

from __future__ import annotations

import dataclasses
import time as clock
from dataclasses import dataclass
from typing import Any

import numpy as np

from stepover.errors import Infeasible
from stepover.model.course import Course
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.model.self_collision import self_clearance
from stepover.motion.footsteps import Footsteps
from stepover.motion.motion import Motion, obstacle_row
from stepover.planning.checks import require, require_speeds
from stepover.planning.optimal.channels import LEFT, RIGHT, WAIST, poses
from stepover.planning.optimal.constraints.own_links import thigh_pairs
from stepover.planning.optimal.durations import BEST, Trial, lasting, require_time, shortest
from stepover.planning.optimal.problem import Evaluation
from stepover.planning.optimal.search import Attempt, Report, Search
from stepover.planning.optimal.torques import TorqueRatio, largest_torque
from stepover.planning.request import one_obstacle

EVERY = 2
"""Samples between those at which the distances of the robot's own links are measured."""


@dataclass(frozen=True, eq=False)
class OptimalPlan:
    """A motion and how it came about.

    Attributes:
        motion: the result.
        attempts: the problems that were solved on the way, in their order.
        torque: largest joint torque over its limit.
        self_clearance: smallest distance between links that must not touch, trunk and thighs included [m].
        planning_time: [s].
        trials: the durations of single supports that were tried, where the shortest was asked for.
    """

    motion: Motion
    attempts: tuple[Attempt, ...]
    torque: TorqueRatio
    self_clearance: float
    planning_time: float
    trials: tuple[Trial, ...] = ()

    @property
    def iterations(self) -> int:
        """All iterations of the SQP."""
        return sum(attempt.iterations for attempt in self.attempts)

    def to_json(self) -> dict[str, Any]:
        """What this planner adds to the values of a motion."""
        return {
            "torque_ratio_max": self.torque.ratio,
            "torque_ratio_joint": self.torque.joint,
            "self_clearance_min": self.self_clearance,
            "iterations": self.iterations,
            "attempts": [attempt._asdict() for attempt in self.attempts],
            "durations": [trial._asdict() for trial in self.trials],
        }


def optimal_plan(
    robot: Robot, obstacle: Obstacle | Course, *, time: float | str | None = None, progress: Report | None = None
) -> Motion:
    """Plan how to step over an obstacle with all limits of the robot kept: joints, speeds, torques, contact, links.

    Args:
        robot: from load_robot.
        obstacle: the obstacle with its margins, or a course that holds one.
        time: how long each single support over the obstacle lasts [s], or "best": the shortest that keeps all limits,
            to 0.05 s. Default: as the robot walks; 1.5 s.
        progress: called after each iteration.

    Returns:
        The whole-body motion.

    Raises:
        InvalidInput: no Robot, no Obstacle, several obstacles, legs whose hip axes do not meet, or no such time.
        Infeasible: names the constraint that stays violated, by how much, when and where, and the nearest obstacle
            that can be crossed.
    """
    return optimal_in_detail(robot, obstacle, time=time, progress=progress).motion


def optimal_in_detail(
    robot: Robot,
    obstacle: Obstacle | Course,
    *,
    time: float | str | None = None,
    progress: Report | None = None,
    leading: int = -1,
    look_for_nearest: bool = True,
) -> OptimalPlan:
    """As optimal_plan, and keep how it came about; `leading`: the side that steps over first."""
    obstacle, start = one_obstacle(robot, obstacle), clock.perf_counter()
    require_time(time, robot.optimal)
    attempts: list[Attempt] = []

    def planned(walking: Robot, look: bool) -> OptimalPlan:
        search = Search.of(walking, obstacle, leading, progress, attempts)
        return _planned(search, obstacle, look and look_for_nearest)

    trials: list[Trial] = []
    if time == BEST:
        found, trials = shortest(robot, planned)
    else:
        found = planned(robot if time is None else lasting(robot, float(time)), True)
    took = clock.perf_counter() - start
    return dataclasses.replace(found, attempts=tuple(attempts), planning_time=took, trials=tuple(trials))


def _planned(search: Search, obstacle: Obstacle, look_for_nearest: bool) -> OptimalPlan:
    """One search, and the checks of its motion."""
    found = search.run(obstacle)
    if found.worst.value > search.parameters.tolerance:
        raise Infeasible(refusal(found), _nearest(search, obstacle) if look_for_nearest else None)
    motion = motion_of(search, found)
    torque, apart = check(search.channels.robot, motion)
    return OptimalPlan(motion, (), torque, apart, 0.0)


def check(robot: Robot, motion: Motion) -> tuple[TorqueRatio, float]:
    """Require all limits of the finished motion; its largest torque, and how near its own links come [m].

    Raises:
        Infeasible: names what is broken, by how much and when.
    """
    require(robot, motion)
    require_speeds(robot, motion)
    torque = largest_torque(robot, motion)
    if torque.ratio > 1.0:
        raise Infeasible(f"{torque.joint} needs {torque.ratio:.2f} of its torque at t = {torque.time:.3f} s")
    apart, one, other, sample = self_clearance(
        [*thigh_pairs(robot), *robot.own_pairs], robot.body.placements(motion.q), EVERY
    )
    if apart <= 0.0:
        raise Infeasible(f"{one} and {other} meet at t = {motion.time[sample]:.3f} s")
    return torque, apart


def _nearest(search: Search, obstacle: Obstacle) -> Obstacle | None:
    """An obstacle near to one that cannot be crossed, whose motion passes all checks; None if none is found."""
    found = search.nearest(obstacle)
    if found is None:
        return None
    try:
        check(search.channels.robot, motion_of(search, found))
    except Infeasible:
        return None
    return found.problem.scene.obstacle


def refusal(found: Evaluation) -> str:
    """The constraint that stays violated, in one line."""
    worst, scene = found.worst, found.problem.scene
    amount, unit = worst.value * worst.group.scale, worst.group.unit
    if unit == "m":
        amount, unit = 1e3 * amount, "mm"
    if unit == "rad":
        amount, unit = float(np.degrees(amount)), "degrees"
    part, when = worst.group.parts[worst.column], scene.time[worst.row]
    return f"{worst.group.name} of {part} stays violated by {amount:.3g} {unit} at t = {when:.3f} s"


def motion_of(search: Search, found: Evaluation) -> Motion:
    """The whole motion of a solution."""
    channels, base, scene = search.channels, search.base, found.problem.scene
    robot, sequence = channels.robot, base.sequence
    all_channels = base.channels + (search.variables.basis @ found.x).reshape(base.channels.shape)
    q = channels.configurations(channels.reach(all_channels).q, base.upper)
    zmp, placements = robot.body.zmp(q, scene.dt), robot.body.placements(q)
    left, right = poses(all_channels[:, LEFT]), poses(all_channels[:, RIGHT])
    rows = []
    for step in sequence.steps:
        x, y, _, yaw = all_channels[step.touch_down, LEFT if step.side > 0 else RIGHT][:4]
        rows.append([base.time[step.touch_down], step.side, x, y, yaw, step.kind])
    return Motion(
        time=base.time, q=q, joint_names=np.array(robot.body.joint_names),
        left_foot=left, right_foot=right, waist=poses(all_channels[:, WAIST]), com=robot.body.com(placements),
        zmp_reference=zmp, zmp=zmp, support=sequence.support, phase=sequence.phase,
        footsteps=Footsteps.from_rows(np.array(rows)), obstacles=obstacle_row(scene.obstacle, found.seen.front)[None],
        robot=robot.name, robot_fingerprint=robot.fingerprint, planner="optimal",
    )  # fmt: skip
