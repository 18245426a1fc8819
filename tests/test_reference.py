"""control/reference.py: a motion in the stabilizer's terms."""

from __future__ import annotations

import numpy as np
import pytest

from stepover.control.reference import reference


@pytest.fixture(scope="module")
def course(robot, motion):
    return reference(robot, motion)


def test_the_dcm_runs_away_from_the_zmp(robot, motion, course):
    """xi' = omega (xi - z), as far as the robot is the pendulum of its plan: 10 mm rms."""
    rate = np.gradient(course.dcm, course.dt, axis=0)
    zmp = course.dcm - rate / course.omega
    error = np.sqrt(((zmp - motion.zmp)[200:-200] ** 2).mean(axis=0))
    assert (error < 0.012).all()
    assert course.omega == pytest.approx(np.sqrt(9.81 / robot.preview.com_height), rel=1e-3)


def test_velocities_integrate_to_the_com(motion, course):
    way = np.cumsum(course.com_velocity, axis=0) * course.dt
    np.testing.assert_allclose(way[-1] - way[0], motion.com[-1] - motion.com[0], atol=1e-4)


def test_ankles_stand_above_their_soles(robot, course):
    offset = np.einsum("nfba,nfb->nfa", course.feet, course.ankles - course.soles)
    np.testing.assert_allclose(offset, np.broadcast_to([0.0, 0.0, robot.foot.ankle_height], offset.shape), atol=1e-9)


def test_landing_is_the_second_half_of_a_swing(motion, course):
    for foot, side in enumerate((1, -1)):
        swings, landing = motion.support == -side, course.landing[:, foot]
        assert not landing[~swings].any()
        assert landing.sum() == pytest.approx(swings.sum() / 2.0, abs=10)
        ends = np.flatnonzero(swings[:-1] & ~swings[1:])
        assert landing[ends].all()
        begins = np.flatnonzero(~swings[:-1] & swings[1:]) + 1
        assert not landing[begins].any()
