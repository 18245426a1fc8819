"""The robot's URDF as the physics needs it: changed in memory, the file keeps its 30 joints.

For compliant soles each foot link is parted: the plate that touches the floor goes behind a rubber bush of three
passive joints, up and down, roll and pitch, in the middle of which the ankle's shadow falls. Both parts together keep
the foot's mass, centre of mass and inertia.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np

from stepover.errors import InvalidInput
from stepover.model.robot import Robot
from stepover.simulation.disturbances import Disturbances

BUSH = ("LIFT", "ROLL", "PITCH")
"""Names of a bush's joints behind that of its foot link, from the ankle down."""
AXES = {"LIFT": "0 0 1", "ROLL": "1 0 0", "PITCH": "0 1 0"}
NEAR_SOLE = 1e-3
"""m: a shape whose underside is as near to the sole belongs to the plate."""
SMALL = 1e-4
"""m^2: inertia over mass of what is between two joints of a bush, which has no size of its own."""


class Description:
    """A URDF that is changed in memory.

    Attributes:
        root: the document.
        passive: names of the bushes' joints, left foot first.
        bush_height: from the ankle down to the bush [m]; 0 without one.
    """

    def __init__(self, robot: Robot) -> None:
        """Read the file; meshes get absolute names, so that the text may lie anywhere."""
        self._robot = robot
        self.root = ET.parse(robot.folder / robot.urdf).getroot()
        self.passive: list[str] = []
        self.bush_height = 0.0
        for mesh in self.root.iter("mesh"):
            mesh.set("filename", str(robot.folder / mesh.get("filename", "")))

    def text(self) -> str:
        """The document as a string."""
        return ET.tostring(self.root, encoding="unicode")

    def link(self, name: str) -> ET.Element:
        """A link by its name."""
        return next(link for link in self.root.iter("link") if link.get("name") == name)

    def foot(self, side: int) -> str:
        """Name of the link behind the last joint of a leg: +1 left, -1 right."""
        last = (self._robot.legs.left if side > 0 else self._robot.legs.right)[-1]
        joint = next(joint for joint in self.root.iter("joint") if joint.get("name") == last)
        return _child(joint, "child").get("link", "")

    def chest(self) -> str:
        """Name of the heaviest link that moves with the chest's yaw."""
        joint_of = {_child(joint, "child").get("link"): joint for joint in self.root.iter("joint")}

        def moves(name: str | None) -> bool:
            while name in joint_of:
                if joint_of[name].get("name") == self._robot.upper_body.chest_yaw:
                    return True
                name = _child(joint_of[name], "parent").get("link")
            return False

        links = [link for link in self.root.iter("link") if moves(link.get("name"))]
        return max(links, key=lambda link: Piece.of(link).mass).get("name", "")

    def load(self, link: str, mass: float, shift: float) -> None:
        """Add mass [kg] at a link's centre of mass, and then move that ahead [m]."""
        inertial = _child(self.link(link), "inertial")
        weight, origin = _child(inertial, "mass"), _child(inertial, "origin")
        weight.set("value", repr(float(weight.get("value", "0")) + mass))
        place = _numbers(origin.get("xyz", "0 0 0"))
        origin.set("xyz", _text(place + np.array([shift, 0.0, 0.0])))

    def soften(self) -> None:
        """Put both soles on rubber."""
        for side in (1, -1):
            self._soften(self.foot(side))

    def _soften(self, foot: str) -> None:
        """Part one foot link."""
        rubber, link = self._robot.sole, self.link(foot)
        plate, top = self._plate(link)
        self.bush_height = -top
        masses = [rubber.bush_mass, rubber.bush_mass, rubber.mass]
        below = np.array([0.0, 0.0, top])
        pieces = [Piece(m, below, m * SMALL * np.eye(3)) for m in masses[:2]] + [_box(plate[0], rubber.mass)]
        rest = Piece.of(link).without(pieces)
        if rest.mass <= 0.0 or np.linalg.eigvalsh(rest.inertia).min() <= 0.0:
            raise InvalidInput(f"sole: what is left of {foot} would have no mass or inertia; make sole.mass smaller")
        rest.write(link)
        parent, places = foot, [below, np.zeros(3), np.zeros(3)]
        for name, piece, place in zip(BUSH, pieces, places, strict=True):
            child = f"{foot}_{name}"
            self.root.append(_joint(child, parent, place, AXES[name]))
            new = ET.SubElement(self.root, "link", name=child)
            piece.moved(-below).write(new)
            self.passive.append(child)
            parent = child
        for element in plate:
            link.remove(element)
            origin = _child(element, "origin")
            origin.set("xyz", _text(_numbers(origin.get("xyz", "0 0 0")) - below))
            new.append(element)

    def _plate(self, link: ET.Element) -> tuple[list[ET.Element], float]:
        """The shapes of a foot link that touch the floor, the one that may collide first, and where their top is."""
        found: list[tuple[ET.Element, float]] = []
        for kind in ("collision", "visual"):
            for element in link.findall(kind):
                box = element.find("geometry/box")
                if box is None:
                    continue
                middle = _numbers(_child(element, "origin").get("xyz", "0 0 0"))[2]
                half = _numbers(box.get("size", ""))[2] / 2.0
                if abs(middle - half + self._robot.foot.ankle_height) < NEAR_SOLE:
                    found.append((element, middle + half))
        if not found or found[0][0].tag != "collision":
            raise InvalidInput(f"a compliant sole needs a box at the underside of {link.get('name')}")
        return [element for element, _ in found], found[0][1]


