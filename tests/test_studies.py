"""Long tables: resumable, parallel, and the stored one is that of today's planner."""

import os
import subprocess
import sys
from functools import wraps
from importlib import import_module
from pathlib import Path

import pytest
from conftest import HRP2

from stepover.errors import InvalidInput
from stepover.studies import breaking_points, landing, robustness, strategies, sweep, trials
from stepover.studies import fingerprint as fingerprints
from stepover.studies import obstacle_plane as plane
from stepover.studies import study as studies
from stepover.studies.agreement import YES
from stepover.studies.engines import convergence, samples
from stepover.studies.fingerprint import fingerprint, robot_files, sources
from stepover.studies.obstacle_plane import at, read_table, study
from stepover.studies.study import run_study, write_rows
from stepover.studies.sweep import Crossing, Point

POINTS = [Point(0.10, 0.02, physics=False), Point(0.30, 0.25, physics=False)]


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    """Folder of a small study that ran in one go."""
    folder = tmp_path_factory.mktemp("uninterrupted")
    study(POINTS, folder / "table.csv", folder, workers=1)
    return folder


@pytest.fixture(scope="module")
def stored():
    """The stored table."""
    return read_table()


def test_rows_say_what_became_of_each_obstacle(uninterrupted):
    crossed, refused = read_table(uninterrupted / "table.csv")
    assert crossed.planned
    assert crossed.planned_clearance >= 0.03
    assert len(crossed.motion) == 64
    assert crossed.crossed is None, "there was no physics"
    assert not refused.planned
    assert refused.motion is None
    assert "mm too near to the obstacle with its margins" in refused.reason


