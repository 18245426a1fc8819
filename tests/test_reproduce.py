"""The reproduction run: what succeeds moves to its place, what fails is named and changes nothing."""

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

from stepover.errors import InvalidInput
from stepover.reproduction import run as module
from stepover.reproduction.run import NotebookFailed, find_notebooks, parameter_value, reproduce

PARAMETERS = 'height = 0.15  # m\nsteps = 7\nrobot = "hrp2"\noutput = "."\nquick = False'
DRAW = 'from pathlib import Path\n\nPath(output, "drawn.txt").write_text(f"{height} {steps} {robot} {quick}")'


def write(top, name, *cells):
    """A notebook with a parameter cell, a line of prose, and these code cells."""
    parameters = new_code_cell(PARAMETERS, metadata={"tags": ["parameters"]})
    body = [new_markdown_cell("# Prose"), parameters, *(new_code_cell(cell) for cell in cells)]
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    (top / "notebooks").mkdir(exist_ok=True)
    nbformat.write(new_notebook(cells=body, metadata={"kernelspec": kernel}), top / "notebooks" / f"{name}.ipynb")


@pytest.fixture
def top(tmp_path):
    """A checkout with an old figure in it."""
    (tmp_path / "figures").mkdir()
    (tmp_path / "figures" / "drawn.txt").write_text("old")
    return tmp_path


def test_what_succeeds_moves_to_figures(top):
    write(top, "good", DRAW)
    assert reproduce(top) == [top / "figures" / "drawn.txt"]
    assert (top / "figures" / "drawn.txt").read_text() == "0.15 7 hrp2 False"
    assert (top / "build" / "notebooks" / "good.ipynb").is_file()
    assert not (top / "build" / "staging" / "good").exists()


def test_own_parameters_go_to_build(top):
    write(top, "good", DRAW)
    own = {"height": "1", "steps": "9", "robot": "7", "quick": "true"}
    assert reproduce(top, "good", own) == [top / "build" / "figures" / "drawn.txt"]
    assert (top / "build" / "figures" / "drawn.txt").read_text() == "1.0 9 7 True"
    assert (top / "figures" / "drawn.txt").read_text() == "old"
    assert (top / "build" / "experiment" / "good.ipynb").is_file()
    assert not (top / "build" / "notebooks").exists(), "the reference's executed copies stay as they were"


def test_an_experiment_goes_on_after_a_notebook_that_refuses_it(top, monkeypatch):
    ran = []

    def run_notebook(notebook, executed, output, values, label):
        ran.append((executed.parent.name, label))
        if notebook.stem != "c":
            raise NotebookFailed(f"notebook {notebook.stem}: no", {"a": 3, "b": 2}[notebook.stem])

    for name in "abc":
        write(top, name, DRAW)
    monkeypatch.setattr(module, "run_notebook", run_notebook)
    with pytest.raises(NotebookFailed, match=r"2 of 3 notebooks failed .*: notebook a: no; notebook b: no") as caught:
        reproduce(top, None, {"height": "0.1"})
    assert caught.value.exit_code == 3
    assert ran == [("experiment", f"{k} of 3: {name}") for k, name in enumerate("abc", start=1)]
    ran.clear()
    with pytest.raises(NotebookFailed, match=r"^notebook a: no"):
        reproduce(top)
    assert ran == [("notebooks", "1 of 3: a")], "the reference run ends at once"


def test_a_failing_notebook_is_named_and_the_old_figures_stay(top):
    write(top, "bad", DRAW, "# why\n\nfirst = 1\nraise ValueError('too high')")
    with pytest.raises(NotebookFailed) as caught:
        reproduce(top)
    for words in ("notebook bad", "code cell 3", "'first = 1'", "ValueError: too high", "build/notebooks/bad.ipynb"):
        assert words in str(caught.value)
    assert caught.value.exit_code == 1
    assert (top / "figures" / "drawn.txt").read_text() == "old"


