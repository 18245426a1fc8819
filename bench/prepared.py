"""What stands ready before the clock runs: plans of obstacles that differ, and what each unit finds in front of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.planning.algorithm_1.plan import Plan
from stepover.planning.algorithm_1.planner import filter_pass, plan_in_detail, whole_body
from stepover.planning.trajectories import WaistAndFeet
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
        poses: waist and feet before the filter.
        q: (N, nq) configurations with it.
        zmp: (N, 2) multi-body ZMP of q [m].
        filtered: the same after the filter.
    """

    obstacle: Obstacle
    plan: Plan
    poses: WaistAndFeet
    q: np.ndarray
    zmp: np.ndarray
    filtered: WaistAndFeet


@lru_cache(maxsize=256)
def ready(height: float, number: int) -> Ready:
    """What stands ready for the units, for the obstacle of a number, from 0, at a height [m]."""
    robot, obstacle = load(), Obstacle(height + HIGHER * number, WIDTH)
    plan = plan_in_detail(robot, obstacle, look_for_nearest=False)
    poses = WaistAndFeet(plan.nominal.waist, plan.nominal.feet)
    q = whole_body(robot, poses, plan.nominal.upper.q, plan.sequence.time)
    waist, zmp = filter_pass(plan.nominal.crossing, poses, plan.nominal.upper.q)
    return Ready(obstacle, plan, poses, q, zmp, WaistAndFeet(waist, plan.nominal.feet))


@lru_cache(maxsize=1)
def load() -> Robot:
    """HRP-2."""
    return load_robot("hrp2")
