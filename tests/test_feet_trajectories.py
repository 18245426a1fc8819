"""units/feet_trajectories.py: the feet over the obstacle, Sec. III-B and Fig. 3, judged by plain geometry."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import yaw_of

from stepover import Obstacle
from stepover.model import pose
from stepover.model.robot import Robot
from stepover.motion.footsteps import BEFORE, LEG_1, LEG_2
from stepover.planning.algorithm_1.feasibility import key_configurations
from stepover.planning.algorithm_1.feet_trajectories import feet_trajectories
from stepover.planning.algorithm_1.step_sequence import Crossing, step_sequence
from stepover.planning.splines import clamped_spline, landing

HEEL, TOE, THICKNESS = 0.1056, 0.1356, 0.030  # the foot's envelope from the ankle, and its lower box's height
DT = 0.005


def of(robot: Robot, obstacle: Obstacle):
    """The steps and FTG's own trajectories to an obstacle, nothing adapted."""
    sequence = step_sequence(robot, obstacle, key_configurations(robot, obstacle)[0], np.zeros(2))
    return sequence, feet_trajectories(Crossing(robot, obstacle, sequence))


@pytest.fixture(scope="module")
def case(robot, obstacle):
    """The 15 cm case."""
    return of(robot, obstacle)


@pytest.fixture(scope="module")
def sequence(case):
    """Its steps."""
    return case[0]


@pytest.fixture(scope="module")
def feet(case):
    """Its feet."""
    return case[1]


def pitch_of(poses: np.ndarray) -> np.ndarray:
    """Toe-down angle (N,) [rad] from where the toe points."""
    ahead = pose.rotation(poses)[:, :, 0]
    return -np.arcsin(ahead[:, 2])


def side_view(poses: np.ndarray) -> np.ndarray:
    """Corners (N, 4, 2) of the foot in the x-z plane: heel, toe, upper toe, upper heel."""
    corners = np.array([[-HEEL, 0.0, 0.0], [TOE, 0.0, 0.0], [TOE, 0.0, THICKNESS], [-HEEL, 0.0, THICKNESS]])
    return (poses[:, None, :3] + corners @ np.swapaxes(pose.rotation(poses), 1, 2))[:, :, [0, 2]]


def outline(poses: np.ndarray) -> np.ndarray:
    """Points (N, 200, 2) densely along the edges of the foot."""
    corners = side_view(poses)
    share = np.linspace(0.0, 1.0, 50)[:, None]
    return np.concatenate([(1.0 - share) * corners[:, None, k - 1] + share * corners[:, None, k] for k in range(4)], 1)


def swing(sequence, feet, kind):
    """Poses of the swing foot from lift-off to touch-down."""
    step = sequence.step(kind)
    return feet.foot(step.side)[step.lift_off : step.touch_down + 1]


def test_position_and_speed_are_continuous(feet):
    for side in (1, -1):
        speed = np.diff(feet.foot(side)[:, :3], axis=0) / DT
        assert np.abs(speed).max() < 1.5
        assert np.abs(np.diff(speed, axis=0)).max() < 0.1
        rate = np.diff(pitch_of(feet.foot(side))) / DT
        assert np.abs(np.diff(rate)).max() < 0.5


def test_each_swing_starts_and_ends_at_rest_on_its_footholds(sequence, feet):
    for step in sequence.steps:
        moving = feet.foot(step.side)[step.lift_off : step.touch_down + 1]
        np.testing.assert_allclose(moving[0, :3], [*step.start, 0.0], atol=1e-12)
        np.testing.assert_allclose(moving[-1, :3], [*step.end, 0.0], atol=1e-12)
        speed = np.diff(moving[:, :3], axis=0) / DT
        assert np.abs(speed[[0, -1]]).max() < 0.06
        np.testing.assert_allclose(pitch_of(moving[[0, -1]]), 0.0, atol=1e-9)


def test_a_standing_foot_does_not_move(sequence, feet):
    for side in (1, -1):
        standing = sequence.support != -side
        inside = np.flatnonzero(standing[1:] & standing[:-1])
        moves = np.abs(np.diff(feet.foot(side), axis=0))[inside]
        assert moves.max() < 1e-12
        assert np.abs(feet.foot(side)[standing][:, 2]).max() < 1e-12


@pytest.mark.parametrize("height", [0.05, 0.10, 0.15, 0.20])
def test_no_corner_goes_through_the_floor(robot, height):
    _, feet = of(robot, Obstacle(height, 0.05))
    for side in (1, -1):
        assert side_view(feet.foot(side))[:, :, 1].min() >= -1e-6


@pytest.mark.parametrize("kind", [LEG_1, LEG_2])
@pytest.mark.parametrize(
    ("height", "width"), [(0.15, 0.05), (0.05, 0.02), (0.05, 0.08), (0.10, 0.05), (0.15, 0.08), (0.12, 0.03)]
)
def test_foot_keeps_out_of_the_margins(robot, kind, height, width):
    obstacle = Obstacle(height, width)
    sequence, feet = of(robot, obstacle)
    x_min, x_max, _, top = obstacle.profile(sequence.front_face, margins=True)
    points = outline(swing(sequence, feet, kind))
    inside = (points[..., 0] > x_min) & (points[..., 0] < x_max) & (points[..., 1] < top)
    assert not inside.any()
    over = (points[..., 0] > x_min) & (points[..., 0] < x_max)
    assert over.any()


