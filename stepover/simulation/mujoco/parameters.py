"""How contact is solved in MuJoCo."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Contact:
    """Contact and solver.

    Attributes:
        solref: time constant [s] and damping ratio of a contact: as stiff as two time steps of 1 ms allow twice over.
        solimp: impedance at touch, at width, width [m], midpoint, power: hard from the first micrometre on.
        iterations: of the solver at most; it ends when it has converged.
        tolerance: at which it has.
        friction_stiffness: how much stiffer friction is than the normal direction, so that feet do not creep.
    """

    solref: tuple[float, float] = (0.004, 1.0)
    solimp: tuple[float, float, float, float, float] = (0.95, 0.99, 0.001, 0.5, 2.0)
    iterations: int = 100
    tolerance: float = 1e-10
    friction_stiffness: float = 10.0
