"""The pages of the site before they are rendered: README, docs/, executed notebooks, and 3-D views."""

from __future__ import annotations

import html
import re
import shutil
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import nbformat

FILES = "figures", "data", "bench"
"""Folders that pages link into, and that the site holds at the same place."""
BESIDE = "LICENSE", "CITATION.cff"
"""Files of the top folder that pages link to."""
RESULTS = "docs/claims", "docs/figures"
GUIDES = "docs/own_robot", "docs/command_line"
"""Pages of docs/ with a caption of their own in the navigation."""
VIEWS = "crossings"
WIDGET = "application/vnd.jupyter.widget-view+json"
CROSSINGS = """# The crossings in 3-D

You can turn each view with the mouse, play, pause, scrub, or slow down to a tenth. The pages need only WebGL.
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
    """Write everything that Sphinx reads, in the layout of the checkout, so that all links work.

    Args:
        top: the checkout.
        notebooks: executed.
        titles: of the 3-D views, by file name.
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
    frames = [FRAME.format(title=html.escape(titles[name]), address=f"{VIEWS}/{name}.html") for name in titles]
    (pages / f"{VIEWS}.md").write_text(CROSSINGS + "".join(frames))
    readme = (pages / "README.md").read_text()
    (pages / "README.md").unlink()
    (pages / "index.md").write_text(readme + contents(readme, pages))


def contents(readme: str, pages: Path) -> str:
    """Every page in the order of the navigation; the notebooks in README's order."""
    known = sorted(path.stem for path in (pages / "notebooks").glob("*.ipynb"))
    named = re.findall(r"\(notebooks/(\w+)\.ipynb\)", readme.partition("## The notebooks")[2])
    notebooks = [name for name in dict.fromkeys(named) if name in known]
    robots = sorted(path.relative_to(pages).with_suffix("").as_posix() for path in pages.glob("data/*/README.md"))
    others = sorted({f"docs/{path.stem}" for path in (pages / "docs").glob("*.md")} - {*RESULTS, *GUIDES})
    return "".join(
        "\n```{toctree}\n:hidden:\n:caption: " + "\n".join([caption, "", *names]) + "\n```\n"
        for caption, names in (
            ("Results", list(RESULTS)),
            ("Notebooks", [f"notebooks/{name}" for name in notebooks + [one for one in known if one not in notebooks]]),
            ("In 3-D", [VIEWS]),
            ("Guides", list(GUIDES)),
            ("Robots", robots),
            ("Library", ["api", *others, "ARCHITECTURE", "CONTRIBUTING", "CHANGELOG"]),
        )
    )


def for_readers(notebook: Any) -> Any:
    """An executed notebook without the path of its figures and without widgets, which need a kernel."""
    notebook.cells = [cell for cell in notebook.cells if "injected-parameters" not in cell.metadata.get("tags", [])]
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.outputs = [output for output in cell.outputs if WIDGET not in output.get("data", {})]
    notebook.metadata.pop("widgets", None)
    return notebook
