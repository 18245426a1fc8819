"""What touches the robot, out of an engine's contact points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from stepover.simulation.engine import FLOOR, NO_FOOT, Contacts


class Touch(NamedTuple):
    """What touches the robot: means and findings over some steps.

    Attributes:
        feet: (2, 6) force [N] and moment about the world's origin [N m] of the floor on the left and right foot.
        total: (6,) the same of the floor on all links.
        others: links on the floor that are no feet.
        obstacle: links that touch the obstacle, with the largest depth [m] of each.
    """

    feet: np.ndarray
    total: np.ndarray
    others: set[str]
    obstacle: dict[str, float]


FEET = np.array([[0], [1]])
"""Left and right, as Contacts counts them."""
NOTHING = Touch(np.zeros((2, 6)), np.zeros(6), set(), {})
"""Nothing touches the robot."""


def summed_up(contacts: Contacts, links: Sequence[str], steps: int) -> Touch:
    """Means and findings over some steps.

    Args:
        contacts: of all the steps.
        links: names that Contacts.link counts.
        steps: how many steps they are of.
    """
    floor, depths = contacts.touched == FLOOR, dict[str, float]()
    if not floor.all():
        for link, depth in zip(contacts.link[~floor].tolist(), contacts.depth[~floor].tolist(), strict=True):
            depths[links[link]] = max(depth, depths.get(links[link], 0.0))
    wrenches = np.where(floor, _wrenches(contacts.position, contacts.force).T, 0.0).T / steps
    others = {links[link] for link in contacts.link[floor & (contacts.foot == NO_FOOT)].tolist()}
    return Touch((contacts.foot == FEET) @ wrenches, wrenches.sum(axis=0), others, depths)


def _wrenches(place: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Forces and moments (n, 6) about the world's origin of forces (n, 3) at places (n, 3)."""
    (px, py, pz), (fx, fy, fz) = place.T, force.T
    both = np.empty((len(force), 6))
    both[:, :3] = force
    both[:, 3], both[:, 4], both[:, 5] = py * fz - pz * fy, pz * fx - px * fz, px * fy - py * fx
    return both
