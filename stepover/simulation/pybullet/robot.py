"""The robot as a body in a PyBullet client: its state, its joints, and how they are driven.

PyBullet gives and takes the base pose of a robot at the centre of mass of its root link. Everything that leaves
this module is in the library's terms: joints in pinocchio's order, and the pose of the root link itself.
"""

from __future__ import annotations

import numpy as np

from stepover.model.pose import axes, product, unit
from stepover.model.robot import Robot
from stepover.simulation.pybullet.client import load_body, local_of, names_of, place_body, pybullet
from stepover.simulation.simulated import SimulatedRobot


class Body:
    """A robot in a client.

    Attributes:
        number: PyBullet's number of the body.
        client: PyBullet's number of the client.
        links: link names by PyBullet's index; the root is at -1. What is beyond a bush counts as the foot's link.
        feet: 0 left or 1 right by PyBullet's index of a link that belongs to a foot.
        joints: PyBullet's indices of the joints in the order of q[7:].
        passive: PyBullet's indices of the bushes' joints: up and down, roll, pitch; the left foot's first.
        ankles: PyBullet's indices of the links of the left and the right leg's last joint.
    """

    def __init__(self, robot: Robot, simulated: SimulatedRobot, client: int) -> None:
        """Load a robot into a client, as it is to be simulated."""
        self.client, self.number = client, load_body(simulated.description, client)
        self.links, index = names_of(self.number, client)
        self.joints = [index[name] for name in robot.body.joint_names]
        self.passive = [index[name] for name in simulated.passive]
        self.ankles = [index[robot.leg(side).joints[-1]] for side in (1, -1)]
        self.feet = {link: foot for foot, link in enumerate(self.ankles)}
        for number, name in zip(self.passive, simulated.passive, strict=True):
            ankle = next(link for link in self.ankles if name.startswith(f"{self.links[link]}_"))
            self.feet[number], self.links[number] = self.feet[ankle], self.links[ankle]
        self._local = local_of(self.number, client)
        self._lever = np.cross(self._local[0], np.eye(3)).T  # lever x spin, which np.cross takes its time for
        self._back = self._local[1].inv().as_quat().tolist()
        self._from_inertial = pybullet.invertTransform(self._local[0].tolist(), self._local[1].as_quat().tolist())

    @property
    def mass(self) -> float:
        """Of all links [kg]."""
        return float(sum(pybullet.getDynamicsInfo(self.number, link, self.client)[0] for link in self.links))

    def place(self, q: np.ndarray) -> None:
        """Put it at rest at a configuration (nq,)."""
        place_body(self.number, self.client, self.joints, self._local, q)

    def press(self, sunk: float) -> None:
        """Press the bushes of both feet by a length [m]."""
        for number in self.passive[0::3]:
            pybullet.resetJointState(self.number, number, sunk, 0.0, self.client)

    def base_pose(self) -> np.ndarray:
        """Pose (7,) of the root link."""
        position, quaternion = pybullet.getBasePositionAndOrientation(self.number, self.client)
        turn = product(unit(quaternion), self._back)
        return np.concatenate([position - axes(turn) @ self._local[0], turn])

    def base_motion(self) -> tuple[np.ndarray, np.ndarray]:
        """Pose (7,) of the root link, and its velocity and angular velocity (6,) in its own axes."""
        middle, turn = pybullet.getBasePositionAndOrientation(self.number, self.client)
        position, quaternion = pybullet.multiplyTransforms(middle, turn, *self._from_inertial)
        frame = np.array(pybullet.getMatrixFromQuaternion(quaternion)).reshape(3, 3)
        linear, spin = np.array(pybullet.getBaseVelocity(self.number, self.client)) @ frame
        return np.array(position + quaternion), np.concatenate([linear + self._lever @ spin, spin])

    def joint_motion(self, joints: list[int]) -> np.ndarray:
        """Angles and speeds of joints: (2, J)."""
        states = pybullet.getJointStates(self.number, joints, self.client)
        return np.array([[state[0] for state in states], [state[1] for state in states]])

    def motor_torques(self) -> np.ndarray:
        """Of the position-controlled motors in the last step (J,) [N m]."""
        return np.array([state[3] for state in pybullet.getJointStates(self.number, self.joints, self.client)])

    def link_frame(self, link: int) -> tuple[np.ndarray, np.ndarray]:
        """Place (3,) and axes (3, 3), as columns, of a link's frame in the world."""
        place, quaternion = pybullet.getLinkState(self.number, link, 0, 1, self.client)[4:6]
        return np.array(place), np.array(pybullet.getMatrixFromQuaternion(quaternion)).reshape(3, 3)

    def release(self, joints: list[int]) -> None:
        """Take the position-controlled motors, which PyBullet begins with, from joints that torques shall move."""
        pybullet.setJointMotorControlArray(
            self.number, joints, pybullet.VELOCITY_CONTROL, forces=[0.0] * len(joints), physicsClientId=self.client
        )

    def drive(self, joints: list[int], torques: np.ndarray) -> None:
        """Torques for the next step on joints that were released [N m, N]."""
        pybullet.setJointMotorControlArray(
            self.number, joints, pybullet.TORQUE_CONTROL, forces=torques.tolist(), physicsClientId=self.client
        )

    def follow(self, angles: np.ndarray, speeds: np.ndarray, torque: float, correction: float) -> None:
        """Set all position-controlled motors for the next step.

        A motor removes a share of the error against the angle and moves on with the speed, unless that takes more
        than its torque.

        Args:
            angles: (J,) [rad], of now.
            speeds: (J,) [rad/s], from now to the next step.
            torque: most of it [N m].
            correction: share of the error that is removed in the step.
        """
        count = len(self.joints)
        pybullet.setJointMotorControlArray(
            self.number, self.joints, pybullet.POSITION_CONTROL, angles.tolist(), speeds.tolist(), [torque] * count,
            [correction] * count, [1.0] * count, self.client,
        )  # fmt: skip

    def push(self, force: np.ndarray) -> None:
        """Push the root link at its centre of mass for the next step: force (3,) in the world [N]."""
        place = pybullet.getBasePositionAndOrientation(self.number, self.client)[0]
        pybullet.applyExternalForce(
            self.number, -1, force.tolist(), place, pybullet.WORLD_FRAME, physicsClientId=self.client
        )
