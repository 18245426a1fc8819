"""The planar biped in double support over the obstacle. Sec. II-A, Fig. 2 (top left), Eqs. (1)-(12).

The biped has four links between five points, and both soles are flat on the floor: x1 is the rear ankle, x2 its knee,
x3 the hip, x4 and x5 the front knee and ankle. With x1 above the origin, three lengths define the posture: X_ads from
ankle to ankle, X_hds from the rear ankle to the hip, and the hip's height Z_hds. Knees bend forwards. Every function
takes arrays of any shape.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from stepover.errors import InvalidInput
from stepover.model.robot import Robot

PITCH = np.array([0.0, 1.0, 0.0])


@dataclass(frozen=True, eq=False)
class PlanarBiped:
    """A robot, seen from the side.

    Attributes:
        thigh, shank: lengths of the links [m].
        ankle_height: ankle above the sole [m].
        foot: foot length F_W [m]; the ankle is above its middle.
        outline: lines around the shank in the knee's frame, (V, 2) each, x ahead and z up along the shank [m].
        limits: (3, 2) of hip, knee and ankle pitch [rad], in the signs of the robot's joints.
    """

    thigh: float
    shank: float
    ankle_height: float
    foot: float
    outline: tuple[np.ndarray, ...]
    limits: np.ndarray


class PlanarLeg(NamedTuple):
    """A leg with its sole flat and its ankle above x = 0.

    Attributes:
        points: (..., 3, 2) ankle, knee and hip, x and z [m]; the knee is NaN if the hip is out of reach.
        angles: (..., 3) of hip, knee and ankle [rad], for an upright waist.
        possible: (...) whether the hip is within reach and the angles within their limits, Eq. (1).
    """

    points: np.ndarray
    angles: np.ndarray
    possible: np.ndarray


def planar_biped(robot: Robot) -> PlanarBiped:
    """The planar biped of a robot: lengths and limits of its left leg, foot and outline of robot.toml.

    Raises:
        InvalidInput: the leg is not a thigh and a shank, one below the other, with a pitch joint at both ends of each.
    """
    body, joints = robot.body, robot.legs.left
    pitches = [k for k, joint in enumerate(joints) if np.allclose(body.axes[body.column(joint) - 7], PITCH)]
    knee = next(k for k, joint in enumerate(joints) if joint in robot.legs.knee)
    if len(pitches) != 3 or pitches[1] != knee:
        raise InvalidInput(f"{robot.name}: a planar biped needs a pitch joint at the hip, the knee and the ankle")
    origins = np.array([body.origin(joint)[1] for joint in joints])
    bones = [origins[first + 1 : last + 1].sum(axis=0) for first, last in pairwise(pitches)]
    if any(abs(bone[0]) > 1e-6 or bone[2] >= 0.0 for bone in bones):
        raise InvalidInput(f"{robot.name}: a planar biped needs the knee below the hip and the ankle below the knee")
    columns = [body.column(joints[k]) - 7 for k in pitches]
    return PlanarBiped(
        float(-bones[0][2]), float(-bones[1][2]), robot.foot.ankle_height, robot.foot.sole_length,
        (np.array(robot.outline.front), np.array(robot.outline.rear)),
        np.column_stack([body.lower[columns], body.upper[columns]]),
    )  # fmt: skip


def planar_leg(biped: PlanarBiped, ahead: np.ndarray, height: np.ndarray) -> PlanarLeg:
    """A leg, given how far its hip is ahead of its ankle and above the floor (...) [m]."""
    ahead, rise = np.broadcast_arrays(ahead, np.asarray(height) - biped.ankle_height)
    thigh, shank, distance = biped.thigh, biped.shank, np.hypot(ahead, rise)
    reached = (distance <= thigh + shank) & (distance >= abs(thigh - shank)) & (distance > 0.0)
    cosine = (distance**2 - thigh**2 - shank**2) / (2.0 * thigh * shank)
    bend = np.arccos(np.where(reached, np.clip(cosine, -1.0, 1.0), np.nan))
    lean = np.arctan2(ahead, rise) + np.arctan2(thigh * np.sin(bend), shank + thigh * np.cos(bend))
    angles = np.stack([lean - bend, bend, -lean], axis=-1)
    knee = np.stack([shank * np.sin(lean), biped.ankle_height + shank * np.cos(lean)], axis=-1)
    ankle = np.stack([np.zeros_like(distance), np.full_like(distance, biped.ankle_height)], axis=-1)
    hip = np.stack([ahead, rise + biped.ankle_height], axis=-1)
    inside = (angles >= biped.limits[:, 0]) & (angles <= biped.limits[:, 1])
    return PlanarLeg(np.stack([ankle, knee, hip], axis=-2), angles, reached & inside.all(axis=-1))


def leg_lines(biped: PlanarBiped, leg: PlanarLeg) -> list[np.ndarray]:
    """Lines (..., V, 2) of a leg: its two links, and the outline if the biped has one."""
    up = (leg.points[..., 1, :] - leg.points[..., 0, :]) / biped.shank
    ahead = up[..., ::-1] * [1.0, -1.0]
    turn = np.stack([ahead, up], axis=-2)
    return [leg.points, *(line @ turn + leg.points[..., 1:2, :] for line in biped.outline)]


def joint_angles(rear: PlanarLeg, front: PlanarLeg) -> np.ndarray:
    """q1 ... q4 (..., 4) [rad]: rear ankle, rear knee, the hip from the rear to the front thigh, front knee."""
    hip = front.angles[..., 0] - rear.angles[..., 0]
    return np.stack([rear.angles[..., 2], rear.angles[..., 1], hip, front.angles[..., 1]], axis=-1)


def over_rear_foot(x: np.ndarray, foot: float) -> np.ndarray:
    """Eq. (6) for the CoM's x at the end of phase 1; Eq. (10) for the ZMP's. From the rear ankle, F_W in foot [m]."""
    return (x >= -foot / 2.0) & (x <= foot / 2.0)


def between_feet(x: np.ndarray, x_ads: np.ndarray | float, foot: float) -> np.ndarray:
    """Eq. (7) for the CoM's x throughout phase 2; Eq. (11) for the ZMP's [m]."""
    return (x >= -foot / 2.0) & (x <= x_ads + foot / 2.0)


def over_front_foot(x: np.ndarray, x_ads: np.ndarray | float, foot: float) -> np.ndarray:
    """Eq. (8) for the CoM's x at the beginning of phase 3; Eq. (12) for the ZMP's [m]."""
    return over_rear_foot(x - x_ads, foot)
