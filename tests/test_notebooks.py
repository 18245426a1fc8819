"""The notebooks: thin, without outputs, and each one runs with quick parameters."""

import subprocess
import sys
from pathlib import Path

import nbformat
import pytest

from stepover.locations import checkout
from stepover.reproduction.claims import read_claims
from stepover.reproduction.run import parameters_of, run_notebook
from stepover.reproduction.verdicts import read_entries, take_records
from stepover.studies.agreement import NO

NOTEBOOKS = sorted((Path(__file__).parents[1] / "notebooks").glob("*.ipynb"))
FIGURES = {
    "adaptation": {"adaptation_clearance", "waist_yaw_frontier", "obstacle_plane"},
    "beyond_the_paper": {"crossing_optimal", "frontier", "limits_used", "optimal_strip"},
    "feasibility_domains": {"fig2_feasibility_domains", "feasibility_by_height", "feasibility_unit"},
    "landing_impact": {
        "fig3_leg_1_landing",
        "landing_forces",
        "landing_sensitivity",
        "spline_and_polynomial",
    },
    "quasi_static_vs_dynamic": {
        "duration_over_epsilon",
        "strategies_by_height",
        "strategies_from_above",
        "strategies_over_time",
        "strategies_strip",
    },
    "simplifications": set(),
    "tour": {"tour"},
    "pybullet_15cm": {"pybullet_zmp_and_waist", "pybullet_contact_forces", "pybullet_clearance", "fig10_strip"},
    "pybullet_25cm": {
        "crossing_25cm",
        "fig6_strip",
        "pybullet_25cm_clearance",
        "pybullet_25cm_contact_forces",
        "pybullet_25cm_zmp_and_waist",
    },
    "robustness": {"breaking_points", "robustness"},
    "servos_and_soles": {"estimator_error", "heights_with_servos", "stabilized"},
    "two_engines": {"two_engines"},
    "stepover_15cm": {
        "fig1_key_configuration",
        "fig4_block_diagram",
        "fig8_walking_direction",
        "fig9_lateral_direction",
        "preview_forms",
    },
    "stepover_25cm": {"fig5_stick_diagram", "fig7_waist_and_feet", "ubmg_lead_knee"},
}
OBSTACLES = {
    "adaptation": [0.15, 0.20, 0.25],
    **dict.fromkeys(("beyond_the_paper", "pybullet_25cm", "stepover_25cm"), 0.25),
}
"""Height [m] that a notebook has for a default, where it is not 0.15."""
COARSE = {"waist-yaw", "without-ubmg"}
"""Claims whose number is found on a coarser grid with quick parameters."""
WHATEVER_THE_HEIGHT = {
    "delta-ds": "a sweep over step lengths on the flat floor",
    "timing": "Sec. V's",
    "step-over-time": "Sec. V's timing",
    "clearance-15": "the path is laid so far above the margin, however high that is",
    "margin-25": "ideal motors keep the plan's clearance to 0.1 mm, and the plan keeps 33 mm over any height",
    "ubmg-waist-shift": "the arms as far back as they may go",
    "fta-lift": "no foot is lifted",
    "chest-for-arms": "the robot's",
    "fta-step": "no foothold is moved",
    "second-stage": "the largest error is at the touch-down of a normal step",
    "upper-body-mass": "the robot's",
    "vertical-acceleration": "a low obstacle needs no planned height; 25 cm is always there",
    "no-stop": "the slowest moment comes before the obstacle",
}
"""Numbers that another height of the obstacle need not change, and why."""
OTHERWISE = {
    "pybullet_15cm": "its claim is a word",
    "robustness": "refuses a motion that its table was not made from",
    "two_engines": "it has no claims",
    "beyond_the_paper": "it has no claims",
    "servos_and_soles": "its claim is read from a table over all heights",
}
"""Notebooks without a number that depends on the height."""
each = pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)


def code_cells(notebook):
    return [cell for cell in nbformat.read(notebook, as_version=4).cells if cell.cell_type == "code"]


