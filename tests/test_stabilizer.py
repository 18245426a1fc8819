"""control/stabilizer.py and its loops: signs, limits, no wind-up, no action without an error, no physics."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from planned_readings import changed, planned_estimate, planned_wrenches, readings

from stepover.control.dcm_feedback import DcmFeedback
from stepover.control.feet_control import FeetControl
from stepover.control.force_distribution import Distribution
from stepover.control.leg_commands import LegCommands, tilt, turned
from stepover.control.reference import reference
from stepover.control.sensors import Sensed
from stepover.control.stabilizer import Stabilizer
from stepover.control.support_region import patch
from stepover.control.waist_control import WaistControl
from stepover.model.pose import Rotation

LEFT, RIGHT = 0, 1
STILL = np.zeros((2, 5))


@pytest.fixture(scope="module")
def course(robot, motion):
    return reference(robot, motion)


@pytest.fixture(scope="module")
def wrenches(robot, motion):
    return planned_wrenches(robot, motion)


@pytest.fixture(scope="module")
def on_left(motion):
    """A sample amid a swing of the right leg."""
    return int(np.flatnonzero(motion.support == 1)[80])


def feedback(robot, motion, course):
    return DcmFeedback(robot, motion, course)


def sole_of(robot, body_q, side):
    """Rotation and place of a sole at a configuration (nq,)."""
    placed = robot.body.placements(body_q[None])
    joint = robot.body.index(robot.leg(side).joints[-1])
    turn = placed.rotations[0, joint]
    return turn, placed.positions[0, joint] - robot.foot.ankle_height * turn[:, 2]


def test_no_action_when_planned_equals_measured(robot, motion, wrenches):
    stabilizer = Stabilizer(robot, motion)
    worst = 0.0
    for sample in range(1, len(motion.time)):
        then = max(sample - round(robot.stabilizer.age / motion.dt), 0)
        angles = stabilizer.command(sample, readings(robot, motion.q[then], wrenches[then]))
        worst = max(worst, float(np.abs(angles - motion.q[sample, 7:]).max()))
    assert worst < 1e-6


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_dcm_that_is_ahead_asks_for_a_zmp_further_ahead(robot, motion, course, on_left, axis, sign):
    error = 0.002 * sign * np.eye(2)[axis]
    estimate = planned_estimate(course, on_left)
    desired = feedback(robot, motion, course).desired(on_left, changed(estimate, dcm=estimate.dcm + error))
    gain = 1.0 + robot.stabilizer.dcm_proportional / course.omega
    np.testing.assert_allclose(desired.zmp - course.zmp[on_left], gain * error, atol=1e-12)
    np.testing.assert_allclose(desired.shared.shares, [1.0, 0.0])
    np.testing.assert_allclose(desired.shared.cops[LEFT], desired.zmp - course.soles[on_left, LEFT, :2])


def test_the_integral_adds_to_it(robot, motion, course, on_left):
    control = feedback(robot, motion, course)
    estimate = planned_estimate(course, on_left)
    ahead = changed(estimate, dcm=estimate.dcm + np.array([0.004, 0.0]))
    first = control.desired(on_left, ahead).zmp[0]
    for _ in range(100):
        last = control.desired(on_left, ahead).zmp[0]
    gain = robot.stabilizer.dcm_integral / course.omega
    assert last - first == pytest.approx(gain * 0.004 * 0.5, rel=0.1)


def test_the_wish_stays_on_the_sole_and_nothing_winds_up(robot, motion, course, on_left):
    control = feedback(robot, motion, course)
    estimate = planned_estimate(course, on_left)
    far = changed(estimate, dcm=estimate.dcm + np.array([0.2, -0.2]))
    for _ in range(400):
        desired = control.desired(on_left, far)
    corners = course.soles[on_left, LEFT, :2] + patch(robot, 1, robot.stabilizer.zmp_inset)
    np.testing.assert_allclose(desired.zmp, [corners[:, 0].max(), corners[:, 1].min()], atol=1e-12)
    assert desired.cut[0] > 0.0 > desired.cut[1]
    np.testing.assert_array_equal(control.integral.value, 0.0)


def test_the_sole_counts_where_it_stands_in_truth(robot, motion, course, on_left):
    """A foot 20 mm further ahead than planned bears a ZMP 20 mm further ahead."""
    estimate = planned_estimate(course, on_left)
    far = changed(estimate, dcm=estimate.dcm + np.array([0.2, 0.0]), soles=estimate.soles + np.array([0.02, 0.0, 0.0]))
    plain = changed(estimate, dcm=estimate.dcm + np.array([0.2, 0.0]))
    further = feedback(robot, motion, course).desired(on_left, far).zmp
    np.testing.assert_allclose(further - feedback(robot, motion, course).desired(on_left, plain).zmp, [0.02, 0.0])


def test_with_the_feedback_a_pendulum_does_not_fall(robot, motion, course):
    """On two feet at rest: a pendulum that is pushed, whose ZMP follows the desired one after 50 ms."""
    control, omega, dt = feedback(robot, motion, course), course.omega, course.dt
    com, speed, zmp = course.com[0, :2].copy(), np.array([0.15, 0.05]), course.zmp[0].copy()
    for _ in range(800):
        estimate = changed(planned_estimate(course, 0), dcm=com + speed / omega, com=np.append(com, 0.8))
        zmp = zmp + dt / 0.05 * (control.desired(0, estimate).zmp - zmp)
        speed = speed + dt * omega**2 * (com - zmp)
        com = com + dt * speed
    assert np.abs(com - course.com[0, :2]).max() < 0.003
    assert np.abs(speed).max() < 0.005


@pytest.mark.parametrize(
    ("too_far", "axis", "sign"),
    [((0.01, 0.0), 1, -1.0), ((-0.01, 0.0), 1, 1.0), ((0.0, 0.01), 0, 1.0), ((0.0, -0.01), 0, -1.0)],
    ids=["toe: toe up", "heel: toe down", "left: left edge up", "right: right edge up"],
)
def test_ankles_give_way_to_the_pressure(robot, course, on_left, too_far, axis, sign):
    feet = FeetControl(robot, course)
    shared = Distribution(np.array([1.0, 0.0]), np.zeros((2, 2)))
    estimate = changed(
        planned_estimate(course, on_left), loads=np.array([500.0, 0.0]), cops=np.array([too_far, (0, 0)])
    )
    feet.give_way(on_left, on_left, estimate, shared)
    wanted = np.zeros((2, 2))
    wanted[LEFT, axis] = sign * course.dt * robot.stabilizer.ankle_admittance * 500.0 * 0.01
    np.testing.assert_allclose(feet.turns, wanted, atol=1e-15)


def test_turns_are_what_they_are_called(robot, motion, course, on_left):
    """Positive pitch puts the toe down, positive roll the left edge up; the ankle stays where it is."""
    legs, q = LegCommands(robot, course), motion.q[on_left].copy()
    for _ in range(20):
        q[7:] = legs.command(on_left, STILL, np.array([[0.02, 0.05], [0.0, 0.0]]), np.zeros(2))
    turn, place = sole_of(robot, q, 1)
    assert turn[2, 0] == pytest.approx(-np.sin(0.05), abs=1e-4)
    assert turn[2, 1] == pytest.approx(np.sin(0.02), abs=1e-4)
    np.testing.assert_allclose(place + robot.foot.ankle_height * turn[:, 2], course.ankles[on_left, LEFT], atol=1e-6)
    np.testing.assert_allclose(sole_of(robot, q, -1)[1], course.soles[on_left, RIGHT], atol=1e-6)


def test_a_foot_that_bears_too_much_rises_and_the_other_comes_down(robot, course):
    feet = FeetControl(robot, course)
    shared = Distribution(np.array([0.5, 0.5]), np.zeros((2, 2)))
    feet.give_way(1, 0, changed(planned_estimate(course, 0), loads=np.array([400.0, 200.0])), shared)
    assert feet.heights[LEFT] == pytest.approx(course.dt * robot.stabilizer.force_admittance * 100.0)
    assert feet.heights[RIGHT] == -feet.heights[LEFT]


def test_a_foot_that_touches_early_gives_way(robot, course, on_left):
    feet = FeetControl(robot, course)
    shared = Distribution(np.array([1.0, 0.0]), np.zeros((2, 2)))
    feet.give_way(on_left, on_left, changed(planned_estimate(course, on_left), loads=np.array([450.0, 120.0])), shared)
    assert feet.heights[RIGHT] > 0.0 > feet.heights[LEFT]


@pytest.mark.parametrize(
    ("place", "axis", "sign"), [((0.03, 0.0), 1, 1.0), ((0.0, 0.03), 0, -1.0)], ids=["toe", "left"]
)
def test_on_rubber_a_foot_turns_by_what_the_rubber_will_bend(robot, course, on_left, place, axis, sign):
    """Even where the pressure is right: the sole stays flat while the moment bends the rubber."""
    feet = FeetControl(robot, course, rubber=True)
    shared = Distribution(np.array([1.0, 0.0]), np.array([place, (0.0, 0.0)]))
    estimate = changed(planned_estimate(course, on_left), loads=np.array([500.0, 0.0]), cops=shared.cops)
    ways = []
    for _ in range(400):
        feet.give_way(on_left, on_left, estimate, shared)
        ways.append(feet.turns[LEFT, axis])
    bent = 500.0 * 0.03 / robot.sole.tilt_stiffness
    assert ways[-1] == pytest.approx(sign * bent, rel=1e-3)
    late = int(robot.sole.tilt_damping / robot.sole.tilt_stiffness / course.dt)
    assert ways[late - 1] == pytest.approx(sign * bent * (1.0 - np.exp(-1.0)), rel=0.05)
    np.testing.assert_array_equal(feet.turns[RIGHT], 0.0)


def descending(course):
    """A sample at which the right foot comes down, and the floor is near."""
    heights = course.ankles[:, RIGHT, 2] - course.ankles[0, RIGHT, 2]
    return int(np.flatnonzero(course.landing[:, RIGHT] & (heights < 0.01) & (heights > 0.005))[0])


def test_a_foot_that_meets_the_floor_early_stops_its_descent(robot, course):
    """Up to the return, which takes back little in this time, and what the other loops do with no load at all."""
    feet, first = FeetControl(robot, course), descending(course)
    shared = Distribution(np.array([1.0, 0.0]), np.zeros((2, 2)))
    light = np.array([550.0, 20.0])
    for sample in range(first + 1, first + 6):
        before = feet.heights[RIGHT]
        estimate = changed(planned_estimate(course, sample), loads=light)
        feet.give_way(sample, sample, estimate, shared)
        descent = course.ankles[sample - 1, RIGHT, 2] - course.ankles[sample, RIGHT, 2]
        assert descent > 0.0
        assert feet.heights[RIGHT] - before == pytest.approx(descent, rel=0.1)


def test_a_foot_that_swings_freely_follows_the_plan(robot, course):
    feet, first = FeetControl(robot, course), descending(course)
    estimate = changed(planned_estimate(course, first), loads=np.array([569.0, 0.0]))
    feet.give_way(first + 1, first, estimate, Distribution(np.array([1.0, 0.0]), np.zeros((2, 2))))
    np.testing.assert_array_equal(feet.heights, 0.0)


def test_a_foot_that_is_late_to_leave_the_floor_is_not_held(robot, course):
    feet, first = FeetControl(robot, course), int(np.flatnonzero(course.support == 1)[10])
    assert course.ankles[first, RIGHT, 2] > course.ankles[first - 1, RIGHT, 2]
    estimate = changed(planned_estimate(course, first), loads=np.array([469.0, 100.0]))
    feet.give_way(first, first, estimate, Distribution(np.array([1.0, 0.0]), np.zeros((2, 2))))
    assert feet.heights[RIGHT] == pytest.approx(course.dt * robot.stabilizer.force_admittance * 100.0)


def test_a_swinging_foot_turns_back(robot, course, on_left):
    feet = FeetControl(robot, course)
    feet._damped[RIGHT] = 0.05
    shared = Distribution(np.array([1.0, 0.0]), np.zeros((2, 2)))
    for _ in range(200):
        feet.give_way(
            on_left, on_left, changed(planned_estimate(course, on_left), loads=np.array([569.0, 0.0])), shared
        )
    assert 0.0 < feet.turns[RIGHT, 0] < 0.05 * np.exp(-0.9 / robot.stabilizer.ankle_return)


@pytest.mark.parametrize("axis", [0, 1])
def test_a_waist_that_leans_is_told_to_lean_the_other_way(robot, course, on_left, axis):
    waist = WaistControl(robot, course)
    lean = 0.02 * np.eye(2)[axis]
    attitude = turned(lean) @ course.attitude[on_left]
    waist.move(on_left, on_left, changed(planned_estimate(course, on_left), attitude=attitude), course.zmp[on_left])
    np.testing.assert_allclose(waist.posture, -course.dt * robot.stabilizer.posture_gain * lean, atol=1e-9)


def test_a_waist_that_has_sunk_is_told_to_rise(robot, course, on_left):
    waist = WaistControl(robot, course)
    estimate = planned_estimate(course, on_left)
    sunk = changed(estimate, waist=estimate.waist - np.array([0.0, 0.0, 0.01]))
    for _ in range(100):
        moved = waist.move(on_left, on_left, sunk, course.zmp[on_left])
    assert 0.0 < waist.height <= robot.stabilizer.height_max
    assert moved[LEFT, 2] == pytest.approx(waist.height)


def test_the_com_gives_way_to_the_zmp(robot, course, on_left):
    waist = WaistControl(robot, course)
    estimate = planned_estimate(course, on_left)
    moved = waist.move(on_left, on_left, estimate, estimate.zmp - np.array([0.01, 0.0]))
    assert moved[LEFT, 0] > 0.0
    assert moved[LEFT, 1] == 0.0


def test_a_standing_leg_hangs_on_the_told_waist_and_a_swinging_one_on_the_true(robot, course, on_left):
    """The waist is 10 mm too far left and leans: the swinging foot is moved back by as much, and stays level."""
    waist = WaistControl(robot, course)
    estimate = planned_estimate(course, on_left)
    lean = np.array([0.0, 0.01])
    true = changed(
        estimate, waist=estimate.waist + np.array([0.0, 0.01, 0.0]), attitude=turned(lean) @ estimate.attitude
    )
    for _ in range(4000):
        moved = waist.move(on_left, on_left, true, estimate.zmp)
    np.testing.assert_allclose(moved[RIGHT], [0.0, 0.01, 0.0, *lean], atol=1e-6)
    np.testing.assert_allclose(moved[LEFT, 3:], waist.posture)
    assert moved[LEFT, 4] < 0.0


def test_tilt_is_turned_s_inverse_for_small_angles():
    for angles in ([0.05, 0.0], [0.0, -0.08], [0.02, 0.03]):
        np.testing.assert_allclose(tilt(turned(np.array(angles))), angles, atol=1e-4)
    np.testing.assert_allclose(tilt(Rotation.from_euler("z", 0.4).as_matrix()), 0.0, atol=1e-12)


def test_commands_put_the_soles_where_they_shall_be(robot, motion, course):
    """With a displaced waist and feet, against the robot's own forward kinematics."""
    rng = np.random.default_rng(3)
    for sample in rng.integers(200, 1800, 12):
        waist = rng.normal(0.0, [0.004, 0.004, 0.002, 0.01, 0.01])
        turns, heights = rng.normal(0.0, 0.02, (2, 2)), rng.normal(0.0, 0.003, 2)
        legs, q = LegCommands(robot, course), motion.q[sample].copy()
        for _ in range(30):
            q[7:] = legs.command(int(sample), np.stack([waist, waist]), turns, heights)
        q[:3] += waist[:3]
        lean = turned(waist[3:]) @ course.attitude[sample]
        q[3:7] = Rotation.from_matrix(lean).as_quat()
        for foot, side in enumerate((1, -1)):
            turn, place = sole_of(robot, q, side)
            ankle = place + robot.foot.ankle_height * turn[:, 2]
            np.testing.assert_allclose(ankle, course.ankles[sample, foot] + [0.0, 0.0, heights[foot]], atol=2e-6)
            np.testing.assert_allclose(turn, turned(turns[foot]) @ course.feet[sample, foot], atol=2e-6)


