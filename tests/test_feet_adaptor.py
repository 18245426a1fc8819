import pickle

import numpy as np
import pytest

from stepover.analysis.limits import with_authors_swing
from stepover.errors import Infeasible, TrailingLegBlocked
from stepover.model.obstacle import Obstacle
from stepover.motion.footsteps import LEG_2
from stepover.planning.algorithm_1 import shift_and_raise
from stepover.planning.algorithm_1.beyond_paper import extra_zmp
from stepover.planning.algorithm_1.com_waist import com_and_waist
from stepover.planning.algorithm_1.feasibility import key_configurations
from stepover.planning.algorithm_1.feet_adaptor import adapt_feet, push_ankle
from stepover.planning.algorithm_1.feet_trajectories import feet_trajectories, swing_shape
from stepover.planning.algorithm_1.plan import Options
from stepover.planning.algorithm_1.planner import algorithm_1, plan_in_detail
from stepover.planning.algorithm_1.shift_and_raise import (
    raise_waist,
    shift_back,
    stance_clearances,
    swing_clearances,
    waist_bump,
)
from stepover.planning.algorithm_1.step_sequence import Crossing, step_sequence
from stepover.planning.leg_check import LegLimits, check_legs
from stepover.planning.measures import measure
from stepover.planning.trajectories import WaistAndFeet


@pytest.fixture(scope="module")
def high(robot):
    """25 cm before FTA, with the ZMP inside the soles: robot, obstacle and steps; waist and feet."""
    obstacle = Obstacle(0.25, 0.05)
    key = next(key for key in key_configurations(robot, obstacle) if key.x_ads > 0.505 and key.z_hds < 0.64)
    sequence = extra_zmp(robot, step_sequence(robot, obstacle, key, robot.rest_zmp()), 2)
    crossing = Crossing(robot, obstacle, sequence)
    feet = feet_trajectories(crossing, swing_shape(robot, 0, leg_2_late=True))
    return crossing, WaistAndFeet(com_and_waist(robot, sequence, key).waist, feet)


def depth(crossing, waist, feet):
    """Smallest separation of the legs in phase 3 [m]."""
    step = crossing.sequence.step(LEG_2)
    swing = slice(step.lift_off, step.touch_down + 1)
    limits = LegLimits(crossing.obstacle.profile(crossing.sequence.front_face, margins=True), 0.0)
    return check_legs(crossing.robot, WaistAndFeet(waist, feet).at(swing), limits).separation.min()


def test_nothing_to_do_at_15_cm(planned):
    assert not planned.adaptation.acted
    assert planned.adaptation.clear
    assert np.isnan(planned.adaptation.start)
    np.testing.assert_array_equal(planned.motion.left_foot, planned.nominal.feet.left)


def test_method_1_moves_the_swing_foot_back_and_nothing_else(robot, high):
    sequence, feet = high[0].sequence, high[1].feet
    step = sequence.step(LEG_2)
    moved = shift_back(robot, feet, step, 0.1)
    change = moved.left - feet.left
    np.testing.assert_array_equal(moved.right, feet.right)
    assert change[:, 0].min() == pytest.approx(-0.1, abs=1e-3)
    assert change[:, 0].max() <= 1e-12
    assert not change[:, 1:].any()
    np.testing.assert_allclose(change[: step.lift_off + 1], 0.0, atol=1e-12)
    np.testing.assert_allclose(change[step.touch_down :], 0.0, atol=1e-12)
    speed = np.diff(change[:, 0]) / robot.walk.sample_time
    assert abs(speed[step.lift_off]) < 0.05, "no jump of speed at lift-off"
    assert abs(speed[step.touch_down - 1]) < 0.05, "nor at landing"


def test_method_1_frees_the_shank(robot, high):
    crossing, poses = high
    sequence, waist, feet = crossing.sequence, poses.waist, poses.feet
    before = depth(crossing, waist, feet)
    after = depth(crossing, waist, shift_back(robot, feet, sequence.step(LEG_2), 0.2))
    assert before < -0.02
    assert after > before + 0.01


