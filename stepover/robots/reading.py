"""How a table of robot.toml becomes its dataclass: every value checked as it is read."""

from __future__ import annotations

import sys
import types
from dataclasses import fields
from itertools import pairwise
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

from stepover.errors import InvalidInput

Section = TypeVar("Section")

SIGNED = {"contact_x", "contact_y", "front", "rear", "angles_deg", "leg1_pitch_deg"}
"""Keys whose values may be negative; all others must be positive, or zero where ZERO says so."""
ZERO = {
    "arms_start",
    "foothold_clearance",
    "knee_margin_deg",
    "leg1_extra_lift",
    "leg2_descent_drop",
    "leg2_extra_lift",
    "leg2_pitch_per_height_deg",
    "spare",
    "waist_delay",
    "waist_yaw_deg",
    "zmp_heel_from",
}
RISING = (
    ("sample_time", "double_support", "single_support"),
    ("sample_time", "double_support_over", "single_support_over"),
    ("step_length_min", "step_length_max"),
    ("step_length_step", "step_length_max"),
    ("rest", "leg1_rise", "leg1_top", "leg1_descent"),
    ("rest", "leg2_rise", "leg2_descent"),
    ("leg2_pitch_start", "leg2_pitch_full", "leg2_descent"),
    ("arms_start", "arms_back"),
    ("zmp_heel_from", "zmp_heel_until", "zmp_ahead_at"),
    ("leg2_rise", "leg2_descent", "leg2_over"),
    ("leg2_pitch_full", "leg2_descent"),
    ("lower_from", "lower_until"),
    ("raise_from", "raise_until"),
)
"""Keys of one table whose values must rise from each to the next."""
SHARES = {
    "rest", "leg1_descent", "leg2_descent", "arms_back", "arms_forth", "shift_peak", "raise_peak", "zmp_toe_at",
    "zmp_ahead_at", "loaded_share",
}  # fmt: skip
"""Keys whose values are shares that must be less than 1."""
RANGES = {"contact_x", "contact_y"}
"""Keys whose values are a lower and an upper end."""


def read_section(kind: type[Section], table: dict[str, Any], where: str) -> Section:
    """Turn one table of robot.toml into its dataclass.

    Raises:
        InvalidInput: a missing or unknown key, a value of the wrong type or sign, not finite, or out of order.
    """
    if not isinstance(table, dict):
        raise InvalidInput(f"{where} must be a table")
    hints = get_type_hints(kind)
    names = [field.name for field in fields(kind)]  # type: ignore[arg-type]
    for key in names:
        if key not in table:
            raise InvalidInput(f"{where} lacks the key {key!r}")
    for key in table:
        if key not in names:
            raise InvalidInput(f"{where} has an unknown key {key!r}; known are {', '.join(names)}")
    values = {key: _value(hints[key], table[key], f"{where}.{key}", key) for key in names}
    _check_order(values, where)
    return kind(**values)


def _check_order(values: dict[str, Any], where: str) -> None:
    """Refuse values of a table that contradict each other."""
    for keys in RISING:
        for low, high in pairwise(key for key in keys if key in values):
            less, more = values[low], values[high]
            if less >= more:
                raise InvalidInput(f"{where}.{low} = {less!r} must be less than {where}.{high} = {more!r}")
    for key in values:
        if key in SHARES and values[key] >= 1.0:
            raise InvalidInput(f"{where}.{key} = {values[key]!r} must be less than 1")
        if key in RANGES and values[key][0] >= values[key][1]:
            raise InvalidInput(f"{where}.{key} = {list(values[key])!r} must be a lower and a higher value")


def _value(hint: Any, raw: Any, where: str, key: str) -> Any:
    """Check one value against its type hint and turn lists into tuples."""
    if get_origin(hint) is tuple:
        inner = get_args(hint)
        if not isinstance(raw, list) or not raw or (Ellipsis not in inner and len(raw) != len(inner)):
            wanted = "one value or more" if Ellipsis in inner else f"{len(inner)}"
            raise InvalidInput(f"{where} = {raw!r} must be a list of {wanted}")
        return tuple(_value(inner[0], item, where, key) for item in raw)
    if get_origin(hint) is types.MappingProxyType:
        if not isinstance(raw, dict):
            raise InvalidInput(f"{where} must be a table of angles in degrees")
        return types.MappingProxyType({name: _value(float, item, f"{where}.{name}", key) for name, item in raw.items()})
    if hint is str:
        if not isinstance(raw, str) or not raw:
            raise InvalidInput(f"{where} = {raw!r} must be a name")
        return raw
    return _number(hint, raw, where, key)


def _number(hint: Any, raw: Any, where: str, key: str) -> float | int:
    """Check a number: its type, that it is finite, and its sign."""
    good_type = isinstance(raw, int) if hint is int else isinstance(raw, int | float)
    if isinstance(raw, bool) or not good_type or not abs(raw) <= sys.float_info.max:
        raise InvalidInput(f"{where} = {raw!r} must be a finite {'whole ' if hint is int else ''}number")
    if key not in SIGNED and (raw < 0 or (raw == 0 and key not in ZERO)):
        raise InvalidInput(f"{where} = {raw!r} must be {'zero or ' if key in ZERO else ''}positive")
    return hint(raw)
