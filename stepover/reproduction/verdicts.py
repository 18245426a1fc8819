"""Gather the records of all notebooks into figures/claims.json and the generated pages."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import BinaryIO

from stepover.errors import InvalidInput
from stepover.output import write_whole
from stepover.reproduction.captions import read_captions
from stepover.reproduction.claims import DIFFERS, Claim, read_claims
from stepover.reproduction.pages import Entry, claims_page, figures_page, readme_with
from stepover.reproduction.recorder import SUFFIX, as_json

RECORDED = ("measured", "verdict", "reason", "parameters", "versions")


def take_records(folder: Path) -> list[Entry]:
    """Take the records out of a notebook's staging folder, so that only its figures remain there."""
    rows: list[Entry] = []
    for path in sorted(folder.glob(f"*{SUFFIX}")):
        rows += json.loads(path.read_text())
        path.unlink()
    return rows


def gather(top: Path, found: Mapping[str, list[Entry]], whole: bool) -> list[Path]:
    """Write figures/claims.json, docs/claims.md, docs/figures.md and README's block.

    A number that depends on the machine keeps its stored value while verdict, reason and versions stay the same. So a
    new run shows no difference where there is none. To store a new value, delete the old entry.

    Args:
        top: the checkout, with data/claims.toml; without that file there are no claims to judge.
        found: the records of the notebooks that ran, by notebook.
        whole: whether all notebooks ran; otherwise the records of the others stay unchanged.

    Returns:
        The files that were written.

    Raises:
        InvalidInput: a record without a claim, a claim without a record, a verdict that differs without a reason, or
            a figure without a caption; nothing has been written then.
    """
    source, stored = top / "data" / "claims.toml", top / "figures" / "claims.json"
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
                raise InvalidInput(f"notebook {notebook} records {row['id']!r}, but {source} has no such claim of it")
            stays = claims[row["id"]].varies and _as_before(row, before.get(row["id"], {}))
            rows[row["id"]] = before[row["id"]] if stays else row
    missing = [name for name, one in claims.items() if name not in rows and (whole or one.notebook in found)]
    if missing:
        raise InvalidInput(f"claims without a record: {', '.join(f'{n} ({claims[n].notebook})' for n in missing)}")
    silent = [name for name, row in rows.items() if row["verdict"] == DIFFERS and not row["reason"]]
    if silent:
        raise InvalidInput(f"claims that differ without a reason: {', '.join(silent)}")
    entries = [entry(claims[name], rows[name]) for name in claims if name in rows]
    return write_pages(top, entries)


def write_pages(top: Path, entries: Sequence[Entry]) -> list[Path]:
    """Write figures/claims.json and every page that is made from it.

    Returns:
        The files that were written.

    Raises:
        InvalidInput: a figure has no caption, or README has no block to fill; nothing has been written then.
    """
    docs = top / "docs"
    texts = {
        top / "figures" / "claims.json": as_json(list(entries)),
        docs / "claims.md": claims_page(entries),
        docs / "figures.md": figures_page(read_captions(top), entries),
        top / "README.md": readme_with(top / "README.md", entries),
    }
    docs.mkdir(exist_ok=True)
    for path, text in texts.items():
        write_whole(path, partial(_write, text))
    return list(texts)


def _write(text: str, file: BinaryIO) -> None:
    """Write a text into an open file."""
    file.write(text.encode())


def _as_before(row: Entry, before: Entry) -> bool:
    """Whether a record equals the stored one, except for its numbers."""
    return all(row[name] == before.get(name) for name in ("verdict", "reason", "versions"))


def entry(claim: Claim, record: Entry) -> Entry:
    """The entry of a claim in claims.json."""
    said = dataclasses.asdict(claim)
    measured = {name: record[name] for name in (*RECORDED, "engines") if name in record or name in RECORDED}
    first = {name: said[name] for name in ("id", "section", "statement", "paper", "unit")}
    then = {name: said[name] for name in ("judged_by", "compare", "bound", "tolerance", "varies", "notebook", "figure")}
    return first | {"measured": measured.pop("measured")} | then | measured


def read_entries(path: Path) -> list[Entry]:
    """The entries of claims.json; none if there is no such file.

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
