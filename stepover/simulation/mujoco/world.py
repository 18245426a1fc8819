"""The engine MuJoCo: a model with its state, and motors that are springs with dampers.

A servo gives tau = k (q_d - q) + d (v_d - v), with angle and speed of the joint at the end of the time step dt, so
that a stiff servo on a light link stays stable. With q + v dt for that angle and v + a dt for that speed, this is

    tau = k q_d + d v_d - k q - (d + k dt) v - dt (d + k dt) a.

The first two parts are MuJoCo's control, the next two the actuator's bias. The last one is an inertia of the joint:
MuJoCo's armature. So the solver of the contacts sees it too. The torque that counts against a servo's limits is the
rest, as if its rotor had that inertia; an ideal motor has no rotor, and its torque is all of tau. Rubber is the same
without a goal.
"""

from __future__ import annotations

from typing import Any, Self

import numpy as np

from stepover.errors import StepOverError
from stepover.model.gravity import GRAVITY
from stepover.simulation.engine import Contacts, Scene
from stepover.simulation.mujoco.model import FLOORS, foot_of, model_of, mujoco
from stepover.simulation.mujoco.touching import Touching
from stepover.simulation.servos import limits_at, springs
from stepover.simulation.simulated import SimulatedRobot, require_mass, simulated_robot
from stepover.simulation.soles import BUSH

STIFFER = 200.0
"""Ideal motors are servos so many times as stiff, without limits: the waist then keeps its place to 0.2 mm."""


