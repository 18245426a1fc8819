"""The cost: half the sum of squares of accelerations, deviations from the base, and ZMP and yaw moment off-centre.

The first two are linear in the variables. The ZMP is drawn to the middle of the bearing sole, since what lies in the
middle survives disturbances; ahead and behind it is free to go further near the double support over the obstacle.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from stepover.motion.footsteps import LEG_1, LEG_2
from stepover.planning.optimal.channels import SIDES, UPPER
from stepover.planning.optimal.instants import Instants
from stepover.planning.optimal.scene import Scene
from stepover.planning.optimal.variables import Variables

OF_ALL = 0.3
"""Common weight of accelerations and deviations."""
ACCELERATION = [0.05, 0.05, 0.08, 0.02, 0.03, 0.03] + [0.02, 0.05, 0.02, 0.02, 0.012, 0.02] * 2
"""Weights of the accelerations of waist and soles: x y z, yaw, pitch, roll [s^2/m, s^2/rad]."""
DEVIATION = [0.0, 0.0, 0.3, 0.0, 0.5, 0.5] + [0.0, 0.3, 0.0, 0.3, 0.0, 0.3] * 2
"""Weights of their deviations from the base motion [1/m, 1/rad]."""
TRUNK, SHOULDER, ARM = (0.02, 0.3), (0.01, 0.15), (0.02, 0.3)
"""Both weights of the trunk's joints, of the shoulders' pitch, and of the joint after it."""
CHEST_YAW = 0.1
"""The trunk's deviation about the vertical is cheaper."""
SMALLEST = 3e-3
"""Weight of each variable itself, so that all are determined."""
FASTEST = 20.0
"""Largest acceleration of the base that counts [m/s^2, rad/s^2]: an over-reaching base has kinks."""


class Quadratic(NamedTuple):
    """The cost's linear part: residuals matrix x + offset."""

    matrix: sp.csr_matrix
    offset: np.ndarray


def quadratic(scene: Scene, variables: Variables, every: int) -> Quadratic:
    """Accelerations and deviations every few samples of the part that can change."""
    (count, dt), inside = (scene.channels.count, scene.dt), scene.samples
    samples = np.arange(inside[0], inside[-1], every)
    before, here, after = (variables.rows(samples + k, count) for k in (-1, 0, 1))
    base = scene.base.channels
    bent = (base[samples - 1] - 2.0 * base[samples] + base[samples + 1]) / dt**2
    quick, away = (OF_ALL * np.tile(weights, len(samples)) for weights in _weights(scene))
    rows = [sp.diags(quick / dt**2) @ (after - 2.0 * here + before), sp.diags(away) @ here]
    offsets = [quick * np.clip(bent, -FASTEST, FASTEST).ravel(), np.zeros(len(away))]
    matrix = sp.vstack([*rows, SMALLEST * sp.eye(variables.count)]).tocsr()
    offset = np.concatenate([*offsets, np.zeros(variables.count)])
    return Quadratic(matrix, offset)


def _weights(scene: Scene) -> tuple[list[float], list[float]]:
    """Weights of accelerations and deviations of all channels."""
    upper, robot = scene.channels.upper, scene.robot
    arms = [
        [TRUNK, SHOULDER, ARM][1 + (name not in robot.upper_body.shoulders) if name in upper[-4:] else 0]
        for name in upper
    ]
    away = [
        CHEST_YAW if name == robot.upper_body.chest_yaw else pair[1] for name, pair in zip(upper, arms, strict=True)
    ]
    assert len(ACCELERATION) == UPPER
    return [*ACCELERATION, *(pair[0] for pair in arms)], [*DEVIATION, *away]


class Centring(NamedTuple):
    """What draws the ZMP to the middle: rows (S,) of the samples, residuals (S, 3), and their weights."""

    rows: np.ndarray
    residuals: np.ndarray
    weights: np.ndarray


def centring(seen: Instants, every: int) -> Centring:
    """Residuals of the ZMP, ahead and aside, and of the yaw moment in single support."""
    scene, p = seen.scene, seen.scene.parameters
    regular = (scene.samples - scene.samples[0]) % every == 0
    rows = np.flatnonzero(regular & (scene.support != 0))
    sequence = scene.base.sequence
    begin, end = scene.base.time[[sequence.step(LEG_1).touch_down, sequence.step(LEG_2).lift_off]]
    apart = np.maximum(np.maximum(begin - scene.time, scene.time - end), 0.0)
    ahead = np.where(apart < p.weight_zmp_around, p.weight_zmp_over, p.weight_zmp)
    middles = {side: scene.robot.contact_patch(side).mean(axis=0) for side in SIDES}
    middle = np.where(scene.bearing[:, None] > 0, middles[1], middles[-1])
    weights = np.column_stack([ahead, np.full_like(ahead, p.weight_zmp), np.full_like(ahead, p.weight_yaw)])[rows]
    off = np.column_stack([seen.zmp - middle, seen.yaw_moment])[rows]
    return Centring(rows, weights * off, weights)


def centring_by(seen: Instants, found: Centring) -> np.ndarray:
    """Derivatives (S, 3, 3 C) of these residuals by q, v, a."""
    by = np.concatenate([seen.zmp_by[found.rows], seen.yaw_moment_by[found.rows, None]], axis=1)
    return found.weights[..., None] * by
