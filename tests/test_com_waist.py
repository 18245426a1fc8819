"""units/com_waist.py: CoM and waist over the obstacle, Sec. III-C."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from conftest import yaw_of

from stepover.model import pose
from stepover.motion.footsteps import LEG_1, LEG_2
from stepover.planning.algorithm_1.com_waist import com_and_waist
from stepover.planning.algorithm_1.preview_control import kajita_gains, track
from stepover.planning.algorithm_1.step_sequence import step_sequence


@pytest.fixture(scope="module")
def low(planned):
    """The key configuration with a lower waist than HRP-2 needs: so that going down shows."""
    return dataclasses.replace(planned.key, z_hds=0.60)


@pytest.fixture(scope="module")
def sequence(robot, obstacle, low):
    """The steps of the 15 cm case, at rest under the CoM."""
    return step_sequence(robot, obstacle, low, com_at_rest(robot))


@pytest.fixture(scope="module")
def result(robot, sequence, low):
    """CWTG1's answer to it."""
    return com_and_waist(robot, sequence, low)


def com_at_rest(robot):
    """Horizontal CoM in half-sitting."""
    return robot.body.com(robot.body.placements(robot.half_sitting()[None]))[0, :2]


def spans(sequence):
    """Leg 1's swing, the double support over the obstacle, leg 2's swing, as slices."""
    first, second = sequence.step(LEG_1), sequence.step(LEG_2)
    return (
        slice(first.lift_off, first.touch_down + 1),
        slice(first.touch_down, second.lift_off + 1),
        slice(second.lift_off, second.touch_down + 1),
    )


def test_waist_goes_down_in_leg_1_holds_and_comes_back_in_leg_2(robot, sequence, result):
    height, normal = result.waist[:, 2], robot.posture.waist_height
    down, held, up = spans(sequence)
    np.testing.assert_allclose(height[: down.start + 1], normal)
    np.testing.assert_allclose(height[held], 0.60)
    np.testing.assert_allclose(height[up.stop - 1 :], normal)
    assert (np.diff(height[down]) <= 1e-12).all()
    assert (np.diff(height[up]) >= -1e-12).all()


def test_waist_turns_as_the_key_configuration_says(sequence, result, low):
    yaw = yaw_of(result.waist)
    turning, held, back = spans(sequence)
    np.testing.assert_allclose(yaw, result.yaw, atol=1e-12)
    np.testing.assert_allclose(yaw[held], low.yaw)
    np.testing.assert_allclose(yaw[: turning.start + 1], 0.0)
    np.testing.assert_allclose(yaw[back.stop - 1 :], 0.0, atol=1e-12)
    assert low.yaw > 0.0  # to the left, so that the right hip, whose leg leads, comes ahead


@pytest.mark.parametrize("which", ["height", "yaw"])
def test_both_are_cubics_with_zero_end_speeds(sequence, result, which):
    curve = result.waist[:, 2] if which == "height" else result.yaw
    for part in (spans(sequence)[0], spans(sequence)[2]):
        values = curve[part]
        share = np.linspace(0.0, 1.0, len(values))
        expected = values[0] + (values[-1] - values[0]) * (3.0 * share**2 - 2.0 * share**3)
        np.testing.assert_allclose(values, expected, atol=1e-12)


def test_waist_stays_upright(result):
    np.testing.assert_allclose(pose.rotation(result.waist)[:, :, 2], np.tile([0.0, 0.0, 1.0], (len(result.yaw), 1)))


def test_waist_rides_over_the_com_as_in_half_sitting(robot, sequence, result):
    from_com = robot.half_sitting()[:2] - com_at_rest(robot)
    np.testing.assert_allclose(result.waist[:, :2] - result.com.position, np.tile(from_com, (len(result.yaw), 1)))
    np.testing.assert_allclose(result.waist[0, :3], robot.half_sitting()[:3], atol=1e-9)


def test_com_is_preview_control_of_the_reference(robot, sequence, result):
    gains = kajita_gains(robot.preview, robot.walk.sample_time)
    expected = track(gains, sequence.zmp, robot.preview, robot.walk.sample_time)
    np.testing.assert_allclose(result.com.position, expected.position)
    np.testing.assert_allclose(result.com.zmp, expected.zmp)
    assert np.sqrt(((result.com.zmp - sequence.zmp) ** 2).mean(axis=0)).max() < 2.5e-3


def test_com_sways_to_the_stance_foot_and_never_goes_back(sequence, result):
    for step in sequence.steps:
        middle = (step.lift_off + step.touch_down) // 2
        assert np.sign(result.com.position[middle, 1]) == -step.side
    assert np.diff(result.com.position[:, 0]).min() > -1e-4


def test_the_com_does_not_stop_over_the_obstacle(sequence, result):
    """What makes the crossing dynamic: the CoM travels on during the short double support."""
    held = spans(sequence)[1]
    assert result.com.velocity[held, 0].min() > 0.2


def test_the_chest_turns_against_the_waist(robot, motion):
    """UBMG keeps the upper body looking ahead (III-C3)."""
    chest = motion.q[:, robot.body.column("CHEST_JOINT0")]
    np.testing.assert_allclose(chest, -yaw_of(motion.waist), atol=1e-9)
    assert np.degrees(chest.min()) == pytest.approx(-25.0, abs=0.01)
    placements = robot.body.placements(motion.q)
    facing = placements.rotations[:, robot.body.index("CHEST_JOINT1")] @ [1.0, 0.0, 0.0]
    np.testing.assert_allclose(facing[:, 1], 0.0, atol=1e-9)
