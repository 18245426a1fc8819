"""A description as the text of a URDF: what pinocchio and PyBullet load.

Every number is written by repr, with a point, whatever the locale is.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterable

import numpy as np
from scipy.spatial.transform import Rotation

from stepover.model.description.links import (
    BOX,
    CYLINDER,
    MESH,
    Description,
    Hinge,
    Inertia,
    Link,
    Place,
    Solid,
)

MeshName = Callable[[Link, int], str]
"""Name of the file that holds the hull of a link's shape, by the link and the shape's number."""


def urdf_text(description: Description, mesh_name: MeshName | None = None) -> str:
    """The text of a URDF.

    Args:
        description: the robot.
        mesh_name: where the hulls of meshes lie; None leaves the shapes out.
    """
    root = ET.Element("robot", name=description.name)
    for link in description.links:
        element = ET.SubElement(root, "link", name=link.name)
        _inertial(element, link.inertia)
        for number, solid in enumerate(link.solids if mesh_name else ()):
            _collision(element, solid, mesh_name(link, number) if mesh_name and solid.kind == MESH else "")
    for joint in description.joints:
        _joint(root, joint)
    ET.indent(root)  # PyBullet reads lines of 1,023 characters at most
    return ET.tostring(root, encoding="unicode")


def numbers(values: Iterable[float]) -> str:
    """Numbers of an attribute, to the last bit."""
    return " ".join(repr(float(value)) for value in values)


def _inertial(link: ET.Element, inertia: Inertia) -> None:
    """Mass, centre and inertia of a link."""
    element = ET.SubElement(link, "inertial")
    ET.SubElement(element, "origin", xyz=numbers(inertia.centre))
    ET.SubElement(element, "mass", value=repr(float(inertia.mass)))
    m = inertia.matrix
    entries = {"ixx": m[0, 0], "iyy": m[1, 1], "izz": m[2, 2], "ixy": m[0, 1], "ixz": m[0, 2], "iyz": m[1, 2]}
    ET.SubElement(element, "inertia", {name: repr(float(value)) for name, value in entries.items()})


def _origin(element: ET.Element, place: Place) -> None:
    """Where an element lies."""
    turned = not np.array_equal(place.rotation, np.eye(3))
    angles = Rotation.from_matrix(place.rotation).as_euler("xyz") if turned else np.zeros(3)
    ET.SubElement(element, "origin", xyz=numbers(place.translation), rpy=numbers(angles))


def _collision(link: ET.Element, solid: Solid, mesh: str) -> None:
    """A shape that a link collides with."""
    element = ET.SubElement(link, "collision")
    _origin(element, solid.place)
    geometry = ET.SubElement(element, "geometry")
    if solid.kind == BOX:
        ET.SubElement(geometry, "box", size=numbers(solid.size))
    elif solid.kind == CYLINDER:
        ET.SubElement(geometry, "cylinder", radius=repr(solid.size[0]), length=repr(solid.size[1]))
    elif solid.kind == MESH:
        ET.SubElement(geometry, "mesh", filename=mesh)
    else:
        ET.SubElement(geometry, "sphere", radius=repr(solid.size[0]))


def _joint(root: ET.Element, joint: Hinge) -> None:
    """A joint."""
    element = ET.SubElement(root, "joint", name=joint.name, type=joint.kind)
    ET.SubElement(element, "parent", link=joint.parent)
    ET.SubElement(element, "child", link=joint.child)
    _origin(element, joint.place)
    ET.SubElement(element, "axis", xyz=numbers(joint.axis))
    limits = {"lower": joint.lower, "upper": joint.upper, "velocity": joint.speed_limit, "effort": joint.torque_limit}
    ET.SubElement(element, "limit", {name: repr(float(value)) for name, value in limits.items()})
