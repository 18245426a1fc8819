"""model/planar_biped.py and model/crossing.py: the planar biped of Sec. II-A, Eqs. (1) to (12)."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
import shapely

from stepover import InvalidInput
from stepover.analysis.double_support import DoubleSupport, double_support
from stepover.analysis.planar.biped import (
    between_feet,
    joint_angles,
    leg_lines,
    over_front_foot,
    over_rear_foot,
    planar_biped,
    planar_leg,
)
from stepover.analysis.planar.crossing import lines_meet, segments_meet
from stepover.model import pose


@pytest.fixture(scope="module")
def biped(robot):
    return planar_biped(robot)


def random_hips(seed, count=2000):
    """Hips ahead of the ankle and above the floor (count,) each, some of them out of reach."""
    rng = np.random.default_rng(seed)
    return rng.uniform(-0.6, 0.6, count), rng.uniform(0.2, 0.75, count)


def shapely_meets(segments):
    """Whether pairs of segments (N, 4, 2) have a point in common, by shapely, to which one of no length is a point."""
    shapes = []
    for pair in (segments[:, :2], segments[:, 2:]):
        no_length = (pair[:, 0] == pair[:, 1]).all(axis=-1)
        shapes.append(np.where(no_length, shapely.points(pair[:, 0]), shapely.linestrings(pair)))
    return shapely.intersects(*shapes)


def test_lengths_limits_and_foot_are_the_robots(robot, biped):
    assert (biped.thigh, biped.shank, biped.ankle_height, biped.foot) == pytest.approx((0.3, 0.3, 0.105, 0.2172))
    np.testing.assert_allclose(np.degrees(biped.limits), [[-125, 42], [0, 150], [-75, 42]], atol=1e-6)
    assert [len(line) for line in biped.outline] == [4, 3]


def test_links_keep_their_lengths_and_join_ankle_to_hip(biped):
    ahead, height = random_hips(1)
    leg = planar_leg(biped, ahead, height)
    bones = np.linalg.norm(np.diff(leg.points, axis=-2), axis=-1)
    reached = np.isfinite(bones).all(axis=-1)
    np.testing.assert_allclose(bones[reached], 0.3, atol=1e-12)
    np.testing.assert_array_equal(reached, np.hypot(ahead, height - 0.105) <= 0.6)
    assert not leg.possible[~reached].any()
    np.testing.assert_array_equal(leg.points[:, 0], np.tile([0.0, 0.105], (len(ahead), 1)))
    np.testing.assert_allclose(leg.points[:, 2], np.column_stack([ahead, height]))
    np.testing.assert_allclose(leg.angles[reached].sum(axis=-1), 0.0, atol=1e-12)  # sole flat, waist upright


def test_angles_are_those_of_the_robot_in_3d(robot, biped):
    """The same leg by the robot's own inverse kinematics, and its knee by forward kinematics."""
    ahead, height = (values[:200] for values in random_hips(2))
    flat = planar_leg(biped, ahead, height)
    reached = np.isfinite(flat.angles).all(axis=-1)
    leg, zero = robot.leg(1), np.zeros(reached.sum())
    waist = pose.pose(np.column_stack([ahead[reached], zero, height[reached]]))
    sole = pose.pose(np.column_stack([zero, zero + 0.095, zero]))
    angles = leg.inverse(waist, sole)
    np.testing.assert_allclose(angles[:, 2:5], flat.angles[reached], atol=1e-9)
    _, _, centres = leg.joint_frames(waist, angles)
    np.testing.assert_allclose(centres[:, 3][:, [0, 2]], flat.points[reached, 1], atol=1e-9)


def test_possible_is_within_the_joint_limits(biped):
    """Lift one limit after the other: what was refused for it becomes possible."""
    ahead, height = random_hips(3)
    leg = planar_leg(biped, ahead, height)
    inside = np.isfinite(leg.angles).all(axis=-1)
    for joint, (low, high) in enumerate(np.radians([(-125, 42), (0, 150), (-75, 42)])):
        inside &= (leg.angles[:, joint] >= low) & (leg.angles[:, joint] <= high)
    np.testing.assert_array_equal(leg.possible, inside)
    assert 0.2 < inside.mean() < 0.8
    free = dataclasses.replace(biped, limits=np.tile([-np.pi, np.pi], (3, 1)))
    np.testing.assert_array_equal(planar_leg(free, ahead, height).possible, np.isfinite(leg.angles).all(axis=-1))