def test_an_obstacle_that_cannot_be_crossed_has_its_exit_code(top):
    write(top, "bad", 'from stepover import Infeasible\n\nraise Infeasible("too high")')
    with pytest.raises(NotebookFailed, match=r"code cell 2 .*Infeasible: too high") as caught:
        reproduce(top)
    assert caught.value.exit_code == 3


def test_a_kernel_that_dies_is_no_success(top):
    write(top, "bad", DRAW, "import os\n\nos._exit(1)")
    with pytest.raises(NotebookFailed, match=r"notebook bad: .*[Kk]ernel"):
        reproduce(top)
    assert (top / "figures" / "drawn.txt").read_text() == "old"


def test_a_run_that_was_killed_leaves_nothing_for_the_next(top, monkeypatch):
    write(top, "good", DRAW)
    left = top / "build" / "staging" / "good"
    left.mkdir(parents=True)
    (left / "half.png").write_text("half")
    monkeypatch.setattr(module, "run_notebook", lambda *_: None)
    assert reproduce(top) == []
    assert not (top / "figures" / "half.png").exists()


def test_a_full_disk_is_one_clear_error(top, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    write(top, "good", DRAW)
    monkeypatch.setattr(module, "run_notebook", full)
    with pytest.raises(NotebookFailed, match=r"good: .*No space left"):
        reproduce(top)


@pytest.mark.parametrize("name", ["hight", "output"])
def test_unknown_parameters_are_refused_before_anything_runs(top, name, monkeypatch):
    write(top, "good", DRAW)
    monkeypatch.setattr(module, "run_notebook", lambda *_: pytest.fail("it ran"))
    with pytest.raises(InvalidInput, match=f"unknown parameter '{name}'.*height, quick, robot, steps"):
        reproduce(top, None, {name: "1"})


def test_a_parameter_goes_to_the_notebooks_that_know_it(top, monkeypatch):
    write(top, "good", DRAW)
    write(top, "other", DRAW)
    text = (top / "notebooks" / "other.ipynb").read_text().replace("steps", "hops")
    (top / "notebooks" / "other.ipynb").write_text(text)
    given = {}
    monkeypatch.setattr(
        module, "run_notebook", lambda notebook, _, __, values, ___: given.update({notebook.stem: values})
    )
    reproduce(top, None, {"steps": "3", "height": "0.2"})
    assert given == {"good": {"steps": 3, "height": 0.2}, "other": {"height": 0.2}}


@pytest.mark.parametrize(
    ("text", "default", "value"),
    [
        ("0.2", 0.15, 0.2),
        ("1", 0.15, 1.0),
        ("3", 7, 3),
        ("true", False, True),
        ("False", True, False),
        ("7", "hrp2", "7"),
        ("a b", "hrp2", "a b"),
    ],
)
def test_values_have_the_type_of_their_default(text, default, value):
    found = parameter_value("p", text, default)
    assert (found, type(found)) == (value, type(default))


@pytest.mark.parametrize(
    ("text", "default"),
    [("nan", 0.15), ("inf", 0.15), ("1e999", 0.15), ("high", 0.15), ("True", 0.15), ("0.5", 7), ("1", False)],
)
def test_values_of_another_type_are_refused(text, default):
    with pytest.raises(InvalidInput, match=r"parameter p = .* must be .*, such as"):
        parameter_value("p", text, default)


def test_notebooks_by_name(top):
    write(top, "b", DRAW)
    write(top, "a", DRAW)
    assert [path.stem for path in find_notebooks(top)] == ["a", "b"]
    for name in ("b", "b.ipynb", "notebooks/b.ipynb"):
        assert [path.stem for path in find_notebooks(top, name)] == ["b"]
    with pytest.raises(InvalidInput, match="unknown notebook 'c': known are a, b"):
        find_notebooks(top, "c")


def test_what_is_no_notebook(top):
    write(top, "good", DRAW)
    (top / "notebooks" / "odd.ipynb").write_text("{}")
    with pytest.raises(InvalidInput, match=r"odd\.ipynb cannot be read as a notebook"):
        reproduce(top)
