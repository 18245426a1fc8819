"""Rigid-body dynamics with a root placed by x y z and yaw, pitch, roll: inverse dynamics and its derivatives.

In these coordinates velocities and accelerations are plain derivatives, so a trajectory optimiser can take them from
differences of its variables. body.py differentiates on the manifold instead; both agree as the sample time shrinks.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from stepover.model.body import Body
from stepover.model.description.urdf_text import urdf_text

ROOT = 6
"""Coordinates of the root: x y z [m], yaw, pitch, roll [rad], in this order of rotation."""


class EulerDynamics:
    """The dynamics of a robot of which some joints move and all others are fixed.

    Attributes:
        joints: names of the joints that move, in the order of q[6:].
        mass: total mass [kg].
    """

    def __init__(self, body: Body, joints: list[str], posture: np.ndarray) -> None:
        """Fix all other joints at a configuration (nq,) of the whole robot."""
        robot, whole, last = pin.buildModelFromXML(urdf_text(body.description)), pin.Model(), 0
        for joint in ("PX", "PY", "PZ", "RZ", "RY", "RX"):  # one by one: of a composite, derivatives come out wrong
            last = whole.addJoint(last, getattr(pin, f"JointModel{joint}")(), pin.SE3.Identity(), f"root {joint}")
        frame = whole.addFrame(pin.Frame("root", last, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))
        whole = pin.appendModel(whole, robot, frame, pin.SE3.Identity())
        fixed = [whole.getJointId(name) for name in body.joint_names if name not in joints]
        reference = pin.neutral(whole)
        for name in body.joint_names:
            reference[whole.joints[whole.getJointId(name)].idx_q] = posture[body.column(name)]
        self._model = pin.buildReducedModel(whole, fixed, reference)
        self._data, self._pool = self._model.createData(), pin.ModelPool(self._model, 1)
        self.joints, self.mass = list(self._model.names)[1 + ROOT :], body.mass

    def forces(self, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        """Generalised forces (n, C) of inverse dynamics for coordinates, speeds and accelerations (n, C) each."""
        columns = [np.asfortranarray(x.T) for x in (q, v, a)]
        found = np.zeros_like(columns[1])
        pin.rneaInParallel(1, self._pool, *columns, found)
        return found.T

    def derivatives(
        self, q: np.ndarray, v: np.ndarray, a: np.ndarray, joints: list[str], wrenches: np.ndarray
    ) -> np.ndarray:
        """Derivatives (n, C, 3 C) of the generalised forces by q, v and a, with a wrench that acts on a joint's frame.

        Args:
            q: (n, C) coordinates.
            v: (n, C) speeds.
            a: (n, C) accelerations.
            joints: (n) names of the joints on whose frames the wrenches act.
            wrenches: (n, 6) force and moment in these frames [N, N m]; they turn with them.
        """
        model, data, size = self._model, self._data, self._model.nv
        found, outer = np.empty((len(q), size, 3 * size)), pin.StdVec_Force()
        for _ in range(model.njoints):
            outer.append(pin.Force.Zero())
        for k, joint in enumerate(joints):  # pinocchio takes one sample at a time here
            index = model.getJointId(joint)
            outer[index] = pin.Force(wrenches[k])
            pin.computeRNEADerivatives(model, data, q[k], v[k], a[k], outer)
            outer[index] = pin.Force.Zero()
            found[k, :, :size], found[k, :, size : 2 * size], found[k, :, 2 * size :] = (
                data.dtau_dq, data.dtau_dv, data.M,
            )  # fmt: skip
        inertia = found[:, :, 2 * size :]  # pinocchio fills its upper triangle
        inertia[:] = np.triu(inertia) + np.swapaxes(np.triu(inertia, 1), 1, 2)
        return found
