"""What a physics engine is: a fresh world with a robot, a floor and obstacles, behind few methods.

Everything outside the folders of the engines works on this protocol alone. SI units; feet in the order left, right;
J joints in the order of q[7:], K obstacles in the order in which the scene names them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any, Protocol, Self, cast

import numpy as np

from stepover.errors import InvalidInput
from stepover.model.robot import Robot
from stepover.simulation.disturbances import NONE, Disturbances

FLOOR, NO_FOOT = -1, -1
"""What Contacts.touched and Contacts.foot say of the floor, and of a link that is no foot."""
NAMES = {"pybullet": "PyBullet", "mujoco": "MuJoCo"}
"""What the engines are called where people read."""
DEFAULT = "pybullet"
"""The engine of the paper's cases."""
_HOMES = {
    "pybullet": ("stepover.simulation.pybullet.world", "World"),
    "mujoco": ("stepover.simulation.mujoco.world", "World"),
}


@dataclass(frozen=True, eq=False)
class Scene:
    """What an engine is asked to build.

    Attributes:
        robot: the robot, with its parameters of the physics, the servos and the rubber.
        obstacles: rows of bare obstacles as a motion has them: front face x, width, height, ... [m]; where they
            really are.
        actuators: "ideal": motors that follow without limits; "limited": servos with stiffness, damping and limits.
        sole: "rigid", or "compliant": rubber between ankle and sole.
        disturbances: friction, slope and the chest's mass concern the engine.
    """

    robot: Robot
    obstacles: tuple[np.ndarray, ...] = ()
    actuators: str = "ideal"
    sole: str = "rigid"
    disturbances: Disturbances = NONE


@dataclass(frozen=True, eq=False)
class Contacts:
    """The n points where the robot bears on the floor or touches an obstacle, over some time steps, as arrays.

    Attributes:
        step: (n,) time step in which a point touches, counted from 0; in rising order.
        link: (n,) index in Engine.links of the robot's link.
        foot: (n,) 0 left, 1 right; NO_FOOT for every other link.
        touched: (n,) number of the obstacle, from 0; FLOOR for the floor.
        position: (n, 3) in the world, on the surface that is touched [m].
        force: (n, 3) on the robot, in the world's axes [N]; a point on the floor bears some.
        depth: (n,) of the overlap [m]; never negative on an obstacle.
    """

    step: np.ndarray
    link: np.ndarray
    foot: np.ndarray
    touched: np.ndarray
    position: np.ndarray
    force: np.ndarray
    depth: np.ndarray

    def floor_force(self, foot: int, step: int) -> np.ndarray:
        """Force (3,) of the floor on a foot, 0 left or 1 right, in one time step [N]."""
        bears = (self.step == step) & (self.touched == FLOOR) & (self.foot == foot)
        return np.asarray(self.force[bears].sum(axis=0))


_NONE, _NOWHERE = np.zeros(0, dtype=int), np.zeros((0, 3))
NO_CONTACTS = Contacts(_NONE, _NONE, _NONE, _NONE, _NOWHERE, _NOWHERE, np.zeros(0))
"""Nothing touches the robot."""


class Engine(Protocol):
    """A fresh world, built from a Scene; a context manager. Equal scenes and commands give equal results to the bit.

    A constructor that fails frees what it has taken. Each time step is one call of command, of push where something
    pushes, and of step; what can be read is the state after it.

    Attributes:
        scene: what it was built from.
        links: names of the robot's links; Contacts.link counts them. The plate under a bush bears the foot's name.
        bush_depth: from the ankle down to the bush of a compliant sole [m]; 0 on rigid soles.
    """

    scene: Scene
    links: tuple[str, ...]
    bush_depth: float

    @property
    def torque(self) -> np.ndarray:
        """Of the motors in the last step (J,) [N m]; zero before the first."""

    @property
    def saturated(self) -> np.ndarray:
        """Whether a limited motor gave all its torque in the last step: (J,) of bool."""

    def __enter__(self) -> Self: ...
    def __exit__(self, *_: object) -> None: ...

    def reset(self, q: np.ndarray) -> None:
        """Put the robot at rest at a configuration (nq,); rubber is pressed by half the weight on each foot."""

    def command(self, start: np.ndarray, end: np.ndarray, speed: np.ndarray) -> None:
        """Tell the motors how the joints shall move in the next step.

        Args:
            start: (J,) angles at its beginning [rad].
            end: (J,) angles at its end [rad].
            speed: (J,) in it [rad/s].
        """

    def push(self, force: np.ndarray) -> None:
        """Push the root link at its centre of mass during the next step: force (3,) in the world's axes [N]."""

    def step(self) -> None:
        """Let one time step of robot.simulation pass."""

    def contacts(self) -> Contacts:
        """The contact points of all steps since the last call, or since the reset; step 0 is the first of them."""

    def base_pose(self) -> np.ndarray:
        """Pose (7,) of the root link's frame in the world: place [m], unit quaternion x y z w."""

    def joints(self) -> np.ndarray:
        """Angles [rad] and speeds [rad/s] of all joints: (2, J)."""

    def imu(self) -> tuple[np.ndarray, np.ndarray]:
        """Of the root link: unit quaternion (4,) x y z w, and angular velocity (3,) in its own axes [rad/s]."""

    def ankle(self, foot: int) -> tuple[np.ndarray, np.ndarray]:
        """Place (3,) [m] and axes (3, 3), as columns, of the frame of a leg's last joint: 0 left, 1 right."""

    def bush(self) -> np.ndarray:
        """Deflections (6,) of the rubber: left up, roll, pitch, then right [m, rad]; zero on rigid soles."""

    def set_ground(self, foot: int, height: float) -> None:
        """Put the floor under a foot, 0 left or 1 right, at a height [m]; every other link keeps the floor at zero."""


def engine_named(name: str) -> Callable[[Scene], Engine]:
    """What builds an engine's world from a scene; the engine's library is loaded now.

    Raises:
        InvalidInput: there is no such engine, or its library is not installed.
    """
    if name not in _HOMES:
        raise InvalidInput(f"engine = {name!r} is not available; available: {', '.join(_HOMES)}")
    module, builder = _HOMES[name]
    found: Any = getattr(import_module(module), builder)
    return cast("Callable[[Scene], Engine]", found)
