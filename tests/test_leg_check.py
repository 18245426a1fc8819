"""leg_check.py: what one leg can take, against what is said of both."""

from __future__ import annotations

import numpy as np
import pytest

from stepover.model.obstacle import Obstacle
from stepover.model.pose import pose
from stepover.planning.leg_check import LegLimits, check_legs, leg_is_free
from stepover.planning.trajectories import FeetTrajectories, WaistAndFeet


@pytest.fixture(scope="module")
def postures(robot):
    """Waist and soles (N, 7) of random double supports, and what must stay free (N, 4): some good, most not."""
    random, zero = np.random.default_rng(9), np.zeros(400)
    x_ads, z_hds = random.uniform(0.3, 0.6, 400), random.uniform(0.5, 0.68, 400)
    waist = pose(np.column_stack([x_ads / 2.0, zero, z_hds]), np.radians(25.0))
    left, right = (pose(np.column_stack([x, zero + y, zero])) for x, y in ((zero, 0.095), (x_ads, -0.095)))
    ahead = np.outer(x_ads - random.uniform(0.1, 0.3, 400), [1.0, 1.0, 0.0, 0.0])
    return WaistAndFeet(waist, FeetTrajectories(left, right)), Obstacle(0.15, 0.05).profile(0.0, margins=True) + ahead


@pytest.mark.parametrize("spare", [0.0, 0.003])
def test_a_posture_is_good_where_both_legs_are_free(robot, postures, spare):
    poses, rectangles = postures
    limits = LegLimits(rectangles, np.radians(15.0))
    both = check_legs(robot, poses, limits).good(spare)
    each = [leg_is_free(robot, side, poses, limits, spare) for side in (1, -1)]
    assert 20 < both.sum() < 380
    assert both.sum() < min(leg.sum() for leg in each), "both legs have a say"
    np.testing.assert_array_equal(both, each[0] & each[1])


def test_of_no_postures_none_is_free(robot, postures):
    poses, rectangles = postures
    assert leg_is_free(robot, 1, poses.at(slice(0)), LegLimits(rectangles[:0], 0.0)).shape == (0,)


def test_the_shape_that_is_named_belongs_to_a_leg_and_collides(robot, postures):
    poses, rectangles = postures
    check = check_legs(robot, poses, LegLimits(rectangles, 0.0))
    worst = int(check.separation.argmin())
    shape = robot.shapes[check.shape[worst]]
    assert shape.link.startswith(("LLEG", "RLEG"))
    assert check.separation[worst] < 0.0