class World:
    """A fresh MuJoCo world, as simulation.engine.Engine describes it."""

    def __init__(self, scene: Scene) -> None:
        """Build the world.

        Raises:
            InvalidInput: the robot weighs something else than its multi-body model, or has no sole for rubber.
        """
        self.scene, robot = scene, scene.robot
        simulated = simulated_robot(robot, scene.sole, scene.disturbances)
        self.bush_depth = simulated.bush_depth
        self._model = model_of(scene, simulated)
        require_mass(scene, float(self._model.body_mass.sum()), "MuJoCo")
        self._data = mujoco.MjData(self._model)
        self._limited, count = scene.actuators == "limited", len(robot.body.joint_names)
        named = [self._model.joint(joint) for joint in (*robot.body.joint_names, *simulated.passive)]
        self._angle, self._speed = (np.array([at(joint) for joint in named]) for at in (_place_of, _column_of))
        self._joints = self._speed[:count]
        stiffer = 1.0 if self._limited else STIFFER
        stiffness, damping = springs(robot, len(simulated.passive) // len(BUSH), stiffer)
        self._stiffness, self._damping = stiffness[:count], damping[:count]
        bias = damping + robot.simulation.time_step * stiffness
        self._model.dof_armature[self._speed] = robot.simulation.time_step * bias
        self._model.actuator_biasprm[:, 1], self._model.actuator_biasprm[:, 2] = -stiffness, -bias
        self._limits = robot.body.effort_limits
        self._calm = (1.0 - robot.servo.speed_fade) * robot.body.speed_limits
        self._fading = True
        self._model.actuator_forcelimited[:count] = self._limited
        self._touching = Touching(self._model, simulated, len(scene.obstacles))
        self._placed, self._pushed = False, False
        self.torque, self.saturated = np.zeros(count), np.zeros(count, dtype=bool)
        self._name_parts(simulated)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        """MuJoCo holds nothing that outlives the object."""

    def reset(self, q: np.ndarray) -> None:
        """Put the robot at rest at a configuration (nq,), on rubber as deep as the weight on both feet presses it."""
        data, count = self._data, len(self.torque)
        mujoco.mj_resetData(self._model, data)
        data.qpos[:3], data.qpos[3:7], data.qpos[self._angle[:count]] = q[:3], q[[6, 3, 4, 5]], q[7:]
        if self.bush_depth:
            robot = self.scene.robot
            sunk = robot.body.mass * GRAVITY / (2.0 * robot.sole.vertical_stiffness)
            data.qpos[2] -= sunk
            data.qpos[self._angle[count :: len(BUSH)]] = sunk
        mujoco.mj_forward(self._model, data)
        self.torque, self.saturated = np.zeros(count), np.zeros(count, dtype=bool)
        self._touching.forget()
        self._placed = True

    def command(self, start: np.ndarray, end: np.ndarray, speed: np.ndarray) -> None:
        """Tell the motors how the joints shall move in the next step: angles (J,) at its ends [rad], speed [rad/s]."""
        data, count = self._data, len(self.torque)
        data.ctrl[:count] = self._stiffness * end + self._damping * speed
        if self._limited:
            speeds = data.qvel[self._joints]
            fading = not (np.abs(speeds) < self._calm).all()
            if fading or self._fading:
                self._model.actuator_forcerange[:count] = np.column_stack(limits_at(self.scene.robot, speeds))
            self._fading = fading

    def push(self, force: np.ndarray) -> None:
        """Push the root link at its centre of mass during the next step: force (3,) in the world's axes [N]."""
        self._data.xfrc_applied[1, :3] = force
        self._pushed = True

    def step(self) -> None:
        """Let one time step pass."""
        mujoco.mj_step(self._model, self._data)
        self.torque = self._data.actuator_force[: len(self.torque)].copy()
        if self._limited:
            self.saturated = np.abs(self.torque) >= self._limits
        else:
            self.torque -= self._model.dof_armature[self._joints] * self._data.qacc[self._joints]
        if self._pushed:
            self._data.xfrc_applied[1], self._pushed = 0.0, False
        self._touching.note(self._data)
        self._placed = False

    def contacts(self) -> Contacts:
        """The contact points of all steps since the last call, or since the reset.

        Raises:
            StepOverError: the simulation is unstable.
        """
        if self._data.warning.number.any():
            raise StepOverError("MuJoCo cannot integrate this: its states are no numbers; take a smaller time step")
        return self._touching.contacts()

    def base_pose(self) -> np.ndarray:
        """Pose (7,) of the root link: place [m], unit quaternion x y z w."""
        return np.array(self._data.qpos[[0, 1, 2, 4, 5, 6, 3]])

    def joints(self) -> np.ndarray:
        """Angles [rad] and speeds [rad/s] of all joints: (2, J)."""
        count = len(self.torque)
        return np.array([self._data.qpos[self._angle[:count]], self._data.qvel[self._speed[:count]]])

    def imu(self) -> tuple[np.ndarray, np.ndarray]:
        """Of the root link: unit quaternion (4,) x y z w, and angular velocity (3,) in its own axes [rad/s]."""
        return np.array(self._data.qpos[[4, 5, 6, 3]]), self._data.qvel[3:6].copy()

    def ankle(self, foot: int) -> tuple[np.ndarray, np.ndarray]:
        """Place (3,) [m] and axes (3, 3), as columns, of the frame of a leg's last joint: 0 left, 1 right."""
        if not self._placed:
            mujoco.mj_kinematics(self._model, self._data)
            self._placed = True
        body = self._ankles[foot]
        return self._data.xpos[body].copy(), self._data.xmat[body].reshape(3, 3).copy()

    def bush(self) -> np.ndarray:
        """Deflections (6,) of the rubber: left up, roll, pitch, then right [m, rad]; zero on rigid soles."""
        return np.array(self._data.qpos[self._angle[len(self.torque) :]]) if self.bush_depth else np.zeros(6)

    def set_ground(self, foot: int, height: float) -> None:
        """Put the floor under a foot, 0 left or 1 right, at a height [m]; every other link keeps the floor at zero."""
        self._data.mocap_pos[self._floors[foot], 2] = height

    def _name_parts(self, simulated: SimulatedRobot) -> None:
        """Links, ankles and floors by MuJoCo's numbers of bodies."""
        model = self._model
        bodies = [model.body(1 + k).name for k in range(len(simulated.description.links))]
        feet = [foot_of(simulated, name) for name in bodies]
        self.links = tuple(simulated.feet[foot] if foot >= 0 else name for name, foot in zip(bodies, feet, strict=True))
        self._ankles = [1 + bodies.index(name) for name in simulated.feet]
        self._floors = [int(model.body(name).mocapid[0]) for name in FLOORS]


def _place_of(joint: Any) -> int:
    """Where a joint's angle stands in qpos."""
    return int(joint.qposadr[0])


def _column_of(joint: Any) -> int:
    """Where a joint's speed stands in qvel."""
    return int(joint.dofadr[0])
