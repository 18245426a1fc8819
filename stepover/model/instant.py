"""The robot at one instant: kinematics and legs of a single configuration, fast enough for a control loop.

body.py and legs.py compute whole motions at once. For a single sample their array operations would be slow.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from scipy.linalg.lapack import dposv

from stepover.model.robot import Robot

TOLERANCE = 1e-7
"""Pose error at which the iteration of the legs has converged [m, rad]."""
NEAR = 1e-4
"""Pose error so small that one more Newton step, whose error is its square, converges [m, rad]."""
DAMPING = 1e-8 * np.eye(6)
"""Damping of the legs' iteration: no effect on a bent knee, and finite steps for a straight one."""


class Instant:
    """Forward kinematics of one configuration after the other, and inverse kinematics of both legs.

    All positions are relative to the root, in the axes of the root's attitude.
    """

    def __init__(self, robot: Robot) -> None:
        """Allocate the data for a robot."""
        body = robot.body
        self._model = body.model
        self._data = self._model.createData()
        self._q = pin.neutral(self._model)
        self._ankles = {side: body.index(robot.leg(side).joints[-1]) for side in (1, -1)}
        self._columns = {side: [column - 7 for column in robot.leg(side).columns] for side in (1, -1)}
        self._speeds = {side: [column + 6 for column in columns] for side, columns in self._columns.items()}
        self._lower, self._upper = body.lower, body.upper

    def place(self, attitude: np.ndarray, joints: np.ndarray) -> None:
        """Set the configuration.

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
        """Joint angles (nq - 7,) that put the ankles at their targets in the root's frame, or as near as limits allow.

        The damped Newton iteration stays bounded if a target is out of reach: the leg then points to it.

        Args:
            targets: by side, rotation (3, 3) and position (3,) of the ankle in the root's frame.
            guess: (nq - 7,) initial angles. Joints outside the legs keep them.
            rounds: largest number of iterations.
        """
        joints = guess.copy()
        self._q[3:7], self._q[7:] = (0.0, 0.0, 0.0, 1.0), joints
        for done in range(rounds):
            pin.computeJointJacobians(self._model, self._data, self._q)
            errors = {side: self._error(side, *target) for side, target in targets.items()}
            off = max(max(error.max(), -error.min()) for error in errors.values())
            if off < TOLERANCE:
                return guess if done == 0 else self._q[7:].copy()
            for side, error in errors.items():
                joints[self._columns[side]] += self._newton(side, error)
            self._q[7:] = np.minimum(np.maximum(joints, self._lower), self._upper)
            joints = self._q[7:].copy()
            if off < NEAR:
                break
        return joints

    def _error(self, side: int, rotation: np.ndarray, position: np.ndarray) -> np.ndarray:
        """Pose error of an ankle (6,): position [m] and rotation vector [rad], in the root's frame."""
        now = self._data.oMi[self._ankles[side]]
        return np.concatenate([position - now.translation, pin.log3(rotation @ now.rotation.T)])

    def _newton(self, side: int, error: np.ndarray) -> np.ndarray:
        """Step (6,) of a leg's joints. LAPACK is called directly: numpy's checks take longer than six equations."""
        jacobian = pin.getJointJacobian(self._model, self._data, self._ankles[side], pin.LOCAL_WORLD_ALIGNED)
        own = jacobian[:, self._speeds[side]]
        return np.asarray(own.T @ dposv(own @ own.T + DAMPING, error)[1])
