from dataclasses import replace

import numpy as np
import pytest

from stepover.model.obstacle import Obstacle
from stepover.motion.footsteps import LEG_1, LEG_2
from stepover.planning.algorithm_1.com_waist import com_and_waist
from stepover.planning.algorithm_1.dynamic_filter import filtered_waist
from stepover.planning.algorithm_1.feasibility import key_configurations
from stepover.planning.algorithm_1.feet_trajectories import feet_trajectories
from stepover.planning.algorithm_1.planner import plan_in_detail
from stepover.planning.algorithm_1.step_sequence import Crossing, step_sequence
from stepover.planning.algorithm_1.upper_body import arm_response, upper_body, with_arms


@pytest.fixture(scope="module")
def high(robot):
    """First stage of the 25 cm case: sequence, feet, CoM and waist."""
    obstacle = Obstacle(0.25, 0.05)
    key = key_configurations(robot, obstacle)[0]
    sequence = step_sequence(robot, obstacle, key, robot.rest_zmp())
    return sequence, feet_trajectories(Crossing(robot, obstacle, sequence)), com_and_waist(robot, sequence, key)


def test_arms_held_back_move_the_waist_by_their_mass_and_way(robot):
    count, swing = 2400, np.radians(robot.upper_body.arm_swing_max_deg)
    _, answer = arm_response(robot, (3.0, 4.0, 8.0, 9.0), count)
    held = answer[int(6.0 / robot.walk.sample_time)]
    still, back = (robot.half_sitting()[None].copy() for _ in range(2))
    for joint in robot.upper_body.shoulders:
        back[0, robot.body.column(joint)] += swing
    com = [robot.body.com(robot.body.placements(q))[0] for q in (still, back)]
    assert com[1][0] < com[0][0], "a positive shoulder pitch takes the arms back"
    assert held[0] > 0.01
    assert held[0] == pytest.approx(com[0][0] - com[1][0], rel=0.1)
    assert abs(held[1]) < 1e-3


def test_p_ref2_has_the_signs_of_the_transient(robot):
    change, answer = arm_response(robot, (3.0, 4.0, 8.0, 9.0), 2400)
    p_ref2 = -change[:, 0]
    dt = robot.walk.sample_time
    accelerating_back = p_ref2[int(3.05 / dt) : int(3.4 / dt)]
    held_back = p_ref2[int(5.0 / dt) : int(7.0 / dt)]
    assert accelerating_back.min() < -0.005, "arms that accelerate back push the ZMP ahead"
    assert held_back.min() > 0.01, "arms that are back take the ZMP back"
    assert answer[int(4.0 / dt), 0] > 0.01, "both move the waist ahead"


def test_the_filter_itself_gives_that_answer(robot):
    count, dt = 2400, robot.walk.sample_time
    times = (3.0, 4.0, 8.0, 9.0)
    _, answer = arm_response(robot, times, count)
    q = np.tile(robot.half_sitting(), (count, 1))
    largest = np.radians(robot.upper_body.arm_swing_max_deg)
    share = np.interp(np.arange(count) * dt, times, [0.0, 1.0, 1.0, 0.0])
    share = share**2 * (3.0 - 2.0 * share)  # the cubic with zero end speeds
    for joint in robot.upper_body.shoulders:
        q[:, robot.body.column(joint)] += largest * share
    reference = np.tile(robot.rest_zmp(), (count, 1))
    moved = filtered_waist(robot, q[:, :7], reference, robot.body.zmp(q, dt))
    np.testing.assert_allclose(moved[:, :2] - q[:, :2], answer, atol=1e-6)


def test_auto_idles_at_15_cm_and_acts_at_25_cm(robot, planned, high):
    assert planned.nominal.upper.arm_swing == 0.0
    assert not np.any(planned.nominal.upper.waist_shift)
    result = upper_body(robot, *high, "auto")
    assert 0.0 < result.arm_swing <= np.radians(25.0) + 1e-12
    assert result.knee_before < 0.0, "without the arms the lead knee over-stretches"
    assert result.knee_after >= result.knee_before


def test_on_and_off(robot, high):
    assert upper_body(robot, *high, "off").arm_swing == 0.0
    assert upper_body(robot, *high, "on").arm_swing == pytest.approx(np.radians(25.0))


def test_on_at_15_cm_buys_knee_margin(robot, obstacle, planned):
    swung = plan_in_detail(robot, obstacle, arms="on", look_for_nearest=False)
    assert swung.nominal.upper.arm_swing == pytest.approx(np.radians(25.0))
    assert swung.nominal.upper.knee_after > swung.nominal.upper.knee_before
    knee = robot.body.column(robot.leg(-1).joints[3])
    before_landing = slice(planned.sequence.step(LEG_1).touch_down - 60, planned.sequence.step(LEG_1).touch_down)
    assert swung.motion.q[before_landing, knee].min() > planned.motion.q[before_landing, knee].min() + np.radians(2.0)


def test_chest_looks_ahead_and_arms_keep_their_limits(robot, high):
    sequence, _, first = high
    q = with_arms(robot, sequence, first.yaw, np.radians(25.0))
    chest = q[:, robot.body.column(robot.upper_body.chest_yaw)]
    np.testing.assert_allclose(chest, -first.yaw)
    columns = [robot.body.column(joint) for joint in robot.upper_body.shoulders]
    joints = np.array(columns) - 7
    assert (q[:, columns] <= robot.body.upper[joints]).all()
    rest = robot.half_sitting()[columns]
    assert (q[:, columns].max(axis=0) > rest + np.radians(24.0)).all()
    np.testing.assert_allclose(q[[0, -1]][:, columns], [rest, rest])
    second = sequence.step(LEG_2)
    np.testing.assert_allclose(q[second.touch_down :, columns], np.tile(rest, (len(q) - second.touch_down, 1)))


def test_swing_is_limited_by_robot_toml(robot, high):
    shy = replace(robot, upper_body=replace(robot.upper_body, arm_swing_max_deg=5.0))
    assert upper_body(shy, *high, "on").arm_swing == pytest.approx(np.radians(5.0))
