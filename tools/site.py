"""`make site`: one site that needs no network, with every notebook executed. The only door to Sphinx.

site_pages lays the pages out, Sphinx renders them with the settings in docs/site, and site_links checks the links. A
notebook runs first if build/notebooks/ holds no executed copy, or an outdated one. Nothing outside build/ is written.
If the site fails, the old one stays unchanged.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from stepover.errors import StepOverError
from stepover.locations import checkout
from stepover.model.obstacle import Obstacle
from stepover.motion.footsteps import LEG_1
from stepover.planning.algorithm_1.planner import plan
from stepover.report import viewer
from stepover.reproduction.run import OUTPUT, find_notebooks, run_notebook
from stepover.robots.loading import load_robot
from tools.site_links import faults
from tools.site_pages import BESIDE, FILES, VIEWS, lay_out

PARTS = "4"
"""Number of parallel jobs of Sphinx. It splits pages alphabetically; with fewer, one core gets the whole reference."""
INDEPENDENT = "cli", "__main__.py"
"""Code of the package that no notebook depends on."""


class SiteFailed(StepOverError):
    """Sphinx gave a warning, or a link is broken. The message names each, one per line."""

    def __init__(self, message: str) -> None:
        """Keep all lines: one for each page or link."""
        Exception.__init__(self, message)

    exit_code = 1


def make(top: Path) -> Path:
    """Make the whole site of a checkout, build/site/.

    Raises:
        NotebookFailed: a notebook had to run and failed.
        SiteFailed: Sphinx gave a warning, or a link is broken.
    """
    executed = [_executed(top, notebook) for notebook in find_notebooks(top)]
    _say("notebooks are up to date; planning the crossings shown in 3-D")
    views = {name: (one.pop("title"), crossing(**one)) for name, one in crossings_of(top).items()}
    return build(top, executed, views, top / "build" / "site")


def crossings_of(top: Path) -> dict[str, Any]:
    """Title, robot, height and width of each 3-D page, by the page's name."""
    return tomllib.loads((top / "docs" / "site" / "views.toml").read_text())


def crossing(robot: str, height: float, width: float) -> str:
    """3-D page of a named robot that steps over an obstacle [m]. It opens at the landing of leg 1."""
    model = load_robot(robot)
    motion = plan(model, Obstacle(height, width))
    (landing,) = motion.footsteps.of_kind(LEG_1).time
    return viewer.page(model, motion, float(landing))


def build(top: Path, notebooks: Sequence[Path], views: Mapping[str, tuple[str, str]], site: Path) -> Path:
    """Render a site and put it in its place when it is complete.

    Args:
        top: the checkout.
        notebooks: executed.
        views: title and page of the 3-D views, by the name of the file.
        site: folder to be made, or replaced.

    Raises:
        SiteFailed: see there.
    """
    work = site.with_name(f"{site.name}.part")
    shutil.rmtree(work, ignore_errors=True)
    pages, made = work / "pages", work / "html"
    lay_out(top, notebooks, {name: title for name, (title, _) in views.items()}, pages)
    _say("rendering the pages; this takes about a minute")
    _render(pages, made, top / "docs" / "site")
    for folder in FILES:
        shutil.copytree(
            pages / folder, made / folder, ignore=shutil.ignore_patterns("*.md", "*.py"), dirs_exist_ok=True
        )
    for name in BESIDE:
        shutil.copy(pages / name, made)
    (made / VIEWS).mkdir()
    for name, (_, page) in views.items():
        (made / VIEWS / f"{name}.html").write_text(page, encoding="utf-8")
    _say("checking the links")
    wrong = faults(made)
    if wrong:
        raise SiteFailed("\n".join(["broken links:", *wrong]))
    shutil.rmtree(site, ignore_errors=True)
    os.replace(made, site)
    shutil.rmtree(work)
    return site


def stale(top: Path, notebook: Path) -> str:
    """Why the executed copy of a notebook is outdated; "" if it is not."""
    executed = top / "build" / "notebooks" / notebook.name
    if not executed.is_file():
        return "has not been run"
    try:
        run = json.loads(executed.read_text())["metadata"]["papermill"]
    except (ValueError, KeyError):
        return "has an executed copy that cannot be read"
    if run.get("exception") or not run.get("end_time") or set(run.get("parameters", {})) - {OUTPUT}:
        return "has not been run to its end with its own parameters"
    newer = (path for path in _sources(top, notebook) if path.stat().st_mtime > executed.stat().st_mtime)
    return next((f"is older than {path.relative_to(top)}" for path in newer), "")


def _sources(top: Path, notebook: Path) -> list[Path]:
    """The files that a notebook depends on: itself, the library, the data, the stored tables."""
    package = top / "stepover"
    code = [path for path in package.rglob("*.py") if path.relative_to(package).parts[0] not in INDEPENDENT]
    data = [path for path in (top / "data").rglob("*") if path.is_file() and path.suffix != ".md"]
    return [notebook, *sorted(code), *sorted(data), *sorted((top / "figures").glob("*.csv"))]


def _executed(top: Path, notebook: Path) -> Path:
    """The executed copy of a notebook. It runs now if the copy is missing or outdated; its figures are dropped."""
    executed, why = top / "build" / "notebooks" / notebook.name, stale(top, notebook)
    if why:
        _say(f"notebook {notebook.stem} {why}: it is run")
        staging = top / "build" / "staging" / notebook.stem
        shutil.rmtree(staging, ignore_errors=True)
        staging.mkdir(parents=True)
        run_notebook(notebook, executed, staging, {})
        shutil.rmtree(staging)
    return executed


def _say(what: str) -> None:
    """Print a message at once."""
    print(what, flush=True)


def _render(pages: Path, made: Path, settings: Path) -> None:
    """Render the pages with Sphinx. Every warning is an error."""
    options = ["-b", "html", "-q", "-W", "--keep-going", "-j", PARTS, "-E", "-d", str(pages.parent / "doctrees")]
    command = [sys.executable, "-m", "sphinx", *options, "-c", str(settings), str(pages), str(made)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        complaints = done.stderr.strip().replace(f"{pages}/index.md", "README.md").replace(f"{pages}/", "")
        raise SiteFailed(f"Sphinx complains:\n{complaints}")


if __name__ == "__main__":
    try:
        print(f"open {make(checkout()) / 'index.html'}")
    except StepOverError as error:
        sys.exit(f"error: {error}")
