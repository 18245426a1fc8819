"""report/delta_ds.py: the look-up table of III-A, Eq. (22)."""

from __future__ import annotations

import numpy as np
import pytest

from stepover import InvalidInput
from stepover.analysis.delta_ds import delta_ds_stepping_over, delta_ds_walking

LENGTHS = [0.20, 0.30, 0.40, 0.50]


@pytest.mark.parametrize("length", LENGTHS)
def test_the_com_passes_midway_between_the_feet(robot, obstacle, length):
    """By symmetry in a steady walk; what is left is the controller's lag of a fraction of a sample."""
    assert delta_ds_walking(robot, length).com == pytest.approx(0.5, abs=0.005)
    assert delta_ds_stepping_over(robot, obstacle, length).com == pytest.approx(0.5, abs=0.005)


@pytest.mark.parametrize("length", LENGTHS)
def test_the_waist_is_where_half_sitting_has_it_from_the_com(robot, obstacle, length):
    behind = robot.rest_zmp()[0] - robot.half_sitting()[0]
    for share in (delta_ds_walking(robot, length), delta_ds_stepping_over(robot, obstacle, length)):
        assert share.waist == pytest.approx(share.com - behind / length)


@pytest.mark.parametrize("length", LENGTHS)
def test_it_hardly_varies_when_stepping_over(robot, obstacle, length):
    assert delta_ds_stepping_over(robot, obstacle, length).waist == pytest.approx(
        delta_ds_walking(robot, length).waist, abs=0.005
    )


def test_it_is_the_plans_own(robot, obstacle, planned):
    """From the arrays of the planned 15 cm case: its first stage, the middle of its phase 2."""
    over = planned.motion.samples(2)
    rear, front = np.sort([planned.motion.left_foot[over.start, 0], planned.motion.right_foot[over.start, 0]])
    waist = planned.nominal.first_stage.waist[(over.start + over.stop) // 2, 0]
    expected = (waist - rear) / (front - rear)
    assert delta_ds_stepping_over(robot, obstacle, planned.key.x_ads).waist == pytest.approx(expected, abs=1e-9)


def test_it_does_not_depend_on_how_many_steps_are_walked(robot):
    assert delta_ds_walking(robot, 0.3, steps=14).waist == pytest.approx(delta_ds_walking(robot, 0.3).waist, abs=1e-6)


@pytest.mark.parametrize("length", [0.0, -0.2, np.nan, np.inf])
def test_what_is_no_step_is_refused(robot, obstacle, length):
    with pytest.raises(InvalidInput, match="step length"):
        delta_ds_walking(robot, length)
    with pytest.raises(InvalidInput, match="step length"):
        delta_ds_stepping_over(robot, obstacle, length)
