"""Contact points out of MuJoCo: copied after each step, and made sense of once for many steps, which is faster."""

from __future__ import annotations

import numpy as np

from stepover.simulation.engine import FLOOR, NO_CONTACTS, NO_FOOT, Contacts
from stepover.simulation.mujoco.model import foot_of, mujoco
from stepover.simulation.simulated import SimulatedRobot

ROOM = 64
"""Points for which there is room at first; it doubles when there are more."""
RAW = np.dtype([("geom", "i4", 2), ("dist", "f8"), ("pos", "f8", 3), ("frame", "f8", 9), ("efc_address", "i4")])
"""What is copied of a contact point, by MuJoCo's names."""


class Touching:
    """Collects the contact points of time steps."""

    def __init__(self, model: mujoco.MjModel, robot: SimulatedRobot, obstacles: int) -> None:
        """Learn links, feet and obstacles by MuJoCo's numbers of shapes."""
        names = [model.body(1 + k).name for k in range(len(robot.description.links))]
        body = model.geom_bodyid - 1
        self._link = np.where(body < len(names), body, -1)
        self._foot = np.array([*(foot_of(robot, name) for name in names), NO_FOOT])[self._link]
        self._touched = np.full(model.ngeom, FLOOR)
        for number in range(obstacles):
            self._touched[model.geom(f"obstacle {number}").id] = number
        self._raw = np.zeros(0, dtype=RAW)
        self._make_room(ROOM)
        self.forget()

    def forget(self) -> None:
        """Begin anew, with step 0."""
        self._ends, self._forces = [0], list[np.ndarray]()

    def note(self, data: mujoco.MjData) -> None:
        """Copy the points of the step that has passed."""
        begin, count = self._ends[-1], data.ncon
        end = begin + count
        self._ends.append(end)
        if end > len(self._raw):
            self._make_room(2 * end)
        if count:
            contact = data.contact
            for name, column in self._columns:
                column[begin:end] = getattr(contact, name)
            self._forces.append(data.efc_force.copy())

    def contacts(self) -> Contacts:
        """The points that bore on the floor, or touched an obstacle, since it began anew; and begin anew."""
        ends, forces, raw = np.array(self._ends), self._forces, self._raw[: self._ends[-1]]
        self.forget()
        if not len(raw):
            return NO_CONTACTS
        counts, geom, address = ends[1:] - ends[:-1], raw["geom"], raw["efc_address"]
        swapped = self._link[geom[:, 0]] >= 0
        other, own = np.where(swapped, geom.T[::-1], geom.T) if swapped.any() else geom.T
        row = address + np.repeat(np.cumsum([0, *map(len, forces[:-1])]), counts[counts > 0])
        local = np.concatenate(forces)[np.where(address < 0, 0, row)[:, None] + np.arange(3)]
        force = (local[:, None] @ raw["frame"].reshape(-1, 3, 3))[:, 0]  # on the second shape
        force[swapped] *= -1.0
        touched = self._touched[other]
        kept = np.where(touched == FLOOR, force[:, 2] > 0.0, raw["dist"] <= 0.0) & (address >= 0)
        step, depth = np.repeat(np.arange(len(counts)), counts), np.maximum(-raw["dist"], 0.0)
        parts = (step, self._link[own], self._foot[own], touched, raw["pos"].copy(), force, depth)
        return Contacts(*parts) if kept.all() else Contacts(*(part[kept] for part in parts))

    def _make_room(self, room: int) -> None:
        """Make room for more points; those in it stay."""
        larger = np.zeros(room, dtype=RAW)
        larger[: len(self._raw)] = self._raw
        self._raw = larger
        self._columns = [(name, larger[name]) for name in RAW.names or ()]