def test_knees_bend_forwards(biped):
    leg = planar_leg(biped, np.linspace(-0.4, 0.4, 41), np.full(41, 0.5))
    ankle, knee, hip = np.moveaxis(leg.points, -2, 0)
    along, aside = hip - ankle, knee - ankle
    assert (along[:, 0] * aside[:, 1] - along[:, 1] * aside[:, 0] < 0.0).all()


def test_the_outline_turns_with_the_shank(biped):
    """Rigid: distances from knee and ankle as in robot.toml; upright: L3 is straight ahead of the knee."""
    leg = planar_leg(biped, *random_hips(4, 100))
    _, front, rear = leg_lines(biped, leg)
    known = np.isfinite(leg.points).all(axis=(1, 2))
    for line, local in ((front, biped.outline[0]), (rear, biped.outline[1])):
        for centre, offset in ((1, [0.0, 0.0]), (0, [0.0, -0.3])):
            distances = np.linalg.norm(line - leg.points[:, centre : centre + 1], axis=-1)[known]
            np.testing.assert_allclose(distances, np.tile(np.linalg.norm(local - offset, axis=1), (len(distances), 1)))
    upright = dataclasses.replace(biped, thigh=0.1)
    squat = leg_lines(upright, planar_leg(upright, np.array(-0.1), np.array(0.405)))[1]
    np.testing.assert_allclose(squat[2], [0.118, 0.405], atol=1e-9)


def test_joint_angles_go_along_the_chain(biped):
    rear = planar_leg(biped, np.array(0.2), np.array(0.6))
    front = planar_leg(biped, np.array(-0.2), np.array(0.6))
    q = joint_angles(rear, front)
    directions = np.cumsum([q[0], q[1], q[2]])  # of l1, l2 from the vertical, and of l3 against l2
    np.testing.assert_allclose(rear.points[1, 0], -0.3 * np.sin(directions[0]), atol=1e-12)
    assert q[0] == rear.angles[2]
    assert q[1] == rear.angles[1]
    assert q[2] == pytest.approx(front.angles[0] - rear.angles[0])
    assert q[3] == front.angles[1]


@pytest.mark.parametrize("seed", range(2))
def test_crossing_agrees_with_shapely_on_the_grid_of_small_integers(seed):
    """Coordinates of 0 to 4: crossing, touching, collinear, overlapping, equal segments and single points, often."""
    segments = np.random.default_rng(seed).integers(0, 5, (10_000, 4, 2)).astype(float)
    found = segments_meet(*np.moveaxis(segments, 1, 0))
    np.testing.assert_array_equal(found, shapely_meets(segments))
    way, ends = segments[:, 1] - segments[:, 0], segments[:, 2:] - segments[:, :1]
    crosses = (way[:, None, 0] * ends[..., 1] - way[:, None, 1] * ends[..., 0]).T
    assert 0.2 < found.mean() < 0.8
    assert ((crosses == 0).all(axis=0) & found).sum() > 100  # collinear with a point in common
    assert ((crosses == 0).all(axis=0) & ~found).sum() > 50  # collinear and apart
    assert ((crosses == 0).any(axis=0) & ~(crosses == 0).all(axis=0) & found).sum() > 1000  # touching


def test_crossing_agrees_with_shapely_on_random_segments():
    segments = np.random.default_rng(5).uniform(-1.0, 1.0, (10_000, 4, 2))
    found = segments_meet(*np.moveaxis(segments, 1, 0))
    np.testing.assert_array_equal(found, shapely_meets(segments))
    assert 0.1 < found.mean() < 0.9


