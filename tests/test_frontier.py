"""The optimiser's studies: which obstacles they hold, what their tables say, and how they are shown."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from stepover.errors import Infeasible
from stepover.locations import checkout
from stepover.report import figures
from stepover.report.tables import optimal as tables
from stepover.studies import obstacle_plane
from stepover.studies.optimal import disturbed, frontier


@pytest.fixture(scope="module")
def found():
    """The stored table of obstacles."""
    return frontier.read_table()


@pytest.fixture(scope="module")
def draws():
    """The stored table of disturbances."""
    return disturbed.read_table()


def test_random_obstacles_lie_in_the_region_of_the_corners():
    sizes = frontier.random_obstacles()
    assert len(set(sizes)) == frontier.RANDOM == 60
    assert sizes == frontier.random_obstacles()
    assert sizes != frontier.random_obstacles(seed=1)
    for height, width in sizes:
        assert 0.15 <= height <= 0.45
        assert 0.05 <= width <= frontier.widest(height) + 5e-4
    heights = [height for height, _ in sizes]
    assert min(heights) < 0.17, "the whole region"
    assert max(heights) > 0.38, "the whole region"


def test_the_region_ends_at_the_corners():
    assert [frontier.widest(height) for height in (0.15, 0.22, 0.45)] == [0.25, 0.12, 0.05]
    assert frontier.widest(0.185) == pytest.approx((0.25 + 0.12) / 2.0)


def test_the_stored_table_is_whole(found, draws):
    assert [(row.group, row.height, row.width) for row in found] == [
        (point.group, point.height, point.width) for point in frontier.points()
    ]
    assert [(row.planner, row.height, row.draw) for row in draws] == [
        (*case, number) for case in disturbed.CASES for number in range(disturbed.RUNS)
    ]


def test_the_corners_cross_in_both_engines_with_every_limit_kept(found):
    """What docs/optimal.md says. Where it fails after `make frontier`, that page needs another look."""
    corners = [row for row in found if row.group == "corner"]
    assert len(corners) == 9
    for row in corners:
        assert row.planned
        assert row.speed_ratio <= 1.0
        assert row.torque_ratio <= 1.0
        assert row.zmp_margin >= 0.015
        assert min(row.pybullet_ideal, row.mujoco_ideal) >= 0.028
        assert min(row.pybullet_real, row.mujoco_real) >= 0.02
        assert row.pybullet_saturated < 0.01 * row.samples
    often = {(row.height, row.width) for row in corners if row.mujoco_saturated >= 0.01 * row.samples}
    assert often == {(0.15, 0.25)}, "docs/optimal.md names it"


def test_what_lies_between_the_corners_crosses_too(found):
    between = [row for row in found if row.group == "random"]
    assert all(row.planned and row.mujoco_ideal >= 0.028 and row.mujoco_real >= 0.02 for row in between)


def test_the_page_on_the_optimiser_says_the_same(found, draws):
    page = " ".join((checkout() / "docs" / "optimal.md").read_text().split())
    for line in tables.frontier_table(found).rows:
        assert line[1] == "refused" or f"| {' | '.join(line)} |" in page, line[0]
    count, _, crossed, ideal, real, _ = tables.random_table(found).rows[0]
    assert f"{count} random obstacles" in page
    assert crossed == count
    assert f"by {ideal} and {real} mm or more" in page
    told = [line[1] for line in tables.disturbed_table(draws).rows]
    assert told[1:] == ["100 of 100"] * 3
    assert f"{told[0]} do" in page


def test_how_high_it_goes(found):
    higher = {row.height: row for row in found if row.group == "higher"}
    assert higher[0.475].planned
    assert not higher[0.50].planned
    assert "BODY and LLEG_LINK2" in higher[0.50].reason


def test_its_motions_are_more_robust(draws):
    good = {case: sum(row.success for row in draws if (row.planner, row.height) == case) for case in disturbed.CASES}
    assert all(good[case] >= good["paper", 0.25] for case in disturbed.CASES)


def test_a_refusal_is_a_row(monkeypatch):
    def refuse(robot, obstacle, look_for_nearest):
        assert not look_for_nearest
        raise Infeasible("too high")

    monkeypatch.setattr(frontier, "optimal_in_detail", refuse)
    row = frontier.Found(**frontier.carry_out(frontier.Point("higher", 0.9, 0.05)))
    assert (row.planned, row.reason, row.clearance, row.mujoco_ideal) == (False, "too high", None, None)


def test_tables_and_figure(found, draws):
    lines = tables.frontier_table(found).rows
    assert [line[0] for line in lines[:2]] == ["15 x 5", "20 x 5"]
    assert lines[-1][:2] == ("50 x 5", "refused")
    assert tables.random_table(found).rows[0][:3] == ("60", "60", "60")
    fallen = [dataclasses.replace(row, mujoco_real=-1.0) if row.group == "random" else row for row in found]
    assert tables.random_table(fallen).rows[0][2] == "0"
    assert next(line[0] for line in tables.disturbed_table(draws).rows) == "Algorithm 1, 25 cm"
    figure = figures.frontier(obstacle_plane.read_table(), found)
    shown = sum(len(points.get_offsets()) for points in figure.axes[0].collections)
    assert shown == len(found) + sum(bool(row.planned and row.crossed) for row in obstacle_plane.read_table())


def test_the_limits_of_a_motion(robot, planned):
    """The largest values in the figure are those that the table states."""
    figure = figures.limits_used(robot, {"15 cm": planned.motion})
    speed, torque, margin = (axis.lines[0].get_ydata() for axis in figure.axes)
    line = tables.planners_table(robot, {"15 cm": planned.motion}).rows[0]
    assert f"{speed.max():.2f}" == line[3].split()[0]
    assert f"{torque.max():.2f}" == line[4].split()[0]
    assert margin.min() == pytest.approx(float(line[2]), abs=0.051)
    assert np.isfinite(margin).all()
