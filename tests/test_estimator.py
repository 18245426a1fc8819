"""control/estimator.py: against pinocchio's truth, on the plan and off it, on rubber, and with loads that change."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from planned_readings import planned_wrenches, pressed, readings

from stepover.control.estimator import Estimator
from stepover.control.reference import reference
from stepover.control.sensors import Sensed
from stepover.model import pose


@pytest.fixture(scope="module")
def course(robot, motion):
    return reference(robot, motion)


@pytest.fixture(scope="module")
def wrenches(robot, motion):
    return planned_wrenches(robot, motion)


@pytest.fixture(scope="module")
def as_planned(robot, motion, course, wrenches):
    """Estimates along the whole motion, when all goes as course."""
    estimator = Estimator(robot, course)
    return [estimator.update(k, readings(robot, motion.q[k], wrenches[k])) for k in range(len(motion.time))]


def stacked(estimates, name):
    return np.array([getattr(estimate, name) for estimate in estimates])


def weight(robot):
    return robot.body.mass * 9.81


def bent(robot, q, side, angles):
    """A configuration with other joint angles whose sole of a side stays where it was: pinocchio's truth."""
    model = robot.body.model
    data = model.createData()
    frame = robot.body.index(robot.leg(side).joints[-1])
    other = q.copy()
    other[7:] += angles
    pin.forwardKinematics(model, data, q)
    held = data.oMi[frame].copy()
    pin.forwardKinematics(model, data, other)
    base = pin.XYZQUATToSE3(other[:7])
    other[:7] = pin.SE3ToXYZQUAT(held * data.oMi[frame].inverse() * base)
    return other


def com_of(robot, q):
    model = robot.body.model
    return np.array(pin.centerOfMass(model, model.createData(), q))


def test_on_the_plan_it_is_the_truth(motion, course, as_planned):
    np.testing.assert_allclose(stacked(as_planned, "waist"), motion.waist[:, :3], atol=1e-6)
    np.testing.assert_allclose(stacked(as_planned, "com"), motion.com, atol=1e-6)
    np.testing.assert_allclose(stacked(as_planned, "com_velocity"), course.com_velocity, atol=1e-5)
    np.testing.assert_allclose(stacked(as_planned, "dcm"), course.dcm, atol=1e-5)
    np.testing.assert_allclose(stacked(as_planned, "zmp"), motion.zmp, atol=1e-6)
    np.testing.assert_allclose(stacked(as_planned, "attitude"), pose.rotation(motion.waist), atol=1e-9)


def test_loads_are_those_of_the_feet_that_stand(robot, motion, as_planned):
    loads = stacked(as_planned, "loads")
    assert (loads[motion.support == 1, 1] == 0.0).all()
    assert (loads[motion.support == -1, 0] == 0.0).all()
    np.testing.assert_allclose(loads.sum(axis=1).mean(), weight(robot), rtol=0.02)


@pytest.mark.parametrize("side", [1, -1])
def test_a_robot_off_its_plan_is_found_from_its_stance_foot(robot, motion, course, side):
    sample = int(np.flatnonzero(motion.support == side)[100])
    rng = np.random.default_rng(side + 1)
    q = bent(robot, motion.q[sample], side, rng.normal(0.0, 0.02, len(motion.joint_names)))
    sole = motion.foot(side)[sample]
    wrenches = np.zeros((2, 6))
    point, force = np.array([0.03, -0.01]), np.array([10.0, -20.0, weight(robot)])
    wrenches[0 if side > 0 else 1] = pressed(robot, sole, point, force)
    estimator = Estimator(robot, course, start=sample)
    estimate = estimator.update(sample, readings(robot, q, wrenches))
    np.testing.assert_allclose(estimate.waist, q[:3], atol=1e-9)
    np.testing.assert_allclose(estimate.com, com_of(robot, q), atol=1e-9)
    np.testing.assert_allclose(estimate.zmp, sole[:2] + point, atol=1e-9)
    np.testing.assert_allclose(estimate.cops[0 if side > 0 else 1], point, atol=1e-9)


def test_a_foot_that_lands_elsewhere_is_walked_on_from_there(robot, motion, course, wrenches):
    """The first step lands 4 mm further ahead than planned, and the robot then stands on it: kinematics sees it."""
    estimator = Estimator(robot, course)
    landing = int(np.flatnonzero((motion.support[:-1] != 0) & (motion.support[1:] == 0))[0]) + 1
    side, end = -int(motion.support[landing - 1]), landing + 60
    foot = 0 if side > 0 else 1
    true, ahead = motion.q[:end].copy(), motion.foot(side)[:end].copy()
    part = slice(landing - 20, end)
    ahead[part, 0] += 0.004
    true[part, robot.leg(side).columns] = robot.leg(side).inverse(motion.waist[part], ahead[part])
    for k in range(end):
        estimate = estimator.update(k, readings(robot, true[k], wrenches[k]))
    np.testing.assert_allclose(estimate.soles[foot], ahead[-1, :3], atol=1e-4)
    np.testing.assert_allclose(estimate.com, com_of(robot, true[-1]), atol=1e-4)
    assert estimate.loads[1 - foot] == 0.0