def pictures_in(folder):
    return [path for path in folder.iterdir() if path.suffix in (".png", ".gif")]


def lines_of(cell):
    return [line for line in cell.source.splitlines() if line.strip() and not line.lstrip().startswith("#")]


def test_all_notebooks_are_known_here():
    assert {notebook.stem for notebook in NOTEBOOKS} == set(FIGURES)


@each
def test_runs_with_quick_parameters(notebook, tmp_path):
    run_notebook(notebook, tmp_path / "executed.ipynb", tmp_path, {"quick": True})
    drawn = {path.stem: path.read_bytes() for path in pictures_in(tmp_path)}
    assert set(drawn) == FIGURES[notebook.stem]
    assert all(len(content) > 10_000 for content in drawn.values())
    shown = [
        data["text/markdown"] for cell in code_cells(tmp_path / "executed.ipynb") for output in cell.outputs
        if "text/markdown" in (data := output.get("data", {}))
    ]  # fmt: skip
    assert not [text for text in shown if f"| {NO} |" in text], "what is stored is no longer so: run make studies"
    recorded = {row["id"]: row for row in take_records(tmp_path)}
    stored = {row["id"]: row for row in read_entries(checkout() / "figures" / "claims.json")}
    assert set(recorded) == {name for name, one in read_claims().items() if one.notebook == notebook.stem}
    for name, row in recorded.items():
        then = stored[name]["measured"]
        if stored[name]["varies"]:
            continue
        assert (name, row["verdict"]) == (name, stored[name]["verdict"])
        if name not in COARSE:
            assert row["measured"] == (then if isinstance(then, str) else pytest.approx(then, rel=0.01, abs=1e-6)), name


@pytest.mark.parametrize("name", sorted(set(FIGURES) - set(OTHERWISE)))
def test_another_height_gives_other_numbers(name, tmp_path):
    notebook = NOTEBOOKS[0].with_name(f"{name}.ipynb")
    defaults, lower = parameters_of(notebook), 0.02
    heights = {"heights": [height - lower for height in defaults.get("heights", [])]}
    values = {"height": defaults["height"] - lower} if "height" in defaults else heights
    run_notebook(notebook, tmp_path / "executed.ipynb", tmp_path, {"quick": True} | values)
    stored = {row["id"]: row for row in read_entries(checkout() / "figures" / "claims.json")}
    for row in take_records(tmp_path):
        then = stored[row["id"]]
        if not then["varies"] and row["id"] not in WHATEVER_THE_HEIGHT and not isinstance(row["measured"], str):
            assert row["measured"] != then["measured"], row["id"]


@each
def test_the_reference_figures_are_there(notebook):
    assert {path.stem for path in pictures_in(checkout() / "figures")} >= FIGURES[notebook.stem]


@each
def test_is_thin(notebook):
    cells = code_cells(notebook)
    assert max(len(lines_of(cell)) for cell in cells) <= 15
    lines = [line for cell in cells for line in lines_of(cell) if not line.startswith(("import ", "from "))]
    assert len(lines) <= 70
    assert not [line for cell in cells for line in lines_of(cell) if line.lstrip().startswith(("def ", "class "))]


@each
def test_prose_stands_before_every_cell_that_shows_something(notebook):
    kinds = [cell.cell_type for cell in nbformat.read(notebook, as_version=4).cells]
    assert kinds[0] == "markdown"
    assert "code code code code" not in " ".join(kinds)


@each
def test_parameters(notebook):
    defaults = parameters_of(notebook)
    height = defaults.get("height", defaults.get("heights"))
    assert {"width", "robot", "output", "quick"} <= set(defaults)
    assert (height, defaults["width"], defaults["quick"]) == (OBSTACLES.get(notebook.stem, 0.15), 0.05, False)


@each
def test_no_outputs_are_stored(notebook):
    assert all(cell.outputs == [] and cell.execution_count is None for cell in code_cells(notebook))
    assert subprocess.run([sys.executable, "-m", "nbstripout", "--verify", notebook]).returncode == 0
