"""planning/checks.py: a motion that breaks a limit is refused, with what, by how much and when."""

from __future__ import annotations

import dataclasses
import re

import numpy as np
import pinocchio as pin
import pytest

from stepover import Infeasible, InvalidInput, Obstacle
from stepover.model import pose
from stepover.motion.motion import obstacle_row
from stepover.planning.checks import check, require
from stepover.planning.measures import _nearest, measure


def tampered(motion, **arrays):
    """A motion with other arrays."""
    return dataclasses.replace(motion, **arrays)


def with_angle(robot, motion, joint, sample, degrees):
    """The motion with one joint at another angle at one sample."""
    q = motion.q.copy()
    q[sample, robot.body.column(joint)] = np.radians(degrees)
    return tampered(motion, q=q)


def across(motion, obstacle):
    """The motion with another obstacle in the same place."""
    return tampered(motion, obstacles=obstacle_row(obstacle, motion.obstacle[0])[None])


def refusal(robot, motion):
    """What require says."""
    with pytest.raises(Infeasible) as caught:
        require(robot, motion)
    message = str(caught.value)
    assert "\n" not in message
    return message


def amount(message):
    """The first number of a message."""
    return float(re.search(r"is (-?\d+\.\d+) ", message).group(1))


def test_the_planned_motion_passes(robot, motion):
    require(robot, motion)


@pytest.mark.parametrize(
    ("joint", "degrees", "beyond"),
    [("RLEG_JOINT2", -130.0, 5.0), ("LLEG_JOINT0", 47.0, 2.0), ("LLEG_JOINT0", -40.0, 10.0),
     ("RLEG_JOINT0", 40.0, 10.0), ("CHEST_JOINT0", 50.0, 5.0), ("HEAD_JOINT1", -31.0, 1.0), ("RARM_JOINT6", 20.0, 4.0)],
)  # fmt: skip
def test_a_joint_beyond_its_limit(robot, motion, joint, degrees, beyond):
    message = refusal(robot, with_angle(robot, motion, joint, 1000, degrees))
    assert message.startswith(joint)
    assert amount(message) == pytest.approx(beyond, abs=0.05)
    assert "degrees beyond its limit" in message
    assert "t = 5.000 s" in message
    assert "phase 1" in message


@pytest.mark.parametrize("side", ["L", "R"])
def test_a_knee_too_straight(robot, motion, side):
    margin = robot.checks.knee_margin_deg
    message = refusal(robot, with_angle(robot, motion, f"{side}LEG_JOINT3", 100, margin - 3.0))
    assert message.startswith(f"{side}LEG_JOINT3")
    assert amount(message) == pytest.approx(3.0, abs=0.05)
    assert "nearer to straight" in message
    assert "t = 0.500 s" in message
    assert "walking" in message
    require(robot, with_angle(robot, motion, f"{side}LEG_JOINT3", 100, margin + 1.0))


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_zmp_outside_of_the_support_polygon(robot, motion, axis, sign):
    zmp = motion.zmp.copy()
    zmp[1000, axis] += sign * 0.15
    message = refusal(robot, tampered(motion, zmp=zmp))
    assert message.startswith("the ZMP is ")
    assert 10.0 < amount(message) < 150.0
    assert "t = 5.000 s" in message


def test_the_margin_of_the_zmp_counts_from_the_right_foot(robot, motion):
    """In single support, what is fine for one foot is outside for the other."""
    assert motion.support[1000] == 1
    message = refusal(robot, tampered(motion, support=-motion.support))
    assert message.startswith("the ZMP is ")


@pytest.mark.parametrize("shift", [0.02, -0.02])
def test_a_link_inside_the_margins(robot, motion, shift):
    """The obstacle stands 2 cm further on or nearer than what was planned for."""
    rows = motion.obstacles.copy()
    rows[0, 0] += shift
    message = refusal(robot, tampered(motion, obstacles=rows))
    assert re.match(r"[RL]LEG_LINK\d is ", message)
    assert "mm inside the obstacle's safety margin" in message
    assert 5.0 < amount(message) <= 25.0
    assert re.search(r"phase [123]", message)


def test_a_foot_that_stays_low_is_found_by_name_and_depth(robot, motion):
    """The right sole 10 cm lower at one sample over the obstacle, by its hip and knee angles."""
    front, width = motion.obstacle[:2]
    over = np.flatnonzero((motion.right_foot[:, 0] > front) & (motion.right_foot[:, 0] < front + width))[0]
    low = motion.right_foot[over : over + 1] - [0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0]
    q = motion.q.copy()
    q[over, robot.leg(-1).columns] = robot.leg(-1).inverse(motion.waist[over : over + 1], low)[0]
    message = refusal(robot, tampered(motion, q=q))
    assert message.startswith("RLEG_LINK5")
    assert amount(message) > 30.0
    assert f"t = {motion.time[over]:.3f} s (phase 1)" in message


def test_larger_margins_than_planned_for_are_missed(robot, motion):
    assert "safety margin" in refusal(robot, across(motion, Obstacle(0.15, 0.05, margin_height=0.06)))
    assert "safety margin" in refusal(robot, across(motion, Obstacle(0.15, 0.05, margin_width=0.05)))
    require(robot, across(motion, Obstacle(0.12, 0.05)))