def test_method_2_raises_the_waist_in_phase_3_only(robot, high):
    crossing, poses = high
    sequence, waist, feet = crossing.sequence, poses.waist, poses.feet
    step = sequence.step(LEG_2)
    bump = waist_bump(robot, sequence, 0.04)
    assert bump.max() == pytest.approx(0.04, abs=1e-4)
    assert not bump[: step.lift_off + 1].any()
    assert np.abs(bump[step.touch_down :]).max() < 1e-12
    raised = raise_waist(robot, sequence, waist, 0.04)
    np.testing.assert_array_equal(raised[:, [0, 1, 3, 4, 5, 6]], waist[:, [0, 1, 3, 4, 5, 6]])
    assert depth(crossing, raised, feet) > depth(crossing, waist, feet)


def test_method_3_is_what_frees_20_by_8_cm(robot):
    obstacle = Obstacle(0.20, 0.08)
    keys = key_configurations(robot, obstacle)
    key = min(keys, key=lambda key: abs(key.x_ads - 0.479) + abs(key.z_hds - robot.posture.waist_height))
    with_it = algorithm_1(robot, obstacle, key, Options("auto", level=1))
    assert 0.0 < with_it.adaptation.pushed <= robot.adaptor.push_total
    with pytest.raises(Infeasible, match="FTA cannot free the trailing leg: LLEG_LINK3 stays"):
        algorithm_1(robot, obstacle, key, Options("auto", methods=(1, 2), level=1))


def test_method_3_pushes_smoothly_and_leaves_lift_off_and_landing(robot, high):
    crossing, poses = high
    sequence, waist, feet = crossing.sequence, poses.waist, poses.feet
    step = sequence.step(LEG_2)
    raised = raise_waist(robot, sequence, waist, 0.04)
    start = shift_back(robot, feet, step, 0.25)
    before = depth(crossing, raised, start)
    pushed = push_ankle(crossing, WaistAndFeet(raised, start))
    assert before < -0.005
    assert depth(crossing, raised, pushed) > before + 0.003
    change = (pushed.left - start.left)[:, :3]
    assert not change[: step.lift_off + 1].any()
    assert not change[step.touch_down :].any()
    acceleration = np.diff(change, 2, axis=0) / robot.walk.sample_time**2
    assert np.abs(acceleration).max() < 12.0, "of the order of the swing's own accelerations"
    np.testing.assert_array_equal(pushed.right, feet.right)


def test_all_three_end_clear(robot, high):
    crossing, poses = high
    sequence, waist = crossing.sequence, poses.waist
    result = adapt_feet(crossing, poses)
    assert result.clear
    assert result.acted
    assert sequence.time[sequence.step(LEG_2).lift_off] <= result.start < result.end
    lifted = raise_waist(robot, sequence, waist, result.raised)
    assert depth(crossing, lifted, result.feet) >= 0.0
    np.testing.assert_allclose(lifted[:, 2] - waist[:, 2], result.waist_raise, atol=1e-12)


def test_looking_closer_step_by_step_misses_no_candidate(robot, high):
    crossing, poses = high
    result = adapt_feet(crossing, poses)
    adaptor, every = robot.adaptor, round(robot.adaptor.look_every / robot.walk.sample_time)
    raises = np.arange(0.0, adaptor.raise_max + 1e-9, adaptor.raise_step)
    shifts = np.arange(0.0, adaptor.shift_max + 1e-9, adaptor.shift_step)
    candidates = np.array([(height, shift) for height in raises for shift in shifts])
    stance = stance_clearances(crossing, poses, candidates[:, 0], every)
    free = np.minimum(stance, swing_clearances(crossing, poses, candidates, every))
    enough = np.flatnonzero(free >= adaptor.spare)
    assert 0 < len(enough) < 0.9 * len(candidates)
    np.testing.assert_allclose([result.raised, result.shift], candidates[enough[0]])


