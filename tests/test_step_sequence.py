"""units/step_sequence.py: the steps, their timing and the ZMP reference of Secs. V and III-C2."""

from __future__ import annotations

import dataclasses
from itertools import pairwise

import numpy as np
import pytest

from stepover import Infeasible
from stepover.model.support import zmp_margin
from stepover.motion.footsteps import AFTER, BEFORE, LEG_1, LEG_2, NORMAL
from stepover.planning.algorithm_1.planner import plan_in_detail
from stepover.planning.algorithm_1.step_sequence import step_sequence

REST = np.array([0.01, 0.002])


@pytest.fixture(scope="module")
def sequence(robot, obstacle, planned):
    """The 15 cm case."""
    return step_sequence(robot, obstacle, planned.key, REST)


def at(robot, obstacle, planned, distance, leading=-1):
    """A sequence to an obstacle at a distance."""
    return step_sequence(robot, dataclasses.replace(obstacle, distance=distance), planned.key, REST, leading)


def durations(sequence):
    """Single supports, and double supports between the steps [s]."""
    steps, time = sequence.steps, sequence.time
    single = [time[s.touch_down] - time[s.lift_off] for s in steps]
    return single, [time[b.lift_off] - time[a.touch_down] for a, b in pairwise(steps)]


def test_seven_steps_as_in_fig_9(sequence):
    assert [s.kind for s in sequence.steps] == [NORMAL, BEFORE, LEG_1, LEG_2, AFTER, NORMAL, NORMAL]
    assert [s.side for s in sequence.steps] == [-1, 1, -1, 1, -1, 1, -1]
    assert sequence.step(LEG_1).side == -1


def test_timing_is_the_papers(sequence):
    single, double = durations(sequence)
    assert single == pytest.approx([0.78, 1.5, 1.5, 1.5, 1.5, 0.78, 0.78])
    assert double == pytest.approx([0.02, 0.04, 0.04, 0.04, 0.04, 0.02])
    assert np.diff(sequence.time) == pytest.approx(0.005)
    assert sequence.time[0] == 0.0


def test_the_time_before_and_after_lets_preview_look_ahead(robot, sequence):
    window = robot.preview.window
    assert sequence.time[sequence.steps[0].lift_off] >= window
    assert sequence.time[-1] - sequence.time[sequence.steps[-1].touch_down] >= window


def test_feet_alternate_and_start_where_they_landed(sequence):
    stands = {1: (0.0, 0.095), -1: (0.0, -0.095)}
    for before, step in zip((None, *sequence.steps), sequence.steps, strict=False):
        assert before is None or step.side == -before.side
        assert step.start == stands[step.side]
        assert step.end[0] >= step.start[0]
        assert step.end[1] == step.side * 0.095
        stands[step.side] = step.end
    assert stands[1][0] == pytest.approx(stands[-1][0])


def test_step_lengths_are_those_of_the_paper(sequence, planned):
    """Nominal 0.20 m, then X_ads, then 0.20 m again; the last step closes."""
    ends = [s.end[0] for s in sequence.steps]
    assert np.diff([0.0, *ends]) == pytest.approx([0.2, 0.2, planned.key.x_ads, 0.2, 0.2, 0.2, 0.0])


def test_obstacle_lies_between_the_feet(robot, obstacle, sequence, planned):
    first, second = sequence.step(LEG_1), sequence.step(LEG_2)
    rear, front = second.start[0], first.end[0]
    x_min, x_max, _, _ = obstacle.profile(sequence.front_face, margins=True)
    assert sequence.front_face - rear == pytest.approx(planned.key.front_face(robot, obstacle))
    assert rear + robot.foot.toe <= x_min
    assert x_max <= front - robot.foot.heel
    assert first.start[0] + robot.foot.toe < x_min


@pytest.mark.parametrize("distance", [0.62, 0.7, 0.815, 1.0, 1.23, 1.5, 2.0, 2.5, 3.0])
def test_every_distance_places_the_rear_foot_alike(robot, obstacle, planned, distance):
    sequence = at(robot, obstacle, planned, distance)
    assert sequence.front_face == pytest.approx(distance)
    rear = sequence.step(BEFORE).end[0]
    assert distance - rear == pytest.approx(planned.key.front_face(robot, obstacle))
    ends = np.array([s.end[0] for s in sequence.steps])
    approach = [s for s in sequence.steps if s.touch_down <= sequence.step(BEFORE).touch_down]
    lengths = np.diff([0.0, *ends[: len(approach)]])
    assert np.ptp(lengths) < 1e-9
    assert robot.walk.step_length_min - 1e-9 <= lengths[0] <= robot.walk.step_length_max + 1e-9
    assert sequence.step(LEG_1).side == -1
    sides = [s.side for s in sequence.steps]
    assert all(a == -b for a, b in pairwise(sides))
    assert [s.kind for s in sequence.steps[-5:]] == [LEG_1, LEG_2, AFTER, NORMAL, NORMAL]
    assert {s.kind for s in sequence.steps[:-6]} <= {NORMAL}


