"""Rigid parts of a URDF: their masses and inertias, and links on fixed joints made one with what they are fixed to.

PyBullet gives every link without an inertial 1 kg, and a robot's URDF has many of them: frames of sensors, of hands and
feet, a root without a body. Merged, the robot weighs what it weighs.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
from scipy.spatial.transform import Rotation

from stepover.errors import InvalidInput

Place = tuple[np.ndarray, np.ndarray]
"""Rotation (3, 3) and translation (3,) [m]."""


class Piece:
    """A rigid body: mass [kg], centre of mass (3,) [m], inertia (3, 3) about that [kg m^2], in a link's frame."""

    def __init__(self, mass: float, centre: np.ndarray, inertia: np.ndarray) -> None:
        """Put it together."""
        self.mass, self.centre, self.inertia = mass, centre, inertia

    @staticmethod
    def of(link: ET.Element) -> Piece:
        """What a link's inertial says."""
        inertial = child(link, "inertial")
        inertia = child(inertial, "inertia")
        turn, centre = place_of(inertial)
        xx, yy, zz, xy, xz, yz = (float(inertia.get(f"i{axes}", "0")) for axes in ("xx", "yy", "zz", "xy", "xz", "yz"))
        matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        return Piece(float(child(inertial, "mass").get("value", "0")), centre, turn @ matrix @ turn.T)

    def moved(self, by: np.ndarray) -> Piece:
        """The same, elsewhere."""
        return Piece(self.mass, self.centre + by, self.inertia)

    def placed(self, place: Place) -> Piece:
        """The same seen from a frame in which its own lies at a place."""
        turn, shift = place
        return Piece(self.mass, turn @ self.centre + shift, turn @ self.inertia @ turn.T)

    def with_also(self, other: Piece) -> Piece:
        """Both as one body."""
        return self.without([Piece(-other.mass, other.centre, -other.inertia)])

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
        ET.SubElement(inertial, "origin", xyz=text_of(self.centre))
        ET.SubElement(inertial, "mass", value=repr(float(self.mass)))
        m = self.inertia
        entries = {"ixx": m[0, 0], "iyy": m[1, 1], "izz": m[2, 2], "ixy": m[0, 1], "ixz": m[0, 2], "iyz": m[1, 2]}
        ET.SubElement(inertial, "inertia", {name: repr(float(value)) for name, value in entries.items()})


def merge_fixed(root: ET.Element) -> bool:
    """Make each link that is fixed to another a part of it, in place, and say whether there was one.

    Raises:
        InvalidInput: a link that then has no mass of its own.
    """
    links = {link.get("name", ""): link for link in root.findall("link")}
    fixed = [joint for joint in root.findall("joint") if joint.get("type") == "fixed"]
    for joint in fixed:
        name, whole = child(joint, "child").get("link", ""), links[child(joint, "parent").get("link", "")]
        _absorb(whole, links[name], place_of(joint))
        for other in root.findall("joint"):
            if child(other, "parent").get("link") == name:
                child(other, "parent").set("link", whole.get("name", ""))
                put(other, joined(place_of(joint), place_of(other)))
        root.remove(joint)
        root.remove(links[name])
        links[name] = whole
    for link in root.findall("link"):
        if link.find("inertial") is None or Piece.of(link).mass <= 0.0:
            raise InvalidInput(f"the URDF's link {link.get('name')!r} has no mass, and is not fixed to one that has")
    return bool(fixed)


def _absorb(whole: ET.Element, part: ET.Element, place: Place) -> None:
    """Give a link the mass and the shapes of another that is fixed to it at a place."""
    if part.find("inertial") is not None:
        piece = Piece.of(part).placed(place)
        if piece.mass > 0.0:
            bare = whole.find("inertial") is None or Piece.of(whole).mass <= 0.0
            (piece if bare else Piece.of(whole).with_also(piece)).write(whole)
    for kind in ("visual", "collision"):
        for shape in part.findall(kind):
            put(shape, joined(place, place_of(shape)))
            whole.append(shape)


def place_of(element: ET.Element) -> Place:
    """Where an element's origin is."""
    origin = element.find("origin")
    if origin is None:
        return np.eye(3), np.zeros(3)
    turn = numbers_of(origin.get("rpy", "0 0 0"))
    matrix = Rotation.from_euler("xyz", turn).as_matrix() if np.any(turn) else np.eye(3)
    return matrix, numbers_of(origin.get("xyz", "0 0 0"))


def put(element: ET.Element, place: Place) -> None:
    """Set an element's origin."""
    for old in element.findall("origin"):
        element.remove(old)
    turn, shift = place
    ET.SubElement(element, "origin", xyz=text_of(shift), rpy=text_of(Rotation.from_matrix(turn).as_euler("xyz")))


def joined(first: Place, second: Place) -> Place:
    """The second place, which is seen from the first."""
    return first[0] @ second[0], first[0] @ second[1] + first[1]


def child(element: ET.Element, name: str) -> ET.Element:
    """A child that must be there."""
    found = element.find(name)
    if found is None:
        raise InvalidInput(f"the URDF's {element.tag} {element.get('name', '')} has no <{name}>")
    return found


def numbers_of(text: str) -> np.ndarray:
    """Numbers of an attribute."""
    return np.array([float(x) for x in text.split()])


def text_of(numbers: np.ndarray) -> str:
    """An attribute of numbers."""
    return " ".join(repr(float(x)) for x in numbers)


def _steiner(mass: float, lever: np.ndarray) -> np.ndarray:
    """Inertia (3, 3) of a point mass at a lever (3,)."""
    return mass * (lever @ lever * np.eye(3) - np.outer(lever, lever))
