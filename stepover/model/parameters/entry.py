"""What is known of each value of a robot: its unit, why it is what it is, how it scales, and what it may be."""

from __future__ import annotations

from dataclasses import Field, dataclass, field
from typing import Any

MOST = {"m": 10.0, "s": 60.0, "deg": 180.0, "kg": 1000.0, "count": 10_000.0}
"""The largest value of a unit that makes sense: more is another unit, or a slip."""
MODEL = "model"
"""The rule of a value that follows from the URDF: what a file says must be near to it."""


@dataclass(frozen=True)
class Entry:
    """What is known of one value.

    Attributes:
        unit: "m", "s", "deg", "kg", "N m" ...; "share" is less than 1, "count" is whole, "" is text or a factor.
        reason: what the value is, and why it is as large as it is.
        source: "P" published, "D" derived, "E" estimated, and where: data/hrp2/README.md names the sources.
        scale: rule of parameters.scaling by which another robot's default follows from HRP-2's, or None.
        sign: "positive", "not negative" or "any".
        below: fields of the same table that must be more than this one.
        rising: whether the value is a lower and a higher end.
        least, most: bounds, where they are other than those of the sign and the unit.
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
        """The largest value that is allowed."""
        known = MOST.get(self.unit, float("inf")) if self.sign != "any" else float("inf")
        return known if self.most is None else self.most


def fact(unit: str, meaning: str, **more: Any) -> Any:
    """A field without default: only the robot's maker knows it. More arguments: see Entry."""
    return field(metadata={"entry": Entry(unit, meaning, **more)})


def parameter(default: Any, unit: str, reason: str, **more: Any) -> Any:
    """A field with HRP-2's value as its default. More arguments: see Entry."""
    return field(default=default, metadata={"entry": Entry(unit, reason, **more)})


def entry_of(known: Field[Any]) -> Entry:
    """What is known of a field."""
    entry: Entry = known.metadata["entry"]
    return entry
