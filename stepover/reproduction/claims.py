"""The paper's claims: the statement of each one, and the rule that judges a number.

data/claims.toml holds one table for each claim. A notebook records its numbers (recorder.py), and `make reproduce`
gathers the records (verdicts.py).
"""

from __future__ import annotations

import dataclasses
import math
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from stepover.errors import InvalidInput
from stepover.locations import data_folder

HOLDS, DIFFERS, UNTESTED = VERDICTS = ("holds", "differs", "cannot be tested here")
PRINTED, OURS, CONSTRUCTION = KINDS = ("printed", "ours", "construction")
"""What judges a claim: a bound that the paper prints, a bound of ours, or nothing, as it is true by construction."""
SLACK = 1e-9
"""Tolerance for rounding errors, as a share of the bound."""

RULES: Mapping[str, Callable[[float, float, float], bool]] = MappingProxyType(
    {
        "within": lambda x, bound, tolerance: abs(x - bound) <= tolerance + SLACK * abs(bound),
        "ratio": lambda x, bound, tolerance: abs(x - bound) <= (tolerance + SLACK) * abs(bound),
        "at most": lambda x, bound, tolerance: x <= bound + tolerance + SLACK * abs(bound),
        "at least": lambda x, bound, tolerance: x >= bound - tolerance - SLACK * abs(bound),
        "below": lambda x, bound, tolerance: x < bound - tolerance,
        "above": lambda x, bound, tolerance: x > bound + tolerance,
    }
)
"""The comparisons by name. Others: "between" (from the first bound to below the second) and "text" (equal)."""


@dataclass(frozen=True)
class Claim:
    """One claim of the paper.

    Attributes:
        id: its name.
        section: of the paper.
        statement: of the paper, in our words.
        paper: the paper's number, numbers, or word.
        unit: of the numbers.
        judged_by: one of KINDS. What is true by construction is a setting, not a finding: no tally counts it.
        compare: one of RULES, "between" or "text".
        bound: the value to compare with, if it is not `paper`.
        tolerance: in the unit; for "ratio" a share.
        notebook: measures it.
        figure: shows it; "" if there is none.
        varies: whether the number depends on the machine.
    """

    id: str
    section: str
    statement: str
    paper: Any
    judged_by: str
    compare: str
    notebook: str
    unit: str = ""
    bound: Any = None
    tolerance: float = 0.0
    figure: str = ""
    varies: bool = False

    def __post_init__(self) -> None:
        """Refuse a claim that cannot be judged."""
        for name in ("section", "statement", "notebook", "unit", "figure", "compare"):
            if not isinstance(getattr(self, name), str) or (name in _REQUIRED and not getattr(self, name)):
                raise InvalidInput(f"claim {self.id!r}: {name} = {getattr(self, name)!r} must be a text")
        if self.judged_by not in KINDS:
            raise InvalidInput(f"claim {self.id!r}: judged_by = {self.judged_by!r} must be one of {', '.join(KINDS)}")
        if self.compare not in (*RULES, "between", "text"):
            raise InvalidInput(f"claim {self.id!r}: compare = {self.compare!r} must be one of {', '.join(RULES)}, "
                               "between, text")  # fmt: skip
        if not _is_number(self.tolerance) or self.tolerance < 0.0:
            raise InvalidInput(f"claim {self.id!r}: tolerance = {self.tolerance!r} must be a number, 0 or more")
        bounds, text = _listed(self.compared_with), self.compare == "text"
        if not bounds or not all(isinstance(one, str) if text else _is_number(one) for one in bounds):
            raise InvalidInput(f"claim {self.id!r}: {self.compare!r} compares with {'texts' if text else 'numbers'}, "
                               f"not with {self.compared_with!r}")  # fmt: skip
        if self.compare == "between" and (len(bounds) != 2 or bounds[0] >= bounds[1]):
            raise InvalidInput(f"claim {self.id!r}: 'between' takes two bounds, the lower one first")

    @property
    def compared_with(self) -> Any:
        """The bound, or the paper's value if there is no bound."""
        return self.paper if self.bound is None else self.bound

    def holds(self, measured: Any) -> bool:
        """Whether a number or text, or each item of a list, satisfies the rule. NaN and infinity never do."""
        values, bounds = _listed(measured), _listed(self.compared_with)
        if self.compare == "between":
            return all(_is_number(x) and bounds[0] <= x < bounds[1] for x in values)
        if len(bounds) not in (1, len(values)) or not values:
            raise InvalidInput(f"claim {self.id!r}: {len(values)} values are measured, {len(bounds)} are compared with")
        pairs = zip(values, bounds * (len(values) // len(bounds)), strict=True)
        if self.compare == "text":
            return all(x == bound for x, bound in pairs)
        return all(_is_number(x) and RULES[self.compare](x, bound, self.tolerance) for x, bound in pairs)


_REQUIRED = ("section", "statement", "notebook", "judged_by", "compare")


def read_claims(path: Path | None = None) -> dict[str, Claim]:
    """All claims by their id, in the order of the file; data/claims.toml unless another file is given.

    Raises:
        InvalidInput: the file cannot be read, or a claim has a missing, unknown or wrong key.
    """
    path = path or data_folder() / "claims.toml"
    try:
        tables = tomllib.loads(path.read_text())
    except OSError as error:
        raise InvalidInput(f"{path} cannot be read: {error.strerror}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InvalidInput(f"{path} is not valid TOML: {error}") from error
    known = {field.name for field in dataclasses.fields(Claim)} - {"id"}
    for name, row in tables.items():
        if not isinstance(row, dict):
            raise InvalidInput(f"{path}: {name} must be a table with the claim's id for its name")
        wrong = [f"lacks the key {key!r}" for key in (*_REQUIRED, "paper") if key not in row]
        wrong += [f"has an unknown key {key!r}" for key in row if key not in known]
        if wrong:
            raise InvalidInput(f"{path}: claim {name!r} {wrong[0]}")
    try:
        return {name: Claim(id=name, **row) for name, row in tables.items()}
    except InvalidInput as error:
        raise InvalidInput(f"{path}: {error}") from error


def _listed(value: Any) -> list[Any]:
    """A list as it is, any other value as a list of one item."""
    return value if isinstance(value, list) else [value]


def _is_number(value: Any) -> bool:
    """Whether a value is a finite number and not a bool."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
