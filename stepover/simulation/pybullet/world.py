"""The engine PyBullet: a world with floor, obstacles and robot in a client of its own."""

from __future__ import annotations

from typing import Self

import numpy as np

from stepover.model.gravity import GRAVITY
from stepover.simulation.engine import Contacts, Scene
from stepover.simulation.pybullet.client import pybullet, silenced
from stepover.simulation.pybullet.motors import Motors, motors_of
from stepover.simulation.pybullet.robot import Body
from stepover.simulation.pybullet.surroundings import Point, Surroundings
from stepover.simulation.simulated import require_mass, simulated_robot


class World:
    """A fresh PyBullet client, as simulation.engine.Engine describes it.

    Attributes:
        scene: what it was built from.
        links: names of the robot's links, the root first.
        bush_depth: from the ankle down to the bush [m]; 0 on rigid soles.
        client: PyBullet's number of the client.
        surroundings: floor and obstacles.
        robot: the robot's body.
        motors: what drives its joints.
    """

    surroundings: Surroundings
    robot: Body
    motors: Motors

    def __init__(self, scene: Scene) -> None:
        """Build the world, with the robot in the pose of the URDF.

        Raises:
            InvalidInput: the robot weighs something else in PyBullet than in pinocchio, or has no sole for rubber.
        """
        self.scene = scene
        self._simulated = simulated_robot(scene.robot, scene.sole, scene.disturbances)
        self.bush_depth = self._simulated.bush_depth
        self._points: list[tuple[int, Point]] = []
        self._steps = 0
        with silenced():
            self.client = pybullet.connect(pybullet.DIRECT)
        try:
            self._build()
        except BaseException:
            self.__exit__()
            raise
        self.links = tuple(self.robot.links[index] for index in sorted(self.robot.links))

    @property
    def torque(self) -> np.ndarray:
        """Of the motors in the last step (J,) [N m]."""
        return self.motors.torque

    @property
    def saturated(self) -> np.ndarray:
        """Whether a limited motor gave all its torque in the last step: (J,)."""
        return self.motors.saturated

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        pybullet.disconnect(self.client)

    def reset(self, q: np.ndarray) -> None:
        """Put the robot at rest at a configuration (nq,), on rubber as deep as the weight on both feet presses it."""
        self._points, self._steps = [], 0
        self.robot.place(q)
        if self.robot.passive:
            robot = self.scene.robot
            sunk = robot.body.mass * GRAVITY / (2.0 * robot.sole.vertical_stiffness)
            self.robot.place(q - np.eye(len(q))[2] * sunk)
            self.robot.press(sunk)

    def command(self, start: np.ndarray, end: np.ndarray, speed: np.ndarray) -> None:
        """Tell the motors how the joints shall move in the next step: angles (J,) at its ends [rad], speed [rad/s]."""
        self.motors.command(start, end, speed)

    def push(self, force: np.ndarray) -> None:
        """Push the root link at its centre of mass during the next step: force (3,) in the world's axes [N]."""
        self.robot.push(force)

    def step(self) -> None:
        """Let one time step pass."""
        pybullet.stepSimulation(self.client)
        on_floor, on_obstacles = self.surroundings.points(self.robot)
        self.motors.look(on_floor)
        self._points += [(self._steps, point) for point in on_floor + on_obstacles]
        self._steps += 1

    def contacts(self) -> Contacts:
        """The contact points of all steps since the last call, or since the reset; in a step the floor's come first."""
        points, self._points, self._steps = self._points, [], 0
        return self.surroundings.contacts(points, self.robot)

    def base_pose(self) -> np.ndarray:
        """Pose (7,) of the root link."""
        return self.robot.base_pose()

    def joints(self) -> np.ndarray:
        """Angles [rad] and speeds [rad/s] of all joints: (2, J)."""
        return self.robot.joint_motion(self.robot.joints)

    def imu(self) -> tuple[np.ndarray, np.ndarray]:
        """Of the root link: unit quaternion (4,), and angular velocity (3,) in its own axes [rad/s]."""
        pose, twist = self.robot.base_motion()
        return pose[3:], twist[3:]

    def ankle(self, foot: int) -> tuple[np.ndarray, np.ndarray]:
        """Place (3,) [m] and axes (3, 3), as columns, of the frame of a leg's last joint: 0 left, 1 right."""
        return self.robot.link_frame(self.robot.ankles[foot])

    def bush(self) -> np.ndarray:
        """Deflections (6,) of the rubber: left up, roll, pitch, then right [m, rad]; zero on rigid soles."""
        return self.robot.joint_motion(self.robot.passive)[0] if self.robot.passive else np.zeros(6)

    def set_ground(self, foot: int, height: float) -> None:
        """Put the floor under a foot, 0 left or 1 right, at a height [m]; from the first time each foot has its own."""
        if not self.surroundings.parted:
            for body in self.surroundings.part_floor(self.robot):
                self._roughen(body, -1)
        self.surroundings.raise_floor(foot, height)

    def _build(self) -> None:
        """Floor, obstacles, robot, physics and motors."""
        with silenced():
            self.surroundings = Surroundings(self.client, self.scene.obstacles)
            self.robot = Body(self.scene.robot, self._simulated, self.client)
        self._settle_physics()
        require_mass(self.scene, self.robot.mass, "PyBullet")
        self.motors = motors_of(self.scene, self.robot, self._simulated)

    def _settle_physics(self) -> None:
        """Time step, solver, gravity and friction."""
        parameters = self.scene.robot.simulation
        pybullet.setGravity(*self.scene.disturbances.gravity, self.client)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=parameters.time_step, numSolverIterations=parameters.solver_iterations, numSubSteps=0,
            deterministicOverlappingPairs=1, physicsClientId=self.client,
        )  # fmt: skip
        for body in self.surroundings.bodies:
            self._roughen(body, -1)
        for link in self.robot.links:
            self._roughen(self.robot.number, link)

    def _roughen(self, body: int, link: int) -> None:
        """Friction, which PyBullet multiplies; and no damping, which PyBullet would add to everything."""
        friction = self.scene.disturbances.friction or self.scene.robot.simulation.friction
        pybullet.changeDynamics(
            body, link, lateralFriction=1.0 if body != self.robot.number else friction, linearDamping=0.0,
            angularDamping=0.0, jointDamping=0.0, physicsClientId=self.client,
        )  # fmt: skip
