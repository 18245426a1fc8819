"""The robot's sensors in the simulation, with noise and delay."""

from __future__ import annotations

import numpy as np

from stepover.control.sensors import Sensed
from stepover.model.pose import Rotation, cross, product, unit
from stepover.simulation.engine import Engine
from stepover.simulation.touch import Touch

STILL = Rotation.identity()
"""Identity rotation: no noise of the attitude."""


class Senses:
    """Encoders, an IMU with an attitude filter, and a force sensor in each ankle, read at each sample of the motion."""

    def __init__(self, engine: Engine, period: float) -> None:
        """Sensors of a world, with a period [s] between readings."""
        self._engine, self._disturbances, self._period = engine, engine.scene.disturbances, period
        self._random = np.random.default_rng(int(self._disturbances.seed))
        self._upright = _upright(self._disturbances.gravity).as_quat().tolist()
        self._readings: list[Sensed] = []

    def read(self, touch: Touch) -> None:
        """Take new readings."""
        d, add = self._disturbances, self._noise
        angles, _ = self._engine.joints()
        turn, rate = self._engine.imu()
        shake = Rotation.from_rotvec(add(np.zeros(3), np.radians(d.noise_attitude))) if d.noise_attitude else STILL
        attitude = product(product(self._upright, unit(turn.tolist())), shake.as_quat().tolist())
        wrenches = [self._at_ankle(foot, wrench) for foot, wrench in enumerate(touch.feet)]
        noisy = [np.concatenate([add(w[:3], d.noise_force), add(w[3:], d.noise_moment)]) for w in wrenches]
        self._readings.append(
            Sensed(add(angles, d.noise_joints), np.array(attitude), add(rate, d.noise_rate), noisy[0], noisy[1])
        )

    def late(self, age: float) -> Sensed:
        """Readings from some time ago [s] plus the disturbance "latency". Before the start: those of the start."""
        back = (age + self._disturbances.latency) / self._period
        whole = int(np.ceil(back - 1e-9))
        older, newer = (self._readings[max(len(self._readings) - 1 - n, 0)] for n in (whole, max(whole - 1, 0)))
        share = whole - back
        return newer if whole == 0 else older if share < 1e-9 else _between(older, newer, share)

    def _at_ankle(self, foot: int, wrench: np.ndarray) -> np.ndarray:
        """A wrench about the world's origin, converted to the frame of an ankle's sensor."""
        place, axes = self._engine.ankle(foot)
        moment = wrench[3:] - cross(place.tolist(), wrench[:3].tolist())
        return np.concatenate([wrench[:3] @ axes, moment @ axes])

    def _noise(self, value: np.ndarray, deviation: float) -> np.ndarray:
        """A value with normal noise. Without noise, no random number is drawn."""
        return value + self._random.normal(0.0, deviation, np.shape(value)) if deviation > 0.0 else value


def _upright(gravity: np.ndarray) -> Rotation:
    """Rotation that makes gravity (3,) point down in the floor's frame, since an IMU is level by gravity."""
    up = -gravity / np.linalg.norm(gravity)
    return Rotation.from_quat([*np.cross(up, [0.0, 0.0, 1.0]), 1.0 + up[2]])


def _between(older: Sensed, newer: Sensed, share: float) -> Sensed:
    """Readings interpolated from older to newer ones by a share from 0 to 1."""
    near = older.attitude if older.attitude @ newer.attitude >= 0.0 else -older.attitude
    attitude = near + share * (newer.attitude - near)
    blend = [
        getattr(older, name) + share * (getattr(newer, name) - getattr(older, name))
        for name in ("joints", "rate", "left_wrench", "right_wrench")
    ]
    return Sensed(blend[0], attitude / np.linalg.norm(attitude), *blend[1:])
