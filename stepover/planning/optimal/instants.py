"""The motion at the samples at which constraints are kept: postures, speeds, forces, and how they change.

Each sample is seen with its two neighbours 5 ms away: speeds are central differences, accelerations second ones, as
everywhere in stepover. All constraint groups read from here, so nothing is computed twice.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from stepover.model.gravity import GRAVITY
from stepover.model.kinematics import Placements
from stepover.planning.optimal.channels import WAIST, Reached, euler_axes
from stepover.planning.optimal.scene import Scene

LEAST = 0.3
"""Share of the weight below which the vertical force does not count as less: half of what a solution keeps."""


class Wrench(NamedTuple):
    """Forces at n samples.

    Attributes:
        force, moment: (n, 3) of the floor on the bearing foot, in the frame of its last joint [N, N m].
        torques: (n, C - 6) of the joints in q, if this foot bears all [N m].
    """

    force: np.ndarray
    moment: np.ndarray
    torques: np.ndarray


class Posed:
    """Postures with speeds and accelerations, and the forces that they need.

    Attributes:
        scene: what stays the same.
        samples: (n,) samples that they belong to.
        q, v, a: (n, C) coordinates, their speeds and accelerations.
    """

    scene: Scene
    samples: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray

    @cached_property
    def placements(self) -> Placements:
        """Of all joints."""
        channels, base = self.scene.channels, self.scene.base
        return self.scene.robot.body.placements(channels.configurations(self.q, base.upper[self.samples]))

    @cached_property
    def axes(self) -> tuple[np.ndarray, np.ndarray]:
        """Axes (n, C, 3) of the coordinates in the world, and points on them (n, C, 3) [m]; the first three slide."""
        body, channels = self.scene.robot.body, self.scene.channels
        axes, origins = np.zeros((2, *self.q.shape, 3))
        axes[:, :3] = np.eye(3)
        axes[:, 3:6], origins[:, 3:6] = euler_axes(self.q[:, WAIST]), self.q[:, None, :3]
        joints = [column - 5 for column in channels.full_columns]
        own = np.array([body.axes[joint - 2] for joint in joints])
        axes[:, 6:] = np.einsum("njab,jb->nja", self.placements.rotations[:, joints], own)
        origins[:, 6:] = self.placements.positions[:, joints]
        return axes, origins

    def twists(self, joints: np.ndarray, points: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """How points that move with joints change with q: (R, C, 3).

        Args:
            joints: (R,) indices in Placements.
            points: (R, 3) in the world [m].
            rows: (R,) samples.
        """
        axes, origins = (part[rows] for part in self.axes)
        moved = np.cross(axes, points[:, None] - origins)
        moved[:, :3] = np.eye(3)
        return moved * self.scene.moved_by[joints][..., None]

    @cached_property
    def forces(self) -> np.ndarray:
        """Generalised forces (n, C) of inverse dynamics."""
        return self.scene.channels.dynamics.forces(self.q, self.v, self.a)

    @cached_property
    def floor_wrench(self) -> tuple[np.ndarray, np.ndarray]:
        """Force (n, 3) of the floor, and its moment about the root (n, 3), in the world [N, N m]."""
        force = self.forces[:, :3]
        return force, np.linalg.solve(self.axes[0][:, 3:6], self.forces[:, 3:6, None])[..., 0]

    def joint_torques(self, joints: np.ndarray, force: np.ndarray, moment: np.ndarray) -> np.ndarray:
        """Torques (n, C - 6) where a force, with its moment about the root, (n, 3), acts on links of joints (n,)."""
        (axes, origins), lever = self.axes, self.q[:, None, :3]
        about = moment[:, None] + np.cross(lever - origins, force[:, None])
        borne = np.einsum("nca,nca->nc", axes, about) * self.scene.moved_by[joints]
        return np.asarray((self.forces - borne)[:, 6:])


@dataclass(frozen=True, eq=False)
class Probe(Posed):
    """Any postures at some samples: to see what changes with q, v and a."""

    scene: Scene
    samples: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray


@dataclass(frozen=True, eq=False)
class Instants(Posed):
    """The motion at the samples of a scene, for one value of the variables.

    Attributes:
        scene: what stays the same.
        steps: channels (3, n, C) one sample before, at, and one sample after.
        front: front face of the obstacle [m].
    """

    scene: Scene
    steps: np.ndarray
    front: float

    @cached_property
    def reached(self) -> Reached:
        """Postures of all 3 n, flattened."""
        return self.scene.channels.reach(self.steps.reshape(-1, self.steps.shape[2]))

    @cached_property
    def _three(self) -> np.ndarray:
        """Coordinates (3, n, C)."""
        return self.reached.q.reshape(self.steps.shape)

    @property
    def samples(self) -> np.ndarray:  # type: ignore[override]
        """(n,) samples."""
        return self.scene.samples

    @property
    def now(self) -> np.ndarray:
        """Channels (n, C)."""
        return np.asarray(self.steps[1])

    @property
    def q(self) -> np.ndarray:  # type: ignore[override]
        """Coordinates (n, C): root x y z, yaw, pitch, roll; joints."""
        return np.asarray(self._three[1])

    @property
    def distance(self) -> np.ndarray:
        """Hip to ankle (n, 2), left and right [m]."""
        return self.reached.distance.reshape(3, -1, 2)[1]

    @cached_property
    def v(self) -> np.ndarray:  # type: ignore[override]
        """Speeds of the coordinates (n, C)."""
        before, _, after = self._three
        return _short_way(after - before) / (2.0 * self.scene.dt)

    @cached_property
    def a(self) -> np.ndarray:  # type: ignore[override]
        """Accelerations (n, C)."""
        before, here, after = self._three
        return (_short_way(after - here) - _short_way(here - before)) / self.scene.dt**2

    @cached_property
    def _bearing_frame(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Joint (n,), rotation (n, 3, 3) and position (n, 3) of the bearing foot's last joint."""
        index = [self.scene.robot.body.index(joint) for joint in self.scene.bearing_joints]
        rows, joints = np.arange(len(index)), np.array(index)
        return joints, self.placements.rotations[rows, joints], self.placements.positions[rows, joints]

    @cached_property
    def wrench(self) -> Wrench:
        """Forces on the bearing foot."""
        joints, turn, place = self._bearing_frame
        force, moment = self.floor_wrench
        there = moment + np.cross(self.q[:, :3] - place, force)
        own, about = (np.einsum("nba,nb->na", turn, part) for part in (force, there))
        return Wrench(own, about, self.joint_torques(joints, force, moment))

    @cached_property
    def zmp(self) -> np.ndarray:
        """ZMP (n, 2) in the bearing sole's frame [m]; of a robot that hardly stands, with a least force."""
        (fx, fy, _), (mx, my, _) = self.wrench.force.T, self.wrench.moment.T
        height, up = self.scene.robot.foot.ankle_height, self._standing_force
        return np.column_stack([-(my + height * fx) / up, (mx - height * fy) / up])

    @cached_property
    def _standing_force(self) -> np.ndarray:
        """Vertical force (n,), at least a share of the weight [N]: or the ZMP of a bad guess were anywhere."""
        return np.maximum(self.wrench.force[:, 2], LEAST * self.scene.channels.dynamics.mass * GRAVITY)

    @cached_property
    def yaw_moment(self) -> np.ndarray:
        """Moment (n,) of the floor about the vertical through the ZMP [N m]."""
        (fx, fy, _), mz = self.wrench.force.T, self.wrench.moment[:, 2]
        return np.asarray(mz - (self.zmp[:, 0] * fy - self.zmp[:, 1] * fx))

    @cached_property
    def wrench_by(self) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives by q, v, a of the wrench on the bearing foot (n, 6, 3 C) and of the torques (n, C - 6, 3 C).

        The floor's wrench w balances the root: J_r' w = tau_r, and the joints take tau_j - J_j' w. With w fixed in the
        foot's frame, pinocchio gives the derivatives of tau; then J_r' dw = dtau_r.
        """
        joints, turn, place = self._bearing_frame
        rows = np.arange(len(joints))
        axes = self.axes[0] * self.scene.moved_by[joints][..., None]
        angular = axes.copy()
        angular[:, :3] = 0.0
        jacobian = np.concatenate([self.twists(joints, place, rows) @ turn, angular @ turn], axis=2)  # (n, C, 6)
        wrenches = np.concatenate([self.wrench.force, self.wrench.moment], axis=1)
        by = self.scene.channels.dynamics.derivatives(self.q, self.v, self.a, self.scene.bearing_joints, wrenches)
        of_wrench = np.linalg.solve(jacobian[:, :6], by[:, :6])
        return of_wrench, by[:, 6:] - jacobian[:, 6:] @ of_wrench

    @cached_property
    def zmp_by(self) -> np.ndarray:
        """Derivative (n, 2, 3 C) of the ZMP by q, v, a."""
        by, up, height = self.wrench_by[0], self._standing_force[:, None], self.scene.robot.foot.ankle_height
        by_up = np.where(self.wrench.force[:, 2, None] < up, 0.0, by[:, 2])
        ahead = -(by[:, 4] + height * by[:, 0] + self.zmp[:, :1] * by_up) / up
        aside = (by[:, 3] - height * by[:, 1] - self.zmp[:, 1:] * by_up) / up
        return np.stack([ahead, aside], axis=1)

    @cached_property
    def yaw_moment_by(self) -> np.ndarray:
        """Derivative (n, 3 C) of the moment about the vertical by q, v, a."""
        by, force, zmp = self.wrench_by[0], self.wrench.force, self.zmp
        moved = self.zmp_by[:, 0] * force[:, 1:2] - self.zmp_by[:, 1] * force[:, :1]
        return np.asarray(by[:, 5] - moved - zmp[:, :1] * by[:, 1] + zmp[:, 1:] * by[:, 0])

    @cached_property
    def by_channels(self) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives by the channels: of q (3, n, C, C), and of the distances (n, 2, C) at the sample itself."""
        flat = self.steps.reshape(-1, self.steps.shape[2])
        by, distance = self.scene.channels.derivatives(flat, self.reached.q)
        n, count = self.q.shape
        return by.reshape(3, n, count, count), distance.reshape(3, n, 2, count)[1]


def _short_way(angles: np.ndarray) -> np.ndarray:
    """Differences on the shorter way round."""
    return (angles + np.pi) % (2.0 * np.pi) - np.pi
