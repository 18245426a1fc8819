"""Motions that respect the joints' speed limits: planner.py with the slow parameters."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from stepover import Infeasible, InvalidInput, Obstacle, load_robot, plan, simulate
from stepover.model.parameters.slow import SLOW
from stepover.motion.footsteps import LEG_2
from stepover.planning.algorithm_1.beyond_paper import extra_zmp, waist_delay
from stepover.planning.algorithm_1.com_waist import com_and_waist
from stepover.planning.algorithm_1.planner import plan_in_detail
from stepover.planning.algorithm_1.step_sequence import step_sequence
from stepover.planning.checks import require, require_speeds
from stepover.planning.measures import measure

HEIGHTS = (0.15, 0.20, 0.22, 0.24, 0.25)


@pytest.fixture(scope="module")
def slowly(robot):
    """Plans within the speed limits, made once each."""
    made = {}

    def of(height, width=0.05):
        if (height, width) not in made:
            obstacle = Obstacle(height, width)
            made[height, width] = plan_in_detail(robot, obstacle, speed_limits="respect", look_for_nearest=False)
        return made[height, width]

    return of


@pytest.mark.parametrize("height", HEIGHTS)
def test_no_joint_exceeds_its_speed_limit_and_all_else_is_kept(robot, slowly, height):
    motion = slowly(height).motion
    found = measure(robot, motion)
    speeds = np.abs(np.gradient(motion.q[:, 7:], motion.dt, axis=0)) / robot.body.speed_limits
    assert speeds.max() <= 1.0
    assert found.joint_speed_ratio_max <= 1.0
    assert found.clearance_min >= 0.030
    assert found.zmp_margin_min >= 0.015
    assert max(found.zmp_rms) <= 0.004
    require(robot, motion)


@pytest.mark.parametrize(("height", "width"), [(0.2499, 0.05), (0.2501, 0.05), (0.25, 0.048), (0.25, 0.052)])
def test_25_cm_are_no_lucky_hit(robot, slowly, height, width):
    assert measure(robot, slowly(height, width).motion).joint_speed_ratio_max <= 0.98


@pytest.mark.parametrize(("height", "width"), [(0.05, 0.02), (0.10, 0.15), (0.12, 0.12), (0.15, 0.08)])
def test_low_and_wide_obstacles(robot, slowly, height, width):
    require_speeds(robot, slowly(height, width).motion)


def test_25_cm_cross_in_the_physics(slowly):
    run = simulate(slowly(0.25).motion)
    assert run.crossed
    assert run.obstacle_contacts == 0
    assert run.clearance_min >= 0.025
    assert run.waist_error_max <= 0.015


def test_a_motion_that_is_too_fast_is_refused_by_joint_speed_and_time(robot, motion):
    with pytest.raises(Infeasible, match=r"LEG_JOINT\d moves at 1\.\d\d of its speed limit at t = \d\.\d\d\d s"):
        require_speeds(robot, motion)


def test_without_extras_nothing_beyond_the_paper_is_used(robot):
    found = plan_in_detail(robot, Obstacle(0.15, 0.05), speed_limits="respect", extras=False, look_for_nearest=False)
    assert found.options.level == 0
    require_speeds(robot, found.motion)


def test_what_cannot_be_crossed_names_a_lower_one_that_can(robot):
    with pytest.raises(Infeasible) as refused:
        plan(robot, Obstacle(0.30, 0.05), speed_limits="respect")
    nearest = refused.value.nearest
    assert 0.25 <= nearest.height < 0.30
    plan_in_detail(robot, nearest, speed_limits="respect", look_for_nearest=False)


def test_slow_parameters_change_what_they_name_and_nothing_else(robot):
    for name in (field.name for field in dataclasses.fields(robot) if field.name != "slow"):
        ours, slow = getattr(robot, name), getattr(robot.slowed, name)
        if name not in SLOW:
            assert slow is ours
            continue
        differing = {key for key, value in dataclasses.asdict(ours).items() if getattr(slow, key) != value}
        assert differing == set(SLOW[name])
        assert {key: getattr(slow, key) for key in differing} == SLOW[name]


def test_a_robot_may_keep_its_own_parameters(spoilt):
    other = load_robot(spoilt({("slow",): False}))
    assert all(getattr(other.slowed, name) is getattr(other, name) for name in SLOW)


def test_slow_parameters_that_contradict_a_robots_own_are_refused(spoilt):
    with pytest.raises(InvalidInput, match=r"stepping_over.leg1_rise = 0\.378.*must be less than .*leg1_top = 0\.37"):
        load_robot(spoilt({("stepping_over",): {"leg1_rise": 0.3, "leg1_top": 0.37}}))


def test_the_heel_is_reached_after_lift_off_and_the_waist_is_lowest_later(robot, slowly):
    slow, key = robot.slowed, slowly(0.25).key
    sequence = step_sequence(slow, Obstacle(0.25, 0.05), key, robot.rest_zmp())
    step, moved = sequence.step(LEG_2), extra_zmp(slow, sequence, 1)
    offset = moved.zmp[:, 0] - sequence.zmp[:, 0]
    reached = step.lift_off + slow.beyond_paper.zmp_heel_from * (step.touch_down - step.lift_off)
    assert offset[step.lift_off] > -slow.beyond_paper.zmp_heel
    assert offset[int(np.ceil(reached))] == pytest.approx(-slow.beyond_paper.zmp_heel)
    height = com_and_waist(slow, moved, key, waist_delay(slow, 1)).waist[:, 2]
    at = round(slow.beyond_paper.waist_delay / slow.walk.sample_time)
    assert height.min() == pytest.approx(key.z_hds)
    assert height[step.lift_off + at] == pytest.approx(key.z_hds)
    assert height[step.lift_off] > key.z_hds + 1e-3
    assert waist_delay(slow, 0) == waist_delay(robot, 1) == 0.0
