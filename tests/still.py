"""Motions made by hand for the physics: standing still, and parts of a motion."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np

from stepover.model.robot import Robot
from stepover.motion.motion import Motion


def samples_of(motion: Motion, samples: np.ndarray) -> Motion:
    """Some samples of a motion, in any order, at the motion's own pace."""
    arrays = {f.name: getattr(motion, f.name) for f in fields(motion)}
    along = {name for name, value in arrays.items() if np.shape(value)[:1] == np.shape(motion.time)}
    chosen = {name: arrays[name][samples] for name in along}
    chosen["time"] = motion.dt * np.arange(len(samples))
    return replace(motion, **chosen)


def standing(motion: Motion, duration: float) -> Motion:
    """The first posture of a motion, held for a time [s]."""
    return samples_of(motion, np.zeros(round(duration / motion.dt) + 1, dtype=int))


def bent(motion: Motion, robot: Robot, joint: str, angle: float) -> Motion:
    """A motion with one joint moved by an angle [rad] from the second sample on."""
    q = motion.q.copy()
    q[1:, robot.body.column(joint)] += angle
    return replace(motion, q=q)
