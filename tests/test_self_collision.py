"""model/self_collision.py: the broad phase against coal on every pair at every sample."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import random_q

from stepover.model.collision import distance_between
from stepover.model.self_collision import lower_bounds, self_clearance


@pytest.fixture(scope="module")
def strewn(robot, pin_model):
    """HRP-2 in 12 random postures, most of which collide, and exact distances (pairs, 12)."""
    placements = robot.body.placements(random_q(pin_model, 12, seed=4))
    exact = [[distance_between(*pair, placements, k) for k in range(12)] for pair in robot.own_pairs]
    return placements, np.array(exact)


def test_what_is_asked_of_coal_is_never_too_little(robot, strewn):
    placements, exact = strewn
    assert (exact < 0.0).sum() > 10
    for up_to in (np.inf, 0.0):
        bounds = lower_bounds(robot.own_pairs, placements, up_to)
        assert (bounds <= exact + 1e-6).all()
        assert ((bounds > 0.0) & (exact > 0.0)).sum() > 0.5 * exact.size


@pytest.mark.parametrize("up_to", [np.inf, 0.0])
def test_the_deepest_collision_is_found(robot, strewn, up_to):
    placements, exact = strewn
    distance, one, other, sample = self_clearance(robot.own_pairs, placements, 1, up_to)
    pair, expected = np.unravel_index(exact.argmin(), exact.shape)
    assert distance == pytest.approx(exact.min(), abs=1e-9)
    assert (one, other) == tuple(shape.link for shape in robot.own_pairs[pair])
    assert sample == expected


def test_every_other_sample_is_counted_from_the_first(robot, strewn):
    placements, exact = strewn
    distance, *_, sample = self_clearance(robot.own_pairs, placements, 5)
    assert sample in (0, 5, 10)
    assert distance == pytest.approx(exact[:, ::5].min(), abs=1e-9)


def test_a_walk_is_told_to_be_free_whether_or_not_by_how_much(robot, motion):
    placements = robot.body.placements(motion.q[::40])
    exact = self_clearance(robot.own_pairs, placements, 1)[0]
    assert 0.005 < exact <= self_clearance(robot.own_pairs, placements, 1, up_to=0.0)[0]
