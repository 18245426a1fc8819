"""report/key_domain.py: all key configurations in 3-D and the frontier of the feasibility unit, Sec. III-A, III-C3."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from stepover import Infeasible, InvalidInput, Obstacle
from stepover.analysis.key_domain import (
    first_found,
    frontier,
    frontiers,
    highest_obstacle,
    key_domain,
    key_grid,
    yaw_gains,
)
from stepover.planning.algorithm_1.feasibility import key_configurations

STEP = 0.01


@pytest.fixture(scope="module")
def grids(robot):
    """Waist ahead and turned."""
    return {yaw: key_grid(robot, STEP, yaw) for yaw in (0.0, robot.feasibility.waist_yaw_deg)}


@pytest.fixture(scope="module")
def turned(robot, grids):
    return grids[robot.feasibility.waist_yaw_deg]


@pytest.mark.parametrize("height", [0.10, 0.15, 0.20, 0.25])
def test_the_first_in_its_order_is_the_one_that_fu_takes(robot, turned, height):
    obstacle = Obstacle(height, 0.05)
    key = key_configurations(robot, obstacle)[0]
    domain = key_domain(robot, obstacle, turned) & turned.searched(robot)
    x_ads, z_hds = first_found(domain, turned)
    assert x_ads == pytest.approx(key.x_ads, abs=STEP)
    assert z_hds == pytest.approx(key.z_hds, abs=STEP)


def test_fu_searches_from_normal_walking_down(robot, turned):
    rows = turned.searched(robot).any(axis=1)
    assert turned.z_hds[rows].max() == pytest.approx(robot.posture.waist_height)
    assert turned.z_hds[rows].min() >= robot.feasibility.waist_height_min - 1e-9
    assert turned.x_ads[turned.searched(robot).any(axis=0)].max() == pytest.approx(robot.feasibility.step_length_max)
    np.testing.assert_allclose(np.diff(turned.z_hds), STEP)
    np.testing.assert_allclose(np.diff(turned.x_ads), STEP)


def test_higher_obstacles_leave_less_and_never_something_new(robot, grids):
    for grid in grids.values():
        masks = [key_domain(robot, Obstacle(height, 0.05), grid) for height in (0.10, 0.15, 0.20, 0.25, 0.30)]
        for low, high in pairwise(masks):
            assert not (high & ~low).any()
            assert high.sum() < low.sum()


def test_turning_the_waist_leaves_more_room_and_raises_the_frontier(robot, grids):
    straight, turned = grids.values()
    for height in (0.10, 0.15, 0.20, 0.25, 0.30):
        areas = [key_domain(robot, Obstacle(height, 0.05), grid).sum() for grid in (straight, turned)]
        assert areas[1] > areas[0]
    widths = np.array([0.05, 0.15, 0.25])
    assert (frontier(robot, widths, turned) > frontier(robot, widths, straight)).all()


def test_the_frontier_is_where_the_domain_ends(robot, grids):
    """A grid twice as fine finds it at the same height, to some millimetres, and nothing above."""
    for grid in grids.values():
        fine = key_grid(robot, STEP / 2.0, grid.yaw_deg)
        for width in (0.05, 0.20):
            highest = highest_obstacle(robot, width, grid)
            assert key_domain(robot, Obstacle(highest - 0.003, width), fine).any()
            assert not key_domain(robot, Obstacle(highest + 0.003, width), fine).any()


def test_fus_own_grid_comes_as_far_as_the_frontier(robot, turned):
    """A key configuration just below it, none above it."""
    for width in (0.05, 0.15):
        highest = highest_obstacle(robot, width, turned, turned.searched(robot))
        assert key_configurations(robot, Obstacle(highest - 0.008, width))
        with pytest.raises(Infeasible):
            key_configurations(robot, Obstacle(highest + 0.002, width))


def test_the_frontier_falls_with_the_width_and_with_less_to_try(robot, turned):
    widths = np.array([0.03, 0.08, 0.15, 0.22, 0.28])
    everywhere, searched = frontier(robot, widths, turned), frontier(robot, widths, turned, turned.searched(robot))
    for heights in (everywhere, searched):
        assert (np.diff(heights) <= 0.0).all()
    assert (searched <= everywhere).all()
    assert everywhere[0] > 0.35
    assert searched[2] < everywhere[2] - 0.05  # steps of 0.60 m at most bind for wide obstacles


def test_what_no_step_spans_has_no_height(robot, turned):
    assert highest_obstacle(robot, 0.8, turned) == 0.0
    assert highest_obstacle(robot, 0.3, turned, turned.searched(robot)) == 0.0
    assert first_found(np.zeros((3, 4), dtype=bool), turned) is None
    assert not key_domain(robot, Obstacle(0.15, 0.8), turned).any()


@pytest.mark.parametrize(
    "options",
    [{"step": 0.0}, {"step": -0.01}, {"step": np.nan}, {"step": 0.01, "x_ads_max": 0.001},
     {"step": 0.01, "z_hds_min": 0.9}, {"step": 0.01, "z_hds_min": 0.0}],
)  # fmt: skip
def test_grids_that_are_none_are_refused(robot, options):
    with pytest.raises(InvalidInput, match="leave no grid"):
        key_grid(robot, yaw_deg=0.0, **options)


def test_frontiers_are_those_of_each_grid_and_of_its_searched_part(robot, grids):
    widths = np.array([0.15])
    found = frontiers(robot, widths, list(grids.values()))
    names = [f"yaw {yaw}°, {part}" for yaw in (0, 25) for part in ("steps to 1 m", "FU's search")]
    assert list(found) == names
    for k, grid in enumerate(grids.values()):
        assert found[names[2 * k]] == frontier(robot, widths, grid)
        assert found[names[2 * k + 1]] == frontier(robot, widths, grid, grid.searched(robot))


def test_gains_are_of_the_same_grid_and_only_where_the_straight_waist_has_any():
    limits = {"straight": [0.3, 0.1], "straight, FU": [0.2, 0.0], "turned": [0.4, 0.15], "turned, FU": [0.25, 0.1]}
    found = yaw_gains({name: np.array(heights) for name, heights in limits.items()})
    np.testing.assert_allclose(found, [0.1, 0.05, 0.05])