def describe(robot: Robot, sole: str, disturbances: Disturbances) -> Description:
    """The URDF as it is to be simulated, with a "rigid" or a "compliant" sole."""
    description = Description(robot)
    if disturbances.loads:
        description.load(description.chest(), disturbances.chest_mass * robot.body.mass, disturbances.chest_com_x)
    if sole == "compliant":
        description.soften()
    return description


class Piece:
    """A rigid body: mass [kg], centre of mass (3,) [m], inertia (3, 3) about that [kg m^2], in a link's frame."""

    def __init__(self, mass: float, centre: np.ndarray, inertia: np.ndarray) -> None:
        """Put it together."""
        self.mass, self.centre, self.inertia = mass, centre, inertia

    @staticmethod
    def of(link: ET.Element) -> Piece:
        """What a link's inertial says; its frame must be parallel to the link's."""
        inertial = _child(link, "inertial")
        origin, inertia = _child(inertial, "origin"), _child(inertial, "inertia")
        if np.any(_numbers(origin.get("rpy", "0 0 0"))):
            raise InvalidInput(f"a compliant sole needs an inertia of {link.get('name')} in the link's own axes")
        xx, yy, zz, xy, xz, yz = (float(inertia.get(f"i{axes}", "0")) for axes in ("xx", "yy", "zz", "xy", "xz", "yz"))
        matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        return Piece(float(_child(inertial, "mass").get("value", "0")), _numbers(origin.get("xyz", "")), matrix)

    def moved(self, by: np.ndarray) -> Piece:
        """The same, elsewhere."""
        return Piece(self.mass, self.centre + by, self.inertia)

    def without(self, others: list[Piece]) -> Piece:
        """What is left when others are taken out."""
        mass = self.mass - sum(other.mass for other in others)
        centre = (self.mass * self.centre - sum(other.mass * other.centre for other in others)) / mass
        about = self.inertia + _steiner(self.mass, self.centre - centre)
        for other in others:
            about = about - other.inertia - _steiner(other.mass, other.centre - centre)
        return Piece(mass, centre, about)

    def write(self, link: ET.Element) -> None:
        """Make it the inertial of a link."""
        for old in link.findall("inertial"):
            link.remove(old)
        inertial = ET.SubElement(link, "inertial")
        ET.SubElement(inertial, "origin", xyz=_text(self.centre))
        ET.SubElement(inertial, "mass", value=repr(float(self.mass)))
        m = self.inertia
        entries = {"ixx": m[0, 0], "iyy": m[1, 1], "izz": m[2, 2], "ixy": m[0, 1], "ixz": m[0, 2], "iyz": m[1, 2]}
        ET.SubElement(inertial, "inertia", {name: repr(float(value)) for name, value in entries.items()})


def _steiner(mass: float, lever: np.ndarray) -> np.ndarray:
    """Inertia (3, 3) of a point mass at a lever (3,)."""
    return mass * (lever @ lever * np.eye(3) - np.outer(lever, lever))


def _box(element: ET.Element, mass: float) -> Piece:
    """A homogeneous box, where a collision shape is."""
    box = element.find("geometry/box")
    sides = _numbers("" if box is None else box.get("size", "")) ** 2
    return Piece(mass, _numbers(_child(element, "origin").get("xyz", "")), mass / 12.0 * np.diag(sides.sum() - sides))


def _joint(name: str, parent: str, place: np.ndarray, axis: str) -> ET.Element:
    """A passive joint to a link of the same name; its limits are never reached."""
    joint = ET.Element("joint", name=name, type="prismatic" if name.endswith("LIFT") else "revolute")
    ET.SubElement(joint, "parent", link=parent)
    ET.SubElement(joint, "child", link=name)
    ET.SubElement(joint, "origin", xyz=_text(place))
    ET.SubElement(joint, "axis", xyz=axis)
    ET.SubElement(joint, "limit", lower="-1", upper="1", velocity="1e3", effort="1e6")
    return joint


def _child(element: ET.Element, name: str) -> ET.Element:
    """A child that must be there."""
    found = element.find(name)
    if found is None:
        raise InvalidInput(f"the URDF's {element.tag} {element.get('name', '')} has no <{name}>")
    return found


def _numbers(text: str) -> np.ndarray:
    """Numbers of an attribute."""
    return np.array([float(x) for x in text.split()])


def _text(numbers: np.ndarray) -> str:
    """An attribute of numbers."""
    return " ".join(repr(float(x)) for x in numbers)
