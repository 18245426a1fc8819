"""All claims together: gather what the notebooks recorded into figures/claims.json and README's table."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from stepover.errors import InvalidInput
from stepover.output import write_whole
from stepover.report.tables.table import table
from stepover.reproduction.claims import DIFFERS, HOLDS, UNTESTED, Claim, read_claims
from stepover.reproduction.marked import with_block
from stepover.reproduction.recorder import SUFFIX, as_json, shown

MARK = "claims"
"""Around README's table and the line above it."""
RECORDED = ("measured", "verdict", "reason", "parameters", "versions")
Entry = dict[str, Any]


def take_records(folder: Path) -> list[Entry]:
    """Take the records out of a notebook's staging folder, so that only its figures are left there."""
    rows: list[Entry] = []
    for path in sorted(folder.glob(f"*{SUFFIX}")):
        rows += json.loads(path.read_text())
        path.unlink()
    return rows


def gather(top: Path, found: Mapping[str, list[Entry]], whole: bool) -> list[Path]:
    """Write figures/claims.json and README's table.

    A number that depends on the machine stays as it is stored while its verdict, reason and versions are the same: so
    whoever reproduces the claims sees no difference where there is none. To store a new one, delete the old entry.

    Args:
        top: the checkout, with data/claims.toml; without that file nothing is to be judged.
        found: records by notebook, of those that ran.
        whole: whether all notebooks ran; else the records of the others stay as they were.

    Returns:
        The files that were written.

    Raises:
        InvalidInput: a record without a claim, a claim without a record, or a verdict that differs without a reason;
            nothing has been written then.
    """
    source, stored, readme = top / "data" / "claims.toml", top / "figures" / "claims.json", top / "README.md"
    if not source.is_file() and not any(found.values()):
        return []
    claims = read_claims(source)
    try:
        before = {row["id"]: row for row in read_entries(stored) if row["id"] in claims}
    except InvalidInput:
        if not whole:
            raise
        before = {}  # all of it is written anew
    rows = {} if whole else {name: row for name, row in before.items() if claims[name].notebook not in found}
    for notebook, records in found.items():
        for row in records:
            if row["id"] not in claims or claims[row["id"]].notebook != notebook:
                raise InvalidInput(f"notebook {notebook} records {row['id']!r}, which is no claim of it in {source}")
            stays = claims[row["id"]].varies and _as_before(row, before.get(row["id"], {}))
            rows[row["id"]] = before[row["id"]] if stays else row
    missing = [name for name, one in claims.items() if name not in rows and (whole or one.notebook in found)]
    if missing:
        raise InvalidInput(f"claims without a record: {', '.join(f'{n} ({claims[n].notebook})' for n in missing)}")
    silent = [name for name, row in rows.items() if row["verdict"] == DIFFERS and not row["reason"]]
    if silent:
        raise InvalidInput(f"claims that differ without a reason: {', '.join(silent)}")
    entries = [entry(claims[name], rows[name]) for name in claims if name in rows]
    text = with_table(readme, entries)
    write_whole(stored, lambda file: file.write(as_json(entries).encode()))
    write_whole(readme, lambda file: file.write(text.encode()))
    return [stored, readme]


def _as_before(row: Entry, before: Entry) -> bool:
    """Whether a record says what is stored, but for its numbers."""
    return all(row[name] == before.get(name) for name in ("verdict", "reason", "versions"))


def entry(claim: Claim, record: Entry) -> Entry:
    """What claims.json holds of a claim."""
    said = dataclasses.asdict(claim)
    measured = {name: record[name] for name in RECORDED}
    first = {name: said[name] for name in ("id", "section", "statement", "paper", "unit")}
    then = {name: said[name] for name in ("compare", "bound", "tolerance", "varies", "notebook", "figure")}
    return first | {"measured": measured.pop("measured")} | then | measured


def read_entries(path: Path) -> list[Entry]:
    """What claims.json holds; nothing where there is no such file.

    Raises:
        InvalidInput: it is not a list of claims.
    """
    if not path.is_file():
        return []
    try:
        rows = json.loads(path.read_text())
        return [dict(row, id=row["id"], **{name: row[name] for name in RECORDED}) for row in rows]
    except (ValueError, TypeError, KeyError) as error:
        raise InvalidInput(f"{path} is no list of claims; delete it and run 'make reproduce'") from error


def readme_table(entries: list[Entry]) -> str:
    """The claims as a table in markdown, narrow enough for a page."""
    rows = [
        (
            row["statement"], shown(row["paper"], row["unit"]), shown(row["measured"], row["unit"]), judgement(row),
            f"{row['section']}; `{row['id']}` in [notebook](notebooks/{row['notebook']}.ipynb)"
            + (f", [figure](figures/{row['figure']}.png)" if row["figure"] else ""),
        )
        for row in entries
    ]  # fmt: skip
    return table("claim | paper | here | verdict | where", rows)._repr_markdown_()


def tally(entries: list[Entry]) -> str:
    """How many claims hold, differ and cannot be tested, in one line."""
    holds, differ, untested = (sum(row["verdict"] == name for row in entries) for name in (HOLDS, DIFFERS, UNTESTED))
    return f"Of {len(entries)} claims {holds} hold, {differ} differ, and {untested} cannot be tested here."


def with_table(readme: Path, entries: list[Entry]) -> str:
    """README's text with the tally and the table between its marks: see with_block."""
    return with_block(readme, MARK, f"{tally(entries)}\n\n{readme_table(entries)}")


def judgement(row: Entry) -> str:
    """A verdict with its reason, in markdown; what does not hold stands out."""
    name = row["verdict"] if row["verdict"] == HOLDS else f"**{row['verdict']}**"
    return f"{name}: {row['reason']}" if row["reason"] else name
