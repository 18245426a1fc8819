"""How another robot's defaults follow from HRP-2's: rules that compare the two robots' legs, soles and masses.

A scaled value is rounded to two digits. All scaled defaults have two, so HRP-2 gets exactly its own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, fields
from typing import Any

from stepover.model.parameters.entry import MODEL, entry_of


@dataclass(frozen=True)
class Size:
    """What the rules compare.

    Attributes:
        leg: thigh, shank and ankle height [m].
        toe, heel: contact patch ahead of the ankle and behind it [m].
        mass: of the whole robot [kg].
        straight_deg: angle of the knee joint at which the leg is straight, positive the way it bends [deg].
        above_hips: root above the first joint of the leg [m].
    """

    leg: float
    toe: float
    heel: float
    mass: float
    straight_deg: float = 0.0
    above_hips: float = 0.0


HRP2 = Size(leg=0.705, toe=0.126, heel=0.096, mass=58.0)
"""The robot that the defaults belong to."""


def _two_digits(value: float) -> float:
    """A value rounded to two significant digits."""
    return float(f"{value:.2g}")


RULES: dict[str, tuple[str, Callable[[float, Size], float]]] = {
    "leg": ("times the leg's length", lambda value, size: _two_digits(value * size.leg / HRP2.leg)),
    "toe": ("times the sole ahead of the ankle", lambda value, size: _two_digits(value * size.toe / HRP2.toe)),
    "heel": ("times the sole behind the ankle", lambda value, size: _two_digits(value * size.heel / HRP2.heel)),
    "mass": ("times the mass", lambda value, size: _two_digits(value * size.mass / HRP2.mass)),
    "1/mass": ("divided by the mass", lambda value, size: _two_digits(value * HRP2.mass / size.mass)),
    "waist": (
        "times the leg's length, and as far as the root is above the hips more",
        lambda value, size: round(_two_digits(value * size.leg / HRP2.leg) + size.above_hips, 3),
    ),
    "knee": (
        "plus the knee angle at which the leg is straight",
        lambda value, size: round(max(value + size.straight_deg, 0.0), 1),
    ),
}
"""Each rule in words, with legs, soles and masses in units of HRP-2's, and as a function."""


def scaled(kind: type[Any], size: Size, values: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """The defaults of a table for a robot of some size; or HRP-2's values of some of its fields, scaled alike."""
    entries = {known.name: (known.default, entry_of(known)) for known in fields(kind)}
    if values is None:
        values = {name: default for name, (default, _) in entries.items() if default is not MISSING}
    return {name: _scaled(value, entries[name][1].scale, size) for name, value in values.items()}


def _scaled(value: Any, rule: str | None, size: Size) -> Any:
    """One value, or each of several."""
    if rule is None or rule == MODEL:
        return value
    if isinstance(value, tuple):
        return tuple(_scaled(part, rule, size) for part in value)
    return RULES[rule][1](value, size)
