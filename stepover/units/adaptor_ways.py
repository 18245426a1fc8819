"""Methods (1) and (2) of FTA, Sec. III-E: which shift of the foot and raise of the waist free the trailing leg?"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.units.feet_trajectories import FeetTrajectories, clamped_spline
from stepover.units.leg_check import LegPosture, leg_posture, leg_separation
from stepover.units.step_sequence import LEG_2, Step, StepSequence

CLOSER = (8, 1)
"""Of the samples that the search looks at, every so many; few of them rule most ways out."""
TIE = 1e-9
"""Better by less is rounding [m]: the swing foot lies where it lies, whatever the waist's height."""


def best_way(
    robot: Robot,
    obstacle: Obstacle,
    sequence: StepSequence,
    waist: np.ndarray,
    feet: FeetTrajectories,
    raises: np.ndarray,
    shifts: np.ndarray,
) -> tuple[float, float, float]:
    """By how much the legs are free, the shift and the raise [m] for it: the first that is enough, else the best."""
    adaptor = robot.adaptor
    ways = np.array([(height, shift) for height in raises for shift in shifts])
    free = np.full(len(ways), np.inf)
    for every in CLOSER:
        left = free > -np.inf
        free[left] = clearances(robot, obstacle, sequence, waist, feet, ways[left], every * adaptor.look_every)
    best = (-np.inf, 0.0, 0.0)
    for height, by in zip(raises, free.reshape(len(raises), -1), strict=True):  # (1), then (2) and (1) again
        enough = by >= adaptor.spare
        first = int(np.argmax(enough if enough.any() else by >= by.max() - TIE))
        if by[first] > best[0] + TIE or best[0] == -np.inf:
            best = (float(by[first]), float(shifts[first]), float(height))
        if enough.any():
            break
    return best


def shift_back(robot: Robot, feet: FeetTrajectories, step: Step, distance: float) -> FeetTrajectories:
    """Method (1): the swing foot's horizontal trajectory moved back, by distance [m] where it is most."""
    return displaced(feet, step, np.outer(-distance * _back(robot, step), [1.0, 0.0, 0.0]))


def raise_waist(robot: Robot, sequence: StepSequence, waist: np.ndarray, height: float) -> np.ndarray:
    """Method (2): the waist (N, 7) raised while the trailing leg steps over."""
    return np.column_stack([waist[:, :2], waist[:, 2] + waist_bump(robot, sequence, height), waist[:, 3:]])


def waist_bump(robot: Robot, sequence: StepSequence, height: float) -> np.ndarray:
    """Extra waist height (N,) [m] of method (2): smooth, zero outside of phase 3."""
    step, bump = sequence.step(LEG_2), np.zeros(len(sequence.time))
    bump[step.lift_off : step.touch_down + 1] = height * _up(robot, step)
    return bump


def _back(robot: Robot, step: Step) -> np.ndarray:
    """Share of method (1)'s shift at the samples of a swing, both ends included."""
    return _bump(robot.adaptor.shift_peak, 1.0 - robot.stepping_over.rest, step.touch_down - step.lift_off + 1)


def _up(robot: Robot, step: Step) -> np.ndarray:
    """Share of method (2)'s raise at the samples of a swing, both ends included."""
    return _bump(robot.adaptor.raise_peak, 1.0, step.touch_down - step.lift_off + 1)


@lru_cache(maxsize=16)
def _bump(peak: float, end: float, count: int) -> np.ndarray:
    """Smooth bump (count,) over a swing's time from 0 to 1: a knot where its peak shall be, 0 at both ends."""
    bump = clamped_spline([(0.0, 0.0), (peak, 1.0), (end, 0.0)], np.linspace(0.0, 1.0, count))
    bump[[0, -1]] = 0.0
    bump /= bump.max()
    bump.flags.writeable = False
    return bump


def clearances(
    robot: Robot,
    obstacle: Obstacle,
    sequence: StepSequence,
    waist: np.ndarray,
    feet: FeetTrajectories,
    ways: np.ndarray,
    every: int,
) -> np.ndarray:
    """Smallest separation (C,) [m] of the legs in phase 3 for ways (C, 2), raise and shift, at every so many samples.

    Up to the spare that is asked for; -inf beyond reach or limits.
    """
    step = sequence.step(LEG_2)
    look, swing = slice(step.lift_off, step.touch_down + 1, every), slice(None, None, every)
    asked = limits(robot, obstacle, sequence)
    heights, which = np.unique(ways[:, 0], return_inverse=True)
    waists, stance = _copies(waist[look], len(heights)), _copies(feet.foot(-step.side)[look], len(heights))
    waists[..., 2] += np.outer(heights, _up(robot, step)[swing])
    soles = _copies(feet.foot(step.side)[look], len(ways))
    soles[..., 0] -= np.outer(ways[:, 1], _back(robot, step)[swing])
    free = _leg_clearances(robot, -step.side, waists, stance, *asked)[which]
    able = free > -np.inf
    free[able] = np.minimum(free[able], _leg_clearances(robot, step.side, waists[which[able]], soles[able], *asked))
    return free


def _copies(poses: np.ndarray, count: int) -> np.ndarray:
    """As many copies (count, n, 7) of poses (n, 7)."""
    return np.tile(poses, (count, 1, 1))


def _leg_clearances(
    robot: Robot, side: int, waists: np.ndarray, soles: np.ndarray, rectangle: np.ndarray, knee_margin: float
) -> np.ndarray:
    """The same (C,) of one leg along C ways of waist and sole (C, n, 7)."""
    posture = leg_posture(robot, side, waists.reshape(-1, 7), soles.reshape(-1, 7), knee_margin)
    able = posture.able().reshape(waists.shape[:2]).all(axis=1)
    rows = np.repeat(able, waists.shape[1])
    free = np.full(len(waists), -np.inf)
    separations = leg_separation(
        robot, side, LegPosture(*(part[rows] for part in posture)), rectangle, robot.adaptor.spare
    )[0]
    free[able] = separations.reshape(-1, waists.shape[1]).min(axis=1)
    return free


def limits(robot: Robot, obstacle: Obstacle, sequence: StepSequence) -> tuple[np.ndarray, float]:
    """What must stay free (4,) [m], and how far knees must stay from straight [rad]."""
    return obstacle.profile(sequence.front_face, margins=True), np.radians(robot.verdict.knee_margin_deg)


def displaced(feet: FeetTrajectories, step: Step, change: np.ndarray) -> FeetTrajectories:
    """Feet with the swing foot moved by change (n, 3) [m] from lift-off to touch-down."""
    foot = feet.foot(step.side).copy()
    foot[step.lift_off : step.touch_down + 1, :3] += change
    return FeetTrajectories(foot, feet.right) if step.side > 0 else FeetTrajectories(feet.left, foot)
