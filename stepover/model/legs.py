"""Inverse kinematics of six-joint legs over whole trajectories at once: step 4 of Algorithm 1.

Leg.inverse chooses a solver. There are closed forms for legs whose hip axes meet in a point and whose ankle axes do
too: for HRP-2's order yaw-roll-pitch-knee-pitch-roll here, for any other order in meeting_axes. All other six-joint
legs use a damped Newton iteration.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from stepover.errors import InvalidInput, OutOfReach
from stepover.model import pose
from stepover.model.body import Body
from stepover.model.kinematics import axis_rotation
from stepover.model.meeting_axes import MeetingAxes

KNEE = 3
"""Position of the knee among a leg's joints. A robot.toml with another position is rejected."""


@dataclass(frozen=True, eq=False)
class Leg:
    """A leg from the root to the sole.

    Attributes:
        body: the robot that it belongs to.
        side: +1 left, -1 right.
        joints: its six joints, from the hip to the sole.
        ankle_height: distance of the sole under the last joint [m].
        rest: joint angles (6,) in half-sitting [rad], where the numerical solver starts.
    """

    body: Body
    side: int
    joints: tuple[str, ...]
    ankle_height: float
    rest: np.ndarray

    def __post_init__(self) -> None:
        """Reject joints that are not one chain of six joints from the root."""
        parents = ["root_joint", *self.joints[:-1]]
        if len(self.joints) != 6 or [self.body.origin(joint)[2] for joint in self.joints] != parents:
            raise InvalidInput(
                f"{', '.join(self.joints)} must be the six joints of one chain from the root to the sole"
            )

    @cached_property
    def columns(self) -> list[int]:
        """Columns of the leg's joints in q."""
        return [self.body.column(joint) for joint in self.joints]

    @cached_property
    def _chain(self) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Fixed rotation, translation and axis of each joint."""
        return [(*self.body.origin(joint)[:2], self.body.axes[self.body.column(joint) - 7]) for joint in self.joints]

    @cached_property
    def _bones(self) -> tuple[complex, complex]:
        """Hip to knee and knee to ankle seen from the side, z + i x [m]."""
        thigh, shank = (self._chain[i][1] for i in (3, 4))
        return complex(thigh[2], thigh[0]), complex(shank[2], shank[0])

    @cached_property
    def is_closed_form(self) -> bool:
        """Whether the closed form applies: axes z x y y y x, hip axes meeting, ankle axes meeting."""
        rotations, origins, axes = (np.array(part) for part in zip(*self._chain, strict=True))
        wanted = np.eye(3)[[2, 0, 1, 1, 1, 0]]
        meeting = [*origins[1], origins[2][0], origins[2][2], origins[5][0], origins[5][2]]
        return np.allclose(rotations, np.eye(3)) and np.allclose(axes, wanted) and np.allclose(meeting, 0.0)

    @cached_property
    def meeting_axes(self) -> MeetingAxes | None:
        """Data of the closed form for any order of axes; None if the hip axes or the ankle axes do not meet."""
        return MeetingAxes.of(self._chain)

    @property
    def length(self) -> float:
        """Thigh, shank and ankle height [m]: what the paper's 21 % and 35 % refer to."""
        bones = [np.linalg.norm(origin[[0, 2]]) for _, origin, _ in self._chain[KNEE:]]
        return float(sum(bones)) + self.ankle_height

    def sole(self, waist: np.ndarray, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Forward kinematics: rotations (N, 3, 3) and positions (N, 3) of the sole frame."""
        rotations, positions, _, _ = self._forward(waist, angles)
        return rotations, positions + rotations @ [0.0, 0.0, -self.ankle_height]

    def joint_frames(self, waist: np.ndarray, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Ankle (N, 3), joint axes (N, 6, 3) and joint centres (N, 6, 3) in the world."""
        _, ankle, axes, centres = self._forward(waist, angles)
        return ankle, axes, centres

    def inverse(self, waist: np.ndarray, sole: np.ndarray, time: np.ndarray | None = None) -> np.ndarray:
        """Joint angles that put the sole at its target. Joint limits are checked elsewhere.

        Args:
            waist: (N, 7) poses of the root.
            sole: (N, 7) poses of the sole frame.
            time: (N,) [s], for the message.

        Returns:
            (N, 6) joint angles [rad].

        Raises:
            OutOfReach: a target is out of reach. The message names the joint and, if `time` is given, the time.
        """
        if not self.is_closed_form:
            angles, excess = self.attempt(waist, sole)
            self._require_reach(excess, time)
            return angles
        bent = self._bend(waist, sole)
        self._require_reach(bent.excess, time)  # before the hip is known: a planner's attempts often end here
        return self._angles(bent)

    def attempt(self, waist: np.ndarray, sole: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Like inverse, but without errors: angles (N, 6), and how far each target is out of reach (N,) [m] or 0."""
        if self.is_closed_form:
            return self._closed_form(waist, sole)
        if self.meeting_axes is not None:
            return self.meeting_axes.solve(waist, sole, self.ankle_height, self.rest[KNEE])
        return self._newton(waist, sole)

    def knee(self, waist: np.ndarray, sole: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Like attempt, but only the knee's angle (N,)."""
        if self.is_closed_form:
            bent = self._bend(waist, sole)
            return _wrapped(bent.knee), bent.excess
        angles, excess = self.attempt(waist, sole)
        return angles[:, KNEE], excess

    def _require_reach(self, excess: np.ndarray, time: np.ndarray | None) -> None:
        """Raise OutOfReach if a target is out of reach, with an excess (N,) above 0 [m]."""
        worst = int(np.argmax(excess))
        if excess[worst] > 0.0:
            when = f"sample {worst}" if time is None else f"t = {time[worst]:.3f} s"
            side = "left" if self.side > 0 else "right"
            knee = self.joints[KNEE]
            raise OutOfReach(
                f"{knee} over-stretches: the {side} sole is {1e3 * excess[worst]:.1f} mm out of reach at {when}",
                short=float(excess[worst]),
            )

    def _closed_form(self, waist: np.ndarray, sole: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """First the bend of the leg, then the turn of its hip."""
        bent = self._bend(waist, sole)
        return self._angles(bent), bent.excess

    def _bend(self, waist: np.ndarray, sole: np.ndarray) -> _Bend:
        """Planar triangle hip-knee-ankle, in complex numbers z + i x: a turn by q about y is a factor exp(i q)."""
        thigh, shank = self._bones
        lateral = sum(origin[1] for _, origin, _ in self._chain[2:])  # ankle beside the hip along the pitch axes
        waist_r, foot_r = pose.rotation(waist), pose.rotation(sole)
        hip = waist[:, :3] + waist_r @ self._chain[0][1]
        ankle = sole[:, :3] + self.ankle_height * foot_r[:, :, 2]
        x, y, z = np.einsum("ban,bn->an", np.ascontiguousarray(foot_r.transpose(1, 2, 0)), (hip - ankle).T)
        radius = np.maximum(np.hypot(y, z), abs(lateral))
        roll = np.arctan2(y, z) + np.arcsin(lateral / radius)
        reach = np.sqrt(radius**2 - lateral**2) + 1j * x  # from the ankle to the hip, in the leg's plane
        length, longest, shortest = abs(reach), abs(thigh) + abs(shank), abs(abs(thigh) - abs(shank))
        excess = np.maximum(np.maximum(length - longest, shortest - length), 0.0)
        cosine = (length**2 - abs(thigh) ** 2 - abs(shank) ** 2) / (2.0 * abs(thigh) * abs(shank))
        bend = np.sign(self.rest[KNEE]) * np.arccos(np.clip(cosine, -1.0, 1.0))
        knee = bend + np.angle(thigh) - np.angle(shank)
        return _Bend(waist_r, foot_r, reach, roll, knee, excess)

    def _angles(self, bent: _Bend) -> np.ndarray:
        """Joint angles (N, 6) of a leg whose knee and ankle's roll are known."""
        (thigh, shank), knee, roll = self._bones, bent.knee, bent.roll
        pitch = -np.angle(-bent.reach / (thigh + shank * np.exp(1j * knee))) - knee
        upper = np.swapaxes(bent.waist_r, 1, 2) @ bent.foot_r @ axis_rotation(np.eye(3)[0], -roll)
        upper = upper @ axis_rotation(np.eye(3)[1], -(knee + pitch))
        hip_angles = [
            np.arctan2(-upper[:, 0, 1], upper[:, 1, 1]),
            np.arcsin(np.clip(upper[:, 2, 1], -1.0, 1.0)),
            np.arctan2(-upper[:, 2, 0], upper[:, 2, 2]),
        ]
        return _wrapped(np.column_stack([*hip_angles, knee, pitch, roll]))

    def _newton(self, waist: np.ndarray, sole: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Damped Newton iteration on the pose error of all samples at once, from half-sitting."""
        target_r = pose.rotation(sole)
        target = sole[:, :3] + target_r @ [0.0, 0.0, self.ankle_height]
        angles = np.tile(self.rest, (len(waist), 1))
        if not len(waist):
            return angles, np.zeros(0)
        error = np.full((len(waist), 6), np.inf)
        for _ in range(60):
            rotations, positions, axes, centres = self._forward(waist, angles)
            turn = Rotation.from_matrix(target_r @ np.swapaxes(rotations, 1, 2)).as_rotvec()
            error = np.column_stack([target - positions, turn])
            if np.abs(error).max() < 1e-11:
                break
            jacobian = np.concatenate([np.cross(axes, positions[:, None] - centres), axes], axis=2)
            gram = jacobian @ np.swapaxes(jacobian, 1, 2) + 1e-10 * np.eye(6)  # (N, joints, joints)
            step = np.linalg.solve(gram, jacobian @ error[..., None])[..., 0]
            angles = angles + step * np.minimum(1.0, 0.5 / np.maximum(np.abs(step).max(axis=1, keepdims=True), 1e-12))
        miss = np.abs(error).max(axis=1)
        return angles, np.where(miss < 1e-7, 0.0, np.linalg.norm(error[:, :3], axis=1) + 1e-7)

    def _forward(self, waist: np.ndarray, angles: np.ndarray) -> tuple[np.ndarray, ...]:
        """Ankle rotations (N, 3, 3) and positions (N, 3); joint axes and centres (N, 6, 3), all in the world."""
        rotations, positions = pose.rotation(waist), waist[:, :3]
        axes, centres = np.empty((2, len(waist), 6, 3))
        for k, (fixed, shift, axis) in enumerate(self._chain):
            positions = positions + rotations @ shift
            rotations = (rotations @ fixed) @ axis_rotation(axis, angles[:, k])
            axes[:, k], centres[:, k] = rotations @ axis, positions
        return rotations, positions, axes, centres


class _Bend(NamedTuple):
    """Intermediate result of the closed form for N postures, before the hip.

    Attributes:
        waist_r, foot_r: (N, 3, 3) rotations.
        reach: (N,) ankle to hip in the leg's plane, z + i x [m].
        roll, knee: (N,) angles [rad].
        excess: (N,) how far the target is out of reach [m].
    """

    waist_r: np.ndarray
    foot_r: np.ndarray
    reach: np.ndarray
    roll: np.ndarray
    knee: np.ndarray
    excess: np.ndarray


def _wrapped(angles: np.ndarray) -> np.ndarray:
    """Angles [rad] within half a turn of zero."""
    turned = angles + np.pi
    beyond = (turned < 0.0) | (turned >= 2.0 * np.pi)  # few, and the remainder is slow
    turned[beyond] %= 2.0 * np.pi
    return np.asarray(turned - np.pi)
