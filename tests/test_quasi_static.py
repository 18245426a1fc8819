"""quasi_static.py and its units: over the obstacle with the CoM over a foot, as slowly as epsilon says; or why not."""

from __future__ import annotations

import dataclasses
import math
from itertools import pairwise

import numpy as np
import pinocchio as pin
import pytest

import stepover
from stepover import Infeasible, InvalidInput, Motion, Obstacle
from stepover.model.gravity import GRAVITY
from stepover.model.support import zmp_margin
from stepover.planning.checks import require
from stepover.planning.leg_check import check_legs
from stepover.planning.measures import measure
from stepover.planning.quasi_static import search as quasi_static_search
from stepover.planning.quasi_static.balance import Targets, balanced, joined
from stepover.planning.quasi_static.path import (
    LEG_1_OVER,
    LEG_2_OVER,
    SEGMENTS,
    TO_FRONT,
    corners,
    pace,
    smooth,
    targets,
)
from stepover.planning.quasi_static.planner import ZMP_MULTIPLE, quasi_static_crossable, quasi_static_in_detail
from stepover.planning.quasi_static.search import find_path
from stepover.planning.quasi_static.timing import durations
from stepover.simulation.run import simulate

EPSILON = 0.001


@pytest.fixture(scope="module")
def slow(robot, obstacle):
    """The paper's case at the default epsilon, with how it came about."""
    return quasi_static_in_detail(robot, obstacle, look_for_nearest=False)


@pytest.fixture(scope="module")
def quick(robot, obstacle):
    """The same at 20 mm."""
    return quasi_static_in_detail(robot, obstacle, 0.02, look_for_nearest=False)


def test_it_is_promised():
    assert "quasi_static_plan" in stepover.__all__
    assert stepover.quasi_static_plan.__module__ == "stepover.planning.quasi_static.planner"


def test_no_path_keeps_three_centimetres_so_it_keeps_one(robot, slow, obstacle):
    assert "end of phase 1, (6)" in slow.refused
    np.testing.assert_allclose(slow.motion.obstacle[1:5], [0.05, 0.15, 0.01, 0.01])
    assert slow.obstacle == dataclasses.replace(obstacle, margin_height=0.01, margin_width=0.01)
    found = measure(robot, slow.motion)
    assert found.clearance_min >= 0.010
    assert found.joint_margin_min > 0.0
    assert found.joint_speed_ratio_max < 1.0


@pytest.mark.parametrize("height", [0.05, 0.09])
def test_the_path_does_not_hang_on_rounding(robot, monkeypatch, height):
    obstacle = Obstacle(height, 0.05)
    path, noise = find_path(robot, obstacle), np.random.default_rng(3)

    def rounded_otherwise(*args):
        check = check_legs(*args)
        return check._replace(separation=check.separation + noise.normal(0.0, 1e-16, len(check.separation)))

    monkeypatch.setattr(quasi_static_search, "check_legs", rounded_otherwise)
    for _ in range(3):
        assert find_path(robot, obstacle) == path


def test_lower_obstacles_keep_their_margins(robot):
    low = quasi_static_in_detail(robot, Obstacle(0.10, 0.05), 0.02)
    assert low.refused is None
    assert tuple(low.motion.obstacle[3:5]) == (0.03, 0.03)
    assert measure(robot, low.motion).clearance_min >= 0.03


def test_joints_keep_their_limits_between_the_looks_of_the_search(robot):
    """Low and wide: on this path a hip comes within a hundredth of a degree of its limit from one look to the next."""
    motion = quasi_static_in_detail(robot, Obstacle(0.03, 0.08), 0.02, look_for_nearest=False).motion
    assert measure(robot, motion).joint_margin_min > 0.0


def test_margins_below_the_least_clearance_are_kept_as_they_are(robot):
    bare = Obstacle(0.15, 0.05, margin_height=0.0, margin_width=0.005)
    assert quasi_static_in_detail(robot, bare, 0.02).obstacle == bare


def test_it_takes_about_forty_seconds(slow):
    """44.1 s. Not fitted: the sum of five durations, each from epsilon and a path."""
    assert slow.motion.time[-1] == pytest.approx(40.0, rel=0.15)
    assert slow.motion.time[-1] == pytest.approx(slow.durations.sum(), abs=1e-6)
    assert slow.durations[TO_FRONT] == pytest.approx(15.0, rel=0.15)


def test_the_com_stays_over_the_soles(robot, slow):
    motion = slow.motion
    margin = zmp_margin(robot, motion.com[:, :2], motion.support, motion.left_foot, motion.right_foot)
    assert margin.min() > 0.025
    for phase, side in ((1, 1), (3, -1)):
        over = motion.samples(phase)
        apart = motion.com[over, :2] - motion.foot(side)[over, :2]
        assert np.ptp(apart, axis=0).max() < 1e-5
        assert abs(apart[:, 1]).max() < 1e-5
        assert robot.foot.contact_x[0] < apart[0, 0] < robot.foot.contact_x[1]


