"""control/floor.py: a slope is learnt from the foot that stands, and the next foot comes down on it."""

from __future__ import annotations

import numpy as np
import pytest
from planned_readings import changed, planned_estimate

from stepover.control.floor import Floor
from stepover.control.leg_commands import LegCommands, tilt, turned
from stepover.control.reference import reference
from stepover.control.waist_control import WaistControl
from stepover.model import pose

LEFT, RIGHT = 0, 1
SLOPES = [(0.02, 0.0), (-0.02, 0.0), (0.0, 0.02), (0.0, -0.02)]


@pytest.fixture(scope="module")
def course(robot, motion):
    return reference(robot, motion)


@pytest.fixture(scope="module")
def on_left(motion):
    """A sample amid a swing of the right leg."""
    return int(np.flatnonzero(motion.support == 1)[80])


def standing(course, sample, slope, **values):
    """The left foot flat on a slope, with all the weight."""
    feet = course.feet[sample].copy()
    feet[LEFT] = turned(np.array(slope)) @ feet[LEFT]
    return changed(planned_estimate(course, sample), feet=feet, loads=np.array([569.0, 0.0]), **values)


@pytest.mark.parametrize("slope", SLOPES)
def test_a_slope_is_learnt_in_its_time(robot, course, on_left, slope):
    floor = Floor(robot, course)
    for _ in range(round(robot.stabilizer.slope_time / course.dt)):
        floor.look(on_left, standing(course, on_left, slope))
    np.testing.assert_allclose(floor.slope, np.array(slope) * (1.0 - np.exp(-1.0)), atol=4e-4)
    for _ in range(1000):
        floor.look(on_left, standing(course, on_left, slope))
    np.testing.assert_allclose(floor.slope, slope, atol=1e-6)


def test_on_rubber_a_foot_that_leans_to_its_pressure_stands_on_a_level_floor(robot, course, on_left):
    cops = np.array([(0.03, -0.02), (0.0, 0.0)])
    bent = 569.0 / robot.sole.tilt_stiffness * np.array([0.02, 0.03])
    floor = Floor(robot, course, rubber=True)
    for _ in range(300):
        floor.look(on_left, standing(course, on_left, bent, cops=cops))
    np.testing.assert_allclose(floor.slope, 0.0, atol=1e-4)


@pytest.mark.parametrize("why", ["on an edge", "both feet", "no load", "double support"])
def test_nothing_is_learnt_from_a_foot_that_may_not_lie_flat(robot, motion, course, on_left, why):
    sample = int(np.flatnonzero(motion.support == 0)[5]) if why == "double support" else on_left
    estimate = standing(course, sample, (0.02, 0.02))
    if why == "on an edge":
        estimate = changed(estimate, cops=np.array([(robot.foot.contact_x[1], 0.0), (0.0, 0.0)]))
    elif why == "both feet":
        estimate = changed(estimate, loads=np.array([300.0, 269.0]))
    elif why == "no load":
        estimate = changed(estimate, loads=np.zeros(2))
    floor = Floor(robot, course)
    floor.look(sample, estimate)
    np.testing.assert_array_equal(floor.slope, 0.0)


def test_what_is_believed_has_a_bound(robot, course, on_left):
    floor = Floor(robot, course)
    for _ in range(2000):
        floor.look(on_left, standing(course, on_left, (0.3, -0.3)))
    most = np.radians(robot.stabilizer.slope_max_deg)
    np.testing.assert_allclose(floor.slope, [most, -most])


@pytest.mark.parametrize("slope", SLOPES)
def test_both_feet_are_put_on_the_sloping_floor(robot, motion, course, on_left, slope):
    """Both soles lie in the plane of the slope that goes through the point under the CoM."""
    floor, legs = Floor(robot, course), LegCommands(robot, course)
    floor.slope = np.array(slope)
    q = motion.q[on_left].copy()
    for _ in range(20):
        q[7:] = legs.command(on_left, np.zeros((2, 5)), np.zeros((2, 2)), floor.rises(on_left), floor.slope)
    placed = robot.body.placements(q[None])
    normal = turned(np.array(slope))[:, 2]
    heights = []
    for side in (1, -1):
        joint = robot.body.index(robot.leg(side).joints[-1])
        turn, ankle = placed.rotations[0, joint], placed.positions[0, joint]
        lifted = motion.foot(side)[on_left, 2]
        np.testing.assert_allclose(
            tilt(turn), np.array(slope) + tilt(pose.rotation(motion.foot(side)[[on_left]])[0]), atol=1e-3
        )
        heights.append((ankle - np.append(course.com[on_left, :2], 0.0)) @ normal - lifted - robot.foot.ankle_height)
    np.testing.assert_allclose(heights, 0.0, atol=2e-4)


def test_up_ahead_means_a_higher_foot_ahead(robot, motion, course):
    sample = int(np.flatnonzero(motion.support == 0)[-1])
    floor, ahead = Floor(robot, course), course.ankles[:, LEFT, 0] - course.ankles[:, RIGHT, 0]
    sample = int(ahead.argmax())
    floor.slope = np.array([0.0, -0.02])
    assert floor.rises(sample)[LEFT] > floor.rises(sample)[RIGHT]
    floor.slope = np.array([0.02, 0.0])
    assert floor.rises(sample)[LEFT] > 0.0 > floor.rises(sample)[RIGHT]


def test_a_waist_over_a_lower_floor_has_not_sunk(robot, course, on_left):
    """From a foot that stands 8 mm higher than the floor under the CoM, the waist seems lower by as much."""
    waist, estimate = WaistControl(robot, course), planned_estimate(course, on_left)
    seen = changed(estimate, waist=estimate.waist - np.array([0.0, 0.0, 0.008]))
    waist.move(on_left, on_left, seen, estimate.zmp, rise=0.008)
    assert waist.height == pytest.approx(0.0, abs=1e-12)
