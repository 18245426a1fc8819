"""The numbers that a notebook measures for the paper's claims. They go into a file beside its figures."""

from __future__ import annotations

import json
import math
import platform
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

from stepover import __version__
from stepover.errors import InvalidInput
from stepover.output import write_whole
from stepover.report.tables.table import Table, table
from stepover.reproduction.claims import DIFFERS, HOLDS, UNTESTED, VERDICTS, read_claims
from stepover.simulation.engine import NAMES

SUFFIX = ".claims.json"
"""Ending of the name of a record file."""
PACKAGES = ("numpy", "pin", "pybullet", "mujoco-core")
"""The packages whose versions a record keeps."""


class Recorder:
    """The records of one notebook. Each record is written at once, beside the notebook's figures."""

    def __init__(self, notebook: str, output: str | Path, known: Path | None = None, **parameters: object) -> None:
        """Start with no records.

        Args:
            notebook: its name.
            output: folder of its figures.
            known: file of the claims, data/claims.toml unless given.
            parameters: of the notebook; each record keeps them.
        """
        self.claims = {name: one for name, one in read_claims(known).items() if one.notebook == notebook}
        self.path = Path(output) / f"{notebook}{SUFFIX}"
        self.parameters, self.records = parameters, dict[str, dict[str, Any]]()
        self.versions = {"stepover": __version__, "python": platform.python_version()}
        self.versions |= {package: version(package) for package in PACKAGES}
        self._write()

    def record(
        self, claim: str, measured: Any, reason: str = "", verdict: str | None = None, **parameters: object
    ) -> None:
        """Record the measured value of a claim, in its unit. Its rule gives the verdict, unless one is given.

        A claim on the physics is measured in several engines. It holds if it holds in all of them.

        Args:
            claim: its id.
            measured: the value; or values by the name of the engine, that of the paper's cases first.
            reason: what the value depends on, or why it differs.
            verdict: one of VERDICTS, if the rule cannot judge.
            parameters: more than the notebook's.

        Raises:
            InvalidInput: this notebook has no such claim, the verdict is unknown, or it needs a reason.
        """
        if claim not in self.claims:
            raise InvalidInput(f"{self.path.name}: {claim!r} is no claim of this notebook: see data/claims.toml")
        one, values = self.claims[claim], plain(measured if isinstance(measured, Mapping) else {"": measured})
        each = {engine: HOLDS if one.holds(value) else DIFFERS for engine, value in values.items()}
        value, found = next(iter(values.values())), verdict or max(each.values(), key=VERDICTS.index)
        if len(set(each.values())) > 1 and not verdict:
            said = ", ".join(f"{said} in {NAMES[engine]}" for engine, said in each.items())
            reason = f"{reason}; the engines disagree: {said}" if reason else f"the engines disagree: {said}"
        if found not in VERDICTS or (found == UNTESTED and not reason):
            raise InvalidInput(f"claim {claim!r}: verdict {found!r} must be one of {', '.join(VERDICTS)}, "
                               "and the last one needs a reason")  # fmt: skip
        digits = 2 if one.varies else 4
        self.records[claim] = {
            "id": claim, "measured": shortened(value, digits), "verdict": found, "reason": reason,
            "parameters": plain(self.parameters | parameters), "versions": self.versions,
        }  # fmt: skip
        if len(values) > 1:
            self.records[claim]["engines"] = {
                engine: {"measured": shortened(values[engine], digits), "verdict": each[engine]} for engine in values
            }
        self._write()

    def table(self) -> Table:
        """The records so far."""
        rows = [
            (one.statement, shown(one.paper, one.unit), in_engines(row, one.unit), row["verdict"], one.judged_by,
             row["reason"])
            for row in self.records.values() for one in [self.claims[row["id"]]]
        ]  # fmt: skip
        return table("claim | paper | here | verdict | judged by | reason, or what it depends on", rows)

    def _write(self) -> None:
        """Write all records so far, completely or not at all."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        text = as_json(list(self.records.values()))
        write_whole(self.path, lambda file: file.write(text.encode()))


def as_json(rows: list[dict[str, Any]]) -> str:
    """Rows as stored text: null for NaN, the same text for the same rows."""
    return json.dumps(rows, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def plain(value: Any) -> Any:
    """Numpy scalars and arrays as Python values."""
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return plain(value.tolist()) if hasattr(value, "tolist") else value


def shortened(value: Any, digits: int) -> Any:
    """Numbers rounded to some significant digits; None for NaN and infinity."""
    if isinstance(value, list):
        return [shortened(item, digits) for item in value]
    if isinstance(value, float):
        return float(f"{value:.{digits}g}") if math.isfinite(value) else None
    return value


def in_engines(row: Mapping[str, Any], unit: str) -> str:
    """What a record measured, for a table; in each engine where there are several and they differ."""
    values = {engine: shown(one["measured"], unit) for engine, one in row.get("engines", {}).items()}
    if len(set(values.values())) < 2:
        return shown(row["measured"], unit)
    return ", ".join(f"{value} ({NAMES[engine]})" for engine, value in values.items())


def shown(value: Any, unit: str = "") -> str:
    """A value with its unit, for a table: three significant digits, or all digits from 1,000 to 100,000."""
    if isinstance(value, list):
        return f"{', '.join(shown(item) for item in value)} {unit}".rstrip()
    if isinstance(value, str):
        return value
    if value is None:
        return "no number"
    return f"{value:.0f} {unit}".rstrip() if 1e3 <= abs(value) < 1e5 else f"{value:.3g} {unit}".rstrip()
