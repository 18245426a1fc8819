"""What stands ready before the clock runs: plans of obstacles that differ, and what each unit finds in front of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.planning.algorithm_1.dynamic_filter import filtered_waist
from stepover.planning.algorithm_1.plan import Plan
from stepover.planning.algorithm_1.planner import plan_in_detail, whole_body
from stepover.planning.algorithm_1.upper_body import moved
from stepover.robots.loading import load_robot

WIDTH = 0.05
HIGHER = 1e-4
"""How much higher each further obstacle is, so that no result of the one before is of use [m]."""


@dataclass(frozen=True, eq=False)
class Ready:
    """A plan, and what steps 4, 6 and 7 of Algorithm 1 find in front of them in their first pass.

    Attributes:
        obstacle: what was planned for.
        plan: the plan.
        waist: (N, 7) before the filter.
        q: (N, nq) configurations with it.
        zmp: (N, 2) multi-body ZMP of q [m].
        filtered: (N, 7) waist after the filter.
    """

    obstacle: Obstacle
    plan: Plan
    waist: np.ndarray
    q: np.ndarray
    zmp: np.ndarray
    filtered: np.ndarray


@lru_cache(maxsize=256)
def ready(height: float, number: int) -> Ready:
    """What stands ready for the units, for the obstacle of a number, from 0, at a height [m]."""
    robot, obstacle = load(), Obstacle(height + HIGHER * number, WIDTH)
    plan = plan_in_detail(robot, obstacle, look_for_nearest=False)
    waist = moved(plan.nominal.first_stage.waist, plan.nominal.upper.waist_shift)
    q = whole_body(robot, waist, plan.nominal.feet, plan.nominal.upper.q, plan.sequence.time)
    zmp = robot.body.zmp(q, robot.walk.sample_time)
    return Ready(obstacle, plan, waist, q, zmp, filtered_waist(robot, waist, plan.sequence.zmp, zmp))


@lru_cache(maxsize=1)
def load() -> Robot:
    """HRP-2."""
    return load_robot("hrp2")
