"""report/strategy_study.py: both strategies by height and epsilon; the stored table is that of today's planners."""

from __future__ import annotations

import dataclasses

import pytest

from stepover.report.tables.strategies import reach
from stepover.studies import strategies as strategy_study
from stepover.studies.agreement import NEARLY, NO, YES
from stepover.studies.strategies import EPSILON, HEIGHT, QUICK, WIDTH, Crossed, Point, again, by_height, over
from stepover.studies.study import write_rows

SAMPLE = (
    Point(HEIGHT, epsilon=EPSILON), Point(HEIGHT, epsilon=QUICK), Point(0.18, epsilon=EPSILON),
    Point(0.19, epsilon=EPSILON), Point(HEIGHT), Point(0.25),
)  # fmt: skip


@pytest.fixture(scope="module")
def stored():
    """The stored table."""
    return strategy_study.read_table()


def crossed(height, epsilon, **known):
    """A row by hand."""
    return Crossed("hrp2", "0", height, 0.05, epsilon, 0.03, 0.03, planned=True, **{"crossed": True} | known)


def test_the_stored_table_is_whole(stored):
    assert [(row.height, row.width, row.epsilon) for row in stored] == [
        (point.height, point.width, point.epsilon) for point in strategy_study.points()
    ]


@pytest.mark.parametrize("point", SAMPLE, ids=str)
def test_todays_planners_plan_the_stored_motions(stored, point):
    new, agrees = again(stored, dataclasses.replace(point, physics=False))
    assert agrees == YES, "a planner has changed: run make studies"
    assert new.crossed is None


def test_again_sees_another_motion_and_another_result(stored, monkeypatch):
    (row,) = (row for row in stored if (row.height, row.epsilon) == (HEIGHT, None))
    point = Point(HEIGHT)
    near = {"simulated_clearance": row.simulated_clearance + 0.001}
    for change, verdict in (
        ({}, YES), (near, NEARLY), ({"motion": "0" * 64}, NO), ({"simulated_clearance": 0.0}, NO),
        ({"crossed": False}, NO),
    ):  # fmt: skip
        new = dataclasses.asdict(dataclasses.replace(row, **change))
        monkeypatch.setattr(strategy_study, "cross", lambda point, new=new: new)
        assert again(stored, point)[1] == verdict
    assert again([], point)[1] == "not in the table"


def test_what_is_planned_crosses_with_the_margins_it_keeps(stored):
    planned = [row for row in stored if row.planned]
    assert len(planned) > 35
    for row in planned:
        assert row.crossed, row
        assert row.planned_clearance >= row.margin, row
        assert row.simulated_clearance > row.margin - 0.005, row
        assert row.margin == (0.01 if row.not_with_margins else 0.03), row


def test_what_is_refused_says_phase_and_condition(stored):
    refused = [row for row in by_height(stored, EPSILON) if not row.planned]
    assert refused
    assert all("margins of 10 mm" in row.reason and "phase" in row.reason and "(6)" in row.reason for row in refused)
    assert all(row.motion is None and row.crossed is None for row in refused)


def test_the_papers_numbers(stored):
    """About 40 s and 15 s at 1 mm; a ratio of about 10 from lift-off to landing; 3.04 s and 40 ms dynamically."""
    slow = {row.epsilon: row for row in over(stored, HEIGHT, WIDTH)}
    assert slow[EPSILON].duration == pytest.approx(40.0, rel=0.15)
    assert slow[EPSILON].double_support == pytest.approx(15.0, rel=0.15)
    assert (slow[None].over, slow[None].double_support) == (3.04, 0.04)
    assert slow[EPSILON].over / slow[None].over == pytest.approx(10.0, rel=0.05)
    for epsilon, row in slow.items():
        if epsilon is not None:
            assert row.duration == pytest.approx(slow[EPSILON].duration * (EPSILON / epsilon) ** 0.5, rel=0.01)
            assert 0.9 * epsilon < row.apart < 1.2 * epsilon


def test_dynamically_it_goes_higher(stored):
    heights = [float(row[1]) for row in reach(stored).rows]
    assert heights[0] < 15.0 < heights[1] < 20.0 < 25.0 <= heights[2]


def test_reach_by_hand():
    slow = [
        crossed(0.05, EPSILON),
        crossed(0.06, EPSILON, not_with_margins="(6)"),
        crossed(0.07, EPSILON, crossed=False, reason="(8)"),
    ]
    fast = [crossed(0.05, None), crossed(0.06, None), crossed(0.07, None, crossed=None, reason="knee")]
    rows = [tuple(row[1:]) for row in reach(slow[::-1] + fast).rows]
    assert rows == [("5", "(6)"), ("6", "(8)"), ("6", "knee")]


def test_rows_are_read_back_as_they_were(tmp_path):
    rows = [crossed(0.05, EPSILON, motion="abc"), crossed(0.05, None, crossed=None)]
    write_rows(rows, tmp_path / "table.csv")
    assert strategy_study.read_table(tmp_path / "table.csv") == rows


def test_a_crossing_that_is_refused_leaves_a_reason():
    row = Crossed(**strategy_study.cross(Point(0.45)))
    assert (row.planned, row.motion, row.crossed) == (False, None, None)
    assert row.reason


def test_the_dynamic_crossing_is_the_faster_the_smaller_epsilon_is():
    crossed = strategy_study.over(strategy_study.read_table(), 0.15, 0.05)
    ratios = strategy_study.speed_ups(crossed)
    assert list(ratios) == sorted([*strategy_study.EPSILONS, strategy_study.EPSILON])
    assert list(ratios.values()) == sorted(ratios.values(), reverse=True)
    assert ratios[0.0005] == pytest.approx(42.485 / 3.04)
    assert strategy_study.speed_ups(crossed[:-1]) == {}, "no dynamic crossing to compare with"
