"""The world in PyBullet: floor, obstacle and robot. The only door to PyBullet, and video.py's.

PyBullet gives and takes the base pose of a robot at the centre of mass of its root link. Everything that leaves
this module is in the library's terms: configurations in pinocchio's order, with the pose of the root link itself.
"""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np

from stepover.errors import InvalidInput
from stepover.model.obstacle import LATERAL_HALF_EXTENT
from stepover.model.pose import Rotation
from stepover.model.robot import Robot
from stepover.units.preview_control import GRAVITY


@contextmanager
def silenced() -> Iterator[None]:
    """Let C code print to nowhere: stdout and stderr at the file descriptors."""
    sys.stdout.flush()
    sys.stderr.flush()
    kept = [os.dup(1), os.dup(2)]
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        yield
    finally:
        ctypes.CDLL(None).fflush(None)
        os.dup2(kept[0], 1)
        os.dup2(kept[1], 2)
        for descriptor in (nowhere, *kept):
            os.close(descriptor)


with silenced():
    import pybullet


class Touch(NamedTuple):
    """What touches the robot: means and findings over some steps.

    Attributes:
        feet: (2, 6) force [N] and moment about the world's origin [N m] of the floor on the left and right foot.
        total: (6,) the same of the floor on all links.
        others: links on the floor that are no feet.
        obstacle: links that touch the obstacle, with the largest depth [m] of each.
    """

    feet: np.ndarray
    total: np.ndarray
    others: set[str]
    obstacle: dict[str, float]


class World:
    """A fresh PyBullet client with floor, robot and, unless None, the obstacle; a context manager.

    Attributes:
        client: PyBullet's number of the client.
        robot: the number of the robot's body.
        links: link names by PyBullet's index; the root is at -1.
        joints: PyBullet's indices of the joints in the order of q[7:].
    """

    def __init__(self, robot: Robot, obstacle: np.ndarray | None) -> None:
        """Build the world.

        Args:
            robot: the robot, in the pose of the URDF until reset.
            obstacle: a motion's obstacle row: front face x, width, height, ... [m].

        Raises:
            InvalidInput: the robot weighs something else in PyBullet than in pinocchio.
        """
        self._parameters = robot.simulation
        with silenced():
            self.client = pybullet.connect(pybullet.DIRECT)
            self._floor = self._still(pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=self.client))
            self._obstacle = None if obstacle is None else self._beam(*obstacle[:3])
            self.robot = load_body(robot, self.client)
        self.links, self.joints = names_of(robot, self.robot, self.client)
        self._feet = {self._link_behind(robot, side): row for row, side in enumerate((1, -1))}
        self._local = local_of(self.robot, self.client)
        self._settle_physics(robot)

    def __enter__(self) -> World:
        return self

    def __exit__(self, *_: object) -> None:
        pybullet.disconnect(self.client)

    def reset(self, q: np.ndarray) -> None:
        """Put the robot at rest at a configuration (nq,)."""
        place_body(self.robot, self.client, self.joints, self._local, q)

    def step(self) -> None:
        """Let one time step pass."""
        pybullet.stepSimulation(self.client)

    def command(self, angles: np.ndarray, speeds: np.ndarray, torque: float, correction: float) -> None:
        """Set all position-controlled motors for the next step.

        A motor removes a share of the error against the angle and moves on with the speed, unless that takes more
        than its torque.

        Args:
            angles: (nq - 7,) [rad], of now.
            speeds: (nq - 7,) [rad/s], from now to the next step.
            torque: most of it [N m].
            correction: share of the error that is removed in the step.
        """
        count = len(self.joints)
        pybullet.setJointMotorControlArray(
            self.robot, self.joints, pybullet.POSITION_CONTROL, angles, speeds, [torque] * count,
            [correction] * count, [1.0] * count, self.client,
        )  # fmt: skip

    def joint_states(self) -> np.ndarray:
        """Angle [rad], speed [rad/s] and motor torque of the last step [N m] of all joints: (3, nq - 7)."""
        states = pybullet.getJointStates(self.robot, self.joints, self.client)
        return np.array([(angle, speed, torque) for angle, speed, _, torque in states]).T

    def base_pose(self) -> np.ndarray:
        """Pose (7,) of the root link."""
        position, quaternion = pybullet.getBasePositionAndOrientation(self.robot, self.client)
        turn = Rotation.from_quat(quaternion) * self._local[1].inv()
        return np.concatenate([position - turn.apply(self._local[0]), turn.as_quat()])

    def contacts(self) -> list[tuple]:
        """Contact points of the last step, as PyBullet gives them: for touch."""
        return list(pybullet.getContactPoints(self.robot, physicsClientId=self.client))

    def touch(self, contacts: list[tuple], steps: int) -> Touch:
        """What the contacts of some steps come to: mean wrenches over the steps."""
        on_floor = [c for c in contacts if c[2] == self._floor and c[9] > 0.0]
        wrenches = _wrenches(on_floor) / steps
        foot = np.array([self._feet.get(c[3], -1) for c in on_floor], dtype=int)
        feet = np.array([wrenches[foot == row].sum(axis=0) for row in range(2)])
        others = {self.links[c[3]] for c in on_floor if c[3] not in self._feet}
        depths: dict[str, float] = {}
        for contact in contacts:
            if contact[2] == self._obstacle and contact[8] <= 0.0:
                name = self.links[contact[3]]
                depths[name] = max(-contact[8], depths.get(name, 0.0))
        return Touch(feet, wrenches.sum(axis=0), others, depths)

    def _still(self, shape: int, position: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> int:
        """A body that never moves."""
        return int(pybullet.createMultiBody(0.0, shape, basePosition=position, physicsClientId=self.client))

    def _beam(self, front: float, width: float, height: float) -> int:
        """The bare obstacle, as a box on the floor."""
        half = [width / 2.0, LATERAL_HALF_EXTENT, height / 2.0]
        box = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=half, physicsClientId=self.client)
        return self._still(box, (front + half[0], 0.0, half[2]))

    def _link_behind(self, robot: Robot, side: int) -> int:
        """PyBullet's index of the foot of a side: a link has the index of its joint."""
        leg = robot.legs.left if side > 0 else robot.legs.right
        return self.joints[robot.body.joint_names.index(leg[-1])]

    def _settle_physics(self, robot: Robot) -> None:
        """Time step, solver, friction; no damping, which PyBullet would add to everything; and check the mass."""
        parameters, client = self._parameters, self.client
        pybullet.setGravity(0.0, 0.0, -GRAVITY, client)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=parameters.time_step, numSolverIterations=parameters.solver_iterations, numSubSteps=0,
            deterministicOverlappingPairs=1, physicsClientId=client,
        )  # fmt: skip
        still = [(body, -1) for body in (self._floor, self._obstacle) if body is not None]
        for body, link in [*still, *((self.robot, link) for link in self.links)]:
            pybullet.changeDynamics(
                body, link, lateralFriction=1.0 if body != self.robot else parameters.friction, linearDamping=0.0,
                angularDamping=0.0, jointDamping=0.0, physicsClientId=client,
            )  # fmt: skip
        mass = sum(pybullet.getDynamicsInfo(self.robot, link, client)[0] for link in self.links)
        if abs(mass - robot.body.mass) > 1e-6 * mass:
            raise InvalidInput(
                f"{robot.urdf} weighs {mass:.3f} kg in PyBullet and {robot.body.mass:.3f} kg in pinocchio: "
                "every link needs an <inertial> with a mass"
            )


