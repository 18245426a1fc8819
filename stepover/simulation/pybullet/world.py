"""The world in PyBullet: floor, obstacle and robot, and what may be otherwise than planned.

PyBullet gives and takes the base pose of a robot at the centre of mass of its root link. Everything that leaves
this module is in the library's terms: configurations in pinocchio's order, with the pose of the root link itself.
"""

from __future__ import annotations

import numpy as np

from stepover.errors import InvalidInput
from stepover.model.gravity import GRAVITY
from stepover.model.obstacle import LATERAL_HALF_EXTENT
from stepover.model.pose import axes, product, unit
from stepover.model.robot import Robot
from stepover.simulation.disturbances import NONE, Disturbances
from stepover.simulation.pybullet.client import load_body, local_of, names_of, place_body, pybullet, silenced
from stepover.simulation.pybullet.description import describe
from stepover.simulation.touch import Touch, summed_up


class World:
    """A fresh PyBullet client with floor, robot and, unless None, the obstacle; a context manager.

    Attributes:
        client: PyBullet's number of the client.
        robot: the number of the robot's body.
        links: link names by PyBullet's index; the root is at -1. What is beyond a bush counts as the foot's link.
        joints: PyBullet's indices of the joints in the order of q[7:].
        passive: PyBullet's indices of the bushes' joints: up and down, roll, pitch; the left foot's first.
        description: the URDF as it is simulated.
        gravity: (3,) [m/s^2].
    """

    def __init__(
        self, robot: Robot, obstacle: np.ndarray | None, sole: str = "rigid", disturbances: Disturbances = NONE
    ) -> None:
        """Build the world.

        Args:
            robot: the robot, in the pose of the URDF until reset.
            obstacle: a motion's obstacle row: front face x, width, height, ... [m]; where it really is.
            sole: "rigid" or "compliant".
            disturbances: friction, slope and the chest's mass are of this place.

        Raises:
            InvalidInput: the robot weighs something else in PyBullet than in pinocchio, or has no sole for rubber.
        """
        self._robot, self._disturbances, self.gravity = robot, disturbances, disturbances.gravity
        self.description = description = describe(robot, sole, disturbances)
        with silenced():
            self.client = pybullet.connect(pybullet.DIRECT)
            self._floor = self._plane()
            self._obstacle = None if obstacle is None else self._beam(*obstacle[:3])
            self.robot = load_body(robot, self.client, description)
        self.links, index = names_of(self.robot, self.client)
        self.joints = [index[name] for name in robot.body.joint_names]
        self.passive = [index[name] for name in description.passive]
        feet = {index[(robot.legs.left if side > 0 else robot.legs.right)[-1]]: side for side in (1, -1)}
        for number, name in zip(self.passive, description.passive, strict=True):
            foot = next(foot for foot in feet if name.startswith(f"{self.links[foot]}_"))
            feet[number], self.links[number] = feet[foot], self.links[foot]
        self._feet = {link: 0 if side > 0 else 1 for link, side in feet.items()}
        self._foot_floors: dict[int, int] = {}
        self._local = local_of(self.robot, self.client)
        self._lever = np.cross(self._local[0], np.eye(3)).T  # lever x spin, which np.cross takes its time for
        self._back = self._local[1].inv().as_quat().tolist()
        self._from_inertial = pybullet.invertTransform(self._local[0].tolist(), self._local[1].as_quat().tolist())
        self._settle_physics()

    @property
    def time_step(self) -> float:
        """Of the physics [s]."""
        return self._robot.simulation.time_step

    def __enter__(self) -> World:
        return self

    def __exit__(self, *_: object) -> None:
        pybullet.disconnect(self.client)

    def reset(self, q: np.ndarray) -> None:
        """Put the robot at rest at a configuration (nq,), on rubber as deep as the weight on both feet presses it."""
        place_body(self.robot, self.client, self.joints, self._local, q)
        if not self.passive:
            return
        sunk = self._robot.body.mass * GRAVITY / (2.0 * self._robot.sole.vertical_stiffness)
        place_body(self.robot, self.client, self.joints, self._local, q - np.eye(len(q))[2] * sunk)
        for number in self.passive[0::3]:
            pybullet.resetJointState(self.robot, number, sunk, 0.0, self.client)

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
            self.robot, self.joints, pybullet.POSITION_CONTROL, angles.tolist(), speeds.tolist(), [torque] * count,
            [correction] * count, [1.0] * count, self.client,
        )  # fmt: skip

    def release(self, joints: list[int]) -> None:
        """Take the position-controlled motors, which PyBullet begins with, from joints that torques shall move."""
        pybullet.setJointMotorControlArray(
            self.robot, joints, pybullet.VELOCITY_CONTROL, forces=[0.0] * len(joints), physicsClientId=self.client
        )

    def drive(self, joints: list[int], torques: np.ndarray) -> None:
        """Torques for the next step on joints that were released [N m, N]."""
        pybullet.setJointMotorControlArray(
            self.robot, joints, pybullet.TORQUE_CONTROL, forces=torques.tolist(), physicsClientId=self.client
        )

    def push(self, force: np.ndarray) -> None:
        """Push the root link at its centre of mass for the next step: force (3,) in the world [N]."""
        place = pybullet.getBasePositionAndOrientation(self.robot, self.client)[0]
        pybullet.applyExternalForce(
            self.robot, -1, force.tolist(), place, pybullet.WORLD_FRAME, physicsClientId=self.client
        )

    def joint_motion(self, joints: list[int]) -> np.ndarray:
        """Angles and speeds of joints: (2, J)."""
        states = pybullet.getJointStates(self.robot, joints, self.client)
        return np.array([[state[0] for state in states], [state[1] for state in states]])

    def base_motion(self) -> tuple[np.ndarray, np.ndarray]:
        """Pose (7,) of the root link, and its velocity and angular velocity (6,) in its own axes."""
        middle, turn = pybullet.getBasePositionAndOrientation(self.robot, self.client)
        position, quaternion = pybullet.multiplyTransforms(middle, turn, *self._from_inertial)
        frame = np.array(pybullet.getMatrixFromQuaternion(quaternion)).reshape(3, 3)
        linear, spin = np.array(pybullet.getBaseVelocity(self.robot, self.client)) @ frame
        return np.array(position + quaternion), np.concatenate([linear + self._lever @ spin, spin])

    def link_frame(self, link: int) -> tuple[tuple[float, float, float], np.ndarray]:
        """Place and axes (3, 3), as columns, of a link's frame in the world."""
        place, quaternion = pybullet.getLinkState(self.robot, link, 0, 1, self.client)[4:6]
        return place, np.array(pybullet.getMatrixFromQuaternion(quaternion)).reshape(3, 3)

    def bush(self) -> np.ndarray:
        """Deflections (6,) of the bushes: left up, roll, pitch, then right [m, rad]; zero where there are none."""
        return self.joint_motion(self.passive)[0] if self.passive else np.zeros(6)

    def set_ground(self, side: int, height: float) -> None:
        """Put the floor that a foot steps on at a height [m]; the first time, each foot gets a floor of its own."""
        if not self._foot_floors:
            self._part_floor()
        where = (0.0, 0.0, height), (0.0, 0.0, 0.0, 1.0)
        pybullet.resetBasePositionAndOrientation(self._foot_floors[side], *where, self.client)

    def joint_states(self) -> np.ndarray:
        """Angle [rad], speed [rad/s] and motor torque of the last step [N m] of all joints: (3, nq - 7)."""
        angles, speeds, _, torques = zip(*pybullet.getJointStates(self.robot, self.joints, self.client), strict=True)
        return np.array([angles, speeds, torques])

    def base_pose(self) -> np.ndarray:
        """Pose (7,) of the root link."""
        position, quaternion = pybullet.getBasePositionAndOrientation(self.robot, self.client)
        turn = product(unit(quaternion), self._back)
        return np.concatenate([position - axes(turn) @ self._local[0], turn])

    def contacts(self) -> list[tuple]:
        """Contact points of the last step, as PyBullet gives them: for touch."""
        return list(pybullet.getContactPoints(self.robot, physicsClientId=self.client))

    def standing(self, contacts: list[tuple]) -> list[tuple]:
        """Those of the contacts that bear on the floor."""
        if self._foot_floors:
            floors = (self._floor, *self._foot_floors.values())
            return [c for c in contacts if c[2] in floors and c[9] > 0.0]
        return [c for c in contacts if c[2] == self._floor and c[9] > 0.0]

    def foot_of(self, contact: tuple) -> int:
        """Which foot a contact is of: 0 left, 1 right, -1 none."""
        return self._feet.get(contact[3], -1)

    def touch(self, contacts: list[tuple], steps: int) -> Touch:
        """What the contacts of some steps come to: mean wrenches over the steps."""
        on_obstacle = [c for c in contacts if c[2] == self._obstacle and c[8] <= 0.0]
        return summed_up(self.standing(contacts), on_obstacle, self._feet, self.links, steps)

    def _still(self, shape: int, position: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> int:
        """A body that never moves."""
        return int(pybullet.createMultiBody(0.0, shape, basePosition=position, physicsClientId=self.client))

    def _beam(self, front: float, width: float, height: float) -> int:
        """The bare obstacle, as a box on the floor."""
        half = [width / 2.0, LATERAL_HALF_EXTENT, height / 2.0]
        box = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=half, physicsClientId=self.client)
        return self._still(box, (front + half[0], 0.0, half[2]))

    def _plane(self) -> int:
        """An endless floor."""
        return self._still(pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=self.client))

    def _part_floor(self) -> None:
        """Give each foot a floor of its own, which nothing else touches.

        A foot in the air does not notice when its floor moves, so that each foothold may have its own height without
        edges to its neighbours.
        """
        for side, row in ((1, 0), (-1, 1)):
            own = self._foot_floors[side] = self._plane()
            self._roughen(own, -1)
            for link in self.links:
                mine = self._feet.get(link) == row
                pybullet.setCollisionFilterPair(own, self.robot, -1, link, int(mine), self.client)
                if mine:
                    pybullet.setCollisionFilterPair(self._floor, self.robot, -1, link, 0, self.client)

    def _roughen(self, body: int, link: int) -> None:
        """Friction, which PyBullet multiplies; and no damping, which PyBullet would add to everything."""
        friction = self._disturbances.friction or self._robot.simulation.friction
        pybullet.changeDynamics(
            body, link, lateralFriction=1.0 if body != self.robot else friction, linearDamping=0.0,
            angularDamping=0.0, jointDamping=0.0, physicsClientId=self.client,
        )  # fmt: skip

    def _settle_physics(self) -> None:
        """Time step, solver, gravity, friction; and check the mass."""
        parameters, client = self._robot.simulation, self.client
        pybullet.setGravity(*self.gravity, client)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=parameters.time_step, numSolverIterations=parameters.solver_iterations, numSubSteps=0,
            deterministicOverlappingPairs=1, physicsClientId=client,
        )  # fmt: skip
        still = [(body, -1) for body in (self._floor, self._obstacle) if body is not None]
        for body, link in [*still, *((self.robot, link) for link in self.links)]:
            self._roughen(body, link)
        mass = sum(pybullet.getDynamicsInfo(self.robot, link, client)[0] for link in self.links)
        expected = self._robot.body.mass * (1.0 + self._disturbances.chest_mass)
        if abs(mass - expected) > 1e-6 * mass:
            raise InvalidInput(
                f"{self._robot.urdf_path.name} weighs {mass:.3f} kg in PyBullet and {expected:.3f} kg in pinocchio: "
                "every link needs an <inertial> with a mass"
            )
