"""Joint torques: abs(tau - sum J' w) <= r tau_max.

Inverse dynamics by RNEA (Featherstone, Rigid Body Dynamics Algorithms, ch. 5), its derivatives after Carpentier and
Mansard, RSS 2018, by pinocchio. In single support the whole wrench w of the floor is on the bearing foot. In double
support the feet share it by the rule of sharing.py.
"""

from __future__ import annotations

import numpy as np

from stepover.planning.optimal.constraints.group import Group, Local
from stepover.planning.optimal.constraints.sharing import shared_torques
from stepover.planning.optimal.instants import Instants, Probe
from stepover.planning.optimal.scene import Scene

DIFFERENCE = 1e-6
"""Step of the differences by q, v and a in double support."""


def torque(seen: Instants) -> Group:
    """Torques of all joints that move, as shares of their limits, both ways."""
    channels, body = seen.scene.channels, seen.scene.robot.body
    limits = body.effort_limits[np.array(channels.full_columns) - 7]
    names, double = channels.dynamics.joints, np.flatnonzero(seen.scene.support == 0)
    torques = seen.wrench.torques.copy()
    torques[double] = shared_torques(_probe(seen, double))
    values = np.hstack([torques, -torques]) / np.tile(limits, 2) - np.tile(shares(seen.scene), 2)

    def gradient(rows: np.ndarray, columns: np.ndarray) -> Local:
        joint, both = columns % len(limits), seen.scene.support[rows] == 0
        by = seen.wrench_by[1][rows, joint]
        if both.any():
            by[both] = _shared_by(seen, double)[np.searchsorted(double, rows[both]), joint[both]]
        sign = np.where(columns < len(limits), 1.0, -1.0) / limits[joint]
        return Local(motion=sign[:, None] * by)

    return Group("joint torque", values, [*names, *names], 1.0, "of its limit", gradient)


def shares(scene: Scene) -> np.ndarray:
    """Largest torques (n, C - 6) as shares of their limits: smaller after leg 1 has landed, and in chest and arms."""
    p, joints = scene.parameters, scene.channels.dynamics.joints
    found = np.full((len(scene.samples), len(joints)), p.torque_share)
    found[scene.landed] = p.torque_share_landed
    found[:, [joints.index(joint) for joint in scene.channels.upper]] = p.torque_share_upper
    return found


def _probe(seen: Instants, rows: np.ndarray) -> Probe:
    """Some of the postures."""
    return Probe(seen.scene, seen.samples[rows], seen.q[rows], seen.v[rows], seen.a[rows])


def _shared_by(seen: Instants, rows: np.ndarray) -> np.ndarray:
    """Derivatives (R, C - 6, 3 C) of the shared torques by q, v, a, by central differences of all of them at once."""
    (n, count), width = (len(rows), seen.q.shape[1]), 3 * seen.q.shape[1]
    state = np.concatenate([seen.q[rows], seen.v[rows], seen.a[rows]], axis=1)
    steps = DIFFERENCE * np.concatenate([np.eye(width), -np.eye(width)])
    moved = (state[:, None] + steps).reshape(-1, 3, count)
    samples = np.repeat(seen.samples[rows], 2 * width)
    torques = shared_torques(Probe(seen.scene, samples, moved[:, 0], moved[:, 1], moved[:, 2]))
    up, down = np.moveaxis(torques.reshape(n, 2, width, count - 6), 1, 0)
    return np.swapaxes(up - down, 1, 2) / (2.0 * DIFFERENCE)