def test_the_other_side_may_lead(robot, obstacle, planned, sequence):
    other = step_sequence(robot, obstacle, planned.key, REST * [1.0, -1.0], leading=1)
    assert [s.side for s in other.steps] == [-s.side for s in sequence.steps]
    np.testing.assert_array_equal(other.support, -sequence.support)
    np.testing.assert_allclose(other.zmp, sequence.zmp * [1.0, -1.0], atol=1e-12)


def test_support_is_the_foot_that_does_not_swing(sequence):
    expected = np.zeros(len(sequence.time), dtype=int)
    for step in sequence.steps:
        expected[step.lift_off : step.touch_down] = -step.side
    np.testing.assert_array_equal(sequence.support, expected)
    assert sequence.support[0] == sequence.support[-1] == 0


def test_phases_are_those_of_sec_ii(sequence):
    first, second = sequence.step(LEG_1), sequence.step(LEG_2)
    expected = np.zeros(len(sequence.time), dtype=int)
    expected[first.lift_off : first.touch_down] = 1
    expected[first.touch_down : second.lift_off] = 2
    expected[second.lift_off : second.touch_down] = 3
    np.testing.assert_array_equal(sequence.phase, expected)
    assert (sequence.support[sequence.phase == 1] == 1).all()
    assert (sequence.support[sequence.phase == 2] == 0).all()
    assert (sequence.support[sequence.phase == 3] == -1).all()


def test_reference_rests_under_the_stance_ankle(sequence):
    stands = {1: np.array([0.0, 0.095]), -1: np.array([0.0, -0.095])}
    for step in sequence.steps:
        swing = slice(step.lift_off, step.touch_down + 1)
        np.testing.assert_allclose(sequence.zmp[swing] - stands[-step.side], 0.0, atol=1e-12)
        stands[step.side] = np.array(step.end)


def test_reference_is_linear_in_double_support_and_continuous(sequence):
    steps = sequence.steps
    for before, after in pairwise(steps):
        between = sequence.zmp[before.touch_down : after.lift_off + 1]
        np.testing.assert_allclose(np.diff(between, 2, axis=0), 0.0, atol=1e-12)
        np.testing.assert_allclose(between[-1], before.end)
    edges = np.abs(np.diff(sequence.zmp, axis=0)).max(axis=0)
    assert (edges <= [0.40 / 4, 0.19 / 4 + 1e-9]).all()


def test_reference_begins_and_ends_where_the_com_rests(sequence):
    np.testing.assert_allclose(sequence.zmp[0], REST)
    end = np.mean([sequence.steps[-1].end, sequence.steps[-2].end], axis=0)
    np.testing.assert_allclose(sequence.zmp[-1], end + REST)


def test_reference_keeps_inside_the_support_polygon(robot, sequence, planned):
    margins = zmp_margin(robot, sequence.zmp, sequence.support, planned.nominal.feet.left, planned.nominal.feet.right)
    assert margins.min() >= 0.055


@pytest.mark.parametrize("distance", [0.02, 0.1, 0.2, 0.25])
def test_an_obstacle_nearer_than_the_first_step_names_one_that_plans(robot, obstacle, planned, distance):
    with pytest.raises(Infeasible, match="nearer than the first step") as caught:
        at(robot, obstacle, planned, distance)
    nearest = caught.value.nearest
    assert nearest.distance > distance
    assert (nearest.height, nearest.width) == (obstacle.height, obstacle.width)
    assert f"{distance:.3f} m" in str(caught.value)
    assert f"{nearest.distance:.3f} m" in str(caught.value)


def test_the_nearest_distance_really_plans(robot, obstacle, planned):
    with pytest.raises(Infeasible) as caught:
        at(robot, obstacle, planned, 0.1)
    nearest = caught.value.nearest
    motion = plan_in_detail(robot, nearest, look_for_nearest=False).motion
    assert motion.obstacle[0] == pytest.approx(nearest.distance)
