"""Estimate base and CoM from sensor readings: stance-foot kinematics and an IMU, after Caron et al. (ICRA 2019).

The IMU gives the waist's attitude, and the encoders give the place of each sole relative to the waist. A loaded sole
stays where it took the load. With two loaded feet, the anchor is their mean weighted by load, so that it passes
smoothly from foot to foot. The rotation of a foot is not used. With a rubber bush the sole lies flat while the ankle
leans; as the bush is near the sole, the middle of the sole computed from the joints hardly moves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stepover.control.reference import Reference
from stepover.control.sensors import Sensed
from stepover.model.gravity import GRAVITY
from stepover.model.instant import Instant
from stepover.model.robot import Robot

SIDES = (1, -1)
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Estimate:
    """The estimated state of the robot at one sample. Feet are in the order left, right.

    Attributes:
        attitude: (3, 3) rotation of the waist in the world.
        waist: (3,) position of the waist [m].
        com, com_velocity: (3,) [m], [m/s].
        dcm: (2,) [m].
        zmp: (2,) point on the floor where the total force of the floor acts [m]; the planned ZMP while no foot bears
            load.
        loads: (2,) vertical forces on the feet, zero for a swinging foot [N].
        cops: (2, 2) centre of pressure under each foot from the middle of its sole, in the world's axes [m].
        weights: (2,) share of each foot in holding the robot; the sum is 1.
        soles: (2, 3) places of the sole frames [m].
        feet: (2, 3, 3) rotations of the feet in the world.
    """

    attitude: np.ndarray
    waist: np.ndarray
    com: np.ndarray
    com_velocity: np.ndarray
    dcm: np.ndarray
    zmp: np.ndarray
    loads: np.ndarray
    cops: np.ndarray
    weights: np.ndarray
    soles: np.ndarray
    feet: np.ndarray


class Estimator:
    """Estimates the state from one Sensed after the other.

    Only the velocity's deviation from the plan is filtered. So the velocity lags behind disturbances, but not behind
    the planned walk.
    """

    def __init__(self, robot: Robot, planned: Reference, give: float = 0.0, start: int = 0) -> None:
        """Start with the planned state.

        Args:
            robot: robot with the gains.
            planned: the motion.
            give: compression of the rubber under an ankle for a load [m/N]; 0 without rubber.
            start: sample at which the feet are at their planned places.
        """
        self._planned = planned
        self._instant = Instant(robot)
        self._height = robot.foot.ankle_height
        self._light = robot.stabilizer.contact_share * robot.body.mass * GRAVITY
        cutoff = 2.0 * np.pi * robot.stabilizer.velocity_cutoff * planned.dt
        self._give = give
        self._blend = cutoff / (1.0 + cutoff)
        self._anchors = planned.soles[start].copy()
        self._from_feet: np.ndarray | None = None
        self._weights = np.array([0.5, 0.5])
        self._deviation = np.zeros(3)

    def update(self, sample: int, sensed: Sensed) -> Estimate:
        """Estimate from the readings of one sample.

        Args:
            sample: sample of the readings.
            sensed: the readings.
        """
        planned, instant = self._planned, self._instant
        instant.place(sensed.attitude, sensed.joints)
        frames = [instant.ankle(side) for side in SIDES]
        loads, cops = self._pressure([r for r, _ in frames], sensed)
        weights = self._shares(sample, loads)
        soles = np.array([position - self._height * turn[:, 2] for turn, position in frames])
        pressed = soles + self._give * loads[:, None] * UP  # pressed rubber raises the floor
        shift = weights @ (self._anchors - pressed)
        self._walk_on(pressed + shift, weights)
        com = instant.com()
        velocity = self._velocity(sample, com - soles, weights)
        placed, bearing = com + shift, loads.sum()
        zmp = loads @ ((soles + shift)[:, :2] + cops) / bearing if bearing else planned.zmp[sample]
        return Estimate(
            attitude=_matrix(sensed.attitude), waist=shift, com=placed, com_velocity=velocity,
            dcm=placed[:2] + velocity[:2] / planned.omega, zmp=zmp, loads=loads, cops=cops, weights=weights,
            soles=soles + shift, feet=np.array([turn for turn, _ in frames]),
        )  # fmt: skip

    def _pressure(self, turns: list[np.ndarray], sensed: Sensed) -> tuple[np.ndarray, np.ndarray]:
        """Loads (2,) and centres of pressure (2, 2): points at the sole's height without a horizontal moment."""
        loads, cops = np.zeros(2), np.zeros((2, 2))
        for foot, (side, turn) in enumerate(zip(SIDES, turns, strict=True)):
            wrench = sensed.wrench(side)
            (fx, fy, fz), (mx, my, _) = turn @ wrench[:3], turn @ wrench[3:]
            if fz > self._light:
                loads[foot] = fz
                down = -self._height * turn[:, 2]  # the middle of the sole from the ankle
                cops[foot] = -(my - down[2] * fx) / fz - down[0], (mx + down[2] * fy) / fz - down[1]
        return loads, cops

    def _shares(self, sample: int, loads: np.ndarray) -> np.ndarray:
        """Share of each foot in holding the robot (2,): by load, or as planned while no foot bears load."""
        total = loads.sum()
        if total > 0.0:
            return np.asarray(loads / total)
        return {0: np.array([0.5, 0.5]), 1: np.array([1.0, 0.0]), -1: np.array([0.0, 1.0])}[
            int(self._planned.support[sample])
        ]

    def _walk_on(self, soles: np.ndarray, weights: np.ndarray) -> None:
        """Set a foot's anchor to the place of its sole when it took the load. The floor is assumed to be level."""
        self._anchors = self._anchors + (1.0 - weights)[:, None] * (soles - self._anchors)
        self._anchors[:, 2] = 0.0

    def _velocity(self, sample: int, from_feet: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Velocity (3,) of the CoM [m/s] against the loaded feet, which stand still."""
        planned = self._planned
        if self._from_feet is not None and sample > 0:
            both = np.minimum(weights, self._weights)  # a foot that has just landed was still moving before
            both = both / both.sum() if both.sum() > 0.0 else weights
            measured = both @ (from_feet - self._from_feet) / planned.dt
            expected = (planned.com[sample] - planned.com[sample - 1]) / planned.dt
            self._deviation = self._deviation + self._blend * (measured - expected - self._deviation)
        self._from_feet, self._weights = from_feet, weights
        return np.asarray(planned.com_velocity[sample] + self._deviation)


def _matrix(quaternion: np.ndarray) -> np.ndarray:
    """Rotation (3, 3) of a unit quaternion (4,) x y z w."""
    x, y, z, w = quaternion.tolist()
    return np.array([
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ])  # fmt: skip