@pytest.mark.parametrize("depth", [-0.03, -0.005])
def test_of_candidates_that_differ_by_rounding_the_least_is_taken(robot, high, monkeypatch, depth):
    crossing, poses = high
    noise = np.random.default_rng(1)
    for leg in ("stance", "swing"):
        alike = lambda *args: depth + noise.normal(0.0, 1e-17, len(args[2]))  # noqa: E731
        monkeypatch.setattr(shift_and_raise, f"{leg}_clearances", alike)
    result = adapt_feet(crossing, poses)
    assert (result.raised, result.shift) == (0.0, 0.0)


def test_without_any_method_it_says_what_remains(robot, high):
    crossing, poses = high
    result = adapt_feet(crossing, poses, methods=())
    assert not result.clear
    assert not result.acted
    error = result.refusal(crossing, poses.waist).explain()
    assert "LLEG_LINK3" in str(error)
    assert f"{1e3 * error.short:.1f} mm inside" in str(error)


def test_what_is_too_much_for_method_3_is_not_pushed_and_explained_when_asked(robot):
    obstacle = Obstacle(0.25, 0.05)
    first = key_configurations(robot, obstacle)[0]
    with pytest.raises(TrailingLegBlocked) as caught:
        algorithm_1(robot, obstacle, first, Options(level=1))
    assert caught.value.short > robot.adaptor.push_max
    said = caught.value.explain()
    assert "FTA cannot free the trailing leg: LLEG_LINK3 stays" in str(said)
    assert "phase 3" in str(said)
    assert str(caught.value) == str(said)
    elsewhere = pickle.loads(pickle.dumps(caught.value))
    assert (str(elsewhere), elsewhere.short) == (str(said), caught.value.short)
    assert said.short >= caught.value.short


def test_at_25_cm_nothing_goes_without_the_two_units(robot):
    obstacle = Obstacle(0.25, 0.05)
    first = key_configurations(robot, obstacle)[0]
    with pytest.raises(Infeasible, match="RLEG_JOINT3 over-stretches"):
        algorithm_1(robot, obstacle, first, Options("off", methods=()))


@pytest.fixture(scope="module")
def crossing(robot):
    """The 25 cm plan."""
    return plan_in_detail(robot, Obstacle(0.25, 0.05), look_for_nearest=False)


def test_25_cm_keeps_every_limit(robot, crossing):
    found = measure(robot, crossing.motion)
    assert found.clearance_min >= 0.03
    assert found.joint_margin_min >= 0.0
    assert found.zmp_margin_min >= 0.015
    assert max(found.zmp_rms) <= 0.004
    knees = [robot.body.column(knee) for knee in robot.legs.knee]
    assert crossing.motion.q[:, knees].min() >= np.radians(5.0) - 1e-9


def test_at_25_cm_both_units_act_on_leg_2(crossing):
    record = crossing.adaptations
    assert record["ubmg"]["acted"]
    assert record["fta"]["acted"]
    assert record["fta"]["leg"] == "leg 2"
    phase = crossing.motion.time[crossing.motion.samples(3)]
    assert phase[0] - 0.01 <= record["fta"]["start"] < record["fta"]["end"] <= phase[-1] + 0.01
    np.testing.assert_array_equal(crossing.motion.right_foot, crossing.nominal.feet.right)


def test_25_cm_takes_more_than_the_authors_control_points(robot):
    with pytest.raises(Infeasible):
        plan_in_detail(with_authors_swing(robot), Obstacle(0.25, 0.05), extras=False, look_for_nearest=False)
    later = plan_in_detail(robot, Obstacle(0.25, 0.05), extras=False)
    assert (later.options.level, later.options.late, later.options.arms) == (0, 2, "off")
    measured = measure(robot, later.motion)
    assert measured.clearance_min >= 0.030
    assert measured.zmp_margin_min == pytest.approx(0.041, abs=0.001)
    assert measured.joint_speed_ratio_max == pytest.approx(1.68, abs=0.01)
    low = plan_in_detail(robot, Obstacle(0.2, 0.05), extras=False).options
    assert (low.level, low.late) == (0, 0), "a late swing lands less softly, so it is tried last"