def test_what_is_out_of_reach_stays_within_limits_and_comes_back(robot, motion, course, on_left):
    legs = LegCommands(robot, course)
    body, far = robot.body, np.array([[0.5, 0.3, 0.4, 0.5, 0.5]] * 2)
    before = motion.q[on_left, 7:]
    for _ in range(300):
        angles = legs.command(on_left, far, np.zeros((2, 2)), np.zeros(2))
        assert np.isfinite(angles).all()
        assert ((angles >= body.lower - 1e-9) & (angles <= body.upper + 1e-9)).all()
        assert (np.abs(angles - before) <= body.speed_limits * course.dt + 1e-9).all()
        before = angles
    for _ in range(300):
        angles = legs.command(on_left, STILL, np.zeros((2, 2)), np.zeros(2))
    np.testing.assert_allclose(angles, motion.q[on_left, 7:], atol=1e-6)


def test_nonsense_readings_give_angles_within_limits(robot, motion):
    rng = np.random.default_rng(8)
    stabilizer, body = Stabilizer(robot, motion), robot.body
    for sample in range(1, 400):
        quaternion = rng.normal(size=4)
        sensed = Sensed(
            rng.uniform(body.lower, body.upper), quaternion / np.linalg.norm(quaternion), rng.normal(size=3),
            *rng.normal(0.0, 1000.0, (2, 6)),
        )  # fmt: skip
        angles = stabilizer.command(sample, sensed)
        assert np.isfinite(angles).all()
        assert ((angles >= body.lower - 1e-9) & (angles <= body.upper + 1e-9)).all()


