"""The pages of the site before they are rendered: README and its like, executed notebooks, claims, 3-D views."""

from __future__ import annotations

import html
import json
import re
import shutil
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import nbformat

from stepover.report.tables.table import table
from stepover.reproduction.recorder import shown
from stepover.reproduction.verdicts import Entry, judgement, read_entries

FILES = "figures", "data", "bench"
"""Folders that pages link into, and that the site holds at the same place."""
BESIDE = "LICENSE", "CITATION.cff"
"""Files at the top that pages link to."""
VIEWS = "crossings"
WIDGET = "application/vnd.jupyter.widget-view+json"
SHOWN_ELSEWHERE = ("id", "statement", "reason")
SELDOM = ("varies", "tolerance")
"""Fields of a claim that are left out where they say no or nothing."""
CLAIMS = """# The claims, in full

What README's table says in short, with everything that [claims.json](figures/claims.json) holds. How each one is
compared is in [claims.toml](data/claims.toml). A claim leads to its section below, which leads to the notebook; there
`judged.record("its name", ...)` is the line that records the number.
"""
CROSSINGS = """# The crossings in 3-D

Turn them with the mouse, play, pause, scrub, or slow them down to a tenth. They need WebGL and nothing else;
`python -m stepover view` makes such a page of any motion.
"""
FRAME = """
## {title}

```{{raw}} html
<iframe class="crossing" src="{address}" title="{title}" loading="lazy"></iframe>
<p><a href="{address}">The same on a page of its own</a></p>
```
"""


def lay_out(top: Path, notebooks: Iterable[Path], titles: dict[str, str], pages: Path) -> None:
    """Write everything that Sphinx reads, at the places that it has in the checkout, so that its links hold.

    Args:
        top: the checkout.
        notebooks: executed.
        titles: of the 3-D views, by the name of their file.
        pages: folder to be made.
    """
    for folder in (*FILES, "docs", "stepover"):
        shutil.copytree(top / folder, pages / folder, ignore=shutil.ignore_patterns("site", "__pycache__"))
    for path in [*top.glob("*.md"), *(top / name for name in BESIDE)]:
        shutil.copy(path, pages)
    shutil.copy(top / "docs" / "site" / "api.rst", pages)
    (pages / "notebooks").mkdir()
    for notebook in notebooks:
        nbformat.write(for_readers(nbformat.read(notebook, as_version=4)), pages / "notebooks" / notebook.name)
    (pages / "claims.md").write_text(claims_page(read_entries(top / "figures" / "claims.json")))
    frames = [FRAME.format(title=html.escape(titles[name]), address=f"{VIEWS}/{name}.html") for name in titles]
    (pages / f"{VIEWS}.md").write_text(CROSSINGS + "".join(frames))
    readme = (pages / "README.md").read_text()
    (pages / "README.md").unlink()
    (pages / "index.md").write_text(readme + contents(readme, pages))


def contents(readme: str, pages: Path) -> str:
    """Every page in the order of the navigation, the notebooks in README's."""
    known = sorted(path.stem for path in (pages / "notebooks").glob("*.ipynb"))
    named = re.findall(r"\(notebooks/(\w+)\.ipynb\)", readme.partition("## The notebooks")[2])
    notebooks = [name for name in dict.fromkeys(named) if name in known]
    robots = sorted(path.relative_to(pages).with_suffix("").as_posix() for path in pages.glob("data/*/README.md"))
    others = sorted(f"docs/{path.stem}" for path in (pages / "docs").glob("*.md") if path.stem != "own_robot")
    return "".join(
        "\n```{toctree}\n:hidden:\n:caption: " + "\n".join([caption, "", *names]) + "\n```\n"
        for caption, names in (
            ("Results", ["claims"]),
            ("Notebooks", [f"notebooks/{name}" for name in notebooks + [one for one in known if one not in notebooks]]),
            ("In 3-D", [VIEWS]),
            ("Robots", ["docs/own_robot", *robots]),
            ("Library", ["api", *others, "ARCHITECTURE", "CONTRIBUTING", "CHANGELOG"]),
        )
    )


def for_readers(notebook: Any) -> Any:
    """An executed notebook without what says nothing to a reader: where its figures went, widgets without a kernel."""
    notebook.cells = [cell for cell in notebook.cells if "injected-parameters" not in cell.metadata.get("tags", [])]
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.outputs = [output for output in cell.outputs if WIDGET not in output.get("data", {})]
    notebook.metadata.pop("widgets", None)
    return notebook


def claims_page(entries: list[Entry]) -> str:
    """All claims as a table, each linked to a section with everything that is known of it; its id is the anchor."""
    rows = [
        (
            f"[{row['statement']}](#{row['id']})", shown(row["paper"], row["unit"]),
            shown(row["measured"], row["unit"]), judgement(row),
            f"{row['section']}; [{row['notebook']}](notebooks/{row['notebook']}.ipynb)",
        )
        for row in entries
    ]  # fmt: skip
    overview = table("claim | paper | here | verdict | where", rows)._repr_markdown_()
    return "\n".join([CLAIMS, overview, *(_claim(row) for row in entries)]) + "\n"


def _claim(row: Entry) -> str:
    """A section on one claim: what it says, what came of it, and everything else as it is stored."""
    ways = {"notebook": "[{0}](notebooks/{0}.ipynb)", "figure": "[{0}](figures/{0}.png)", "verdict": "**{0}**"}
    known = {name: value for name, value in row.items() if name not in SHOWN_ELSEWHERE and value not in (None, "")}
    told = {name: value for name, value in known.items() if value or name not in SELDOM}
    fields = [(name, ways.get(name, "{0}").format(_plain(value))) for name, value in told.items()]
    all_of_it = table("field | value", fields)._repr_markdown_()
    return f"\n## {row['id']}\n\n{row['statement']}: {judgement(row)}.\n\n{all_of_it}"


def _plain(value: Any) -> str:
    """A value of claims.json, all its digits."""
    if isinstance(value, dict):
        return ", ".join(f"{key} {_plain(item)}" for key, item in value.items())
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
