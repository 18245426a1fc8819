"""What touches the robot, out of PyBullet's contact points."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


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


NOTHING = Touch(np.zeros((2, 6)), np.zeros(6), set(), {})
"""Nothing touches the robot."""


def summed_up(
    on_floor: list[tuple], on_obstacle: list[tuple], feet: dict[int, int], links: dict[int, str], steps: int
) -> Touch:
    """Means and findings over some steps.

    Args:
        on_floor: contact points that bear on the floor.
        on_obstacle: contact points that touch the obstacle.
        feet: row in Touch.feet by the index of a link.
        links: names by the index of a link.
        steps: time steps that the contacts are of.
    """
    wrenches = _wrenches(on_floor) / steps
    foot = np.array([feet.get(c[3], -1) for c in on_floor], dtype=int)
    each = np.array([wrenches[foot == row].sum(axis=0) for row in range(2)])
    others = {links[c[3]] for c in on_floor if c[3] not in feet}
    depths: dict[str, float] = {}
    for contact in on_obstacle:
        name = links[contact[3]]
        depths[name] = max(-contact[8], depths.get(name, 0.0))
    return Touch(each, wrenches.sum(axis=0), others, depths)


def _wrenches(contacts: list[tuple]) -> np.ndarray:
    """Forces and moments (C, 6) about the world's origin that contact points give to the robot."""
    if not contacts:
        return np.zeros((0, 6))
    numbers = np.array([(*c[6], *c[7], *c[11], *c[13], c[9], c[10], c[12]) for c in contacts])
    place, normal, first, second, sizes = (numbers[:, i : i + 3] for i in range(0, 15, 3))
    force = sizes[:, :1] * normal + sizes[:, 1:2] * first + sizes[:, 2:] * second
    (px, py, pz), (fx, fy, fz) = place.T, force.T
    return np.column_stack([force, py * fz - pz * fy, pz * fx - px * fz, px * fy - py * fx])
