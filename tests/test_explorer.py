"""report/explorer.py: a slider that is moved changes the picture and the numbers, headless and in a kernel."""

from __future__ import annotations

import base64

import nbformat
import pytest
from matplotlib import pyplot as plt
from nbclient import NotebookClient

from stepover.model.obstacle import Obstacle
from stepover.report import explorer as explorers
from stepover.report.explorer import Explorer, height_slider, obstacle_sliders

PNG = b"\x89PNG"


@pytest.fixture
def drawn(monkeypatch):
    """Titles of the figures that have been drawn."""
    titles = []

    def png(figure):
        titles.append(figure.get_suptitle())
        return PNG + titles[-1].encode()

    monkeypatch.setattr(explorers, "_png", png)
    return titles


def test_a_slider_replans_and_draws(robot, drawn):
    explorer = obstacle_sliders(robot, Obstacle(0.15, 0.05))
    assert drawn[-1].startswith("15 cm high, 5 cm wide: step 39.4 cm")
    assert "clearance 33.0 mm" in drawn[-1]
    first = explorer.picture
    explorer.sliders["height"].value = 5.0
    assert drawn[-1].startswith("5 cm high, 5 cm wide: step 35.9 cm")
    assert explorer.picture != first
    explorer.sliders["margin"].value = 2.0
    assert "clearance 23.0 mm" in drawn[-1]
    explorer.sliders["width"].value = 8.0
    assert drawn[-1].startswith("5 cm high, 8 cm wide")
    assert explorer.status.value == "height 5 cm, width 8 cm, margin 2 cm"


def test_what_was_drawn_is_not_drawn_again(robot, drawn):
    explorer = obstacle_sliders(robot, Obstacle(0.15, 0.05))
    first = explorer.picture
    for height in (10.0, 15.0):
        explorer.sliders["height"].value = height
    assert (explorer.picture, len(drawn)) == (first, 2)


def test_an_impossible_obstacle_says_why(robot, drawn):
    explorer = obstacle_sliders(robot, Obstacle(0.15, 0.05))
    explorer.sliders["width"].value = 30.0
    assert "cannot be crossed. no key configuration: 0.300 m of width" in drawn[-1]
    explorer.sliders["width"].value = 5.0
    assert b"clearance" in explorer.picture


def test_no_figure_is_left_open(robot):
    explorer = obstacle_sliders(robot, Obstacle(0.05, 0.05))
    explorer.sliders["width"].value = 30.0
    assert explorer.picture.startswith(PNG)
    assert plt.get_fignums() == []


def test_a_slider_makes_room_for_where_it_stands(robot, drawn):
    explorer = obstacle_sliders(robot, Obstacle(0.5, 0.05, 0.08, 0.08))
    assert (explorer.sliders["height"].value, explorer.sliders["height"].max) == (50.0, 50.0)
    assert explorer.sliders["margin"].value == 8.0


def test_the_height_of_the_domains(robot):
    explorer = height_slider(robot, 0.05, 0.15, points=30)
    slider, first = explorer.sliders["height"], explorer.picture
    assert (slider.value, first[:4]) == (15.0, PNG)
    slider.value = 25.0
    assert explorer.picture != first
    slider.value = 15.0
    assert explorer.picture == first


def test_outside_of_a_notebook_nothing_is_shown(robot, drawn, capsys):
    Explorer(lambda height: plt.Figure(), height=(0.1, 0.0, 0.2, 0.01)).sliders["height"].value = 5.0
    assert capsys.readouterr().out == ""


def test_in_a_kernel_the_picture_is_replaced_in_its_place():
    """An executed notebook holds the picture of the last state once, as an ordinary output."""
    cells = ["from matplotlib.figure import Figure\nfrom stepover.report.explorer import Explorer\n"
             "e = Explorer(lambda side: Figure((side, side)), side=(0.5, 0.1, 1.0, 0.1))\ne",
             "first = e.picture; e.sliders['side'].value = 100.0; first != e.picture"]  # fmt: skip
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    NotebookClient(notebook, kernel_name="python3", timeout=120).execute()
    shown, moved = (cell.outputs for cell in notebook.cells)
    assert moved[-1].data["text/plain"] == "True"
    assert ["image/png" in output.data for output in shown] == [False, True]
    assert len(moved) == 1
    width = int.from_bytes(base64.b64decode(shown[1].data["image/png"])[16:20], "big")
    assert width == explorers.RESOLUTION