@pytest.mark.parametrize(("name", "epsilon"), [("slow", EPSILON), ("quick", 0.02)])
def test_the_zmp_stays_within_epsilon_of_the_com(request, robot, name, epsilon):
    motion = request.getfixturevalue(name).motion
    apart = np.linalg.norm(motion.zmp - motion.com[:, :2], axis=1)
    assert 0.9 * epsilon < apart.max() < ZMP_MULTIPLE * epsilon
    assert zmp_margin(robot, motion.zmp, motion.support, motion.left_foot, motion.right_foot).min() > 0.0


def test_com_and_zmp_by_pinocchio_alone(pin_model, quick):
    """The oracle: the CoM of every link, and the ZMP from the rate of the centroidal momentum, not from RNEA."""
    motion, data, dt = quick.motion, pin_model.createData(), quick.motion.dt
    q = motion.q

    def momentum(k):
        v = pin.difference(pin_model, q[k - 1], q[k + 1]) / (2.0 * dt)
        return pin.computeCentroidalMomentum(pin_model, data, q[k], v).vector.copy()

    mass, ends = pin.computeTotalMass(pin_model), np.cumsum(np.round(quick.durations / dt))
    for k in range(10, len(q) - 10, 23):
        com = pin.centerOfMass(pin_model, data, q[k])
        np.testing.assert_allclose(motion.com[k], com, atol=1e-9)
        if np.abs(ends - k).min() < 5:  # a swing's acceleration jumps where it begins and ends
            continue
        rate = (momentum(k + 1) - momentum(k - 1)) / (2.0 * dt)
        force = [*rate[:2], rate[2] + mass * GRAVITY]
        x = com[0] - (rate[4] + com[2] * force[0]) / force[2]
        y = com[1] + (rate[3] - com[2] * force[1]) / force[2]
        np.testing.assert_allclose(motion.zmp[k], [x, y], atol=1e-3)


def test_the_motion_is_a_motion_like_any_other(robot, slow, tmp_path):
    motion = slow.motion
    motion.save(tmp_path / "motion.npz")
    assert Motion.load(tmp_path / "motion.npz").hash() == motion.hash()
    require(robot, motion)
    assert motion.samples(1).stop == motion.samples(2).start
    assert motion.samples(2).stop == motion.samples(3).start
    assert set(motion.support[motion.samples(1)]) == {1}
    assert set(motion.support[motion.samples(3)]) == {-1}
    assert set(motion.support[motion.phase % 2 == 0]) == {0}
    np.testing.assert_array_equal(motion.footsteps.rows()[:, [1, 5]], [[-1, 2], [1, 3]])
    for time, side, x, y, _, _ in motion.footsteps.rows():
        landed = motion.foot(int(side))[round(time / motion.dt) :]
        np.testing.assert_allclose(landed[:, :3], np.tile([x, y, 0.0], (len(landed), 1)), atol=1e-12)
    assert motion.key_configuration[0] == slow.path.x_ads


def test_it_starts_and_ends_standing_at_rest(robot, slow):
    q, rest = slow.motion.q, robot.half_sitting()
    for end, x in ((q[0], 0.0), (q[-1], slow.path.x_ads)):
        np.testing.assert_allclose(end, rest + np.eye(len(rest))[0] * x, atol=1e-5)
    assert np.abs(np.diff(q, axis=0)[[0, -1]]).max() < 1e-6


def test_sole_frames_are_those_of_q(robot, quick):
    for side in (1, -1):
        leg = robot.leg(side)
        _, positions = leg.sole(quick.motion.waist, quick.motion.q[:, leg.columns])
        np.testing.assert_allclose(positions, quick.motion.foot(side)[:, :3], atol=1e-4)


def test_swing_feet_clear_the_obstacle_and_the_floor(slow):
    motion = slow.motion
    for phase, side in ((1, -1), (3, 1)):
        foot = motion.foot(side)[motion.samples(phase)]
        assert foot[:, 2].min() > -1e-9
        assert foot[:, 2].max() > motion.obstacle[2] + 0.01
        assert foot[:, 0].max() < slow.path.x_ads + 1e-3


def test_it_crosses_in_the_physics(robot, quick):
    run = simulate(quick.motion, robot=robot)
    assert run.crossed
    assert run.clearance_min > 0.01
    assert run.waist_error_max < 0.005


def test_durations_fall_with_the_root_of_epsilon(robot, slow, quick):
    for epsilon in (0.0005, 0.002, 0.005, 0.02):
        times = durations(robot, slow.zmp_errors, epsilon)
        np.testing.assert_allclose(times, slow.durations * math.sqrt(EPSILON / epsilon), atol=0.0101)
    np.testing.assert_allclose(quick.durations, durations(robot, slow.zmp_errors, 0.02))