def test_arms_count_too(robot, motion):
    """A hand that reaches down through the margins: no leg, yet refused."""
    low = motion.q.copy()
    low[:, 2] -= 0.45
    message = refusal(robot, tampered(motion, q=low))
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
    rows = motion.obstacles.copy()
    rows[0, 2] = 0.25
    found = measure(robot, tampered(motion, obstacles=rows))
    assert found.clearance_min < -0.01
    assert found.clearance_link.startswith(("RLEG", "LLEG"))
    assert 4.0 < found.clearance_time < 7.0


# Motions of any planner


def bare_of_algorithm_1(motion):
    """The motion as a planner returns it that knows no phases, filter and key configuration."""
    return tampered(motion, phase=np.zeros_like(motion.phase), zmp_first_stage=None, key_configuration=None)


def test_what_only_algorithm_1_knows_is_not_needed(robot, motion):
    plain, found, full = bare_of_algorithm_1(motion), None, measure(robot, motion)
    require(robot, plain)
    found = measure(robot, plain)
    assert found.zmp_rms_first_stage is None
    assert np.isnan([found.step_over_duration, found.com_travel_double_support]).all()
    assert (found.clearance_min, found.zmp_rms, found.zmp_margin_min) == (
        full.clearance_min, full.zmp_rms, full.zmp_margin_min
    )  # fmt: skip
    low = with_angle(robot, plain, "RLEG_JOINT2", 1000, -130.0)
    assert refusal(robot, low).endswith("t = 5.000 s (walking)")
    with pytest.raises(InvalidInput, match="no phase 1"):
        plain.samples(1)


def test_every_check_says_value_limit_part_and_time(robot, motion):
    rows = {found.check: found for found in check(robot, motion)}
    assert list(rows) == ["joint limits", "knees", "ZMP", "self-collision", "obstacle", "joint speeds"]
    assert all(found.kept for name, found in rows.items() if name != "joint speeds")
    full = measure(robot, motion)
    assert rows["ZMP"].value == pytest.approx(full.zmp_margin_min)
    assert rows["ZMP"].limit == robot.checks.zmp_margin
    knees = np.degrees(np.abs(motion.q[:, [robot.body.column(knee) for knee in robot.legs.knee]]))
    assert np.degrees(rows["knees"].value) == pytest.approx(knees.min())
    sample, which = np.unravel_index(knees.argmin(), knees.shape)
    assert (rows["knees"].part, rows["knees"].time) == (robot.legs.knee[which], pytest.approx(motion.time[sample]))
    assert rows["joint speeds"].value == pytest.approx(full.joint_speed_ratio_max)
    assert rows["joint speeds"].kept == (full.joint_speed_ratio_max <= 1.0)
    assert 0.0 <= rows["obstacle"].margin <= full.clearance_min - 0.03 + 1e-9


def test_check_and_require_agree_on_what_is_broken(robot, motion):
    low = with_angle(robot, motion, "RLEG_JOINT2", 1000, -130.0)
    (broken,) = [found for found in check(robot, low) if found.check == "joint limits"]
    assert not broken.kept
    assert (broken.part, broken.time) == ("RLEG_JOINT2", pytest.approx(5.0))
    assert np.degrees(broken.margin) == pytest.approx(-5.0, abs=0.05)
    assert refusal(robot, low) == broken.refusal


def test_every_obstacle_counts(robot, motion):
    """A second one further on is hit by the walk behind the first, and named by its number."""
    row = motion.obstacles[0]
    far = tampered(motion, obstacles=np.array([row, [row[0] + 10.0, *row[1:]]]))
    require(robot, far)
    assert measure(robot, far).clearance_min == measure(robot, motion).clearance_min
    last = motion.waist[-1, 0]
    near = tampered(motion, obstacles=np.array([row, [last, *row[1:]]]))
    assert "inside the obstacle 2's safety margin" in refusal(robot, near)
    assert measure(robot, near).clearance_min < 0.0
    assert [found.check for found in check(robot, near)][4:6] == ["obstacle 1", "obstacle 2"]


@pytest.mark.parametrize("yaw", [0.3, -0.3])
def test_an_obstacle_that_is_turned_is_seen_turned(robot, motion, yaw):
    """Robot and obstacle turned together keep their distance; the obstacle turned alone is hit."""
    front, turned = motion.obstacle[0], motion.obstacles.copy()
    turned[0, 6] = yaw
    turn = pin.AngleAxis(yaw, np.array([0.0, 0.0, 1.0])).matrix()
    q, middle = motion.q[600:1400].copy(), np.array([front, 0.0, 0.0])
    q[:, :3] = (q[:, :3] - middle) @ turn.T + middle
    own = pose.from_matrices(turn @ pose.rotation(q[:, :7]), q[:, :3])
    q[:, :7] = own
    whole = motion.q.copy()
    whole[600:1400] = q
    part = [600, 1400]
    seen = [_nearest(robot, m, robot.body.placements(m.q[slice(*part)])) for m in (
        motion, tampered(motion, q=whole, obstacles=turned), tampered(motion, obstacles=turned))]  # fmt: skip
    assert seen[1].distance == pytest.approx(seen[0].distance, abs=1e-6)
    assert seen[1].link == seen[0].link
    assert seen[2].distance < seen[0].distance - 0.005
