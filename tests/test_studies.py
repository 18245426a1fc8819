"""Long tables: resumable, parallel, and the stored one is that of today's planner."""

import shutil

import pytest

from stepover.errors import InvalidInput
from stepover.studies import obstacle_plane as plane
from stepover.studies import study as studies
from stepover.studies.agreement import YES
from stepover.studies.obstacle_plane import at, read_table, study
from stepover.studies.study import fingerprint, run_study, write_rows
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
    (part,) = uninterrupted.glob("*.part")
    lines = part.read_bytes().splitlines(keepends=True)
    assert len(lines) == 2
    (tmp_path / part.name).write_bytes(lines[0] + lines[1][: len(lines[1]) // 2])  # killed while it wrote
    computed = []
    cross = plane.cross
    monkeypatch.setattr(plane, "cross", lambda point: (computed.append(point), cross(point))[1])
    study(POINTS, tmp_path / "table.csv", tmp_path, workers=1)
    assert computed == POINTS[1:]
    assert (tmp_path / "table.csv").read_bytes() == (uninterrupted / "table.csv").read_bytes()
    assert (tmp_path / part.name).read_bytes() == part.read_bytes()


def test_a_finished_study_computes_nothing(uninterrupted, tmp_path, monkeypatch):
    shutil.copytree(uninterrupted, tmp_path, dirs_exist_ok=True)
    monkeypatch.setattr(plane, "cross", None)
    study(POINTS, tmp_path / "table.csv", tmp_path)
    assert (tmp_path / "table.csv").read_bytes() == (uninterrupted / "table.csv").read_bytes()


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
    now = fingerprint("hrp2")
    assert now == fingerprint("hrp2")
    assert now != fingerprint("hrp2", "0.2")
    monkeypatch.setattr(studies, "INDEPENDENT", studies.INDEPENDENT[1:])
    assert now != fingerprint("hrp2")


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
