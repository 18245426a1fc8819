"""How a table of robot.toml becomes its dataclass: every value is checked by what its field knows."""

from __future__ import annotations

import re
import sys
import types
from collections.abc import Mapping
from dataclasses import MISSING, Field, fields
from difflib import get_close_matches
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

from stepover.errors import InvalidInput
from stepover.model.parameters.entry import MODEL, Entry, entry_of

Section = TypeVar("Section")
NEAR = 0.1
"""An override may differ by this share from what the model says."""


class WrongEntry(InvalidInput):
    """A table or a value of robot.toml that makes no sense.

    Attributes:
        places: the tables and keys that it is about, such as walk.lift; the first that the file has is at fault.
    """

    def __init__(self, message: str, *places: str) -> None:
        super().__init__(message)
        self.places = places


def read_section(
    kind: type[Section], table: Mapping[str, Any], where: str, defaults: Mapping[str, Any] | None = None
) -> Section:
    """Turn one table of robot.toml into its dataclass.

    Args:
        kind: the dataclass; its fields come from parameters.entry.
        table: as the file has it.
        where: the table's name.
        defaults: values of fields that the table leaves out, instead of the dataclass's own.

    Raises:
        WrongEntry: a missing or unknown key, a value of the wrong type, sign or size, not finite, or out of order.
    """
    if not isinstance(table, dict):
        raise WrongEntry(f"{where} must be a table", where)
    known: dict[str, Field[Any]] = {field.name: field for field in fields(kind)}  # type: ignore[arg-type]
    require_known(table, list(known), where)
    hints, values = get_type_hints(kind), dict(defaults or {})
    for key, field in known.items():
        if key in table:
            values[key] = _value(hints[key], table[key], f"{where}.{key}", entry_of(field))
            _require_near(values[key], (defaults or {}).get(key), f"{where}.{key}", entry_of(field))
        elif key not in values and field.default is MISSING:
            raise WrongEntry(f"{where} lacks the key {key!r}: {entry_of(field).reason}", where)
    section = kind(**values)
    _require_order(section, table, where)
    return section


def require_known(table: Mapping[str, Any], names: list[str], where: str = "") -> None:
    """Refuse keys of a table that mean nothing."""
    for key in table:
        if key not in names:
            near = get_close_matches(key, names, 1)
            meant = f"did you mean {near[0]!r}? " if near else ""
            message = f"{where} has an unknown key {key!r}: {meant}known are {', '.join(names)}"
            raise WrongEntry(message.strip(), f"{where}.{key}".strip("."))


def line_of(text: str, place: str) -> int | None:
    """The line of a file's text that a table or a key such as walk.lift is on, or None."""
    table = ""
    for number, line in enumerate(text.splitlines(), 1):
        if found := re.match(r'\s*\[\s*([A-Za-z_"][^\[\]]*)\]', line):
            table = name = found[1].replace('"', "").strip()
        elif found := re.match(r"\s*([^\s=#\[\]]+)\s*=", line):
            name = f"{table}.{found[1]}".replace('"', "").strip(".")
        else:
            continue
        if name == place:
            return number
    return None


def _require_order(section: Any, table: Mapping[str, Any], where: str) -> None:
    """Refuse values of a table that contradict each other."""
    for field in fields(section):
        entry, low, less = entry_of(field), f"{where}.{field.name}", getattr(section, field.name)
        for name in entry.below:
            high, more = f"{where}.{name}", getattr(section, name)
            if less >= more:
                shown = [f"{less!r}", f"{more!r}"]
                for k, key in enumerate((field.name, name)):
                    shown[k] += "" if key in table else " (the default)"
                raise WrongEntry(f"{low} = {shown[0]} must be less than {high} = {shown[1]}", low, high)
        if entry.rising and less[0] >= less[1]:
            raise WrongEntry(f"{low} = {list(less)!r} must be a lower and a higher value", low)


def _require_near(value: Any, derived: Any, where: str, entry: Entry) -> None:
    """Refuse an override that is far off what the model says."""
    if entry.scale == MODEL and derived is not None and abs(value - derived) > NEAR * derived:
        raise WrongEntry(
            f"{where} = {value!r} is far from {derived:.4g} {entry.unit}, which follows from the URDF: "
            f"leave it out, or stay within {NEAR:.0%}", where,
        )  # fmt: skip


def _value(hint: Any, raw: Any, where: str, entry: Entry) -> Any:
    """Check one value against its type hint and turn lists into tuples."""
    if get_origin(hint) is tuple:
        inner = get_args(hint)
        if not isinstance(raw, list) or not raw or (Ellipsis not in inner and len(raw) != len(inner)):
            wanted = "one value or more" if Ellipsis in inner else f"{len(inner)}"
            raise WrongEntry(f"{where} = {raw!r} must be a list of {wanted}", where)
        return tuple(_value(inner[0], item, where, entry) for item in raw)
    if get_origin(hint) is types.MappingProxyType:
        if not isinstance(raw, dict):
            raise WrongEntry(f"{where} must be a table of angles in degrees", where)
        return types.MappingProxyType(
            {name: _value(float, item, f"{where}.{name}", entry) for name, item in raw.items()}
        )
    if hint is str:
        if not isinstance(raw, str) or not raw:
            raise WrongEntry(f"{where} = {raw!r} must be a name", where)
        return raw
    return _number(hint, raw, where, entry)


def _number(hint: Any, raw: Any, where: str, entry: Entry) -> float | int:
    """Check a number: its type, that it is finite, its sign and its size."""
    good_type = isinstance(raw, int) if hint is int else isinstance(raw, int | float)
    if isinstance(raw, bool) or not good_type or not abs(raw) <= sys.float_info.max:
        raise WrongEntry(f"{where} = {raw!r} must be a finite {'whole ' if hint is int else ''}number", where)
    zero = entry.sign == "not negative"
    if entry.sign != "any" and (raw < 0 or (raw == 0 and not zero)):
        raise WrongEntry(f"{where} = {raw!r} must be {'zero or ' if zero else ''}positive", where)
    if entry.unit == "share" and raw >= 1.0:
        raise WrongEntry(f"{where} = {raw!r} must be less than 1: it is a share", where)
    unit = "" if entry.unit == "count" else f" {entry.unit}"
    if abs(raw) > entry.limit:
        raise WrongEntry(f"{where} = {raw!r} must be {entry.limit:g}{unit} at most", where)
    if entry.least is not None and raw < entry.least:
        raise WrongEntry(f"{where} = {raw!r} must be {entry.least:g}{unit} at least", where)
    return hint(raw)
