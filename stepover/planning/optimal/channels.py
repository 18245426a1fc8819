"""The channels of a motion, and the postures that belong to them.

A channel is one number over time: waist and both soles as x y z, yaw, pitch, roll, then the joints of chest and arms
that move. The legs follow by inverse kinematics. Beyond the longest allowed leg the sole is not reached: it stays on
the line from the hip, at a distance that goes on smoothly, so that an optimiser can come back. The distance itself is
a constraint (constraints/reach.py).
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from stepover.errors import InvalidInput
from stepover.model import pose
from stepover.model.euler_dynamics import ROOT, EulerDynamics
from stepover.model.legs import KNEE, Leg
from stepover.model.robot import Robot

WAIST, LEFT, RIGHT, UPPER = slice(0, 6), slice(6, 12), slice(12, 18), 18
"""Channels of waist, left sole, right sole; the first channel of chest and arms."""
SIDES = (1, -1)


class Reached(NamedTuple):
    """Postures of n samples: coordinates q (n, C) of the dynamics, and the distances of ankles from hips (n, 2) [m]."""

    q: np.ndarray
    distance: np.ndarray


class Channels:
    """From channels (n, C) to postures, and how these change with them.

    Attributes:
        robot: the robot.
        dynamics: its dynamics in the coordinates q: root, then the joints that move.
        count: number C of channels and of coordinates.
    """

    def __init__(self, robot: Robot, knee: float) -> None:
        """Prepare for a robot.

        Args:
            robot: the robot.
            knee: angle from straight at which the legs are as long as they may get [rad].

        Raises:
            InvalidInput: a leg whose hip axes do not meet in a point.
        """
        self.robot = robot
        if any(not robot.leg(side).is_closed_form and robot.leg(side).meeting_axes is None for side in SIDES):
            raise InvalidInput(f"the optimising planner needs legs whose hip axes meet; those of {robot.name!r} do not")
        self.upper = upper_joints(robot)
        moving = [*robot.legs.left, *robot.legs.right, *self.upper]
        self.dynamics = EulerDynamics(robot.body, moving, robot.half_sitting())
        self.count = ROOT + len(moving)
        self.longest = hip_to_ankle(robot.leg(1), knee)
        self._softness = hip_to_ankle(robot.leg(1), knee / 2.0) - self.longest
        self._sole_columns = {side: [self.column(joint) for joint in robot.leg(side).joints] for side in SIDES}

    def column(self, joint: str) -> int:
        """Column of a joint in q."""
        return ROOT + self.dynamics.joints.index(joint)

    @cached_property
    def full_columns(self) -> list[int]:
        """Columns in the robot's own configuration of the joints in q[:, 6:]."""
        return [self.robot.body.column(joint) for joint in self.dynamics.joints]

    @cached_property
    def upper_columns(self) -> list[int]:
        """Columns in q of chest and arms, in the order of their channels."""
        return [self.column(joint) for joint in self.upper]

    def leg_columns(self, side: int) -> list[int]:
        """Columns in q of a leg: +1 left, -1 right."""
        return self._sole_columns[side]

    def reach(self, channels: np.ndarray) -> Reached:
        """Postures of channels (n, C)."""
        q = np.empty_like(channels)
        q[:, WAIST], q[:, self.upper_columns] = channels[:, WAIST], channels[:, UPPER:]
        waist, distance = poses(channels[:, WAIST]), np.empty((len(channels), 2))
        for k, side in enumerate(SIDES):
            sole, leg = poses(channels[:, of_sole(side)]), self.robot.leg(side)
            away, distance[:, k] = self._from_hip(leg, waist, sole)
            short = self._shown(distance[:, k])[0] / distance[:, k] - 1.0
            sole[:, :3] += short[:, None] * away
            q[:, self._sole_columns[side]] = leg.attempt(waist, sole)[0]
        return Reached(q, distance)

    def derivatives(self, channels: np.ndarray, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Of q (n, C, C) and of the distances (n, 2, C), by the channels.

        The legs' part is J dq = target's twist - what the waist carries along: no differences are taken.
        """
        n, count = channels.shape
        by, by_distance = np.zeros((n, count, count)), np.zeros((n, 2, count))
        by[:, range(ROOT), range(ROOT)] = 1.0
        by[:, self.upper_columns, range(UPPER, count)] = 1.0
        waist, turn = poses(channels[:, WAIST]), euler_axes(channels[:, WAIST])
        for k, side in enumerate(SIDES):
            leg, own = self.robot.leg(side), of_sole(side)
            sole = poses(channels[:, own])
            away, distance = self._from_hip(leg, waist, sole)
            hip, along = pose.offset(waist, hip_in_waist(leg))[:, :3], away / distance[:, None]
            by_hip = _moved(turn, hip - waist[:, :3])  # (n, 3, 6) by the waist's channels
            by_ankle = _moved(euler_axes(channels[:, own]), hip + away - sole[:, :3])
            shown, slope = self._shown(distance)
            line = along[:, :, None] * along[:, None]
            kept = (shown / distance)[:, None, None] * (np.eye(3) - line) + slope[:, None, None] * line
            joints = leg.joint_frames(waist, q[:, self._sole_columns[side]])
            ankle, axes, centres = joints
            twist = np.zeros((n, 6, 12))
            carried = _moved(turn, ankle - waist[:, :3])
            twist[:, :3, :6] = (np.eye(3) - kept) @ by_hip - carried
            twist[:, :3, 6:] = kept @ by_ankle
            twist[:, 3:, 3:6] = -np.swapaxes(turn, 1, 2)
            twist[:, 3:, 9:] = np.swapaxes(euler_axes(channels[:, own]), 1, 2)
            jacobian = np.concatenate([np.cross(axes, ankle[:, None] - centres), axes], axis=2).swapaxes(1, 2)
            solved, rows = np.linalg.solve(jacobian, twist), self._sole_columns[side]
            by[:, rows, WAIST], by[:, rows, own] = solved[:, :, :6], solved[:, :, 6:]
            by_distance[:, k, WAIST] = -(along[:, None] @ by_hip)[:, 0]
            by_distance[:, k, own] = (along[:, None] @ by_ankle)[:, 0]
        return by, by_distance

    def configurations(self, q: np.ndarray, others: np.ndarray) -> np.ndarray:
        """The robot's own configurations (n, nq); others (n, nq) say where the joints are that do not move."""
        full = others.copy()
        full[:, :7], full[:, self.full_columns] = poses(q[:, :ROOT]), q[:, ROOT:]
        return full

    def _shown(self, distance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distance (n,) at which the ankle is placed, and its derivative."""
        over = np.maximum(distance - self.longest, 0.0) / self._softness
        return np.minimum(distance, self.longest) + self._softness * np.tanh(over), 1.0 / np.cosh(over) ** 2

    @staticmethod
    def _from_hip(leg: Leg, waist: np.ndarray, sole: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Ankle minus hip (n, 3), and its length (n,) [m]."""
        hip = pose.offset(waist, hip_in_waist(leg))[:, :3]
        away = pose.offset(sole, np.array([0.0, 0.0, leg.ankle_height]))[:, :3] - hip
        return away, np.linalg.norm(away, axis=1)


def upper_joints(robot: Robot) -> list[str]:
    """Joints of chest and arms that move: from the root to the shoulders, each shoulder, and the joint after it."""
    body, parents = robot.body, {joint: robot.body.origin(joint)[2] for joint in robot.body.joint_names}
    trunk: list[str] = []
    for shoulder in robot.upper_body.shoulders:
        chain, joint = [], parents[shoulder]
        while joint in parents:
            chain.append(joint)
            joint = parents[joint]
        trunk += [joint for joint in reversed(chain) if joint not in trunk]
    arms = [
        joint
        for shoulder in sorted(robot.upper_body.shoulders, key=body.joint_names.index)
        for joint in [shoulder, *[name for name in body.joint_names if parents[name] == shoulder][:1]]
    ]
    return [*trunk, *arms]


def of_sole(side: int) -> slice:
    """Channels of a sole: +1 left, -1 right."""
    return LEFT if side > 0 else RIGHT


def hip_in_waist(leg: Leg) -> np.ndarray:
    """Point (3,) in which the hip's axes meet, in the root's frame [m]."""
    still = np.array([[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]])
    return np.asarray(leg.joint_frames(still, np.zeros((1, 6)))[2][0, 2])


def hip_to_ankle(leg: Leg, bend: float) -> float:
    """Distance of the ankle from the hip [m] with the knee at an angle from straight [rad]."""
    still, angles = np.array([[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]]), np.zeros((1, 6))
    angles[0, KNEE] = np.copysign(bend, leg.rest[KNEE])
    ankle, _, centres = leg.joint_frames(still, angles)
    return float(np.linalg.norm(ankle[0] - centres[0, 2]))


def poses(channels: np.ndarray) -> np.ndarray:
    """Poses (n, 7) of x y z, yaw, pitch, roll (n, 6), without sign jumps where the angles have none."""
    (cy, cp, cr), (sy, sp, sr) = np.cos(channels[:, 3:].T / 2.0), np.sin(channels[:, 3:].T / 2.0)
    vector = [sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy]
    return np.column_stack([channels[:, :3], *vector, cr * cp * cy + sr * sp * sy])


def euler(poses: np.ndarray) -> np.ndarray:
    """Position, yaw, pitch, roll (N, 6) of poses (N, 7)."""
    angles = Rotation.from_quat(poses[:, 3:]).as_euler("ZYX")
    return np.column_stack([poses[:, :3], np.unwrap(angles, axis=0)])


def euler_axes(channels: np.ndarray) -> np.ndarray:
    """Axes (n, 3, 3) in the world, one a row, about which yaw, pitch and roll turn a frame (n, 6)."""
    yaw, pitch = channels[:, 3], channels[:, 4]
    c, s, flat, up = np.cos(yaw), np.sin(yaw), np.cos(pitch), np.sin(pitch)
    none = np.zeros_like(c)
    rows = [[none, none, none + 1.0], [-s, c, none], [c * flat, s * flat, -up]]
    return np.moveaxis(np.array(rows), 2, 0)


def _moved(axes: np.ndarray, lever: np.ndarray) -> np.ndarray:
    """Derivative (n, 3, 6) of a point by x y z and the turns of its frame, from which it is a lever (n, 3) away."""
    turned = np.swapaxes(np.cross(axes, lever[:, None]), 1, 2)
    return np.concatenate([np.broadcast_to(np.eye(3), turned.shape), turned], axis=2)
