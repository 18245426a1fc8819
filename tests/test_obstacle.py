"""model/obstacle.py, o_h, o_w, s_h, s_w of the paper; model/course.py, several of them."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from stepover import Course, InvalidInput, Obstacle, StepOverError

BAD_LENGTHS = [-0.1, math.nan, math.inf, -math.inf, "0.1", [0.1], 10**400]


def test_margins_make_the_papers_15_by_5_cm_18_by_11():
    obstacle = Obstacle(height=0.15, width=0.05)
    assert obstacle.safe_height == pytest.approx(0.18)
    assert obstacle.safe_depth == pytest.approx(0.11)
    assert obstacle.distance is None


def test_profile_lies_behind_the_front_face_and_grows_by_the_margins():
    obstacle = Obstacle(0.15, 0.05, margin_height=0.02, margin_width=0.04)
    x_min, x_max, z_min, z_max = obstacle.profile(0.6, margins=False)
    assert (x_min, x_max, z_max) == pytest.approx((0.60, 0.65, 0.15))
    wide = obstacle.profile(0.6, margins=True)
    np.testing.assert_allclose(wide[[0, 1, 3]], [0.56, 0.69, 0.17])
    assert z_min < 0.0
    assert wide[2] == z_min


@pytest.mark.parametrize("name", ["height", "width", "margin_height", "margin_width", "distance"])
@pytest.mark.parametrize("value", BAD_LENGTHS, ids=lambda value: repr(value)[:8])
def test_nonsense_is_refused_by_name(name, value):
    sizes = {"height": 0.15, "width": 0.05, name: value}
    with pytest.raises(InvalidInput, match=name) as caught:
        Obstacle(**sizes)
    assert "\n" not in str(caught.value)
    assert isinstance(caught.value, ValueError)
    assert isinstance(caught.value, StepOverError)


@pytest.mark.parametrize("name", ["height", "width", "distance"])
def test_zero_is_no_obstacle(name):
    with pytest.raises(InvalidInput, match=f"{name} = 0.0 must be a positive"):
        Obstacle(**{"height": 0.15, "width": 0.05, name: 0.0})


def test_margins_may_be_zero():
    bare = Obstacle(0.15, 0.05, margin_height=0.0, margin_width=0.0)
    np.testing.assert_array_equal(bare.profile(1.0, margins=True), bare.profile(1.0, margins=False))


@pytest.mark.parametrize("yaw", [math.nan, math.inf, 1.6, -1.6, "0.1", [0.1]], ids=repr)
def test_a_yaw_that_is_no_angle_across_the_path_is_refused(yaw):
    with pytest.raises(InvalidInput, match="yaw") as caught:
        Obstacle(0.15, 0.05, yaw=yaw)
    assert "\n" not in str(caught.value)


def test_an_obstacle_may_be_turned():
    assert Obstacle(0.15, 0.05).yaw == 0.0
    assert Obstacle(0.15, 0.05, yaw=-0.3).yaw == -0.3


def test_a_course_keeps_its_obstacles_in_order():
    near, far = Obstacle(0.15, 0.05, distance=0.6), Obstacle(0.25, 0.10, distance=2.4)
    assert Course([near, far]).obstacles == (near, far)
    assert Course([near, far]) == Course((near, far))
    assert Course([Obstacle(0.15, 0.05)]).obstacles[0].distance is None


@pytest.mark.parametrize(
    ("obstacles", "words"),
    [
        ([], "at least one"),
        (Obstacle(0.15, 0.05), "list of obstacles"),
        ("high", "list of obstacles"),
        ([0.15], "obstacle 1 of the course must be of type Obstacle"),
        ([Obstacle(0.1, 0.1, distance=0.6), Obstacle(0.1, 0.1)], "obstacle 2 of the course needs a distance"),
        ([Obstacle(0.1, 0.1, distance=2.4), Obstacle(0.1, 0.1, distance=0.6)], "here it is -1.900 m"),
        ([Obstacle(0.1, 0.1, distance=0.6), Obstacle(0.1, 0.1, distance=0.7)], "must have a gap"),
        ([Obstacle(0.1, 0.1, distance=0.6, yaw=1.2), Obstacle(0.1, 0.1, distance=0.8)], "must have a gap"),
    ],
)
def test_a_course_that_cannot_stand_there_is_refused(obstacles, words):
    with pytest.raises(InvalidInput, match=words) as caught:
        Course(obstacles)
    assert "\n" not in str(caught.value)


def test_neighbours_need_no_more_than_a_gap():
    first = Obstacle(0.1, 0.1, distance=0.6)
    assert len(Course([first, Obstacle(0.1, 0.1, distance=0.71)]).obstacles) == 2
    assert len(Course([dataclasses.replace(first, yaw=1.2), Obstacle(0.1, 0.1, distance=0.9)]).obstacles) == 2


def test_it_cannot_be_changed():
    with pytest.raises(dataclasses.FrozenInstanceError):
        Obstacle(0.15, 0.05).height = 0.2


def test_advice_names_sizes_and_distance():
    assert "0.150 m high, 0.050 m wide" in Obstacle(0.15, 0.05).as_advice()
    assert "distance of 0.800 m" in Obstacle(0.15, 0.05, distance=0.8).as_advice()
    assert "distance" not in Obstacle(0.15, 0.05).as_advice()
