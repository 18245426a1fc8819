"""Methods (1) and (2) of FTA, Sec. III-E: which shift of the foot and raise of the waist free the trailing leg?"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from stepover.model.parameters.planning import samples
from stepover.model.robot import Robot
from stepover.motion.footsteps import LEG_2
from stepover.planning.algorithm_1.step_sequence import Crossing, Step, StepSequence
from stepover.planning.leg_check import LegPosture, leg_posture, leg_separation
from stepover.planning.splines import clamped_spline
from stepover.planning.trajectories import FeetTrajectories, WaistAndFeet

FEW = 8
"""The search first looks at one in so many of its samples: that is enough to rule most candidates out."""
TIE = 1e-9
"""Better by less is rounding [m]: the swing foot stays where it is, whatever the waist's height."""


def best_candidate(
    crossing: Crossing, poses: WaistAndFeet, raises: np.ndarray, shifts: np.ndarray, hopeless: float
) -> tuple[float, float, float]:
    """Try raises of the waist and shifts of the foot [m]: the first that is free enough, else the freest.

    A few samples rule most candidates out: those whose separation there is no larger than what is hopeless [m].

    Returns:
        Separation of the legs, shift and raise [m].
    """
    every = samples(crossing.robot.adaptor.look_every, crossing.robot.walk.sample_time)
    candidates = np.array([(height, shift) for height in raises for shift in shifts])  # (1), then (2) and (1) again
    free = np.repeat(stance_clearances(crossing, poses, raises, every), len(shifts))
    for closer in (FEW * every, every):
        hopeful = free > hopeless
        free[hopeful] = np.minimum(free[hopeful], swing_clearances(crossing, poses, candidates[hopeful], closer))
    best = int(np.argmax(free >= free.max() - TIE))
    height, shift = candidates[best].tolist()
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
    bump[step.swing] = height * _up(robot, step)
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


def stance_clearances(crossing: Crossing, poses: WaistAndFeet, raises: np.ndarray, every: int) -> np.ndarray:
    """Smallest separation (H,) [m] of the stance leg in phase 3 for raises (H,) of the waist, at one in every samples.

    Separations beyond the spare of the adaptor are not told apart; -inf beyond reach or limits.
    """
    step = crossing.sequence.step(LEG_2)
    waist, sole = _looked_at(poses, step, -step.side, every)
    waists = _raised(crossing.robot, step, waist, raises, every)
    return _leg_clearances(crossing, -step.side, waists, _copies(sole, len(raises)))


def swing_clearances(crossing: Crossing, poses: WaistAndFeet, candidates: np.ndarray, every: int) -> np.ndarray:
    """The same (C,) of the swing leg for candidates (C, 2), raise and shift."""
    step = crossing.sequence.step(LEG_2)
    waist, sole = _looked_at(poses, step, step.side, every)
    soles = _copies(sole, len(candidates))
    soles[..., 0] -= np.outer(candidates[:, 1], _back(crossing.robot, step)[::every])
    waists = _raised(crossing.robot, step, waist, candidates[:, 0], every)
    return _leg_clearances(crossing, step.side, waists, soles)


def _looked_at(poses: WaistAndFeet, step: Step, side: int, every: int) -> tuple[np.ndarray, np.ndarray]:
    """Waist and sole (n, 7) of one side at one in every samples of a swing."""
    return poses.waist[step.swing][::every], poses.feet.foot(side)[step.swing][::every]


def _raised(robot: Robot, step: Step, waist: np.ndarray, raises: np.ndarray, every: int) -> np.ndarray:
    """Waists (H, n, 7) raised by some raises (H,), of the waist (n, 7) at one in every samples of a swing."""
    waists = _copies(waist, len(raises))
    waists[..., 2] += np.outer(raises, _up(robot, step)[::every])
    return waists


def _copies(poses: np.ndarray, count: int) -> np.ndarray:
    """As many copies (count, n, 7) of poses (n, 7)."""
    return np.tile(poses, (count, 1, 1))


def _leg_clearances(crossing: Crossing, side: int, waists: np.ndarray, soles: np.ndarray) -> np.ndarray:
    """The same (C,) of one leg for C trajectories of waist and sole (C, n, 7)."""
    robot, limits = crossing.robot, crossing.limits
    posture = leg_posture(robot, side, waists.reshape(-1, 7), soles.reshape(-1, 7), limits.knee_margin)
    able = posture.able().reshape(waists.shape[:2]).all(axis=1)
    rows = np.repeat(able, waists.shape[1])
    within = LegPosture(*(part[rows] for part in posture))
    free = np.full(len(waists), -np.inf)
    separations, _ = leg_separation(robot, side, within, limits.rectangle, robot.adaptor.spare)
    free[able] = separations.reshape(-1, waists.shape[1]).min(axis=1)
    return free


def displaced(feet: FeetTrajectories, step: Step, change: np.ndarray) -> FeetTrajectories:
    """Feet with the swing foot moved by change (n, 3) [m] from lift-off to touch-down."""
    foot = feet.foot(step.side).copy()
    foot[step.swing, :3] += change
    return FeetTrajectories(foot, feet.right) if step.side > 0 else FeetTrajectories(feet.left, foot)
