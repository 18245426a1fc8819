"""Errors of the multi-body ZMP before and after the dynamic filter: over the obstacle, in normal steps, peaks. Sec. V.

Kicking off and stopping are left out: the errors are taken from the first lift-off to the last touch-down.
"""

from __future__ import annotations

import numpy as np

from stepover.errors import InvalidInput
from stepover.model.robot import Robot
from stepover.motion.motion import Motion


def first_stage(motion: Motion) -> np.ndarray:
    """Error (N, 2) of the multi-body ZMP before the filter [m].

    Raises:
        InvalidInput: the motion's planner has no filter.
    """
    if motion.zmp_first_stage is None:
        raise InvalidInput("the motion has no first stage: its planner has no filter")
    return motion.zmp_first_stage - motion.zmp_reference


def crossing_and_walking(motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """The error before the filter, rms in x and y (2,) each [m]: over the obstacle (phases 1 to 3), in other steps."""
    error, walking = first_stage(motion), np.flatnonzero(motion.support)
    moving = np.zeros(len(error), bool)
    moving[walking[0] : walking[-1] + 1] = True
    over = motion.phase != 0
    return _rms(error[over]), _rms(error[moving & ~over])


def peak_over_support(robot: Robot, motion: Motion) -> np.ndarray:
    """Largest single error after the filter over half the length and half the width of a sole: (2,)."""
    half = np.ptp(robot.contact_patch(1), axis=0) / 2.0
    return np.asarray(np.abs(motion.zmp - motion.zmp_reference).max(axis=0) / half)


def beyond(motion: Motion, limit: float) -> float:
    """How long the error after the filter is beyond a limit [m] in x or y [s]."""
    return float((np.abs(motion.zmp - motion.zmp_reference) > limit).any(axis=1).sum() * motion.dt)


def _rms(error: np.ndarray) -> np.ndarray:
    """Root mean square over the samples, by axis."""
    return np.asarray(np.sqrt((error**2).mean(axis=0)))
