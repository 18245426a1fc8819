"""model/pose.py: poses as x y z and a quaternion x y z w."""

from __future__ import annotations

import numpy as np
from conftest import yaw_of
from scipy.spatial.transform import Rotation

from stepover.model import pose

RNG = np.random.default_rng(3)


def test_pitch_then_yaw():
    yaw, pitch = RNG.uniform(-3.0, 3.0, (2, 20))
    poses = pose.pose(np.zeros((20, 3)), yaw, pitch)
    expected = Rotation.from_euler("ZY", np.column_stack([yaw, pitch]))
    np.testing.assert_allclose(pose.rotation(poses), expected.as_matrix(), atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(poses[:, 3:], axis=1), 1.0)


def test_positive_yaw_turns_left_and_positive_pitch_lowers_the_toe():
    turned, dipped = pose.pose(np.zeros((1, 3)), yaw=0.3), pose.pose(np.zeros((1, 3)), pitch=0.3)
    assert (pose.rotation(turned) @ [1.0, 0.0, 0.0])[0, 1] > 0.0
    assert (pose.rotation(dipped) @ [1.0, 0.0, 0.0])[0, 2] < 0.0


def test_yaw_is_found_again():
    yaw, pitch = RNG.uniform(-3.0, 3.0, 20), RNG.uniform(-1.0, 1.0, 20)
    np.testing.assert_allclose(yaw_of(pose.pose(np.zeros((20, 3)), yaw, pitch)), yaw, atol=1e-12)


def test_offset_is_in_the_poses_own_frame():
    quarter = pose.pose(np.array([[1.0, 2.0, 3.0]]), yaw=np.pi / 2.0)
    np.testing.assert_allclose(pose.offset(quarter, [0.1, 0.0, -0.105])[0, :3], [1.0, 2.1, 2.895])
    np.testing.assert_array_equal(pose.offset(quarter, [0.1, 0.0, -0.105])[0, 3:], quarter[0, 3:])


def test_quaternions_of_a_full_turn_have_no_sign_jumps():
    angles = np.linspace(0.0, 4.0 * np.pi, 400)
    matrices = Rotation.from_euler("z", angles[:, None]).as_matrix()
    poses = pose.from_matrices(matrices, np.zeros((400, 3)))
    assert np.abs(np.diff(poses[:, 3:], axis=0)).max() < 0.05
    np.testing.assert_allclose(pose.rotation(poses), matrices, atol=1e-12)
    assert poses[0, 6] > 0.0


def test_single_quaternions_agree_with_scipy():
    for first, second in RNG.normal(size=(20, 2, 4)):
        one, other = Rotation.from_quat(first), Rotation.from_quat(second)
        np.testing.assert_allclose(pose.unit(first), one.as_quat(), atol=1e-15)
        np.testing.assert_allclose(pose.product(one.as_quat(), other.as_quat()), (one * other).as_quat(), atol=1e-15)
        np.testing.assert_allclose(pose.axes(one.as_quat()), one.as_matrix(), atol=1e-15)


def test_cross_product_is_right_handed():
    np.testing.assert_array_equal(pose.cross([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]), [0.0, 0.0, 1.0])
    a, b = RNG.normal(size=(2, 3))
    np.testing.assert_allclose(pose.cross(a, b), np.cross(a, b), atol=1e-15)


def test_turns_are_those_between_the_matrices_whatever_sign_a_quaternion_has():
    for size in (1.0, 1e-3, 1e-9, 0.0):
        steps = Rotation.from_rotvec(size * RNG.normal(size=(40, 3)))
        ways = [Rotation.from_euler("ZY", [0.7, 0.4])]
        for step in steps:
            ways.append(ways[-1] * step)
        quaternions = np.array([way.as_quat() for way in ways]) * RNG.choice([-1.0, 1.0], (len(ways), 1))
        poses = np.column_stack([np.zeros((len(ways), 3)), quaternions])
        np.testing.assert_allclose(pose.turns(poses), steps.as_rotvec(), atol=3e-15)
