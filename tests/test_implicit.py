"""model/implicit.py: accelerations of the next step, with points of the feet on the floor."""

from __future__ import annotations

import numpy as np
import pytest

from stepover.model.implicit import Prediction
from stepover.model.pose import rotation
from stepover.model.robot import Robot
from stepover.motion.motion import Motion

DOWN = np.array([0.0, 0.0, -9.81])


@pytest.fixture(scope="module")
def prediction(robot: Robot) -> Prediction:
    """The robot with the corners of its contact patches."""
    names, points = robot.body.joint_names, []
    for side, leg in ((1, robot.legs.left), (-1, robot.legs.right)):
        corners = np.column_stack([robot.contact_patch(side), np.full(4, -robot.foot.ankle_height)])
        points.append((leg[-1], corners))
    return Prediction(robot.urdf_path.read_text(), names, points, 1e-3)


def accelerations(prediction: Prediction, motion: Motion, standing: tuple[int, ...]) -> np.ndarray:
    """Of all joints, without torques, from the motion's first posture at rest."""
    still = np.zeros(len(motion.joint_names))
    return prediction.acceleration(motion.q[0, :7], np.zeros(6), motion.q[0, 7:], still, still, standing, still + 0.1)


def test_the_floor_holds_what_presses_on_it_and_pulls_at_nothing(prediction: Prediction, motion: Motion) -> None:
    prediction.set_gravity(DOWN)
    free, held = accelerations(prediction, motion, ()), accelerations(prediction, motion, (0, 1, 2, 3))
    assert np.abs(free).max() < 1e-6
    assert np.abs(held).max() > 1.0
    prediction.set_gravity(-DOWN)
    np.testing.assert_allclose(
        accelerations(prediction, motion, (0, 1, 2, 3)), accelerations(prediction, motion, ()), atol=1e-6
    )


def test_the_nearest_corner_of_a_turned_foot(prediction: Prediction, robot: Robot, motion: Motion) -> None:
    accelerations(prediction, motion, ())
    for foot, side in enumerate((1, -1)):
        sole = motion.foot(side)[:1]
        corners = np.column_stack([0.9 * robot.contact_patch(side), np.zeros(4)])[::-1]
        places = corners @ rotation(sole)[0].T + sole[0, :3]
        np.testing.assert_array_equal(prediction.nearest(foot, places), [3, 2, 1, 0])