def test_a_shift_is_timed_by_the_cart(robot, slow):
    """T = sqrt(10 / sqrt(3) d z_c / (g epsilon)): the quintic's acceleration, and Eq. (15)."""
    ends = corners(robot, slow.path)[TO_FRONT : TO_FRONT + 2]
    height = slow.motion.com[slow.motion.samples(2), 2].max()
    wanted = math.sqrt(10.0 / math.sqrt(3.0) * math.dist(*ends) * height / (GRAVITY * EPSILON))
    assert slow.durations[TO_FRONT] == pytest.approx(wanted, abs=0.01)


def test_the_quintic_goes_from_rest_to_rest():
    time = np.linspace(0.0, 1.0, 2001)
    share = smooth(time)
    speed, acceleration = np.gradient(share, time), np.gradient(np.gradient(share, time), time)
    assert (share[0], share[-1]) == (0.0, 1.0)
    assert np.abs(speed[[0, -1]]).max() < 1e-5
    assert np.abs(acceleration).max() == pytest.approx(10.0 / math.sqrt(3.0), rel=1e-3)
    np.testing.assert_array_equal(smooth(np.array([-1.0, 2.0])), [0.0, 1.0])


def test_segments_join(robot, slow):
    ends = np.array([0.0, 1.0])
    parts = [targets(robot, slow.obstacle, slow.path, k, pace(k, ends)) for k in SEGMENTS]
    for before, after in pairwise(parts):
        for one, other in zip(before, after, strict=True):
            np.testing.assert_allclose(one[-1], other[0], atol=1e-12)


def test_balance_brings_the_com_of_all_links_over_its_target(robot, slow):
    share = np.linspace(0.0, 1.0, 21)
    parts = [targets(robot, slow.obstacle, slow.path, k, share) for k in (LEG_1_OVER, TO_FRONT, LEG_2_OVER)]
    wanted = joined(parts)
    assert isinstance(wanted, Targets)
    errors = [
        np.abs(robot.body.com(robot.body.placements(balanced(robot, wanted, rounds)))[:, :2] - wanted.com).max()
        for rounds in (0, 3, 6)
    ]
    assert errors[0] > 0.005
    assert errors[1] < 0.1 * errors[0]
    assert errors[2] < 1e-5


@pytest.mark.parametrize("epsilon", [0.0, -0.001, 1e-9, math.nan, math.inf, 0.05, "1 mm", True, None])
def test_an_epsilon_that_makes_no_sense_is_refused(robot, obstacle, epsilon):
    with pytest.raises(InvalidInput, match=r"epsilon = .* must be a length of 0\.00001 to 0\.026 m"):
        quasi_static_in_detail(robot, obstacle, epsilon)


@pytest.mark.parametrize(("height", "width"), [(0.20, 0.05), (0.25, 0.05), (0.15, 0.15)])
def test_what_is_too_high_or_wide_is_refused_with_phase_and_condition(robot, height, width):
    with pytest.raises(Infeasible, match=r"10 mm.*phase 1, \(6\).*CoM over the rear foot.*mm too near") as caught:
        quasi_static_in_detail(robot, Obstacle(height, width), look_for_nearest=False)
    assert caught.value.nearest is None


def test_the_other_conditions_are_named_too(robot):
    for change, height, what in (
        ({"com_behind": 0.001}, 0.18, r"beginning of phase 3, \(8\).*over the front foot"),
        ({"raises": (0.001,)}, 0.15, r"phase 2, \(7\): on the way .*mm too near"),
        ({"leg1_extra_lift": -0.10}, 0.15, r"phase 1, \(6\): on the way .*mm too near"),
        ({"leg2_pitches_deg": (0.1,)}, 0.18, r"phase 3, \(8\): on the way a leg joint is .* degrees beyond"),
    ):
        other = dataclasses.replace(robot, quasi_static=dataclasses.replace(robot.quasi_static, **change))
        with pytest.raises(Infeasible, match=what):
            find_path(other, Obstacle(height, 0.05, 0.01, 0.01))


def test_a_refusal_names_the_nearest_that_can_be_crossed(robot):
    coarse = dataclasses.replace(robot.quasi_static, com_parts=1, places=2, step_length_step=0.02)
    coarsely = dataclasses.replace(robot, quasi_static=coarse)
    with pytest.raises(Infeasible) as caught:
        quasi_static_in_detail(coarsely, Obstacle(0.20, 0.05))
    nearest = caught.value.nearest
    assert 0.17 < nearest.height < 0.20
    assert quasi_static_crossable(coarsely, nearest)


def test_the_obstacle_stands_where_it_is_asked_to(robot):
    near = Obstacle(0.12, 0.05, distance=0.20)
    assert quasi_static_in_detail(robot, near, 0.02).motion.obstacle[0] == 0.20
    with pytest.raises(Infeasible, match=r"at a distance of 1\.000 m between the feet") as caught:
        quasi_static_in_detail(robot, dataclasses.replace(near, distance=1.0))
    assert quasi_static_crossable(robot, caught.value.nearest)
