"""The robot at one instant: kinematics and legs of a single configuration, as fast as a control loop wants them.

Beside body.py and legs.py, which take whole motions at once: for one sample their arrays cost more than the sums.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from stepover.model.robot import Robot

TOLERANCE = 1e-7
"""Pose error [m, rad] at which the iteration of the legs has arrived."""
DAMPING = 1e-8 * np.eye(6)
"""Of the legs' iteration: nothing where the knee is bent, and a finite step where it is not."""


class Instant:
    """Forward kinematics of one configuration after the other, and both legs' inverse kinematics.

    All places are relative to the root's, in the axes that the root's attitude is given in.
    """

    def __init__(self, robot: Robot) -> None:
        """Make room for a robot."""
        body = robot.body
        self._model = body.model
        self._data = self._model.createData()
        self._q = pin.neutral(self._model)
        self._ankles = {side: body.index(robot.leg(side).joints[-1]) for side in (1, -1)}
        self._columns = {side: [column - 7 for column in robot.leg(side).columns] for side in (1, -1)}
        self._speeds = {side: [column + 6 for column in columns] for side, columns in self._columns.items()}
        self._lower, self._upper = body.lower, body.upper

    def place(self, attitude: np.ndarray, joints: np.ndarray) -> None:
        """Take a configuration.

        Args:
            attitude: (4,) quaternion x y z w of the root.
            joints: (nq - 7,) [rad].
        """
        self._q[3:7], self._q[7:] = attitude, joints
        pin.forwardKinematics(self._model, self._data, self._q)

    def ankle(self, side: int) -> tuple[np.ndarray, np.ndarray]:
        """Rotation (3, 3) and position (3,) [m] of the last leg joint's frame."""
        frame = self._data.oMi[self._ankles[side]]
        return frame.rotation, frame.translation

    def com(self) -> np.ndarray:
        """Centre of mass (3,) [m]."""
        return np.array(pin.centerOfMass(self._model, self._data, False))

    def legs(self, targets: dict[int, tuple[np.ndarray, np.ndarray]], guess: np.ndarray, rounds: int) -> np.ndarray:
        """Joint angles (nq - 7,) whose ankles are where they shall be in the root's frame, or as near as limits allow.

        A damped Newton iteration, so that nothing grows where a target is out of reach: the leg then points to it.

        Args:
            targets: by side, rotation (3, 3) and position (3,) of the ankle in the root's frame.
            guess: (nq - 7,) angles to start from; other joints than the legs' stay as they are.
            rounds: iterations at most.
        """
        joints = guess.copy()
        self._q[3:7], self._q[7:] = (0.0, 0.0, 0.0, 1.0), joints
        for done in range(rounds):
            pin.computeJointJacobians(self._model, self._data, self._q)
            errors = {side: self._error(side, *target) for side, target in targets.items()}
            if all(np.abs(error).max() < TOLERANCE for error in errors.values()):
                return guess if done == 0 else self._q[7:].copy()
            for side, error in errors.items():
                joints[self._columns[side]] += self._newton(side, error)
            self._q[7:] = np.minimum(np.maximum(joints, self._lower), self._upper)
            joints = self._q[7:].copy()
        return joints

    def _error(self, side: int, rotation: np.ndarray, position: np.ndarray) -> np.ndarray:
        """What an ankle lacks (6,): position [m] and rotation vector [rad], in the root's frame."""
        now = self._data.oMi[self._ankles[side]]
        return np.concatenate([position - now.translation, pin.log3(rotation @ now.rotation.T)])

    def _newton(self, side: int, error: np.ndarray) -> np.ndarray:
        """Step (6,) of a leg's joints."""
        jacobian = pin.getJointJacobian(self._model, self._data, self._ankles[side], pin.LOCAL_WORLD_ALIGNED)
        own = jacobian[:, self._speeds[side]]
        return np.asarray(own.T @ np.linalg.solve(own @ own.T + DAMPING, error))
