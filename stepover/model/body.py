"""The multi-body robot: kinematics, centre of mass and ZMP over a whole motion at once.

The ZMP is that of the full rigid-body dynamics (RNEA of pinocchio). Derivatives are taken on the manifold: central
differences for velocities, second differences for accelerations. Sec. II-B, Eq. (20).
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache

import numpy as np
import pinocchio as pin

from stepover.errors import InvalidInput
from stepover.model import pose
from stepover.model.description.links import Description
from stepover.model.description.urdf_text import urdf_text
from stepover.model.kinematics import Joint, Placements, place_joints


def _told_apart(description: Description) -> Description:
    """The robot with other names for its links: a joint may be called like a link, but pinocchio's frames may not."""
    links = tuple(replace(link, name=f"link {link.name}") for link in description.links)
    joints = tuple(replace(j, parent=f"link {j.parent}", child=f"link {j.child}") for j in description.joints)
    return replace(description, links=links, joints=joints)


class Body:
    """A floating-base robot.

    Attributes:
        description: what it is built from.
        joint_names: names of the joints behind q[7:], in pinocchio's order.
        link_names: names of the links, the root first.
        lower, upper: joint limits (nq - 7,) [rad].
        speed_limits, effort_limits: (nq - 7,) [rad/s], [N m].
        mass: total mass [kg].
    """

    def __init__(self, description: Description) -> None:
        """Build the model of a robot."""
        self.description = description
        self._model = pin.buildModelFromXML(urdf_text(_told_apart(description)), pin.JointModelFreeFlyer())
        self.joint_names = list(self._model.names)[2:]
        self.link_names = [link.name for link in description.links]
        self.lower, self.upper = self._model.lowerPositionLimit[7:].copy(), self._model.upperPositionLimit[7:].copy()
        self.speed_limits, self.effort_limits = self._model.velocityLimit[6:].copy(), self._model.effortLimit[6:].copy()
        self.mass = float(pin.computeTotalMass(self._model))
        self._masses = np.array([inertia.mass for inertia in self._model.inertias])
        self._centres = np.array([inertia.lever for inertia in self._model.inertias])
        self._origins = [(p.rotation.copy(), p.translation.copy()) for p in self._model.jointPlacements]
        self._parents = list(self._model.parents)

    @property
    def model(self) -> pin.Model:
        """Pinocchio's model, for computations on single configurations in model.instant."""
        return self._model

    @cached_property
    def axes(self) -> np.ndarray:
        """Joint axes (nq - 7, 3) in their own frames."""
        data = self._model.createData()
        pin.computeJointJacobians(self._model, data, pin.neutral(self._model))
        return np.array([np.ravel(data.joints[i].S)[3:] for i in range(2, self._model.njoints)])

    @cached_property
    def _tree(self) -> dict[int, Joint]:
        """All joints after the root by their index, for forward kinematics."""
        joints = range(2, self._model.njoints)
        return {i: Joint(self._parents[i], *self._origins[i], self.axes[i - 2]) for i in joints}

    def mass_beyond(self, joint: str) -> float:
        """Total mass of all links that a joint moves [kg]."""
        return float(self._masses[list(self._model.subtrees[self.index(joint)])].sum())

    def beyond(self, joints: Sequence[str], further: int) -> set[int]:
        """Indices of all joints that move with some joints, starting a number of links further out."""
        return {i for joint in joints for i in list(self._model.subtrees[self.index(joint)])[further:]}

    def column(self, joint: str) -> int:
        """Column of a joint in q, or InvalidInput."""
        if joint not in self.joint_names:
            raise InvalidInput(f"the URDF has no joint {joint!r}; it has {', '.join(self.joint_names)}")
        return 7 + self.joint_names.index(joint)

    def index(self, joint: str) -> int:
        """Index of a joint in Placements, or InvalidInput."""
        return self.column(joint) - 7 + 2

    def origin(self, joint: str) -> tuple[np.ndarray, np.ndarray, str]:
        """Fixed rotation (3, 3) and translation (3,) of a joint in its parent joint's frame, and that parent."""
        index = self.index(joint)
        return *self._origins[index], self._model.names[self._parents[index]]

    def joint_of(self, link: str) -> int:
        """Index in Placements of the joint that moves a link; 1 for the root, which the free-flyer moves."""
        above = self.description.joint_above
        return self.index(above[link].name) if link in above else 1

    def placements(self, q: np.ndarray, joints: Sequence[str] | None = None) -> Placements:
        """Forward kinematics over all samples: one pass along the tree, arrays over time.

        Args:
            q: (N, nq) configurations.
            joints: only these joints, which must be whole chains from the root; the others' positions are NaN.
        """
        wanted = range(2, self._model.njoints) if joints is None else sorted(self.index(joint) for joint in joints)
        chain = {index: self._tree[index] for index in wanted}
        return place_joints(chain, self._model.njoints, (pose.rotation(q[:, :7]), q[:, :3]), q[:, 7:])

    def com(self, placements: Placements) -> np.ndarray:
        """Centre of mass (N, 3) [m]."""
        turns, places = placements.rotations.transpose(2, 1, 3, 0), placements.positions.transpose(2, 1, 0)
        shares = self._masses / self.mass
        levers = np.einsum("jb,ajbn->an", shares[:, None] * self._centres, turns)
        return (levers + np.einsum("j,ajn->an", shares, places)).T

    def velocities(self, q: np.ndarray, dt: float) -> np.ndarray:
        """Velocities (N, nv) by central differences on the manifold; one-sided at the ends."""
        return self._derivatives(q, dt)[0]

    def accelerations(self, q: np.ndarray, dt: float) -> np.ndarray:
        """Accelerations (N, nv) by second differences on the manifold; zero at the ends."""
        return self._derivatives(q, dt)[1]

    def _derivatives(self, q: np.ndarray, dt: float) -> tuple[np.ndarray, np.ndarray]:
        """Velocities and accelerations."""
        steps = self._steps(q)
        return (steps[1:] + steps[:-1]) / (2.0 * dt), np.diff(steps, axis=0) / dt**2

    def contact_wrench(self, q: np.ndarray, dt: float) -> np.ndarray:
        """Force and moment of the ground about the world's origin: (N, 6) [N, N m]."""
        still = (q[:, 7:] == q[0, 7:]).all(axis=0)
        pool = _pool(self._model, tuple(np.flatnonzero(still).tolist()), tuple(q[0, 7:][still].tolist()))
        q = np.delete(q, 7 + np.flatnonzero(still), axis=1)
        torques = _sweep(pool, q, *self._derivatives(q, dt))()
        base = pose.rotation(q[:, :7])
        force, moment = np.moveaxis(base @ torques[:6].reshape(2, 3, -1).T, 2, 0)
        return np.column_stack([force, moment + np.cross(q[:, :3], force)])

    def dynamics_sweep(self, q: np.ndarray, dt: float) -> Callable[[], np.ndarray]:
        """A function that computes the RNEA of all joints over q (N, nq) on one thread: (nv, N) [N, N m]."""
        return _sweep(pin.ModelPool(self._model, 1), q, *self._derivatives(q, dt))

    def zmp(self, q: np.ndarray, dt: float) -> np.ndarray:
        """Multi-body ZMP (N, 2) [m]: the point of the floor z = 0 where the ground's moment has no horizontal part."""
        wrench = self.contact_wrench(q, dt)
        return np.column_stack([-wrench[:, 4], wrench[:, 3]]) / wrench[:, 2:3]

    @staticmethod
    def _steps(q: np.ndarray) -> np.ndarray:
        """Differences (N + 1, nv) on the manifold from each sample to the next; the first and the last one twice."""
        inverse = np.swapaxes(pose.rotation(q[:-1, :7]), 1, 2)
        turn = pose.turns(q[:, :7])
        shift = (inverse @ np.diff(q[:, :3], axis=0)[..., None])[..., 0]
        steps = np.column_stack([_log_translation(turn, shift), turn, np.diff(q[:, 7:], axis=0)])
        return np.vstack([steps[:1], steps, steps[-1:]])


