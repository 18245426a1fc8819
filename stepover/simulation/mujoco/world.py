"""The engine MuJoCo: a world with floor, obstacles and robot, and motors that are integrated implicitly.

A servo is a spring with a damper: tau = k (q_d - q) + d (v_d - v). Both are taken at the end of the time step, so that
stiff servos on light links stay stable whatever the step is. With q at the end as q + v dt that is an actuator with the
gain k and the bias -k q - (d + k dt) v, of which MuJoCo integrates the part with v implicitly. Rubber is the same
without a goal.
"""

from __future__ import annotations

from typing import Self

import mujoco
import numpy as np

from stepover.model.gravity import GRAVITY
from stepover.simulation.engine import FLOOR, NO_CONTACTS, NO_FOOT, Contacts, Scene
from stepover.simulation.mujoco.model import model_of
from stepover.simulation.mujoco.parameters import Contact
from stepover.simulation.servos import limits_at, springs
from stepover.simulation.simulated import simulated_robot

STIFFER = 10.0
"""Ideal motors are servos so many times as stiff, without limits."""


class World:
    """A MuJoCo model with its state, as simulation.engine.Engine describes it."""

    def __init__(self, scene: Scene) -> None:
        """Build the world, with the robot in the pose of the URDF."""
        self.scene = scene
        robot, parts = scene.robot, simulated_robot(scene.robot, scene.sole, scene.disturbances)
        self.bush_depth = parts.bush_depth
        self._model = model_of(scene, parts, Contact())
        self._data = mujoco.MjData(self._model)
        names = [self._model.joint(k).name for k in range(1, self._model.njnt)]
        self._order = np.array([names.index(joint) for joint in (*robot.body.joint_names, *parts.passive)])
        self._count, self._limited = len(robot.body.joint_names), scene.actuators == "limited"
        stiffer = 1.0 if self._limited else STIFFER
        self._stiffness, self._damping = springs(robot, len(parts.passive) // 3, stiffer)
        step = self._model.opt.timestep
        self._model.dof_armature[6 + self._order] = step * (self._damping + step * self._stiffness)
        self.torque, self.saturated = np.zeros(self._count), np.zeros(self._count, dtype=bool)
        self._limits = robot.body.effort_limits if self._limited else np.full(self._count, np.inf)
        self._goal, self._speed = np.zeros((2, len(self._order)))
        self._name_parts(parts)
        self.contacts_of_step = NO_CONTACTS

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        """Nothing is held: the model goes with the object."""

    def _name_parts(self, parts) -> None:
        """Links, feet and floors by MuJoCo's numbers."""
        bodies = [self._model.body(k).name for k in range(1, self._model.nbody)]
        feet = {name: foot for foot, link in enumerate(parts.feet) for name in (link, *(p for p in parts.passive if p.startswith(f"{link}_")))}
        self.links = tuple(parts.feet[feet[name]] if name in feet else name for name in bodies)
        self._root = 1
        self._geom_link = self._model.geom_bodyid - 1
        self._geom_foot = np.array([feet.get(bodies[link], NO_FOOT) if link >= 0 else NO_FOOT for link in self._geom_link])
        self._floors = [self._model.geom(name).id for name in ("left floor", "right floor")]
        self._obstacles = np.full(self._model.ngeom, FLOOR)
        for number in range(len(self.scene.obstacles)):
            self._obstacles[self._model.geom(f"obstacle {number}").id] = number
        legs = (self.scene.robot.legs.left, self.scene.robot.legs.right)
        self._ankles = [1 + bodies.index(link) for link in parts.feet]

    def reset(self, q: np.ndarray) -> None:
        """Put the robot at rest at a configuration (nq,), on rubber as deep as the weight on both feet presses it."""
        mujoco.mj_resetData(self._model, self._data)
        state = self._data.qpos
        state[:3], state[3:7] = q[:3], q[[6, 3, 4, 5]]
        state[7 + self._order[: self._count]] = q[7:]
        if self.bush_depth:
            robot = self.scene.robot
            sunk = robot.body.mass * GRAVITY / (2.0 * robot.sole.vertical_stiffness)
            state[2] -= sunk
            state[7 + self._order[self._count :: 3]] = sunk
        mujoco.mj_forward(self._model, self._data)
        self.torque, self.saturated = np.zeros(self._count), np.zeros(self._count, dtype=bool)

    def command(self, start: np.ndarray, end: np.ndarray, speed: np.ndarray) -> None:
        """Tell the motors how the joints shall move in the next step: angles (J,) at its ends [rad], speed [rad/s]."""
        n, data, step = self._count, self._data, self._model.opt.timestep
        angles, speeds = data.qpos[7 + self._order], data.qvel[6 + self._order]
        self._goal[:n], self._speed[:n] = end, speed
        torque = self._stiffness * (self._goal - angles - step * speeds) + self._damping * (self._speed - speeds)
        if self._limited:
            least, most = limits_at(self.scene.robot, speeds[:n])
            torque[:n] = np.minimum(np.maximum(torque[:n], least), most)
        data.ctrl[:] = torque
        self.torque = torque[:n]
        self.saturated = np.abs(self.torque) >= self._limits

    def push(self, force: np.ndarray) -> None:
        """Push the root link at its centre of mass during the next step: force (3,) in the world's axes [N]."""
        self._data.xfrc_applied[self._root, :3] = force

    def step(self) -> None:
        """Let one time step pass."""
        model, data = self._model, self._data
        mujoco.mj_step(model, data)
        data.xfrc_applied[:] = 0.0
        self.contacts_of_step = self._contacts()
        mujoco.mj_kinematics(model, data)

    def contacts(self) -> Contacts:
        """The contact points of the last step."""
        return self.contacts_of_step

    def _contacts(self) -> Contacts:
        """The same, read out of the solver."""
        data = self._data
        contact = data.contact
        if data.ncon == 0:
            return NO_CONTACTS
        geoms, address = contact.geom, contact.efc_address
        active = address >= 0
        geoms, address = geoms[active], address[active]
        if not len(geoms):
            return NO_CONTACTS
        local = data.efc_force[address[:, None] + np.arange(3)]
        frame = contact.frame[active].reshape(-1, 3, 3)
        force = np.einsum("ni,nij->nj", local, frame)  # on the second geometry
        first = self._geom_link[geoms[:, 0]] >= 0
        own, other = np.where(first, geoms[:, 0], geoms[:, 1]), np.where(first, geoms[:, 1], geoms[:, 0])
        force = np.where(first[:, None], -force, force)
        touched, depth = self._obstacles[other], -contact.dist[active]
        kept = np.where(touched == FLOOR, force[:, 2] > 0.0, depth >= 0.0)
        return Contacts(
            self._geom_link[own][kept], self._geom_foot[own][kept], touched[kept], contact.pos[active][kept],
            force[kept], np.maximum(depth[kept], 0.0),
        )  # fmt: skip

    def base_pose(self) -> np.ndarray:
        """Pose (7,) of the root link: place [m], unit quaternion x y z w."""
        return self._data.qpos[[0, 1, 2, 4, 5, 6, 3]]

    def joints(self) -> np.ndarray:
        """Angles [rad] and speeds [rad/s] of all joints: (2, J)."""
        columns = self._order[: self._count]
        return np.array([self._data.qpos[7 + columns], self._data.qvel[6 + columns]])

    def imu(self) -> tuple[np.ndarray, np.ndarray]:
        """Of the root link: unit quaternion (4,) x y z w, and angular velocity (3,) in its own axes [rad/s]."""
        return self._data.qpos[[4, 5, 6, 3]], self._data.qvel[3:6].copy()

    def ankle(self, foot: int) -> tuple[np.ndarray, np.ndarray]:
        """Place (3,) [m] and axes (3, 3), as columns, of the frame of a leg's last joint: 0 left, 1 right."""
        body = self._ankles[foot]
        return self._data.xpos[body].copy(), self._data.xmat[body].reshape(3, 3).copy()

    def bush(self) -> np.ndarray:
        """Deflections (6,) of the rubber: left up, roll, pitch, then right [m, rad]; zero on rigid soles."""
        return self._data.qpos[7 + self._order[self._count :]] if self.bush_depth else np.zeros(6)

    def set_ground(self, foot: int, height: float) -> None:
        """Put the floor under a foot, 0 left or 1 right, at a height [m]; every other link keeps the floor at zero."""
        self._model.geom_pos[self._floors[foot], 2] = height