def load_body(robot: Robot, client: int) -> int:
    """Load the URDF into a client, and give its number.

    Self-collision stays off: neighbouring boxes overlap at the joints by design, and the planner keeps the legs apart.
    """
    flags = pybullet.URDF_USE_INERTIA_FROM_FILE
    path = str(robot.folder / robot.urdf)
    return int(pybullet.loadURDF(path, flags=flags, physicsClientId=client))


def names_of(robot: Robot, body: int, client: int) -> tuple[dict[int, str], list[int]]:
    """Names of all links by PyBullet's index, and the indices of the joints in the order of q[7:]."""
    infos = [pybullet.getJointInfo(body, i, client) for i in range(pybullet.getNumJoints(body, client))]
    links = {-1: pybullet.getBodyInfo(body, client)[0].decode(), **{i[0]: i[12].decode() for i in infos}}
    index = {info[1].decode(): info[0] for info in infos}
    return links, [index[name] for name in robot.body.joint_names]


def local_of(body: int, client: int) -> tuple[np.ndarray, Rotation]:
    """Position and rotation of the root link's inertial frame, PyBullet's base, in the root link."""
    position, quaternion = pybullet.getDynamicsInfo(body, -1, client)[3:5]
    return np.array(position), Rotation.from_quat(quaternion)


def place_body(body: int, client: int, joints: list[int], local: tuple[np.ndarray, Rotation], q: np.ndarray) -> None:
    """Put a body at rest at a configuration (nq,).

    Args:
        body: its number.
        client: its client.
        joints: as from names_of.
        local: as from local_of.
        q: where to.
    """
    turn = Rotation.from_quat(q[3:7])
    position, quaternion = q[:3] + turn.apply(local[0]), (turn * local[1]).as_quat()
    pybullet.resetBasePositionAndOrientation(body, position, quaternion, client)
    pybullet.resetBaseVelocity(body, [0.0] * 3, [0.0] * 3, client)
    pybullet.resetJointStatesMultiDof(
        body, joints, [[angle] for angle in q[7:]], [[0.0]] * len(joints), physicsClientId=client
    )


def _wrenches(contacts: list[tuple]) -> np.ndarray:
    """Forces and moments (C, 6) about the world's origin that contact points give to the robot."""
    if not contacts:
        return np.zeros((0, 6))
    place, normal, first, second = (np.array([c[i] for c in contacts]) for i in (6, 7, 11, 13))
    sizes = np.array([(c[9], c[10], c[12]) for c in contacts])
    force = sizes[:, :1] * normal + sizes[:, 1:2] * first + sizes[:, 2:] * second
    return np.column_stack([force, np.cross(place, force)])
