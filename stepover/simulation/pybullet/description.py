"""The robot's URDF as the physics needs it: changed in memory, the file stays as it is.

Links on fixed joints are merged into what they are fixed to. Meshes that may collide, unless they are obj, become the
convex hulls that the planner sees.

For compliant soles each foot link is parted: the plate that touches the floor goes behind a rubber bush of three
passive joints, up and down, roll and pitch, in the middle of which the ankle's shadow falls. Both parts together keep
the foot's mass, centre of mass and inertia.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

from stepover.errors import InvalidInput
from stepover.model.collision import hull_of_mesh
from stepover.model.robot import Robot
from stepover.robots.files import find_mesh
from stepover.simulation.disturbances import Disturbances
from stepover.simulation.pybullet.rigid import Piece, child, merge_fixed, numbers_of, text_of
from stepover.simulation.soles import BUSH, NEAR_SOLE

AXES = {"LIFT": "0 0 1", "ROLL": "1 0 0", "PITCH": "0 1 0"}
SMALL = 1e-4
"""m^2: inertia over mass of what is between two joints of a bush, which has no size of its own."""


class Description:
    """A URDF that is changed in memory.

    Attributes:
        root: the document.
        changed: whether it says something else than the file.
        hulls: texts of obj files by their names, which must lie beside the text.
        passive: names of the bushes' joints, left foot first.
        bush_height: from the ankle down to the bush [m]; 0 without one.
    """

    def __init__(self, robot: Robot) -> None:
        """Read the file, and merge what is fixed; meshes get absolute names, so that the text may lie anywhere."""
        self._robot = robot
        self.root = ET.parse(robot.urdf_path).getroot()
        self.passive: list[str] = []
        self.bush_height = 0.0
        self.hulls: dict[str, str] = {}
        for mesh in self.root.iter("mesh"):
            mesh.set("filename", str(find_mesh(mesh.get("filename", ""), robot.urdf_path)))
        merged = merge_fixed(self.root)
        for mesh in self.root.iterfind("link/collision/geometry/mesh"):
            self._make_convex(mesh)
        self.changed = merged or bool(self.hulls)

    def _make_convex(self, mesh: ET.Element) -> None:
        """Let a mesh be its convex hull, unless PyBullet reads it as coal does."""
        path = Path(mesh.get("filename", ""))
        if path.suffix.lower() == ".obj":
            return
        name = f"hull_{len(self.hulls)}.obj"
        corners, faces = hull_of_mesh(path)
        lines = [f"v {text_of(corner)}" for corner in corners] + [f"f {a} {b} {c}" for a, b, c in faces + 1]
        self.hulls[name] = "\n".join([*lines, ""])
        mesh.set("filename", name)

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
        return child(joint, "child").get("link", "")

    def chest(self) -> str:
        """Name of the heaviest link that moves with the chest's yaw."""
        joint_of = {child(joint, "child").get("link"): joint for joint in self.root.iter("joint")}

        def moves(name: str | None) -> bool:
            while name in joint_of:
                if joint_of[name].get("name") == self._robot.upper_body.chest_yaw:
                    return True
                name = child(joint_of[name], "parent").get("link")
            return False

        links = [link for link in self.root.iter("link") if moves(link.get("name"))]
        return max(links, key=lambda link: Piece.of(link).mass).get("name", "")

    def load(self, link: str, mass: float, shift: float) -> None:
        """Add mass [kg] at a link's centre of mass, and then move that ahead [m]."""
        self.changed = True
        inertial = child(self.link(link), "inertial")
        weight, origin = child(inertial, "mass"), child(inertial, "origin")
        weight.set("value", repr(float(weight.get("value", "0")) + mass))
        place = numbers_of(origin.get("xyz", "0 0 0"))
        origin.set("xyz", text_of(place + np.array([shift, 0.0, 0.0])))

    def soften(self) -> None:
        """Put both soles on rubber."""
        self.changed = True
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
            part = f"{foot}_{name}"
            self.root.append(_joint(part, parent, place, AXES[name]))
            new = ET.SubElement(self.root, "link", name=part)
            piece.moved(-below).write(new)
            self.passive.append(part)
            parent = part
        for element in plate:
            link.remove(element)
            origin = child(element, "origin")
            origin.set("xyz", text_of(numbers_of(origin.get("xyz", "0 0 0")) - below))
            new.append(element)

    def _plate(self, link: ET.Element) -> tuple[list[ET.Element], float]:
        """The shapes of a foot link that touch the floor, the one that may collide first, and where their top is."""
        found: list[tuple[ET.Element, float]] = []
        for kind in ("collision", "visual"):
            for element in link.findall(kind):
                box = element.find("geometry/box")
                if box is None:
                    continue
                middle = numbers_of(child(element, "origin").get("xyz", "0 0 0"))[2]
                half = numbers_of(box.get("size", ""))[2] / 2.0
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


def _box(element: ET.Element, mass: float) -> Piece:
    """A homogeneous box, where a collision shape is."""
    box = element.find("geometry/box")
    sides = numbers_of("" if box is None else box.get("size", "")) ** 2
    return Piece(mass, numbers_of(child(element, "origin").get("xyz", "")), mass / 12.0 * np.diag(sides.sum() - sides))


def _joint(name: str, parent: str, place: np.ndarray, axis: str) -> ET.Element:
    """A passive joint to a link of the same name; its limits are never reached."""
    joint = ET.Element("joint", name=name, type="prismatic" if name.endswith("LIFT") else "revolute")
    ET.SubElement(joint, "parent", link=parent)
    ET.SubElement(joint, "child", link=name)
    ET.SubElement(joint, "origin", xyz=text_of(place))
    ET.SubElement(joint, "axis", xyz=axis)
    ET.SubElement(joint, "limit", lower="-1", upper="1", velocity="1e3", effort="1e6")
    return joint
