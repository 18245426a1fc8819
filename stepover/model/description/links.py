"""A robot as plain values: links with inertia and shapes, and the joints between them.

It is what `robots/` reads from a URDF, once. The multi-body model and every physics engine are built from it, so that
all of them see the same robot.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

REVOLUTE, PRISMATIC = "revolute", "prismatic"
"""Kinds of joints. Prismatic ones occur in the rubber under a sole only."""
BOX, CYLINDER, SPHERE, MESH = "box", "cylinder", "sphere", "mesh"
"""Kinds of shapes."""


@dataclass(frozen=True, eq=False)
class Place:
    """Where a frame lies in another one: rotation (3, 3) and translation (3,) [m]."""

    rotation: np.ndarray
    translation: np.ndarray

    def then(self, other: Place) -> Place:
        """A place that is seen from this one, as it is seen from where this one is."""
        return Place(self.rotation @ other.rotation, self.rotation @ other.translation + self.translation)


ORIGIN = Place(np.eye(3), np.zeros(3))


@dataclass(frozen=True, eq=False)
class Inertia:
    """Mass [kg], centre of mass (3,) [m] and inertia (3, 3) about it [kg m^2], in the axes of the link's frame."""

    mass: float
    centre: np.ndarray
    matrix: np.ndarray

    def placed(self, place: Place) -> Inertia:
        """The same seen from the frame in which its own one lies at a place."""
        turn = place.rotation
        return Inertia(self.mass, turn @ self.centre + place.translation, turn @ self.matrix @ turn.T)

    def plus(self, other: Inertia) -> Inertia:
        """Both as one body."""
        return self._joined([other], 1.0)

    def minus(self, others: list[Inertia]) -> Inertia:
        """What is left when others are taken out."""
        return self._joined(others, -1.0)

    def _joined(self, others: list[Inertia], sign: float) -> Inertia:
        """This body, and others with a sign."""
        mass = self.mass + sign * sum(other.mass for other in others)
        centre = (self.mass * self.centre + sign * sum(other.mass * other.centre for other in others)) / mass
        matrix = self.matrix + _steiner(self.mass, self.centre - centre)
        for other in others:
            matrix = matrix + sign * other.matrix + sign * _steiner(other.mass, other.centre - centre)
        return Inertia(mass, centre, matrix)


@dataclass(frozen=True, eq=False)
class Solid:
    """A convex shape that a link collides with.

    Attributes:
        kind: BOX, CYLINDER, SPHERE or MESH.
        size: sides of a box, radius and length of a cylinder, radius of a sphere [m]; empty for a mesh.
        place: in the link's frame.
        corners: (V, 3) corners of its convex hull in its own frame [m]; of a hull around a cylinder or sphere.
        name: of the element or file that it comes from, for messages.
    """

    kind: str
    size: tuple[float, ...]
    place: Place
    corners: np.ndarray
    name: str


@dataclass(frozen=True, eq=False)
class Link:
    """A rigid body with its shapes."""

    name: str
    inertia: Inertia
    solids: tuple[Solid, ...] = ()


@dataclass(frozen=True, eq=False)
class Hinge:
    """A joint of one degree of freedom.

    Attributes:
        name, parent, child: names of the joint and of the links that it connects.
        place: of the joint's frame, and of the child's frame at angle 0, in the parent link's frame.
        axis: (3,) unit vector in the joint's frame.
        lower, upper: range [rad].
        speed_limit, torque_limit: [rad/s], [N m].
        kind: REVOLUTE; PRISMATIC in m, m/s, N.
        mimic: the joint that it follows, a factor and an offset [rad]; None for a joint of its own.
    """

    name: str
    parent: str
    child: str
    place: Place
    axis: np.ndarray
    lower: float
    upper: float
    speed_limit: float
    torque_limit: float
    kind: str = REVOLUTE
    mimic: tuple[str, float, float] | None = None


@dataclass(frozen=True, eq=False)
class Description:
    """All links, the root first, and the joints that connect them as a tree."""

    name: str
    links: tuple[Link, ...]
    joints: tuple[Hinge, ...]

    @cached_property
    def link_by_name(self) -> dict[str, Link]:
        """Links by their names."""
        return {link.name: link for link in self.links}

    @cached_property
    def joint_above(self) -> dict[str, Hinge]:
        """The joint that moves a link, by the link's name; none for the root."""
        return {joint.child: joint for joint in self.joints}

    @property
    def mass(self) -> float:
        """Of all links [kg]."""
        return sum(link.inertia.mass for link in self.links)

    def with_links(self, *changed: Link, joints: tuple[Hinge, ...] = ()) -> Description:
        """Some links changed, those that are new added at the end, with their joints."""
        known = {link.name: link for link in changed}
        old = tuple(known.pop(link.name, link) for link in self.links)
        return replace(self, links=(*old, *known.values()), joints=(*self.joints, *joints))


def _steiner(mass: float, lever: np.ndarray) -> np.ndarray:
    """Inertia (3, 3) of a point mass at a lever (3,)."""
    return np.asarray(mass * (lever @ lever * np.eye(3) - np.outer(lever, lever)))
