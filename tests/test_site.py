"""The site: whole, offline, every link of it leads somewhere; and the check of links finds what is broken."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_output

from stepover.locations import checkout
from stepover.reproduction.pages import claims_page
from stepover.reproduction.run import NotebookFailed
from stepover.reproduction.verdicts import read_entries
from tools import site
from tools.site_links import faults
from tools.site_pages import WIDGET, contents

TOP = checkout()
PIXEL = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="


def with_outputs(notebook, folder):
    """A copy of a notebook as if it had been executed."""
    book = nbformat.read(notebook, as_version=4)
    shown = [
        {"text/markdown": "| angle | torque |\n| --- | --- |\n| $\\alpha_{ankle}$ | 12 |", "text/plain": "a table"},
        {"image/png": PIXEL, "text/plain": "a figure"},
        {WIDGET: {"model_id": "1", "version_major": 2}, "text/plain": "a slider"},
    ]
    outputs = [new_output("display_data", data) for data in shown]
    told = new_code_cell("output = '/a/staging/folder'", metadata={"tags": ["injected-parameters"]})
    book.cells += [told, new_code_cell("show()", outputs=outputs)]
    book.metadata["widgets"] = {"application/vnd.jupyter.widget-state+json": {"state": {}, "version_major": 2}}
    nbformat.write(book, folder / notebook.name)
    return folder / notebook.name


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """A site of the real pages, with made-up outputs in one notebook and made-up 3-D pages."""
    folder = tmp_path_factory.mktemp("site")
    first, *others = sorted((TOP / "notebooks").glob("*.ipynb"))
    titles = {name: one["title"] for name, one in site.crossings_of(TOP).items()}
    views = {name: (title, f"<html><body>{title}</body></html>") for name, title in titles.items()}
    return site.build(TOP, [with_outputs(first, folder), *others], views, folder / "site")


class TestSite:
    def test_every_link_leads_somewhere_and_nothing_comes_from_a_host(self, built):
        assert faults(built) == []

    def test_every_notebook_and_page_is_there_and_in_the_navigation(self, built):
        front = (built / "index.html").read_text()
        pages = [f"notebooks/{path.stem}.html" for path in (TOP / "notebooks").glob("*.ipynb")]
        pages += [f"docs/{path.stem}.html" for path in (TOP / "docs").glob("*.md")]
        pages += ["crossings.html", "ARCHITECTURE.html", "data/jvrc1/README.html"]
        for page in [*pages, "api/stepover.model.html", "api/stepover.report.figures.html"]:
            assert f'href="{page}"' in front, page
        text = (built / "index.html").read_text().split("sidebar-tree")[1]
        order = ["claims", "stepover_15cm", "adaptation", "crossings", "own_robot", "api", "ARCHITECTURE"]
        places = [text.index(f"{name}.html") for name in order]
        assert places == sorted(places)

    def test_outputs_are_shown_formulas_as_mathml(self, built):
        page = (built / "notebooks" / "adaptation.html").read_text()
        assert re.search(r"<th[^>]*><p>torque</p></th>", page)
        assert "<mi>α</mi>" in page
        assert len(re.findall(r"<img[^>]* src=\"../_images/", page)) == 1
        assert "a slider" not in page
        assert "/a/staging/folder" not in page
        assert "widget" not in page.replace("mystnb", "")

    def test_every_claim_has_its_anchor_and_all_that_is_known_of_it(self, built):
        page = (built / "docs" / "claims.html").read_text()
        for row in read_entries(TOP / "figures" / "claims.json"):
            assert f'id="{row["id"]}"' in page
            assert f'href="#{row["id"]}"' in page
        assert page.count("pybullet 3.") == len(read_entries(TOP / "figures" / "claims.json"))

    def test_files_of_the_repository_come_along(self, built):
        for name in (
            "figures/claims.json",
            "figures/landing.csv",
            "bench/history.json",
            "data/claims.toml",
            "CITATION.cff",
        ):
            assert (built / name).read_bytes() == (TOP / name).read_bytes()

    def test_every_promised_name_is_described(self, built):
        import stepover

        described = "".join(path.read_text() for path in (built / "api").glob("*.html"))
        for name in stepover.__all__:
            assert re.search(rf'id="stepover\.[\w.]*\b{name}"', described), name

    def test_a_link_to_a_module_opens_its_reference(self, built):
        page = (built / "notebooks" / "tour.html").read_text()
        assert '"../api/stepover.planning.algorithm_1.html#module-stepover.planning.algorithm_1.feet_adaptor"' in page

    def test_nothing_is_left_beside_it(self, built):
        assert not built.with_name("site.part").exists()


class TestFaults:
    """A small site that is whole, spoilt in one place each."""

    @pytest.fixture
    def small(self, tmp_path):
        (tmp_path / "sub").mkdir()
        (tmp_path / "index.html").write_text(
            '<link rel="stylesheet" href="a.css"><link rel="next" href="sub/b.html"><a href="sub/b.html#here">b</a>'
            '<a href="https://doi.org/10">paper</a><a href="#top">top</a><p id="top">top</p>'
            '<img src="data:image/png,0">'
        )
        (tmp_path / "sub" / "b.html").write_text('<p id="here">here</p><a href="../index.html?x=1">back</a>')
        (tmp_path / "a.css").write_text("p { background: url(data:image/png,0) }")
        return tmp_path

    def test_a_whole_one_has_none(self, small):
        assert faults(small) == []

    @pytest.mark.parametrize(("spoilt", "fault"), [
        ('<a href="sub/c.html">c</a>', "sub/c.html is not there"),
        ('<a href="sub/b.html#there">c</a>', "sub/b.html#there has no such anchor"),
        ('<a href="#bottom">c</a>', "#bottom has no such anchor"),
        ('<a href="sub">c</a>', "leads to the folder sub"),
        ('<a href="../outside.html">c</a>', "../outside.html is not there"),
        ('<a href="file:///etc/hosts">c</a>', "leads to file:///etc/hosts"),
        ('<img src="c.png">', "c.png is not there"),
        ('<img srcset="c.png 2x">', "c.png is not there"),
        ('<img src="https://a.host/c.png"/>', "loads https://a.host/c.png"),
        ('<script src="//a.host/c.js"></script>', "loads //a.host/c.js"),
        ('<link rel="stylesheet" href="https://a.host/c.css">', "loads https://a.host/c.css"),
        ('<link rel="preconnect" href="https://a.host">', "loads https://a.host"),
        ('<iframe src="https://a.host"></iframe>', "loads https://a.host"),
        ("<style>p { background: url('https://a.host/c.png') }</style>", "loads https://a.host/c.png"),
        ('<p style="background: url(c.png)">c</p>', "c.png is not there"),
    ])  # fmt: skip
    def test_a_spoilt_one_names_page_and_link(self, small, spoilt, fault):
        (small.parent / "outside.html").write_text("outside")
        page = small / "index.html"
        page.write_text(page.read_text() + spoilt)
        assert faults(small) == [f"index.html: {fault}"]

    @pytest.mark.parametrize(("sheet", "fault"), [
        ('@import "https://a.host/c.css";', "loads https://a.host/c.css"),
        ("p { background: url(c.png) }", "c.png is not there"),
    ])  # fmt: skip
    def test_style_sheets_too(self, small, sheet, fault):
        (small / "a.css").write_text(sheet)
        assert faults(small) == [f"a.css: {fault}"]

    def test_an_empty_folder_is_no_site(self, tmp_path):
        assert faults(tmp_path) == [f"{tmp_path}: no pages"]


class TestBuild:
    """With Sphinx left out."""

    @pytest.fixture
    def rendered(self, monkeypatch):
        def render(pages, made, settings):
            shutil.copytree(pages, made)
            (made / "index.html").write_text('<a href="nowhere.html">a link of README</a>')

        monkeypatch.setattr(site, "_render", render)

    def test_a_broken_link_leaves_the_old_site(self, tmp_path, rendered):
        old = tmp_path / "site"
        old.mkdir()
        (old / "index.html").write_text("old")
        with pytest.raises(site.SiteFailed, match=r"index\.html: nowhere\.html is not there"):
            site.build(TOP, [], {}, old)
        assert (old / "index.html").read_text() == "old"

    def test_what_sphinx_complains_about_is_said_of_the_checkouts_own_files(self, tmp_path, monkeypatch):
        def run(command, **options):
            (*_, pages, _made) = command
            said = f"{pages}/index.md:3: WARNING: no such page\n{pages}/docs/own_robot.md:1: WARNING: nor this one\n"
            return subprocess.CompletedProcess(command, 1, "", said)

        monkeypatch.setattr(subprocess, "run", run)
        with pytest.raises(site.SiteFailed) as failed:
            site.build(TOP, [], {}, tmp_path / "site")
        assert str(failed.value).splitlines()[1:] == [
            "README.md:3: WARNING: no such page",
            "docs/own_robot.md:1: WARNING: nor this one",
        ]


class TestPages:
    def test_notebooks_stand_in_readmes_order_and_none_is_left_out(self, tmp_path):
        (tmp_path / "notebooks").mkdir()
        for name in ("a", "b", "c"):
            (tmp_path / "notebooks" / f"{name}.ipynb").touch()
        readme = "[a](notebooks/a.ipynb)\n## The notebooks\n[c](notebooks/c.ipynb) [a](notebooks/a.ipynb)"
        found = re.findall(r"^notebooks/(.)$", contents(readme, tmp_path), re.MULTILINE)
        assert found == ["c", "a", "b"]

    def test_a_claim_with_a_bar_in_it_stays_in_its_cell(self):
        row = {"id": "one", "section": "V", "statement": "a | b", "paper": [1.0, 2.0], "unit": "m", "measured": None,
               "judged_by": "ours", "verdict": "differs", "reason": "so it is", "parameters": {"height": 0.15},
               "notebook": "x", "varies": False, "tolerance": 0.0}  # fmt: skip
        text = claims_page([row])
        row = r"| [a \| b](#one) | 1, 2 m | no number | **differs**: so it is | ours | V; [notebook]"
        assert row + "(../notebooks/x.ipynb) |" in text
        assert "a | b: **differs**: so it is." in text
        assert "| verdict | **differs** |" in text
        assert "| parameters | height 0.15 |" in text
        assert "| notebook | [x](../notebooks/x.ipynb) |" in text
        assert not re.search(r"\| (reason|varies|tolerance) \|", text)


class TestStale:
    @pytest.fixture
    def top(self, tmp_path):
        for name in ("stepover/cli", "stepover/motion", "tools", "data", "figures", "notebooks", "build/notebooks"):
            (tmp_path / name).mkdir(parents=True)
        for name in ("stepover/motion/motion.py", "stepover/cli/plan.py", "tools/site.py", "data/robot.toml",
                     "data/README.md", "figures/table.csv", "figures/claims.json", "notebooks/a.ipynb"):  # fmt: skip
            (tmp_path / name).touch()
            os.utime(tmp_path / name, (100, 100))
        self.run(tmp_path)
        return tmp_path

    @staticmethod
    def run(top: Path, name: str = "a.ipynb", **papermill):
        executed = top / "build" / "notebooks" / name
        known = {"exception": None, "end_time": "2026", "parameters": {"output": "build/figures"}} | papermill
        executed.write_text(json.dumps({"metadata": {"papermill": known}}))
        os.utime(executed, (200, 200))

    def test_a_finished_run_will_do(self, top):
        assert site.stale(top, top / "notebooks" / "a.ipynb") == ""

    @pytest.mark.parametrize(
        "newer",
        ["notebooks/a.ipynb", "stepover/motion/motion.py", "data/robot.toml", "figures/table.csv"],
    )
    def test_not_one_that_is_older_than_what_it_shows(self, top, newer):
        os.utime(top / newer, (300, 300))
        assert site.stale(top, top / "notebooks" / "a.ipynb") == f"is older than {newer}"

    @pytest.mark.parametrize("newer", ["stepover/cli/plan.py", "tools/site.py", "data/README.md",
                                       "figures/claims.json"])  # fmt: skip
    def test_what_it_does_not_show_does_not_matter(self, top, newer):
        os.utime(top / newer, (300, 300))
        assert site.stale(top, top / "notebooks" / "a.ipynb") == ""

    @pytest.mark.parametrize("papermill", [{"exception": True}, {"end_time": None},
                                           {"parameters": {"output": "x", "quick": True}}])  # fmt: skip
    def test_not_one_that_failed_or_had_other_parameters(self, top, papermill):
        self.run(top, **papermill)
        assert "its own parameters" in site.stale(top, top / "notebooks" / "a.ipynb")

    @pytest.mark.parametrize("text", ["", "{}", '{"metadata": {}}'])
    def test_not_one_that_was_cut_short(self, top, text):
        (top / "build" / "notebooks" / "a.ipynb").write_text(text)
        assert "cannot be read" in site.stale(top, top / "notebooks" / "a.ipynb")

    def test_not_one_that_is_not_there(self, top):
        (top / "build" / "notebooks" / "a.ipynb").unlink()
        assert site.stale(top, top / "notebooks" / "a.ipynb") == "has not been run"

    def test_only_what_is_stale_is_run_and_its_figures_go_nowhere(self, top, monkeypatch, capsys):
        ran = []

        def run_notebook(notebook, executed, output, values):
            ran.append(notebook.stem)
            (output / "figure.png").touch()
            if notebook.stem == "c":
                raise NotebookFailed("notebook c")
            self.run(top, executed.name)

        monkeypatch.setattr(site, "run_notebook", run_notebook)
        monkeypatch.setattr(site, "build", lambda top, executed, views, place: [path.name for path in executed])
        monkeypatch.setattr(site, "crossings_of", lambda _: {})
        (top / "notebooks" / "b.ipynb").touch()
        os.utime(top / "notebooks" / "b.ipynb", (100, 100))
        assert site.make(top) == ["a.ipynb", "b.ipynb"]
        assert ran == ["b"]
        assert capsys.readouterr().out.splitlines()[0] == "notebook b has not been run: it is run"
        assert not list(top.rglob("*.png"))
        (top / "notebooks" / "c.ipynb").touch()
        with pytest.raises(NotebookFailed):
            site.make(top)