def test_foot_does_not_swing_needlessly_high(robot, obstacle, sequence, feet):
    """4 cm over the margin for leg 1; for leg 2 its toe's drop and 1 cm; some more for the spline between."""
    assert 0.18 < swing(sequence, feet, LEG_1)[:, 2].max() < 0.18 + 0.04 + 0.02
    assert 0.18 < swing(sequence, feet, LEG_2)[:, 2].max() < 0.18 + TOE * np.sin(np.radians(21.6)) + 0.01 + 0.03
    assert swing(sequence, feet, BEFORE)[:, 2].max() == pytest.approx(robot.walk.lift, abs=1e-3)


def test_leg_1_lands_from_above_with_a_speed_that_falls_linearly(robot, sequence, feet):
    moving = swing(sequence, feet, LEG_1)
    share = np.linspace(0.0, 1.0, len(moving))
    late = share > robot.stepping_over.leg1_descent + 0.03
    np.testing.assert_allclose(moving[late, 0], sequence.step(LEG_1).end[0], atol=1e-9)
    speed = np.gradient(moving[:, 2], DT)[late][:-1]
    left = (1.0 - share[late])[:-1]
    slope = (speed @ left) / (left @ left)
    assert slope < -0.5
    np.testing.assert_allclose(speed, slope * left, atol=0.03 * np.abs(speed).max())


def test_leg_2_comes_forward_to_rest_with_a_speed_that_falls_linearly(robot, sequence, feet):
    moving, shape = swing(sequence, feet, LEG_2), robot.stepping_over
    share = np.linspace(0.0, 1.0, len(moving))
    late = (share > shape.leg2_descent + 0.06) & (share < 1.0 - shape.rest)
    speed = np.gradient(moving[:, 0], DT)[late]
    left = 1.0 - shape.rest - share[late]
    slope = (speed @ left) / (left @ left)
    assert slope > 0.5
    np.testing.assert_allclose(speed, slope * left, atol=0.05 * np.abs(speed).max())


def test_leg_1_lands_heel_first(sequence, feet):
    pitch = pitch_of(swing(sequence, feet, LEG_1))
    assert np.degrees(pitch.min()) == pytest.approx(-2.0, abs=0.01)
    assert pitch.max() < 1e-9
    corners = side_view(swing(sequence, feet, LEG_1))
    flat = int(0.9 * len(pitch))
    assert corners[flat, 0, 1] < corners[flat, 1, 1]


def test_leg_2_passes_with_the_toe_down(sequence, feet):
    """120 degrees a metre of height with margin: 21.6 degrees over 0.18 m, toe below the heel."""
    moving = swing(sequence, feet, LEG_2)
    assert np.degrees(pitch_of(moving)).max() == pytest.approx(21.6, abs=0.3)
    assert np.degrees(pitch_of(moving)).min() > -0.5
    corners = side_view(moving)
    over = int(0.45 * len(moving))
    assert corners[over, 1, 1] < corners[over, 0, 1] - 0.05


def test_feet_keep_to_their_sides_and_straight_ahead(feet):
    np.testing.assert_allclose(feet.left[:, 1], 0.095, atol=1e-9)
    np.testing.assert_allclose(feet.right[:, 1], -0.095, atol=1e-9)
    assert feet.foot(1) is feet.left
    assert feet.foot(-1) is feet.right
    for side in (1, -1):
        np.testing.assert_allclose(yaw_of(feet.foot(side)), 0.0, atol=1e-12)


def test_left_and_right_swing_in_turn(sequence, feet):
    up = {side: feet.foot(side)[:, 2] > 0.01 for side in (1, -1)}
    assert not (up[1] & up[-1]).any()
    assert (sequence.support[up[1]] == -1).all()
    assert (sequence.support[up[-1]] == 1).all()


def test_clamped_spline_rests_at_both_ends():
    time = np.linspace(-0.5, 1.5, 2001)
    curve = clamped_spline([(1.0, 2.0), (0.0, 1.0), (0.4, 3.0)], time)
    np.testing.assert_allclose(curve[time <= 0.0], 1.0)
    np.testing.assert_allclose(curve[time >= 1.0], 2.0)
    np.testing.assert_allclose(np.interp(0.4, time, curve), 3.0, atol=1e-6)
    assert np.abs(np.gradient(curve, time)[np.isclose(time, 0.0) | np.isclose(time, 1.0)]).max() < 0.05


def test_landing_knots_lie_on_a_parabola():
    knots = np.array(landing(0.6, 0.3, 1.0, 0.1, 8))
    assert len(knots) == 8
    np.testing.assert_allclose(knots[-1], [1.0, 0.1])
    np.testing.assert_allclose(knots[:, 1], 0.1 + 0.2 * ((1.0 - knots[:, 0]) / 0.4) ** 2)
    assert (np.diff(knots[:, 0]) > 0.0).all()