def _log_translation(turn: np.ndarray, shift: np.ndarray) -> np.ndarray:
    """Linear part (N, 3) of the logarithm on SE(3) of a rotation vector and a translation, (N, 3) each."""
    angle = np.linalg.norm(turn, axis=1, keepdims=True)
    small = angle < 1e-4
    safe = np.where(small, 1.0, angle)
    factor = np.where(small, 1.0 / 12.0 + angle**2 / 720.0, 1.0 / safe**2 - 0.5 / (safe * np.tan(safe / 2.0)))
    once = np.cross(turn, shift)
    return shift - 0.5 * once + factor * np.cross(turn, once)


def _sweep(pool: pin.ModelPool, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> Callable[[], np.ndarray]:
    """A function that computes the RNEA over all samples, with all threads of the pool."""
    columns = [np.asfortranarray(x.T) for x in (q, v, a)]
    torques = np.zeros_like(columns[1])

    def sweep() -> np.ndarray:
        pin.rneaInParallel(pool.size(), pool, *columns, torques)
        return torques

    return sweep


@lru_cache(maxsize=8)
def _pool(model: pin.Model, still: tuple[int, ...], angles: tuple[float, ...]) -> pin.ModelPool:
    """A model in which joints that stand still are rigid, with a pool of all OpenMP threads.

    Joints that never move, such as those of the hands, only add their masses to the dynamics.
    """
    reference = pin.neutral(model)
    reference[[7 + joint for joint in still]] = angles
    reduced = pin.buildReducedModel(model, [2 + joint for joint in still], reference)
    threads = os.environ.get("OMP_NUM_THREADS", "")
    return pin.ModelPool(reduced, int(threads) if threads.isdigit() else os.cpu_count() or 1)
