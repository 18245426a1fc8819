"""The robot as an engine simulates it: with a heavier chest, or with rubber between ankles and soles.

For compliant soles each foot link is parted: the plate that touches the floor goes behind a rubber bush of three
passive joints, up and down, roll and pitch, in the middle of which the ankle's shadow falls. Both parts together keep
the foot's mass, centre of mass and inertia.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from stepover.errors import InvalidInput
from stepover.model.description.links import (
    BOX,
    ORIGIN,
    PRISMATIC,
    REVOLUTE,
    Description,
    Hinge,
    Inertia,
    Link,
    Place,
    Solid,
)
from stepover.model.robot import Robot
from stepover.simulation.disturbances import Disturbances
from stepover.simulation.engine import Scene
from stepover.simulation.soles import BUSH, NEAR_SOLE

AXES = {"LIFT": (0.0, 0.0, 1.0), "ROLL": (1.0, 0.0, 0.0), "PITCH": (0.0, 1.0, 0.0)}
SMALL = 1e-4
"""m^2: inertia over mass of what is between two joints of a bush, which has no size of its own."""


@dataclass(frozen=True, eq=False)
class SimulatedRobot:
    """A robot as it is simulated.

    Attributes:
        description: links and joints.
        passive: names of the bushes' joints, and of the links behind them: the left foot's first.
        feet: names of the links of the left and the right foot.
        bush_depth: from the ankle down to the bush [m]; 0 on rigid soles.
    """

    description: Description
    passive: tuple[str, ...]
    feet: tuple[str, str]
    bush_depth: float


def simulated_robot(robot: Robot, sole: str, disturbances: Disturbances) -> SimulatedRobot:
    """The robot with a "rigid" or a "compliant" sole, and the disturbances of its chest."""
    description = robot.description
    if disturbances.loads:
        chest = _chest(robot)
        inertia = chest.inertia
        mass = inertia.mass + disturbances.chest_mass * robot.body.mass
        centre = inertia.centre + np.array([disturbances.chest_com_x, 0.0, 0.0])
        description = description.with_links(replace(chest, inertia=Inertia(mass, centre, inertia.matrix)))
    feet = tuple(_foot(robot, legs) for legs in (robot.legs.left, robot.legs.right))
    left, right = feet
    if sole != "compliant":
        return SimulatedRobot(description, (), (left, right), 0.0)
    depth = 0.0
    passive: list[str] = []
    for foot in feet:
        description, depth = _softened(robot, description, foot)
        passive += [f"{foot}_{name}" for name in BUSH]
    return SimulatedRobot(description, tuple(passive), (left, right), depth)


def require_mass(scene: Scene, mass: float, engine: str) -> None:
    """Refuse a robot that weighs something else in an engine than in pinocchio.

    Args:
        scene: with the robot.
        mass: in the engine [kg].
        engine: its name, for the message.
    """
    expected = scene.robot.body.mass * (1.0 + scene.disturbances.chest_mass)
    if abs(mass - expected) > 1e-6 * mass:
        raise InvalidInput(
            f"{scene.robot.urdf_path.name} weighs {mass:.3f} kg in {engine} and {expected:.3f} kg in pinocchio: "
            "every link needs an <inertial> with a mass"
        )


def _foot(robot: Robot, leg: tuple[str, ...]) -> str:
    """Name of the link behind the last joint of a leg."""
    return next(joint.child for joint in robot.description.joints if joint.name == leg[-1])


def _chest(robot: Robot) -> Link:
    """The heaviest link that moves with the chest's yaw."""
    above = robot.description.joint_above

    def moves(name: str) -> bool:
        while name in above:
            if above[name].name == robot.upper_body.chest_yaw:
                return True
            name = above[name].parent
        return False

    return max((link for link in robot.description.links if moves(link.name)), key=lambda link: link.inertia.mass)


def _softened(robot: Robot, description: Description, foot: str) -> tuple[Description, float]:
    """The description with one foot link parted, and how deep below the ankle its bush is [m].

    Raises:
        InvalidInput: the foot has no plate, or nothing is left of it beside the plate.
    """
    rubber, link = robot.sole, description.link_by_name[foot]
    solids = [shape for shape in link.solids if _touches(robot, shape)]
    if not solids:
        raise InvalidInput(f"a compliant sole needs a box at the underside of {foot}")
    top = solids[0].place.translation[2] + solids[0].size[2] / 2.0
    below = np.array([0.0, 0.0, top])
    bush = [Inertia(mass, below, mass * SMALL * np.eye(3)) for mass in (rubber.bush_mass, rubber.bush_mass)]
    pieces = [*bush, _of_box(solids[0], rubber.mass)]
    rest = link.inertia.minus(pieces)
    if rest.mass <= 0.0 or np.linalg.eigvalsh(rest.matrix).min() <= 0.0:
        raise InvalidInput(f"sole: what is left of {foot} would have no mass or inertia; make sole.mass smaller")
    up = Place(np.eye(3), -below)
    parts, joints, parent = [], [], foot
    for name, piece, place in zip(BUSH, pieces, (below, np.zeros(3), np.zeros(3)), strict=True):
        part = f"{foot}_{name}"
        joints.append(_passive(part, parent, place, AXES[name]))
        parts.append(Link(part, replace(piece, centre=piece.centre - below)))
        parent = part
    parts[-1] = replace(
        parts[-1],
        solids=tuple(replace(shape, place=up.then(shape.place)) for shape in solids),
    )
    whole = replace(
        link,
        inertia=rest,
        solids=tuple(shape for shape in link.solids if shape not in solids),
    )
    return description.with_links(whole, *parts, joints=tuple(joints)), -top


def _touches(robot: Robot, shape: Solid) -> bool:
    """Whether a shape of a foot is a box that touches the floor."""
    if shape.kind != BOX:
        return False
    return bool(abs(shape.place.translation[2] - shape.size[2] / 2.0 + robot.foot.ankle_height) < NEAR_SOLE)


def _of_box(box: Solid, mass: float) -> Inertia:
    """A homogeneous box, where a shape is."""
    squares = np.array(box.size) ** 2
    return Inertia(mass, box.place.translation, mass / 12.0 * np.diag(squares.sum() - squares))


def _passive(name: str, parent: str, place: np.ndarray, axis: tuple[float, float, float]) -> Hinge:
    """A joint of a bush, to a link of the same name; its limits are never reached."""
    kind = PRISMATIC if name.endswith("LIFT") else REVOLUTE
    return Hinge(name, parent, name, Place(ORIGIN.rotation, place), np.array(axis), -1.0, 1.0, 1e3, 1e6, kind)
