"""Closed-form inverse kinematics of legs whose hip axes meet in one point, and whose ankle axes meet in another.

The hip's three axes may have any order, and so may the ankle's two. The knee may lie off the straight line between
them. In the ankle's frame, knee and ankle angles determine the place of the hip. The remaining rotation belongs to the
hip.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from stepover.model import pose
from stepover.model.kinematics import axis_rotation

TOLERANCE = 1e-9
"""Tolerance of axes and offsets [m], for the rounding in a URDF."""
X, Y, _ = np.eye(3)


class MeetingAxes(NamedTuple):
    """Data of a leg for the closed form.

    Attributes:
        hip: (3,) point where the hip's axes meet, in the root's frame [m].
        order: the hip's axes, such as "YXZ" for pitch, roll, yaw.
        rolls_first: whether the ankle's roll comes before its pitch.
        signs: (6,) +1 or -1: direction in which each joint turns about its axis.
        thigh, shank: hip to knee and knee to ankle seen from the side, as complex numbers z + i x [m].
        lateral: hip beside the ankle along the pitch axes [m].
    """

    hip: np.ndarray
    order: str
    rolls_first: bool
    signs: np.ndarray
    thigh: complex
    shank: complex
    lateral: float

    @staticmethod
    def of(chain: Sequence[tuple[np.ndarray, np.ndarray, np.ndarray]]) -> MeetingAxes | None:
        """The data from fixed rotation, translation and axis of the six joints; None if the axes do not meet."""
        rotations, origins, axes = (np.array(part) for part in zip(*chain, strict=True))
        letters = "".join("XYZ"[k] for k in np.abs(axes).argmax(axis=1))
        together = origins[[1, 2, 5]]
        if (
            np.abs(rotations - np.eye(3)).max() > TOLERANCE
            or np.abs(np.abs(axes).max(axis=1) - 1.0).max() > TOLERANCE
            or np.abs(together).max() > TOLERANCE
            or sorted(letters[:3]) != ["X", "Y", "Z"]
            or letters[3:] not in ("YXY", "YYX")
        ):
            return None
        thigh, shank = (complex(origins[k][2], origins[k][0]) for k in (3, 4))
        lateral = -float(origins[3][1] + origins[4][1])
        return MeetingAxes(origins[0], letters[:3], letters[4] == "X", axes.sum(axis=1).round(), thigh, shank, lateral)

    def solve(
        self, waist: np.ndarray, sole: np.ndarray, ankle_height: float, bends: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Angles (N, 6) [rad], and how far each target is out of reach (N,) [m] or 0.

        Args:
            waist: (N, 7) poses of the root.
            sole: (N, 7) poses of the sole frame.
            ankle_height: ankle above the sole [m].
            bends: knee angle of a posture that bends in the wanted direction [rad].
        """
        waist_r, foot_r = pose.rotation(waist), pose.rotation(sole)
        hip, ankle = waist[:, :3] + waist_r @ self.hip, sole[:, :3] + foot_r @ [0.0, 0.0, ankle_height]
        seen = np.einsum("nba,nb->na", foot_r, hip - ankle)  # from the ankle to the hip, in the foot
        knee, excess = self._knee(np.sqrt(np.maximum((seen**2).sum(axis=1) - self.lateral**2, 0.0)), bends)
        leg = -(self.thigh * np.exp(-1j * knee) + self.shank)  # the same, in the shank
        solver = self._roll_before_pitch if self.rolls_first else self._pitch_before_roll
        roll, pitch, short = solver(seen, leg)
        ankle_r = [axis_rotation(X, roll), axis_rotation(Y, pitch)]
        shank_r = foot_r @ np.swapaxes(ankle_r[0] @ ankle_r[1] if self.rolls_first else ankle_r[1] @ ankle_r[0], 1, 2)
        thigh_r = np.swapaxes(waist_r, 1, 2) @ shank_r @ axis_rotation(Y, -knee)
        last = (roll, pitch) if self.rolls_first else (pitch, roll)
        angles = np.column_stack([Rotation.from_matrix(thigh_r).as_euler(self.order), knee, *last]) * self.signs
        return (angles + np.pi) % (2.0 * np.pi) - np.pi, np.maximum(excess, short)

    @property
    def straight(self) -> float:
        """Turn of the knee about y at which hip, knee and ankle are in line [rad]."""
        return float(np.angle(self.thigh / self.shank))

    def _knee(self, reach: np.ndarray, bends: float) -> tuple[np.ndarray, np.ndarray]:
        """Turn of the knee about y for a distance (N,) between hip and ankle from the side, and the missing reach."""
        thigh, shank = abs(self.thigh), abs(self.shank)
        excess = np.maximum(np.maximum(reach - thigh - shank, abs(thigh - shank) - reach), 0.0)
        bend = np.arccos(np.clip((reach**2 - thigh**2 - shank**2) / (2.0 * thigh * shank), -1.0, 1.0))
        way = 1.0 if self.signs[3] * bends >= self.straight else -1.0
        return self.straight + way * bend, excess

    def _roll_before_pitch(self, seen: np.ndarray, leg: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Roll and pitch of the ankle (N,) for the hip seen from the foot and from the shank, and the missing reach."""
        radius = np.hypot(self.lateral, leg.real)
        roll = np.arcsin(np.clip(seen[:, 1] / radius, -1.0, 1.0)) - np.arctan2(self.lateral, leg.real)
        upright = np.cos(roll) * leg.real - np.sin(roll) * self.lateral + 1j * leg.imag
        pitch = np.angle(upright / (seen[:, 2] + 1j * seen[:, 0]))
        return roll, pitch, np.maximum(np.abs(seen[:, 1]) - radius, 0.0)

    def _pitch_before_roll(self, seen: np.ndarray, leg: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The same where the pitch comes first."""
        side = np.hypot(seen[:, 1], seen[:, 2])
        up = np.sqrt(np.maximum(side**2 - self.lateral**2, 0.0))
        roll = np.arctan2(seen[:, 1], seen[:, 2]) - np.arctan2(self.lateral, up)
        pitch = np.angle(leg / (up + 1j * seen[:, 0]))
        return roll, pitch, np.maximum(abs(self.lateral) - side, 0.0)
