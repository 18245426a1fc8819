"""The cost: half the sum of squares of accelerations, deviations from the base, and ZMP and yaw moment off-centre.

The first two are linear in the variables. The ZMP is drawn to the middle of the bearing sole, since what lies in the
middle survives disturbances; ahead and behind it is free to go further near the double support over the obstacle.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from stepover.motion.footsteps import LEG_1, LEG_2
from stepover.planning.optimal.channels import SIDES
from stepover.planning.optimal.instants import Instants
from stepover.planning.optimal.scene import Scene
from stepover.planning.optimal.variables import Variables

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
    quick, away = (np.tile(weights, len(samples)) for weights in _weights(scene))
    rows = [sp.diags(quick / dt**2) @ (after - 2.0 * here + before), sp.diags(away) @ here]
    offsets = [quick * np.clip(bent, -FASTEST, FASTEST).ravel(), np.zeros(len(away))]
    matrix = sp.vstack([*rows, scene.parameters.weight_variable * sp.eye(variables.count)]).tocsr()
    offset = np.concatenate([*offsets, np.zeros(variables.count)])
    return Quadratic(matrix, offset)


def _weights(scene: Scene) -> tuple[list[float], list[float]]:
    """Weights of accelerations and deviations of all channels: of waist and soles x y z, yaw, pitch, roll."""
    p, robot, upper = scene.parameters, scene.robot, scene.channels.upper
    waist = [p.weight_waist_travel] * 2 + [p.weight_waist_height, p.weight_waist_yaw] + [p.weight_waist_tilt] * 2
    sole = [p.weight_sole_travel, p.weight_sole_aside, p.weight_sole_travel]
    sole += [p.weight_sole_turn, p.weight_sole_pitch, p.weight_sole_turn]
    stay_waist = [0.0, 0.0, p.stay_waist_height, 0.0, p.stay_waist_tilt, p.stay_waist_tilt]
    stay_sole = [0.0, p.stay_sole_aside, 0.0, p.stay_sole_turn, 0.0, p.stay_sole_turn]
    swings = [name in robot.upper_body.shoulders for name in upper]
    quick = [p.weight_shoulders if one else p.weight_trunk for one in swings]
    away = [p.stay_shoulders if one else p.stay_trunk for one in swings]
    away = [
        p.stay_chest_yaw if name == robot.upper_body.chest_yaw else one for name, one in zip(upper, away, strict=True)
    ]
    return [*waist, *sole, *sole, *quick], [*stay_waist, *stay_sole, *stay_sole, *away]


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
