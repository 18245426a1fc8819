"""Record measurements while the physics runs, at every sample of the motion."""

from __future__ import annotations

import hashlib

import numpy as np

from stepover.model.parameters.planning import samples
from stepover.motion.motion import Motion
from stepover.simulation.engine import Engine
from stepover.simulation.observers import Observer, Sample


class Recording(Observer):
    """Measured series at the N sample times of the motion. The first `count` samples are filled.

    Forces and torques are means over the time steps since the sample before. They are zero at the first sample.

    Attributes:
        q: (N, nq) measured configurations.
        dq: (N, nq - 7) joint speeds [rad/s].
        torque: (N, nq - 7) [N m].
        feet: (N, 2, 6) wrenches of the floor on the left and right foot, about the world's origin.
        total: (N, 6) the same on the whole robot.
        saturated: (N, nq - 7) whether a motor reached its torque limit.
        bush: (N, 6) deflections of the rubber under the left and the right ankle: up, roll, pitch [m, rad].
        bush_depth: depth of the rubber below the ankle [m]; 0 for rigid soles.
        believed_waist, believed_com: (N, 3) the stabilizer's estimates [m]; NaN without a stabilizer.
        obstacle_depth: (N,) largest depth of a contact with the obstacle [m]; NaN without contact.
        touched: the first sample with such a contact and the links that touch, or None.
        count: number of filled samples.
    """

    def __init__(self, motion: Motion, engine: Engine) -> None:
        """Allocate the arrays for a motion in a world."""
        count, joints = len(motion.time), len(motion.joint_names)
        self.bush_depth = engine.bush_depth
        self._age = samples(engine.scene.robot.stabilizer.age, motion.dt)
        self.q = np.zeros((count, 7 + joints))
        self.dq, self.torque = np.zeros((count, joints)), np.zeros((count, joints))
        self.feet, self.total = np.zeros((count, 2, 6)), np.zeros((count, 6))
        self.saturated, self.bush = np.zeros((count, joints), dtype=bool), np.zeros((count, 6))
        self.believed_waist, self.believed_com = np.full((2, count, 3), np.nan)
        self.obstacle_depth = np.full(count, np.nan)
        self.touched: tuple[int, list[str]] | None = None
        self.count = 0

    def sampled(self, sample: Sample) -> None:
        """Record one sample."""
        k, touch = sample.index, sample.touch
        self.q[k], self.dq[k] = sample.q, sample.dq
        if k and self.q[k, 3:7] @ self.q[k - 1, 3:7] < 0.0:
            self.q[k, 3:7] *= -1.0
        self.torque[k], self.feet[k], self.total[k] = sample.torque, touch.feet, touch.total
        self.saturated[k], self.bush[k] = sample.saturated, sample.bush
        if touch.obstacle:
            self.obstacle_depth[k] = max(touch.obstacle.values())
            self.touched = self.touched or (k, sorted(touch.obstacle))
        if sample.estimate is not None and k >= self._age:
            self.believed_waist[k - self._age], self.believed_com[k - self._age] = (
                sample.estimate.waist, sample.estimate.com,
            )  # fmt: skip
        self.count = k + 1

    def state_hash(self) -> str:
        """SHA-256 of all recorded states, torques and forces, to the last bit."""
        series = (self.q, self.dq, self.torque, self.feet, self.total)
        return hashlib.sha256(b"".join(part[: self.count].tobytes() for part in series)).hexdigest()
