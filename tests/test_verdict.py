"""verdict.py: a motion that breaks a limit is refused, with what, by how much and when."""

from __future__ import annotations

import dataclasses
import re

import numpy as np
import pytest

from stepover import Infeasible, Obstacle
from stepover.planning.checks import measure, require


def tampered(motion, **arrays):
    """A motion with other arrays."""
    return dataclasses.replace(motion, **arrays)


def with_angle(robot, motion, joint, sample, degrees):
    """The motion with one joint at another angle at one sample."""
    q = motion.q.copy()
    q[sample, robot.body.column(joint)] = np.radians(degrees)
    return tampered(motion, q=q)


def refusal(robot, motion, obstacle):
    """What require says."""
    with pytest.raises(Infeasible) as caught:
        require(robot, obstacle, motion)
    message = str(caught.value)
    assert "\n" not in message
    return message


def amount(message):
    """The first number of a message."""
    return float(re.search(r"is (-?\d+\.\d+) ", message).group(1))


def test_the_planned_motion_passes(robot, motion, obstacle):
    require(robot, obstacle, motion)


@pytest.mark.parametrize(
    ("joint", "degrees", "beyond"),
    [("RLEG_JOINT2", -130.0, 5.0), ("LLEG_JOINT0", 47.0, 2.0), ("LLEG_JOINT0", -40.0, 10.0),
     ("RLEG_JOINT0", 40.0, 10.0), ("CHEST_JOINT0", 50.0, 5.0), ("HEAD_JOINT1", -31.0, 1.0), ("RARM_JOINT6", 20.0, 4.0)],
)  # fmt: skip
def test_a_joint_beyond_its_limit(robot, motion, obstacle, joint, degrees, beyond):
    message = refusal(robot, with_angle(robot, motion, joint, 1000, degrees), obstacle)
    assert message.startswith(joint)
    assert amount(message) == pytest.approx(beyond, abs=0.05)
    assert "degrees beyond its limit" in message
    assert "t = 5.000 s" in message
    assert "phase 1" in message


@pytest.mark.parametrize("side", ["L", "R"])
def test_a_knee_too_straight(robot, motion, obstacle, side):
    margin = robot.checks.knee_margin_deg
    message = refusal(robot, with_angle(robot, motion, f"{side}LEG_JOINT3", 100, margin - 3.0), obstacle)
    assert message.startswith(f"{side}LEG_JOINT3")
    assert amount(message) == pytest.approx(3.0, abs=0.05)
    assert "nearer to straight" in message
    assert "t = 0.500 s" in message
    assert "walking" in message
    require(robot, obstacle, with_angle(robot, motion, f"{side}LEG_JOINT3", 100, margin + 1.0))


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_zmp_outside_of_the_support_polygon(robot, motion, obstacle, axis, sign):
    zmp = motion.zmp.copy()
    zmp[1000, axis] += sign * 0.15
    message = refusal(robot, tampered(motion, zmp=zmp), obstacle)
    assert message.startswith("the ZMP is ")
    assert 10.0 < amount(message) < 150.0
    assert "t = 5.000 s" in message


def test_the_margin_of_the_zmp_counts_from_the_right_foot(robot, motion, obstacle):
    """In single support, what is fine for one foot is outside for the other."""
    assert motion.support[1000] == 1
    message = refusal(robot, tampered(motion, support=-motion.support), obstacle)
    assert message.startswith("the ZMP is ")


@pytest.mark.parametrize("shift", [0.02, -0.02])
def test_a_link_inside_the_margins(robot, motion, obstacle, shift):
    """The obstacle stands 2 cm further on or nearer than what was planned for."""
    row = motion.obstacle.copy()
    row[0] += shift
    message = refusal(robot, tampered(motion, obstacle=row), obstacle)
    assert re.match(r"[RL]LEG_LINK\d is ", message)
    assert "mm inside the obstacle's safety margin" in message
    assert 5.0 < amount(message) <= 25.0
    assert re.search(r"phase [123]", message)


def test_a_foot_that_stays_low_is_found_by_name_and_depth(robot, motion, obstacle):
    """The right sole 10 cm lower at one sample over the obstacle, by its hip and knee angles."""
    front, width = motion.obstacle[:2]
    over = np.flatnonzero((motion.right_foot[:, 0] > front) & (motion.right_foot[:, 0] < front + width))[0]
    low = motion.right_foot[over : over + 1] - [0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0]
    q = motion.q.copy()
    q[over, robot.leg(-1).columns] = robot.leg(-1).inverse(motion.waist[over : over + 1], low)[0]
    message = refusal(robot, tampered(motion, q=q), obstacle)
    assert message.startswith("RLEG_LINK5")
    assert amount(message) > 30.0
    assert f"t = {motion.time[over]:.3f} s (phase 1)" in message


def test_larger_margins_than_planned_for_are_missed(robot, motion, obstacle):
    assert "safety margin" in refusal(robot, motion, Obstacle(0.15, 0.05, margin_height=0.06))
    assert "safety margin" in refusal(robot, motion, Obstacle(0.15, 0.05, margin_width=0.05))
    require(robot, Obstacle(0.12, 0.05), motion)


def test_arms_count_too(robot, motion, obstacle):
    """A hand that reaches down through the margins: no leg, yet refused."""
    low = motion.q.copy()
    low[:, 2] -= 0.45
    message = refusal(robot, tampered(motion, q=low), obstacle)
    assert "mm inside the obstacle's safety margin" in message


def test_measures_name_what_is_tightest(robot, motion):
    tight = with_angle(robot, motion, "HEAD_JOINT0", 700, 44.9)
    found = measure(robot, tight)
    assert found.joint_margin_joint == "HEAD_JOINT0"
    assert found.joint_margin_min == pytest.approx(np.radians(0.1), abs=1e-6)
    assert found.joint_speed_joint == "HEAD_JOINT0"
    assert found.joint_speed_ratio_max == pytest.approx(np.radians(44.9) / (2.0 * motion.dt) / 6.88)


@pytest.mark.parametrize(("off", "joint"), [(0.0, "HEAD_JOINT0"), (0.5, "HEAD_JOINT1")])
def test_a_joint_that_stands_still_counts_only_beyond_its_limit(robot, motion, off, joint):
    tight = with_angle(robot, motion, "HEAD_JOINT0", 700, 44.9)
    column = robot.body.column("HEAD_JOINT1")
    tight.q[:, column] = robot.body.lower[column - 7] - np.radians(off)
    found = measure(robot, tight)
    assert found.joint_margin_joint == joint
    assert found.joint_margin_min == pytest.approx(np.radians(-off or 0.1), abs=1e-6)


def test_measured_clearance_is_signed(robot, motion):
    row = motion.obstacle.copy()
    row[2] = 0.25
    found = measure(robot, tampered(motion, obstacle=row))
    assert found.clearance_min < -0.01
    assert found.clearance_link.startswith(("RLEG", "LLEG"))
    assert 4.0 < found.clearance_time < 7.0
