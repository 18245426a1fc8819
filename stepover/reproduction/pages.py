"""The pages that are generated from claims and captions: docs/claims.md, docs/figures.md, and README's block."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from stepover.report.tables.table import table
from stepover.reproduction.captions import Caption
from stepover.reproduction.claims import CONSTRUCTION, DIFFERS, HOLDS, OURS, PRINTED, UNTESTED, VERDICTS
from stepover.reproduction.marked import with_block
from stepover.reproduction.recorder import in_engines, shown

MARK = "claims"
"""Name of README's generated block."""
TELLING = "margin-25", "second-stage", "speed-up", "impact-ratio", "limit-20"
"""The claims that README shows."""
IN_PROSE = ("id", "statement", "reason")
"""Fields of a claim that stand above its table."""
SELDOM = ("varies", "tolerance")
"""Fields of a claim that are left out where they are false or zero."""
GENERATED = "<!-- 'make reproduce' writes this page. Do not edit it. -->\n\n"
CLAIMS = """# The claims

Each row compares a statement of the paper with our result. A claim links to its section below, which holds all details:
numbers, rule, tolerance, parameters and versions. The same data is in [claims.json](../figures/claims.json). The rules
are in [claims.toml](../data/claims.toml).

The column *judged by* says where the bound comes from. *printed*: the paper gives it. *ours*: the paper gives a word,
and we chose the bound; [claims.toml](../data/claims.toml) says why. *construction*: the planner makes it so. Such a row
is a setting and not a finding, so the tally leaves it out.

To find the line that computes a number, search the notebook for the name of the claim, such as `leg-ratio-15`.

FU, FTG, CWTG, UBMG and FTA are the paper's units: feasibility, feet trajectories, CoM and waist, upper body, feet
trajectory adaptor. X_ads is the length of the step over the obstacle. X_hds and Z_hds are the position of the waist in
the middle of that step, forward and up. Leg 1 crosses first, then leg 2. (6), (7) and (8) put the CoM over the rear
foot, between the feet, and over the front foot. RLEG and LLEG are the legs' links and joints in the URDF: 2 is the
thigh, 3 the knee with the shank, 5 the foot.
"""
FIGURES = """# The figures

`make reproduce` draws every figure into `figures/`.
"""
Entry = dict[str, Any]


def tally(entries: Sequence[Entry]) -> str:
    """How many findings hold, differ and cannot be tested, and by whose bound; and how many rows are settings."""
    count = Counter((row["judged_by"], row["verdict"]) for row in entries)
    settings = sum(count[CONSTRUCTION, verdict] for verdict in VERDICTS)
    said = {verdict: count[PRINTED, verdict] + count[OURS, verdict] for verdict in VERDICTS}
    line = (
        f"Of {len(entries) - settings} findings {said[HOLDS]} hold ({count[PRINTED, HOLDS]} by a bound that the paper "
        f"prints, {count[OURS, HOLDS]} by one of ours), {said[DIFFERS]} differ ({count[PRINTED, DIFFERS]} and "
        f"{count[OURS, DIFFERS]}), and {said[UNTESTED]} cannot be tested here."
    )
    return f"{line} Not counted: {settings} that {'is' if settings == 1 else 'are'} true by construction."


def readme_with(readme: Path, entries: Sequence[Entry]) -> str:
    """README's text with the tally and the telling claims between its marks: see with_block."""
    known = {row["id"]: row for row in entries}
    rows = [
        (f"[{row['statement']}](docs/claims.md#{row['id']})", *_numbers(row), _stressed(row["verdict"]))
        for row in (known[name] for name in TELLING if name in known)
    ]
    overview = table("claim | paper | here | verdict", rows)._repr_markdown_()
    return with_block(readme, MARK, f"{tally(entries)}\n\n{overview}")


def claims_page(entries: Sequence[Entry]) -> str:
    """All claims as a table, then a section for each one. The id of a claim is the anchor of its section."""
    rows = [
        (
            f"[{row['statement']}](#{row['id']})",
            *_numbers(row),
            judgement(row),
            row["judged_by"],
            f"{row['section']}; {_places(row)}",
        )
        for row in entries
    ]
    overview = table("claim | paper | here | verdict | judged by | where", rows)._repr_markdown_()
    return "\n".join([GENERATED + CLAIMS, tally(entries), "", overview, *map(_claim, entries)]) + "\n"


def figures_page(captions: Sequence[Caption], entries: Sequence[Entry]) -> str:
    """All figures with captions, notebooks and claims. The name of a figure is the anchor of its section."""
    return GENERATED + FIGURES + "".join(_figure(one, entries) for one in captions)


def judgement(row: Entry) -> str:
    """A verdict with its reason, in markdown."""
    name = _stressed(row["verdict"])
    return f"{name}: {row['reason']}" if row["reason"] else name


def _stressed(verdict: str) -> str:
    """A verdict in markdown; bold unless the claim holds."""
    return verdict if verdict == HOLDS else f"**{verdict}**"


def _numbers(row: Entry) -> tuple[str, str]:
    """The paper's value and ours."""
    return shown(row["paper"], row["unit"]), in_engines(row, row["unit"])


def _places(row: Entry) -> str:
    """Links to the notebook and to the figure of a claim."""
    figure = f", [figure](figures.md#{row['figure']})" if row.get("figure") else ""
    return f"[notebook](../notebooks/{row['notebook']}.ipynb){figure}"


def _claim(row: Entry) -> str:
    """The section of one claim: statement, verdict, reason, and every stored field."""
    links = {"notebook": "[{0}](../notebooks/{0}.ipynb)", "figure": "[{0}](figures.md#{0})", "verdict": "**{0}**"}
    known = {name: value for name, value in row.items() if name not in IN_PROSE and value not in (None, "")}
    told = {name: value for name, value in known.items() if value or name not in SELDOM}
    fields = [(name, links.get(name, "{0}").format(_plain(value))) for name, value in told.items()]
    details = table("field | value", fields)._repr_markdown_()
    return f"\n## {row['id']}\n\n{row['statement']}: {judgement(row)}.\n\n{details}"


def _figure(one: Caption, entries: Sequence[Entry]) -> str:
    """The section of one figure."""
    name = Path(one.file).stem
    claims = ", ".join(f"[{row['id']}](claims.md#{row['id']})" for row in entries if row["figure"] == name)
    where = f"Notebook: [{one.notebook}](../notebooks/{one.notebook}.ipynb)."
    where += f" Claims: {claims}." if claims else ""
    return f"\n## {name}\n\n![{name}](../figures/{one.file})\n\n{one.caption}\n\n{where}\n"


def _plain(value: Any) -> str:
    """A value of claims.json, all its digits."""
    if isinstance(value, dict):
        return ", ".join(f"{key} {_plain(item)}" for key, item in value.items())
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