def test_a_resumed_study_equals_an_uninterrupted_one(uninterrupted, tmp_path, monkeypatch):
    monkeypatch.setattr(studies, "write_rows", lambda *_: sys.exit("killed"))
    with pytest.raises(SystemExit):
        study(POINTS, tmp_path / "table.csv", tmp_path, workers=1)
    monkeypatch.undo()
    (part,) = tmp_path.glob("*.part")
    lines = part.read_bytes().splitlines(keepends=True)
    assert len(lines) == 2
    part.write_bytes(lines[0] + lines[1][: len(lines[1]) // 2])  # killed while it wrote
    computed, cross = [], plane.cross
    monkeypatch.setattr(plane, "cross", wraps(cross)(lambda point: (computed.append(point), cross(point))[1]))
    study(POINTS, tmp_path / "table.csv", tmp_path, workers=1)
    assert computed == POINTS[1:]
    assert (tmp_path / "table.csv").read_bytes() == (uninterrupted / "table.csv").read_bytes()


def test_nothing_stays_beside_a_finished_table(uninterrupted):
    assert os.listdir(uninterrupted) == ["table.csv"]


def test_a_finished_study_computes_nothing(uninterrupted, tmp_path, monkeypatch):
    table, build = tmp_path / "table.csv", tmp_path / "build"
    computed, cross = [], plane.cross
    monkeypatch.setattr(plane, "cross", wraps(cross)(lambda point: (computed.append(point), cross(point))[1]))
    study(POINTS, table, build, workers=1)
    assert computed == POINTS
    assert list(build.glob("*.part")) == []
    study(POINTS, table, build, workers=1)
    assert computed == POINTS
    assert table.read_bytes() == (uninterrupted / "table.csv").read_bytes()
    table.write_text("another")
    study(POINTS, table, build, workers=1)
    assert computed == POINTS * 2
    study(POINTS[:1], table, build, workers=1)
    assert computed == POINTS * 2 + POINTS[:1]
    assert len(read_table(table)) == 1


def test_processes_give_the_same_rows_in_the_same_order(tmp_path):
    points = [Point(0.35, 0.25, physics=False), Point(0.30, 0.25, physics=False)]
    rows = run_study(points, plane.cross, tmp_path / "two.part", workers=2)
    assert rows == [plane.cross(point) for point in points]


def test_an_error_ends_the_study_and_keeps_what_is_done(tmp_path):
    with pytest.raises(ZeroDivisionError):
        run_study([1, 2, 0, 4], lambda x: {"inverse": 1 / x}, tmp_path / "part", workers=1)
    computed = []
    rows = run_study([1, 2, 4], lambda x: computed.append(x) or {"inverse": 1 / x}, tmp_path / "part", workers=1)
    assert computed == [4]
    assert [row["inverse"] for row in rows] == [1.0, 0.5, 0.25]


def test_a_damaged_part_file_is_refused(tmp_path):
    (tmp_path / "part").write_bytes(b'["1", {"inverse": 1.0}]\n[\n')
    with pytest.raises(InvalidInput, match="delete it"):
        run_study([1, 2], lambda x: {"inverse": 1 / x}, tmp_path / "part", workers=1)


def test_the_fingerprint_follows_the_code_and_what_is_named(monkeypatch):
    now = fingerprint(plane.cross, "hrp2")
    assert now == fingerprint(plane.cross, "hrp2")
    assert now != fingerprint(plane.cross, "hrp2", "0.2")
    assert now != fingerprint(landing.carry_out, "hrp2")
    code = sources(sweep.__name__)
    monkeypatch.setattr(fingerprints, "sources", lambda module: code[1:])
    assert now != fingerprint(plane.cross, "hrp2")


@pytest.mark.parametrize(
    "work",
    [
        plane.cross, strategies.cross, trials.carry_out, robustness.Trial, landing.carry_out,
        breaking_points.carry_out, convergence.carry_out, samples.carry_out,
    ],
)  # fmt: skip
def test_all_code_that_rows_depend_on_counts(work):
    """What a fresh Python loads with the module is among what its imports say."""
    code = (
        f"import sys, {work.__module__};"
        "print(*[m.__file__ for name, m in sys.modules.items() if name.partition('.')[0] == 'stepover'])"
    )
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert len(loaded) > 20
    assert set(loaded) <= {str(path) for path in sources(work.__module__)}


def test_other_code_does_not_count():
    rooms = {path.relative_to(fingerprints.FOLDER).parts[0] for path in sources(trials.__name__)}
    assert {"planning", "simulation", "studies", "__init__.py"} <= rooms
    assert not {"report", "reproduction", "cli"} & rooms
    names = {path.name for path in sources(trials.__name__)}
    assert "trials.py" in names
    assert not {"sweep.py", "landing.py", "robustness.py"} & names


def test_a_change_in_the_code_or_in_a_mesh_counts(spoilt, monkeypatch):
    robot = spoilt({})
    files = robot_files(str(robot))
    assert {path.suffix for path in files} == {".toml", ".urdf", ".obj"}
    assert [path.name for path in files if path.suffix == ".obj"] == sorted(p.name for p in HRP2.glob("*.obj"))
    now, read = fingerprint(plane.cross, str(robot)), Path.read_bytes
    for kind in (".obj", ".urdf", ".py"):
        monkeypatch.setattr(Path, "read_bytes", lambda path, kind=kind: read(path) + b"\n" * (path.suffix == kind))
        assert fingerprint(plane.cross, str(robot)) != now, kind
    monkeypatch.setattr(Path, "read_bytes", read)
    assert fingerprint(plane.cross, str(robot)) == now


def test_imports_inside_functions_count_those_for_types_do_not(tmp_path, monkeypatch):
    text = """
from typing import TYPE_CHECKING
if TYPE_CHECKING:
    from stepover.cli.plan import plan
else:
    import stepover.model.gravity

def work():
    from stepover.motion.motion import Motion
"""
    (tmp_path / "own_study.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    import_module("own_study")
    names = {path.name for path in sources("own_study")}
    assert {"own_study.py", "motion.py", "gravity.py", "errors.py"} <= names
    assert "plan.py" not in names


def test_tables_are_read_back(tmp_path):
    known = {"robot": "hrp2", "version": "0", "width": 0.05, "margin_height": 0.03, "margin_width": 0.03}
    rows = [
        Crossing(height=0.2, planned=False, reason="too high, too wide", **known),
        Crossing(height=0.1, planned=True, motion="abc", crossed=False, simulated_clearance=-0.001, **known),
    ]
    write_rows(rows, tmp_path / "table.csv")
    assert read_table(tmp_path / "table.csv") == rows
    assert at(rows, 0.1, 0.05) is rows[1]
    with pytest.raises(InvalidInput, match=r"no obstacle 0\.300 m high"):
        at(rows, 0.3, 0.05)


def test_what_is_no_table_is_refused(tmp_path):
    with pytest.raises(InvalidInput, match="make studies"):
        read_table(tmp_path / "none.csv")
    (tmp_path / "other.csv").write_text("height,colour\n0.1,red\n")
    with pytest.raises(InvalidInput, match="not a table of this study"):
        read_table(tmp_path / "other.csv")


def test_the_stored_table_is_whole(stored):
    assert [(row.height, row.width) for row in stored] == sorted((p.height, p.width) for p in plane.whole_plane())


@pytest.mark.parametrize("sizes", plane.SAMPLE)
def test_todays_planner_plans_the_stored_motions(stored, sizes):
    _, agrees = plane.again(at(stored, *sizes), physics=False)
    assert agrees == YES, "the planner has changed: run make studies"


def test_what_is_planned_crosses(stored):
    for row in (row for row in stored if row.planned):
        assert row.crossed, row
        assert row.planned_clearance >= 0.03, row
        assert row.simulated_clearance >= 0.025, row
        assert row.zmp_margin >= 0.015, row


def test_what_must_be_crossed_is(stored):
    corners = (*plane.CORNERS, (0.25, 0.05))
    must = [row for row in stored if any(row.height <= h and row.width <= w for h, w in corners)]
    assert len(must) == 30
    assert all(row.crossed for row in must)


def test_what_is_refused_says_why(stored):
    refused = [row for row in stored if not row.planned]
    assert refused
    assert all("mm" in row.reason or "of its" in row.reason for row in refused)
