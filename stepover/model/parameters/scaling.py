"""Scaling of HRP-2's defaults to another robot, by rules that compare the robots' legs, soles and masses.

A scaled value is rounded to two digits. All scaled defaults have two digits, so HRP-2 gets exactly its own values.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, fields
from typing import Any

from stepover.model.parameters.entry import MODEL, entry_of


@dataclass(frozen=True)
class Size:
    """Sizes of a robot that the rules compare.

    Attributes:
        leg: thigh, shank and ankle height [m].
        toe, heel: length of the contact patch ahead of the ankle and behind it [m].
        mass: mass of the whole robot [kg].
        straight_deg: angle of the knee joint at which the leg is straight, positive in the direction of bending [deg].
        above_hips: height of the root above the first joint of the leg [m].
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
    "1/leg": ("divided by the leg's length", lambda value, size: _two_digits(value * HRP2.leg / size.leg)),
    "waist": (
        "times the leg's length, plus the height of the root above the hips",
        lambda value, size: round(_two_digits(value * size.leg / HRP2.leg) + size.above_hips, 3),
    ),
    "knee": (
        "plus the knee angle at which the leg is straight",
        lambda value, size: round(max(value + size.straight_deg, 0.0), 1),
    ),
}
"""Each rule in words and as a function. The words count legs, soles and masses in units of HRP-2's."""


def scaled(kind: type[Any], size: Size, values: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """The defaults of a table for a robot of some size; or given values of HRP-2, scaled by the same rules."""
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