def test_crossing_is_symmetric_and_does_not_depend_on_the_frame():
    a, b, c, d = np.moveaxis(np.random.default_rng(6).integers(-4, 5, (5000, 4, 2)).astype(float), 1, 0)
    found = segments_meet(a, b, c, d)
    mirror, quarter = np.array([-1.0, 1.0]), np.array([[0.0, 1.0], [-1.0, 0.0]])
    for other in (
        (b, a, c, d), (a, b, d, c), (c, d, a, b), (a * mirror, b * mirror, c * mirror, d * mirror),
        (a @ quarter, b @ quarter, c @ quarter, d @ quarter), (a + 8.0, b + 8.0, c + 8.0, d + 8.0),
    ):  # fmt: skip
        np.testing.assert_array_equal(segments_meet(*other), found)


def test_lines_meet_the_obstacle_where_shapely_says(biped):
    ahead, height = random_hips(7, 400)
    leg = planar_leg(biped, ahead, height)
    known = leg.possible
    lines = [line[known] for line in leg_lines(biped, leg)]
    front = np.random.default_rng(8).uniform(-0.3, 0.3, known.sum())
    edges = np.array([[0.0, 0.0], [0.0, 0.15], [0.05, 0.15], [0.05, 0.0]]) + np.stack([front, 0 * front], -1)[:, None]
    found = lines_meet(lines, edges)
    shapes = [shapely.linestrings(line) for line in lines]
    expected = np.any([shapely.intersects(shape, shapely.linestrings(edges)) for shape in shapes], axis=0)
    np.testing.assert_array_equal(found, expected)
    assert 0.1 < found.mean() < 0.9


def test_conditions_of_the_com_and_the_zmp():
    """(6) to (8), by hand: F_W = 0.2, X_ads = 0.5; the ends belong to them."""
    x = np.array([-0.11, -0.1, 0.0, 0.1, 0.11, 0.39, 0.4, 0.5, 0.6, 0.61])
    assert over_rear_foot(x, 0.2).tolist() == [False, True, True, True] + [False] * 6
    assert between_feet(x, 0.5, 0.2).tolist() == [False] + [True] * 8 + [False]
    assert over_front_foot(x, 0.5, 0.2).tolist() == [False] * 6 + [True] * 3 + [False]
    np.testing.assert_array_equal(over_front_foot(x, 0.5, 0.2), over_rear_foot(0.5 - x, 0.2))  # seen from the front
    np.testing.assert_array_equal(between_feet(x, 0.5, 0.2), between_feet(0.5 - x, 0.5, 0.2))


def test_the_planned_motion_is_dynamic(robot, motion):
    """Its CoM breaks (6) and (8) by far and keeps (7); its ZMP keeps (10) to (12)."""
    over = double_support(robot, motion)
    assert over.x_ads == pytest.approx(motion.key_configuration[0], abs=1e-9)
    assert over.holds(over.com) == (False, True, False)
    assert over.holds(over.zmp) == (True, True, True)
    assert len(over.com) == round(robot.walk.double_support_over / robot.walk.sample_time) + 1
    still = DoubleSupport(over.x_ads, over.foot, np.linspace(0.0, over.x_ads, 9), over.zmp)
    assert still.holds(still.com) == (True, True, True)
    ahead = DoubleSupport(over.x_ads, over.foot, np.linspace(0.0, over.x_ads + over.foot, 9), over.zmp)
    assert ahead.holds(ahead.com) == (True, False, False)


def test_a_motion_without_a_double_support_is_refused(robot, motion):
    walk = dataclasses.replace(motion, phase=np.zeros_like(motion.phase))
    with pytest.raises(InvalidInput, match="no double support"):
        double_support(robot, walk)


def test_a_leg_without_a_pitch_joint_at_the_knee_is_refused(robot):
    legs = dataclasses.replace(robot.legs, knee=robot.legs.left[4:5])  # the ankle
    crooked = SimpleNamespace(name="crooked", body=robot.body, legs=legs)
    with pytest.raises(InvalidInput, match="pitch joint at the hip, the knee and the ankle"):
        planar_biped(crooked)
