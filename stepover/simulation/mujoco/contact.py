"""How MuJoCo solves contacts: the settings, with their reasons."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ContactSettings:
    """Contacts and their solver.

    Attributes:
        solref: time constant [s] and damping ratio. MuJoCo needs two time steps at least; its default, 20 ms, lets a
            landing foot sink by millimetres.
        solimp: impedance at first touch and beyond a depth, that depth [m], midpoint and power: hard from the start.
        friction_stiffness: how much stiffer friction is than the normal direction, so that no loaded foot creeps.
        iterations: of the solver at most; it ends when it has converged.
        tolerance: at which it has.
    """

    solref: tuple[float, float] = (0.004, 1.0)
    solimp: tuple[float, float, float, float, float] = (0.95, 0.99, 0.001, 0.5, 2.0)
    friction_stiffness: float = 10.0
    iterations: int = 100
    tolerance: float = 1e-10


CONTACT = ContactSettings()
