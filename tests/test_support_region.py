"""control/support_region.py: where the desired ZMP may be."""

from __future__ import annotations

import numpy as np
import pytest
from shapely import Point, Polygon

from stepover.control.support_region import Region, patch, regions
from stepover.model.support import zmp_margin


def test_nearest_point_against_shapely():
    region = Region(np.array([[0.0, 0.0], [0.2, -0.1], [0.4, 0.1], [0.3, 0.3], [0.05, 0.2]]))
    polygon = Polygon(region.corners)
    rng = np.random.default_rng(2)
    for point in rng.uniform(-0.3, 0.7, (300, 2)):
        nearest = region.nearest(point)
        assert polygon.distance(Point(nearest)) < 1e-12
        assert np.linalg.norm(nearest - point) == pytest.approx(polygon.distance(Point(point)), abs=1e-12)


def test_inside_nothing_is_changed():
    region = Region(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]))
    point = np.array([0.3, 0.4])
    assert region.nearest(point) is point


@pytest.mark.parametrize("side", [1, -1])
def test_a_patch_is_smaller_by_the_inset_on_all_sides(robot, side):
    whole, inner = robot.contact_patch(side), patch(robot, side, 0.01)
    np.testing.assert_allclose(inner.min(axis=0) - whole.min(axis=0), 0.01)
    np.testing.assert_allclose(whole.max(axis=0) - inner.max(axis=0), 0.01)


def test_regions_follow_the_support_and_hold_the_planned_zmp(robot, motion):
    inset = robot.stabilizer.zmp_inset
    found = regions(robot, motion, inset)
    assert len(found) == len(motion.time)
    margin = zmp_margin(robot, motion.zmp, motion.support, motion.left_foot, motion.right_foot)
    assert margin.min() > inset
    for k in range(0, len(found), 7):
        region = found[k]
        assert region.nearest(motion.zmp[k]) is motion.zmp[k] or (region.nearest(motion.zmp[k]) == motion.zmp[k]).all()
        outside = np.array([5.0, 3.0])
        edge = region.nearest(outside)[None]
        one = slice(k, k + 1)
        feet = motion.left_foot[one], motion.right_foot[one]
        left = zmp_margin(robot, edge, motion.support[one], *feet)[0]
        assert inset - 1e-9 <= left <= np.sqrt(2.0) * inset + 1e-9  # the hull of smaller patches cuts its corners
