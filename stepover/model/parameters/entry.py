"""Descriptions of a robot's values: unit, reason, rule of scaling, and allowed range."""

from __future__ import annotations

from dataclasses import Field, dataclass, field
from typing import Any

MOST = {"m": 10.0, "s": 60.0, "deg": 180.0, "kg": 1000.0, "count": 10_000.0}
"""The largest sensible value for each unit. A larger one means another unit or a typing error."""
MODEL = "model"
"""The rule of a value that follows from the URDF. A value in a file must be near to it."""


@dataclass(frozen=True)
class Entry:
    """Description of one value.

    Attributes:
        unit: "m", "s", "deg", "kg", "N m" ...; "share" is less than 1, "count" is whole, "" is text or a factor.
        reason: meaning of the value, and the reason for its size.
        source: "P" published, "D" derived or "E" estimated, and the source; data/hrp2/README.md lists the sources.
        scale: rule in parameters.scaling that gives another robot's default from HRP-2's, or None.
        sign: "positive", "not negative" or "any".
        below: fields of the same table that must be larger than this one.
        rising: whether the value is a pair of a lower and a higher end.
        least, most: bounds, if they differ from those of the sign and the unit.
    """

    unit: str
    reason: str
    source: str = "E"
    scale: str | None = None
    sign: str = "positive"
    below: tuple[str, ...] = ()
    rising: bool = False
    least: float | None = None
    most: float | None = None

    @property
    def limit(self) -> float:
        """The largest allowed size of a value."""
        known = MOST.get(self.unit, float("inf"))
        return known if self.most is None else self.most


def fact(unit: str, meaning: str, **more: Any) -> Any:
    """A field without default, which only the robot's maker knows. See Entry for more arguments."""
    return field(metadata={"entry": Entry(unit, meaning, **more)})


def parameter(default: Any, unit: str, reason: str, **more: Any) -> Any:
    """A field with HRP-2's value as its default. See Entry for more arguments."""
    return field(default=default, metadata={"entry": Entry(unit, reason, **more)})


def entry_of(known: Field[Any]) -> Entry:
    """The description of a field."""
    entry: Entry = known.metadata["entry"]
    return entry