def test_a_deviating_velocity_is_found_within_the_filter_s_time(robot, motion, course):
    """The waist sways at 50 mm/s over both feet while the plan stands still."""
    estimator, speed = Estimator(robot, course), 0.05
    half = weight(robot) / 2.0
    force = np.array([0.0, 0.0, half])
    wrench = np.array([pressed(robot, motion.foot(side)[0], np.zeros(2), force) for side in (1, -1)])
    truth = com_of(robot, motion.q[0])
    for k in range(41):
        q = motion.q[0].copy()
        q[0] += speed * k * motion.dt
        for side in (1, -1):
            q[robot.leg(side).columns] = robot.leg(side).inverse(q[None, :7], motion.foot(side)[:1])[0]
        before, truth = truth, com_of(robot, q)
        estimate = estimator.update(k, readings(robot, q, wrench))
        if k == 2:
            early = estimate.com_velocity[0]
    np.testing.assert_allclose(estimate.com, truth, atol=1e-9)
    settled = (truth - before)[0] / motion.dt
    np.testing.assert_allclose(estimate.com_velocity[0], settled, rtol=0.01)
    assert 0.1 * settled < early < 0.7 * settled
    omega = course.omega
    np.testing.assert_allclose(estimate.dcm, estimate.com[:2] + estimate.com_velocity[:2] / omega, atol=1e-12)


@pytest.mark.parametrize("give", [0.0, 2.5e-5])
def test_rubber_under_the_ankle(robot, motion, course, give):
    """The stance sole lies flat, while the foot above it leans by 3 degrees and is 14 mm lower."""
    sample = int(np.flatnonzero(motion.support == 1)[100])
    sunk = 2.5e-5 * weight(robot)
    pivot = motion.left_foot[sample, :3] + np.array([0.0, 0.0, 0.030])
    lean = pose.Rotation.from_euler("xy", [2.0, 2.0], degrees=True)
    q = motion.q[sample].copy()
    q[:3] = pivot + lean.apply(q[:3] - pivot) - [0.0, 0.0, sunk]
    q[3:7] = (lean * pose.Rotation.from_quat(q[3:7])).as_quat()
    force = np.array([0.0, 0.0, weight(robot)])
    wrenches = np.array([pressed(robot, motion.left_foot[sample], np.array([0.02, 0.0]), force), np.zeros(6)])
    estimator = Estimator(robot, course, give, sample)
    estimate = estimator.update(sample, readings(robot, q, wrenches))
    error = estimate.com - com_of(robot, q)
    assert np.abs(error[:2]).max() < 0.0015
    assert abs(error[2] - (0.0 if give else sunk)) < 0.0005
    np.testing.assert_allclose(estimate.zmp, motion.left_foot[sample, :2] + np.array([0.02, 0.0]), atol=0.0015)


def test_without_any_load_the_plan_says_which_foot_holds(robot, motion, course):
    sample = int(np.flatnonzero(motion.support == -1)[50])
    estimator = Estimator(robot, course, start=sample)
    estimate = estimator.update(sample, readings(robot, motion.q[sample], np.zeros((2, 6))))
    np.testing.assert_allclose(estimate.waist, motion.waist[sample, :3], atol=1e-6)
    np.testing.assert_array_equal(estimate.zmp, motion.zmp[sample])
    assert not estimate.loads.any()


def test_a_light_touch_counts_for_nothing(robot, motion, course):
    sample = int(np.flatnonzero(motion.support == -1)[50])
    light = 0.5 * robot.stabilizer.contact_share * weight(robot)
    wrenches = np.zeros((2, 6))
    wrenches[0] = pressed(robot, motion.left_foot[sample], np.zeros(2), np.array([0.0, 0.0, light]))
    wrenches[1] = pressed(robot, motion.right_foot[sample], np.zeros(2), np.array([0.0, 0.0, weight(robot)]))
    estimate = Estimator(robot, course).update(sample, readings(robot, motion.q[sample], wrenches))
    assert estimate.loads[0] == 0.0
    assert estimate.loads[1] == pytest.approx(weight(robot))


def test_the_sensor_s_axes_are_the_foot_s(robot, motion, course):
    """Force and moment come in the ankle's axes: the same floor on a foot that is turned reads otherwise."""
    q = motion.q[0].copy()
    q[robot.leg(1).columns[4]] += 0.2
    force = np.array([15.0, -25.0, 300.0])
    wrenches = np.array([pressed(robot, motion.left_foot[0], np.array([0.02, 0.01]), force), np.zeros(6)])
    sensed = readings(robot, q, wrenches)
    assert isinstance(sensed, Sensed)
    assert not np.allclose(sensed.wrench(1)[:3], force, atol=1.0)
    estimate = Estimator(robot, course).update(0, sensed)
    assert estimate.loads[0] == pytest.approx(300.0)