def test_only_the_legs_are_moved(robot, motion, wrenches):
    stabilizer, legs = Stabilizer(robot, motion), [robot.body.column(j) - 7 for j in robot.legs.left + robot.legs.right]
    rest = np.setdiff1d(np.arange(len(motion.joint_names)), legs)
    q = motion.q[0].copy()
    q[3:7] = Rotation.from_euler("xy", [0.02, 0.02]).as_quat()
    for sample in range(1, 50):
        angles = stabilizer.command(sample, readings(robot, q, wrenches[0]))
    np.testing.assert_array_equal(angles[rest], motion.q[49, 7:][rest])
    assert np.abs(angles[legs] - motion.q[49, 7:][legs]).max() > 1e-3


def test_the_same_readings_give_the_same_commands(robot, motion, wrenches):
    runs = []
    for _ in range(2):
        stabilizer = Stabilizer(robot, motion)
        sensed = readings(robot, motion.q[5], wrenches[3])
        runs.append([stabilizer.command(sample, sensed) for sample in range(1, 30)])
    np.testing.assert_array_equal(*runs)


def test_neither_physics_nor_simulation_is_loaded():
    code = (
        "import sys, stepover.control.stabilizer, stepover.control.estimator;"
        "print(sorted(m for m in sys.modules if m.startswith(('pybullet', 'stepover.simulation', 'stepover.report'))))"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"
