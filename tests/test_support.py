"""model/support.py: the support polygon of one or both feet, Eqs. (10)-(12)."""

from __future__ import annotations

import numpy as np
import pytest

from stepover.model import pose
from stepover.model.support import corners_on_floor, zmp_margin

LEFT, RIGHT = [0.0, 0.095, 0.0], [0.0, -0.095, 0.0]


def margin(robot, zmp, support, left=LEFT, right=RIGHT, yaw=0.0):
    """Margin of one ZMP."""
    feet = [pose.pose(np.array([foot]), yaw) for foot in (left, right)]
    return zmp_margin(robot, np.array([zmp]), np.array([support]), *feet)[0]


@pytest.mark.parametrize("side", [1, -1])
def test_single_support_is_the_flat_patch_of_the_stance_foot(robot, side):
    ankle = side * 0.095
    assert margin(robot, [0.0, ankle], side) == pytest.approx(0.059)  # the inner edge is nearer than the outer one
    assert margin(robot, [0.0, ankle + side * 0.070], side) == pytest.approx(0.009)
    assert margin(robot, [0.0, ankle - side * 0.070], side) == pytest.approx(-0.011)
    assert margin(robot, [0.120, ankle], side) == pytest.approx(0.006)
    assert margin(robot, [-0.100, ankle], side) == pytest.approx(-0.004)
    assert margin(robot, [0.0, -ankle], side) == pytest.approx(-0.190 + 0.059)


def test_double_support_spans_both_feet(robot):
    assert margin(robot, [0.0, 0.0], 0) == pytest.approx(0.096)
    assert margin(robot, [0.0, 0.170], 0) == pytest.approx(0.004)
    assert margin(robot, [0.0, -0.170], 0) == pytest.approx(0.004)
    ahead = [0.4, -0.095, 0.0]
    assert margin(robot, [0.2, 0.0], 0, right=ahead) > 0.05
    assert margin(robot, [0.4, 0.095], 0, right=ahead) < -0.05
    assert margin(robot, [0.4, -0.095], 0, right=ahead) == pytest.approx(0.079)


def test_the_patch_turns_with_the_foot(robot):
    corners = corners_on_floor(robot, -1, pose.pose(np.array([[1.0, 2.0, 0.0]]), yaw=np.pi / 2.0)[0])
    np.testing.assert_allclose([*corners.min(axis=0), *corners.max(axis=0)], [0.941, 1.904, 1.079, 2.126])


def test_the_margin_is_a_distance_in_any_heading(robot):
    for yaw in (0.0, 0.4, -1.0):
        spot = np.array([np.cos(yaw) * 0.1 - np.sin(yaw) * 0.0, np.sin(yaw) * 0.1]) + LEFT[:2]
        assert margin(robot, spot, 1, yaw=yaw) == pytest.approx(0.026)


def test_each_sample_has_its_own_support(robot):
    support = np.array([0, 1, 1, 0, -1, -1, 0])
    zmp = np.array([[0.0, 0.0], *[[0.0, 0.095]] * 2, [0.1, 0.0], *[[0.2, -0.095]] * 2, [0.1, 0.0]])
    left = pose.pose(np.array([LEFT] * 7))
    right = pose.pose(np.array([[0.1 * k if k < 3 else 0.2, -0.095, 0.02 * (k in (1, 2))] for k in range(7)]))
    together = zmp_margin(robot, zmp, support, left, right)
    apart = [zmp_margin(robot, zmp[k : k + 1], support[k : k + 1], left[k : k + 1], right[k : k + 1])[0]
             for k in range(7)]  # fmt: skip
    np.testing.assert_allclose(together, apart, atol=1e-12)
    assert (together > 0.0).all()
    swapped = zmp_margin(robot, zmp, -support, left, right)
    assert (swapped[[1, 2, 4, 5]] < 0.0).all()
