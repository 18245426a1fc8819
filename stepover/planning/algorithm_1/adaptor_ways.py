"""Methods (1) and (2) of FTA, Sec. III-E: which shift of the foot and raise of the waist free the trailing leg?"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from stepover.model.obstacle import Obstacle
from stepover.model.parameters.planning import samples
from stepover.model.robot import Robot
from stepover.planning.algorithm_1.feet_trajectories import FeetTrajectories, clamped_spline
from stepover.planning.algorithm_1.step_sequence import LEG_2, Step, StepSequence
from stepover.planning.leg_check import LegPosture, leg_posture, leg_separation

FEW = 8
"""Of the samples that the search looks at, every so many are enough to rule most ways out."""
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
    hopeless: float,
) -> tuple[float, float, float]:
    """By how much the legs are free, the shift and the raise [m] for it: the first that is enough, else the best.

    Few samples rule most ways out: those that are not freer there than what is hopeless [m].
    """
    every = samples(robot.adaptor.look_every, robot.walk.sample_time)
    ways = np.array([(height, shift) for height in raises for shift in shifts])  # (1), then (2) and (1) again
    asked = robot, obstacle, sequence, waist, feet
    free = np.repeat(stance_clearances(*asked, raises, every), len(shifts))
    for closer in (FEW * every, every):
        hopeful = free > hopeless
        free[hopeful] = np.minimum(free[hopeful], swing_clearances(*asked, ways[hopeful], closer))
    best = int(np.argmax(free >= free.max() - TIE))
    height, shift = ways[best].tolist()
    return float(free[best]), shift, height


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


def stance_clearances(
    robot: Robot,
    obstacle: Obstacle,
    sequence: StepSequence,
    waist: np.ndarray,
    feet: FeetTrajectories,
    raises: np.ndarray,
    every: int,
) -> np.ndarray:
    """Smallest separation (H,) [m] of the stance leg in phase 3 for raises (H,) of the waist, at every so many samples.

    Up to the spare that is asked for; -inf beyond reach or limits.
    """
    step = sequence.step(LEG_2)
    look = slice(step.lift_off, step.touch_down + 1, every)
    soles = _copies(feet.foot(-step.side)[look], len(raises))
    waists = _raised(robot, step, waist[look], raises, every)
    return _leg_clearances(robot, -step.side, waists, soles, *limits(robot, obstacle, sequence))


def swing_clearances(
    robot: Robot,
    obstacle: Obstacle,
    sequence: StepSequence,
    waist: np.ndarray,
    feet: FeetTrajectories,
    ways: np.ndarray,
    every: int,
) -> np.ndarray:
    """The same (C,) of the swing leg for ways (C, 2), raise and shift."""
    step = sequence.step(LEG_2)
    look = slice(step.lift_off, step.touch_down + 1, every)
    soles = _copies(feet.foot(step.side)[look], len(ways))
    soles[..., 0] -= np.outer(ways[:, 1], _back(robot, step)[::every])
    waists = _raised(robot, step, waist[look], ways[:, 0], every)
    return _leg_clearances(robot, step.side, waists, soles, *limits(robot, obstacle, sequence))


def _raised(robot: Robot, step: Step, waist: np.ndarray, raises: np.ndarray, every: int) -> np.ndarray:
    """Waists (H, n, 7) raised by some raises (H,), of the waist (n, 7) at every so many samples of a swing."""
    waists = _copies(waist, len(raises))
    waists[..., 2] += np.outer(raises, _up(robot, step)[::every])
    return waists


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
    return obstacle.profile(sequence.front_face, margins=True), np.radians(robot.checks.knee_margin_deg)


def displaced(feet: FeetTrajectories, step: Step, change: np.ndarray) -> FeetTrajectories:
    """Feet with the swing foot moved by change (n, 3) [m] from lift-off to touch-down."""
    foot = feet.foot(step.side).copy()
    foot[step.lift_off : step.touch_down + 1, :3] += change
    return FeetTrajectories(foot, feet.right) if step.side > 0 else FeetTrajectories(feet.left, foot)
