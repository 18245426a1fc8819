"""The elements of a URDF as values: numbers, places, inertias, shapes. Each refusal says what would be right."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from stepover.errors import InvalidInput
from stepover.model.description.corners import corners_of
from stepover.model.description.links import BOX, CYLINDER, MESH, ORIGIN, SPHERE, Inertia, Place, Solid
from stepover.robots.files import find_file
from stepover.robots.meshes import corners_of_mesh, require_solid

SIZES = {BOX: ("size",), CYLINDER: ("radius", "length"), SPHERE: ("radius",)}
"""Attributes of the shapes."""
LARGEST = 1e3
"""m, kg, kg m^2: no number of a walking robot's links is larger; one that is has another unit."""
WIDEST = 2.0
"""m: largest radius of gyration of a link."""
ROUNDED = 0.01
"""Share by which rounded inertias may miss the triangle inequality."""


def attribute(element: ET.Element, name: str) -> str:
    """An attribute that must be there."""
    value = element.get(name)
    if not value:
        raise InvalidInput(f"its <{element.tag}> has no {name}")
    return value


def number(element: ET.Element, name: str, default: float | None = None) -> float:
    """A finite number of plausible size.

    Raises:
        InvalidInput: it is missing and has no default, no number, not finite, or too large.
    """
    if default is not None and element.get(name) is None:
        return default
    return _number(attribute(element, name), f"{name} of its <{element.tag}>", 1e9)


def vector(element: ET.Element, name: str, count: int = 3) -> np.ndarray:
    """Some finite numbers (count,)."""
    parts = attribute(element, name).split()
    if len(parts) != count:
        raise InvalidInput(f"{name} of its <{element.tag}> is {element.get(name)!r}; {count} numbers are needed")
    return np.array([_number(part, f"{name} of its <{element.tag}>", LARGEST) for part in parts])


def _number(text: str, what: str, most: float) -> float:
    """A number, or InvalidInput."""
    try:
        value = float(text) if text.isascii() and "_" not in text else float("nan")
    except ValueError:
        value = float("nan")
    if not np.isfinite(value):
        comma = "; write a point, not a comma" if "," in text else ""
        raise InvalidInput(f"{what} is {text!r}; it must be a finite number{comma}")
    if abs(value) > most:
        raise InvalidInput(f"{what} is {text!r}; it must be at most {most:g}: lengths are in m, masses in kg")
    return value


def origin_of(element: ET.Element) -> Place:
    """Where an element lies."""
    origin = element.find("origin")
    if origin is None:
        return ORIGIN
    turn, shift = (vector(origin, name) if origin.get(name) else np.zeros(3) for name in ("rpy", "xyz"))
    return Place(Rotation.from_euler("xyz", turn).as_matrix() if np.any(turn) else np.eye(3), shift)


def inertia_of(link: ET.Element) -> Inertia:
    """Mass, centre and inertia of a link; without an inertial it has no mass.

    Raises:
        InvalidInput: a number is missing or wrong, or no body has such an inertia.
    """
    inertial = link.find("inertial")
    if inertial is None:
        return Inertia(0.0, np.zeros(3), np.zeros((3, 3)))
    mass_element, inertia = inertial.find("mass"), inertial.find("inertia")
    if mass_element is None:
        raise InvalidInput("its <inertial> has no <mass>")
    mass = number(mass_element, "value")
    if not 0.0 <= mass <= LARGEST:
        raise InvalidInput(f"its mass is {mass:g} kg; it must be zero or positive, and at most {LARGEST:g}")
    if inertia is None:
        if mass > 0.0:
            raise InvalidInput("its <inertial> has a mass and no <inertia>")
        return Inertia(0.0, np.zeros(3), np.zeros((3, 3)))
    xx, yy, zz = (number(inertia, f"i{axes}") for axes in ("xx", "yy", "zz"))
    xy, xz, yz = (number(inertia, f"i{axes}", 0.0) for axes in ("xy", "xz", "yz"))
    matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if mass > 0.0:
        _require_possible(mass, matrix)
    place = origin_of(inertial)
    if not np.array_equal(place.rotation, np.eye(3)):
        matrix = place.rotation @ matrix @ place.rotation.T
    return Inertia(mass, place.translation, matrix)


def _require_possible(mass: float, matrix: np.ndarray) -> None:
    """Refuse an inertia that no body of that mass has."""
    small, middle, large = np.linalg.eigvalsh(matrix)
    if small <= 0.0:
        raise InvalidInput(f"its inertia has the principal moment {small:.3g} kg m^2; all three must be positive")
    if large > (1.0 + ROUNDED) * (small + middle):
        raise InvalidInput(
            f"its principal moments are {small:.3g}, {middle:.3g} and {large:.3g} kg m^2; "
            "the largest must be at most the sum of the others"
        )
    if large > mass * WIDEST**2:
        raise InvalidInput(
            f"its inertia of {large:.3g} kg m^2 is that of a body more than {WIDEST:g} m wide: the unit is kg m^2"
        )


def solid_of(element: ET.Element, urdf: Path, link: str) -> Solid:
    """A shape to collide with.

    Raises:
        InvalidInput: an unknown kind, a size that is not positive, or a mesh that cannot be used.
    """
    kind, size, mesh = _geometry(element)
    name = element.get("name") or f"collision shape of {link}"
    if mesh is None:
        return Solid(kind, size, origin_of(element), corners_of(kind, size), name)
    path = find_file(attribute(mesh, "filename"), urdf.parent)
    corners = corners_of_mesh(path) * _scale(mesh)
    require_solid(corners, str(path))
    return Solid(MESH, (), origin_of(element), corners, path.name)


def _geometry(element: ET.Element) -> tuple[str, tuple[float, ...], ET.Element | None]:
    """Kind and size of a shape, and its element where it is a mesh."""
    geometry = element.find("geometry")
    shape = None if geometry is None else next(iter(geometry), None)
    if shape is None:
        raise InvalidInput(f"its <{element.tag}> has no shape")
    if shape.tag == MESH:
        return MESH, (), shape
    if shape.tag not in SIZES:
        raise InvalidInput(f"a shape of the kind {shape.tag!r} is not known; known are {', '.join(SIZES)} and mesh")
    size = vector(shape, "size") if shape.tag == BOX else np.array([number(shape, n) for n in SIZES[shape.tag]])
    if size.min() <= 0.0:
        raise InvalidInput(f"its {shape.tag} has the size {' '.join(f'{s:g}' for s in size)}; sizes must be positive")
    return str(shape.tag), tuple(size.tolist()), None


def _scale(mesh: ET.Element) -> np.ndarray:
    """Scale (3,) of a mesh; negative ones mirror it."""
    scale = vector(mesh, "scale") if mesh.get("scale") else np.ones(3)
    if (scale == 0.0).any():
        raise InvalidInput("the scale of its mesh is zero")
    return scale
