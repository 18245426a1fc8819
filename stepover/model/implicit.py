"""Accelerations in the next time step, for springs and servos that are integrated implicitly.

A joint is driven by tau = P + ... - D a dt, where a is the acceleration in the same step. It moves as if it had an
additional inertia D dt (Tan, Liu, Turk 2011, "Stable proportional-derivative controllers"). Pinocchio calls such an
inertia of a joint an armature, and solves for the accelerations with feet on the floor.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import compress

import numpy as np
import pinocchio as pin

REGULARISATION = 1e-6
"""Regularisation of the contact forces, which are not unique at the four corners of a flat foot."""
ROUNDS = 3
"""Rounds of pinocchio's proximal iteration over the contact forces."""
LOOKS = 3
"""Number of rounds in which points that the floor would have to pull are removed."""


class Prediction:
    """A floating-base robot with armatures, and points of its feet that may stand on the floor."""

    def __init__(
        self,
        urdf: str,
        joints: Sequence[str],
        points: Sequence[tuple[str, np.ndarray]],
        step: float,
    ) -> None:
        """Build the model.

        Args:
            urdf: the robot's description itself.
            joints: names of all joints, in the order of the arrays of acceleration.
            points: for each foot, the joint that moves it, and points (C, 3) in that joint's frame [m].
            step: time in which the floor stops a point [s].
        """
        self._stopping = pin.BaumgarteCorrectorParameters(0.0, 1.0 / step)
        self._model = pin.buildModelFromXML(urdf, pin.JointModelFreeFlyer())
        self._data = self._model.createData()
        ids = [self._model.getJointId(joint) for joint in joints]
        self._q = np.array([self._model.joints[i].idx_q for i in ids])
        self._v = np.array([self._model.joints[i].idx_v for i in ids])
        self._armature = np.zeros(self._model.nv)
        self._feet = [(self._model.getJointId(joint), corners) for joint, corners in points]
        self._settings = pin.ProximalSettings(1e-12, REGULARISATION, ROUNDS)
        self._known: dict[tuple[int, ...], tuple] = {}
        self._standing: tuple[int, ...] | None = None
        self._state, self._speed, self._torque = pin.neutral(self._model), *np.zeros((2, self._model.nv))

    def set_gravity(self, gravity: np.ndarray) -> None:
        """Gravity (3,) in the world [m/s^2]."""
        self._model.gravity.linear = gravity

    def nearest(self, foot: int, places: np.ndarray) -> np.ndarray:
        """The points of a foot nearest to places (n, 3) in the world, at the pose of the last acceleration."""
        joint, corners = self._feet[foot]
        here = self._data.oMi[joint]
        local = (places - here.translation) @ here.rotation
        x, y = local[:, :1] - corners[:, 0], local[:, 1:2] - corners[:, 1]
        return np.asarray((x * x + y * y).argmin(axis=1))

    def acceleration(
        self,
        base: np.ndarray,
        twist: np.ndarray,
        angles: np.ndarray,
        speeds: np.ndarray,
        torque: np.ndarray,
        standing: tuple[int, ...],
        armature: np.ndarray,
    ) -> np.ndarray:
        """Joint accelerations (J,).

        Args:
            base: (7,) pose of the root.
            twist: (6,) velocity and angular velocity of the root in its own axes.
            angles: (J,) angles of all joints [rad, m].
            speeds: (J,) speeds of all joints [rad/s, m/s].
            torque: (J,) torques on all joints [N m, N].
            standing: numbers of the points that may stand on the floor, counted over all feet, in rising order. The
                floor holds a point only if it need not pull it.
            armature: (J,) additional inertia of each joint [kg m^2].
        """
        self._armature[self._v] = armature
        self._model.armature = self._armature
        self._state[:7], self._state[self._q] = base, angles
        self._speed[:6], self._speed[self._v] = twist, speeds
        self._torque[self._v] = torque
        for look in range(LOOKS):
            models, datas = self._contacts(standing)
            result = pin.constraintDynamics(
                self._model, self._data, self._state, self._speed, self._torque, models, datas, self._settings
            )
            held = self._data.lambda_c[2 : 3 * len(standing) : 3] >= 0.0  # a point's force has three parts
            if held.all() or look == LOOKS - 1:
                break
            standing = tuple(compress(standing, held))
        return np.asarray(result[self._v])

    def _contacts(self, standing: tuple[int, ...]) -> tuple:
        """Pinocchio's constraints for points that the floor holds."""
        if standing not in self._known:
            places = [(joint, corner) for joint, corners in self._feet for corner in corners]
            models, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
            for k in standing:
                joint, corner = places[k]
                where, frame = pin.SE3(np.eye(3), corner), pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
                model = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, self._model, joint, where, frame)
                model.setBaumgarteCorrectorParameters(self._stopping)
                models.append(model)
                datas.append(model.createData())
            self._known[standing] = models, datas
        models, datas = self._known[standing]
        if standing != self._standing:
            pin.initConstraintDynamics(self._model, self._data, models, datas)
            self._standing = standing
        return models, datas
