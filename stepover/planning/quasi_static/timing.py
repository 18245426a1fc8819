"""How slow is quasi-static? The duration of each segment from the allowed distance between ZMP and CoM. Eq. (15).

With the CoM at a constant height z_c, the ZMP is off the CoM's projection by z_c c'' / g (Eq. (15), p_z = 0). On a
quintic over a distance d in a time T the acceleration is at most (10 / sqrt(3)) d / T^2, so epsilon sets T. While a
foot is in the air the CoM rests, and what moves the ZMP is the angular momentum of the leg and of the waist that
makes up for it: that part is measured on the multi-body ZMP of a slow swing, and scales with 1 / T^2 as well.
"""

from __future__ import annotations

import numpy as np

from stepover.model.gravity import GRAVITY
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.planning.quasi_static.balance import balanced
from stepover.planning.quasi_static.path import SEGMENTS, SWINGS, CrossingPath, pace, targets

QUINTIC_PEAK = 10.0 / np.sqrt(3.0)
"""Largest acceleration of the quintic from 0 to 1 in 1 s."""


def zmp_errors(robot: Robot, obstacle: Obstacle, path: CrossingPath) -> np.ndarray:
    """Largest distance of ZMP and CoM projection [m] on each segment, (5,), if it took 1 s."""
    return np.array([(_swing if k in SWINGS else _shift)(robot, obstacle, path, k) for k in SEGMENTS])


def durations(robot: Robot, errors: np.ndarray, epsilon: float) -> np.ndarray:
    """Duration of each segment [s], (5,): the shortest, in whole samples, that keeps epsilon [m].

    Args:
        robot: the robot.
        errors: from zmp_errors.
        epsilon: largest distance of ZMP and CoM projection that is allowed [m].
    """
    dt = robot.walk.sample_time
    return np.ceil(np.sqrt(errors / epsilon) / dt) * dt


def _shift(robot: Robot, obstacle: Obstacle, path: CrossingPath, segment: int) -> float:
    """Largest ZMP error [m] of the cart on a shift of the CoM that takes 1 s."""
    wanted = targets(robot, obstacle, path, segment, np.linspace(0.0, 1.0, robot.quasi_static.look))
    q = balanced(robot, wanted, robot.quasi_static.search_rounds)
    height = robot.body.com(robot.body.placements(q))[:, 2].max()
    return float(QUINTIC_PEAK * np.linalg.norm(wanted.com[-1] - wanted.com[0]) * height / GRAVITY)


def _swing(robot: Robot, obstacle: Obstacle, path: CrossingPath, segment: int) -> float:
    """Largest ZMP error [m] of the multi-body robot in a swing that takes 1 s, from one that takes much longer."""
    time, p = robot.quasi_static.swing_time, robot.quasi_static
    share = pace(segment, np.linspace(0.0, 1.0, p.swing_samples + 1))
    wanted = targets(robot, obstacle, path, segment, share)
    q = balanced(robot, wanted, p.rounds)
    error = robot.body.zmp(q, time / p.swing_samples) - wanted.com
    return float(np.linalg.norm(error, axis=1).max() * time**2)
