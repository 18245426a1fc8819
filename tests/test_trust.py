"""Inputs that once hung, hoarded memory or passed unnoticed: each ends soon, in one line, or works."""

from __future__ import annotations

import dataclasses
import gc
import tracemalloc
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

from stepover import Infeasible, InvalidInput, Obstacle, plan
from stepover.planning.nearest import nearest_crossable

MEGABYTE = 2**20
NO_REAL_NUMBERS = [
    True, np.bool_(True), None, "0.1", Decimal("0.1"), Fraction(1, 10), 0.1 + 0j, np.array(0.1), np.array([[0.1]] * 9),
]  # fmt: skip
LENGTHS = ("height", "width", "margin_height", "margin_width", "distance")


@pytest.fixture(scope="module")
def coarse(robot):
    """HRP-2 with 10 ms samples: half the work."""
    return dataclasses.replace(robot, walk=dataclasses.replace(robot.walk, sample_time=0.01))


def test_a_refusal_keeps_no_memory(coarse):
    gc.collect()
    gc.disable()
    tracemalloc.start()
    try:
        before = tracemalloc.get_traced_memory()[0]
        with pytest.raises(Infeasible, match="the nearest obstacle that can be stepped over") as caught:
            plan(coarse, Obstacle(0.30, 0.10))
        now, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
        gc.enable()
    assert caught.value.__cause__ is None
    assert caught.value.__context__ is None
    assert now - before < 10 * MEGABYTE
    assert peak - before < 100 * MEGABYTE


def test_where_the_size_is_not_what_is_wrong_the_search_for_the_nearest_ends_soon():
    tried = []
    assert nearest_crossable(Obstacle(0.2, 0.1), lambda other: bool(tried.append(other))) is None
    assert [(one.height, one.width) for one in tried] == [(0.02, 0.1), (0.02, 0.02)]


def test_a_distance_in_millimetres_is_refused_at_once():
    with pytest.raises(InvalidInput, match="distance = 570 must be 20 m at most"):
        Obstacle(0.1, 0.05, distance=570)
    assert Obstacle(0.1, 0.05, distance=20).distance == 20.0


@pytest.mark.parametrize("name", [*LENGTHS, "yaw"])
@pytest.mark.parametrize("value", NO_REAL_NUMBERS, ids=lambda value: type(value).__name__)
def test_what_is_no_real_number_is_refused(name, value):
    if name == "distance" and value is None:
        return  # the nominal steps say where
    with pytest.raises(InvalidInput, match=f"obstacle {name} = ") as caught:
        Obstacle(**{"height": 0.1, "width": 0.05, name: value})
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 120


@pytest.mark.parametrize("name", LENGTHS)
@pytest.mark.parametrize("value", [1e306, 1e15, 10**300, np.float32(1e30)], ids=str)
def test_what_is_too_long_is_refused_with_the_true_reason(name, value):
    with pytest.raises(InvalidInput, match=rf"obstacle {name} = .* must be (10|20) m at most"):
        Obstacle(**{"height": 0.1, "width": 0.05, name: value})


def test_an_integer_that_python_does_not_write_is_refused():
    with pytest.raises(InvalidInput, match="obstacle height = "):
        Obstacle(10**5000, 0.05)


@pytest.mark.parametrize("name", [*LENGTHS, "yaw"])
@pytest.mark.parametrize("kind", [int, np.int64, np.uint8, np.float16, np.float32, np.float64, np.longdouble])
def test_numbers_become_floats_once(name, kind):
    value = getattr(Obstacle(**{"height": 2, "width": 2, name: kind(1)}), name)
    assert type(value) is float
    assert value == 1.0


@pytest.mark.parametrize("extras", ["no", 0, None])
def test_extras_is_true_or_false(robot, obstacle, extras):
    with pytest.raises(InvalidInput, match=f"extras = {extras!r} must be True or False"):
        plan(robot, obstacle, extras=extras)
