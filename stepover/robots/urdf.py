"""One reading of a URDF: checked, links on fixed joints merged, axes normalised, meshes found and made convex.

What comes out is a `Description`. Nothing else in the project reads the file.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import numpy as np

from stepover.errors import InvalidInput
from stepover.model.description.links import Description, Hinge, Inertia, Link
from stepover.robots.files import read_text
from stepover.robots.findings import Findings
from stepover.robots.merging import merged
from stepover.robots.urdf_elements import attribute, inertia_of, number, origin_of, solid_of, vector

MOST_BYTES = 20_000_000
"""Largest URDF that is read."""
Part = TypeVar("Part")


def read_urdf(path: Path) -> tuple[Description, Findings]:
    """Read a URDF.

    Raises:
        InvalidInput: the file cannot be read, or the robot cannot be used: the first error, with file and element.
    """
    findings = Findings(str(path))
    root = _document(path)
    reader = _Reader(path, findings)
    links = [reader.link(element) for element in root.findall("link")]
    joints = [joint for joint in map(reader.joint, root.findall("joint")) if joint]
    for kind, names in (("link", [link.name for link in links]), ("joint", [joint.name for joint in joints])):
        for name in sorted({name for name in names if names.count(name) > 1}):
            findings.error(f"{kind} {name!r}", f"the name is used {names.count(name)} times; each {kind} needs its own")
    findings.require()
    description = Description(root.get("name", path.stem), tuple(links), tuple(joints))
    _require_tree(description, findings)
    findings.require()
    whole = merged(description, reader.fixed)
    for link in whole.links:
        if link.inertia.mass <= 0.0:
            findings.error(f"link {link.name!r}", "it has no mass, and is not fixed to a link that has: give it one")
    findings.require()
    return whole, findings


def _document(path: Path) -> ET.Element:
    """The document's root.

    Raises:
        InvalidInput: it is not XML, has a document type, or is not a URDF.
    """
    text = read_text(path, MOST_BYTES)
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise InvalidInput(f"{path}: a document type or entity is not read; a URDF needs none")
    try:
        root = ET.fromstring(text.encode())
    except (ET.ParseError, ValueError, LookupError) as error:
        raise InvalidInput(f"{path} is not well-formed XML: {error}") from error
    if root.tag != "robot":
        raise InvalidInput(f"{path} is not a URDF: its root is <{root.tag}>, not <robot>")
    if any(str(element.tag).startswith("{http://") and "xacro" in str(element.tag) for element in root.iter()):
        raise InvalidInput(f"{path} is a xacro file: 'xacro FILE > robot.urdf' makes a URDF of it")
    return root


class _Reader:
    """Reads elements, and keeps what is wrong with them.

    Attributes:
        fixed: names of the joints that are fixed.
    """

    def __init__(self, path: Path, findings: Findings) -> None:
        """Begin with a file."""
        self._path, self._findings = path, findings
        self.fixed: set[str] = set()
        self._notes: set[str] = set()

    def link(self, element: ET.Element) -> Link:
        """A link with what can be read of it."""
        name = element.get("name", "")
        where = f"link {name!r}"
        nothing = Inertia(0.0, np.zeros(3), np.zeros((3, 3)))
        inertia = self._part(where, lambda: inertia_of(element), nothing)
        solids = [
            self._part(where, lambda e=each: solid_of(e, self._path, name), None)  # type: ignore[misc]
            for each in element.findall("collision")
        ]
        return Link(name, inertia, tuple(solid for solid in solids if solid))

    def joint(self, element: ET.Element) -> Hinge | None:
        """A joint, revolute or fixed; None where it cannot be used."""
        where = f"joint {element.get('name', '')!r}"
        return self._part(where, lambda: self._joint(element), None)

    def _joint(self, element: ET.Element) -> Hinge:
        """A joint, or InvalidInput."""
        name, kind = attribute(element, "name"), attribute(element, "type")
        parent, child = (_end(element, end) for end in ("parent", "child"))
        place = origin_of(element)
        if kind == "fixed":
            self.fixed.add(name)
            return Hinge(name, parent, child, place, np.array([1.0, 0.0, 0.0]), 0.0, 0.0, 0.0, 0.0)
        if kind != "revolute":
            raise InvalidInput(f"its type is {kind!r}; only revolute joints with limits, and fixed ones, can be used")
        mimic = element.find("mimic")
        follows = None
        if mimic is not None:
            follows = attribute(mimic, "joint"), number(mimic, "multiplier", 1.0), number(mimic, "offset", 0.0)
        axis = element.find("axis")
        direction = np.array([1.0, 0.0, 0.0]) if axis is None else vector(axis, "xyz")
        length = float(np.linalg.norm(direction))
        if length < 1e-6:
            raise InvalidInput("its axis has no direction")
        if abs(length - 1.0) > 1e-9:
            direction = direction / length
            if abs(length - 1.0) > 1e-3:
                self._findings.note(f"joint {name!r}", f"its axis of length {length:g} is taken with length 1")
        return Hinge(name, parent, child, place, direction, *_limits(element), mimic=follows)

    def _part(self, where: str, read: Callable[[], Part], instead: Part) -> Part:
        """What a function reads; where it cannot, a finding and something instead."""
        try:
            return read()
        except InvalidInput as error:
            self._findings.error(where, str(error))
            return instead


def _end(element: ET.Element, end: str) -> str:
    """Name of the link at one end of a joint, "parent" or "child"."""
    found = element.find(end)
    if found is None:
        raise InvalidInput(f"it has no <{end}>")
    return attribute(found, "link")


def _limits(element: ET.Element) -> tuple[float, float, float, float]:
    """Range, speed limit and torque limit of a joint."""
    limit = element.find("limit")
    if limit is None:
        raise InvalidInput("it has no <limit>: lower, upper, velocity and effort are needed")
    lower, upper = (number(limit, name, 0.0) for name in ("lower", "upper"))
    speed, torque = (number(limit, name) for name in ("velocity", "effort"))
    if lower >= upper:
        raise InvalidInput(f"its range is {lower:g} to {upper:g}; lower must be less than upper")
    for name, value in (("velocity", speed), ("effort", torque)):
        if value <= 0.0:
            raise InvalidInput(f"its {name} limit is {value:g}; it must be positive")
    return lower, upper, speed, torque


def _require_tree(description: Description, findings: Findings) -> None:
    """Find links and joints that do not exist, links with two parents, and more roots than one."""
    known = {joint.name for joint in description.joints}
    for joint in description.joints:
        if joint.mimic and joint.mimic[0] not in known - {joint.name}:
            findings.error(f"joint {joint.name!r}", f"it mimics {joint.mimic[0]!r}, and there is no such joint")
    names, children = {link.name for link in description.links}, [joint.child for joint in description.joints]
    for joint in description.joints:
        for end in (joint.parent, joint.child):
            if end not in names:
                findings.error(f"joint {joint.name!r}", f"there is no link {end!r}")
        if children.count(joint.child) > 1:
            findings.error(f"joint {joint.name!r}", f"the link {joint.child!r} has more than one parent")
    roots = [link.name for link in description.links if link.name not in children]
    if len(roots) != 1:
        said = ", ".join(map(repr, roots)) or "none"
        findings.error("", f"a robot needs one root link that no joint moves; it has {said}")
        return
    reached, front = set(roots), roots
    while front:
        front = [joint.child for joint in description.joints if joint.parent in front and joint.child not in reached]
        reached.update(front)
    for name in sorted(names - reached):
        findings.error(f"link {name!r}", "no chain of joints leads to it from the root")
