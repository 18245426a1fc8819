"""units/dynamic_filter.py: the second stage of preview control on the multi-body ZMP, Eq. (19)."""

from __future__ import annotations

import numpy as np
import pytest

from stepover.model import pose
from stepover.planning.algorithm_1.dynamic_filter import filtered_waist

COUNT = 1600


@pytest.fixture
def waist():
    """A waist that walks ahead and turns."""
    time = np.linspace(0.0, 1.0, COUNT)
    return pose.pose(np.column_stack([time, 0.05 * np.sin(6.0 * time), 0.65 - 0.02 * time]), yaw=0.4 * time)


def bump(height):
    """A smooth change of the ZMP (N,) that is zero at both ends and constant for a while in the middle [m]."""
    time = np.linspace(0.0, 1.0, COUNT)
    return height * np.clip(np.minimum(time - 0.3, 0.7 - time) / 0.1, 0.0, 1.0)


def test_nothing_to_correct_changes_nothing(robot, waist):
    zmp = waist[:, :2]
    np.testing.assert_array_equal(filtered_waist(robot, waist, zmp, zmp), waist)


def test_height_and_heading_are_kept(robot, waist):
    zmp = waist[:, :2]
    moved = filtered_waist(robot, waist, zmp, zmp + bump(0.02)[:, None])
    np.testing.assert_array_equal(moved[:, 2:], waist[:, 2:])
    assert np.abs(moved[:, :2] - waist[:, :2]).max() > 0.01


@pytest.mark.parametrize("axis", [0, 1])
def test_a_zmp_too_far_ahead_moves_the_waist_back(robot, waist, axis):
    """p_ref2 = p_ref - p_MB: the waist goes against the error, along its axis alone, by its size where it lasts."""
    reference, zmp = waist[:, :2].copy(), waist[:, :2].copy()
    zmp[:, axis] += bump(0.02)
    change = (filtered_waist(robot, waist, reference, zmp) - waist)[:, :2]
    assert change[COUNT // 2, axis] == pytest.approx(-0.02, abs=1e-3)
    np.testing.assert_array_equal(change[:, 1 - axis], 0.0)
    np.testing.assert_allclose(change[[0, -1]], 0.0, atol=1e-3)


def test_it_begins_before_the_error_and_is_linear(robot, waist):
    reference = waist[:, :2]
    once, twice = (filtered_waist(robot, waist, reference, reference + bump(h)[:, None]) - waist for h in (0.01, 0.02))
    np.testing.assert_allclose(twice, 2.0 * once, atol=1e-9)
    assert once[int(0.29 * COUNT), 0] < -1e-4


def test_on_the_whole_body_one_pass_takes_most_of_the_error(robot, planned):
    """From the first stage's waist and feet, by inverse kinematics and the multi-body ZMP, as in Algorithm 1."""
    body, dt, first = robot.body, robot.walk.sample_time, planned.nominal.first_stage.waist
    feet, reference = planned.nominal.feet, planned.sequence.zmp

    def zmp_of(waist):
        q = np.tile(robot.half_sitting(), (len(waist), 1))
        q[:, :7] = waist
        q[:, body.column("CHEST_JOINT0")] = -planned.nominal.first_stage.yaw
        for side in (1, -1):
            q[:, robot.leg(side).columns] = robot.leg(side).inverse(waist, feet.foot(side))
        return body.zmp(q, dt)

    def rms(zmp):
        return np.sqrt(((zmp - reference) ** 2).mean(axis=0))

    before = zmp_of(first)
    once = filtered_waist(robot, first, reference, before)
    after = zmp_of(once)
    twice = zmp_of(filtered_waist(robot, once, reference, after))
    assert (rms(before) > 3.0 * rms(after)).all()
    assert (rms(after) < 3e-3).all()
    assert (rms(twice) < 1.5 * rms(after)).all()
    assert np.abs(once[:, :2] - first[:, :2]).max() < 0.05
