"""model/instant.py: one configuration at a time, against the arrays of body.py and legs.py."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import random_q

from stepover.model import pose
from stepover.model.instant import Instant

ROUNDS = 12


def test_kinematics_agree_with_the_whole_motion_s(robot, pin_model):
    instant, body = Instant(robot), robot.body
    for q in random_q(pin_model, 20, seed=4):
        placed = body.placements(q[None])
        instant.place(q[3:7], q[7:])
        np.testing.assert_allclose(instant.com() + q[:3], body.com(placed)[0], atol=1e-12)
        for side in (1, -1):
            joint = body.index(robot.leg(side).joints[-1])
            turn, place = instant.ankle(side)
            np.testing.assert_allclose(turn, placed.rotations[0, joint], atol=1e-12)
            np.testing.assert_allclose(place + q[:3], placed.positions[0, joint], atol=1e-12)


def targets(robot, motion, sample):
    """Where both ankles are in the waist's frame."""
    back = pose.rotation(motion.waist[[sample]])[0].T
    found = {}
    for side in (1, -1):
        sole = motion.foot(side)[[sample]]
        ankle = pose.offset(sole, np.array([0.0, 0.0, robot.foot.ankle_height]))[0, :3]
        found[side] = back @ pose.rotation(sole)[0], back @ (ankle - motion.waist[sample, :3])
    return found


@pytest.mark.parametrize("sample", [50, 700, 900, 1150, 1300])
def test_legs_agree_with_the_closed_form(robot, motion, sample):
    rng = np.random.default_rng(sample)
    guess = motion.q[sample, 7:] + rng.normal(0.0, 0.02, len(motion.joint_names))
    found = Instant(robot).legs(targets(robot, motion, sample), guess, ROUNDS)
    for side in (1, -1):
        columns = [column - 7 for column in robot.leg(side).columns]
        closed = robot.leg(side).inverse(motion.waist[[sample]], motion.foot(side)[[sample]])[0]
        np.testing.assert_allclose(found[columns], closed, atol=1e-6)
    others = [k for k in range(len(guess)) if k + 7 not in robot.leg(1).columns + robot.leg(-1).columns]
    np.testing.assert_array_equal(found[others], guess[others])


def test_what_is_right_already_is_left_as_it_is(robot, motion):
    guess = motion.q[700, 7:]
    assert Instant(robot).legs(targets(robot, motion, 700), guess, ROUNDS) is guess


def test_out_of_reach_the_leg_points_there(robot, motion):
    wanted = targets(robot, motion, 0)
    wanted[1] = wanted[1][0], wanted[1][1] - np.array([0.0, 0.0, 0.3])
    found = Instant(robot).legs(wanted, motion.q[0, 7:], 60)
    body = robot.body
    assert np.isfinite(found).all()
    assert ((found >= body.lower) & (found <= body.upper)).all()
    knee = body.column(robot.leg(1).joints[3]) - 7
    assert found[knee] < np.radians(10.0)
