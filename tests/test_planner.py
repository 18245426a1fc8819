"""planner.py: the 15 cm case by the paper's numbers and from outside the library; what cannot be crossed."""

from __future__ import annotations

import dataclasses
import itertools
import json
import subprocess
import sys
import types

import numpy as np
import pinocchio as pin
import pytest
from conftest import HRP2, yaw_of

from stepover import Infeasible, InvalidInput, Motion, Obstacle, load_robot, plan, quasi_static_plan
from stepover.analysis.limits import with_authors_swing
from stepover.model import pose
from stepover.model.support import zmp_margin
from stepover.planning.algorithm_1 import planner, search
from stepover.planning.algorithm_1.feasibility import key_configurations
from stepover.planning.algorithm_1.plan import Options
from stepover.planning.algorithm_1.planner import algorithm_1, plan_in_detail
from stepover.planning.measures import measure

CORNERS = [(height, width) for height in (0.05, 0.15) for width in (0.02, 0.08)]
BETWEEN = [(0.12, 0.05), *np.random.default_rng(15).uniform([0.05, 0.02], [0.15, 0.08], (3, 2)).round(3).tolist()]
URDF = HRP2 / "hrp2.urdf"


@pytest.fixture(scope="module")
def measures(robot, motion):
    """What the motion comes to."""
    return measure(robot, motion)


@pytest.fixture(scope="module")
def coarse(robot):
    """HRP-2 with so coarse a search that looking for the nearest obstacle takes a second."""
    search = dataclasses.replace(robot.feasibility, step_length_step=0.12, waist_height_step=0.2)
    return dataclasses.replace(robot, feasibility=search, walk=dataclasses.replace(robot.walk, sample_time=0.01))


def crossing(robot, obstacle):
    """A motion, or its error at once."""
    return plan_in_detail(robot, obstacle, look_for_nearest=False).motion


def rms(error):
    """Root mean square a column."""
    return np.sqrt(np.mean(np.square(error), axis=0))


def stepping(motion):
    """Samples from the first lift-off to the last touch-down."""
    single = np.flatnonzero(motion.support)
    return slice(single[0], single[-1] + 2)


class TestFifteenCentimetres:
    """The paper's obstacle, and every number that is asked of its motion."""

    def test_key_configuration(self, motion, robot):
        x_ads, x_hds, z_hds = motion.key_configuration
        assert 0.36 <= x_ads <= 0.43
        assert x_hds == pytest.approx(0.5 * x_ads)
        assert z_hds == pytest.approx(robot.posture.waist_height)

    def test_knees_at_least_15_degrees_from_straight_in_the_key_configuration(self, motion, robot, planned):
        key = planned.key
        waist = pose.pose(np.array([[key.x_hds, 0.0, key.z_hds]]), key.yaw)
        for side, x in ((-1, key.x_ads), (1, 0.0)):
            knee = robot.leg(side).inverse(waist, pose.pose(np.array([[x, 0.095 * side, 0.0]])))[0, 3]
            assert np.degrees(knee) >= 15.0

    def test_no_joint_beyond_its_limits(self, motion, pin_model, measures):
        assert [pin_model.names[i] for i in range(2, pin_model.njoints)] == motion.joint_names.tolist()
        assert (motion.q[:, 7:] >= pin_model.lowerPositionLimit[7:]).all()
        assert (motion.q[:, 7:] <= pin_model.upperPositionLimit[7:]).all()
        assert measures.joint_margin_min > 0.0
        assert measures.joint_margin_joint in motion.joint_names

    def test_clearance_of_every_link_at_every_sample(self, motion, pin_model, measures):
        """At least 30 mm, from pinocchio's own geometry and coal; the obstacle reaches no deeper than the floor."""
        geometry = pin.buildGeomFromUrdf(pin_model, str(URDF), pin.GeometryType.COLLISION, package_dirs=[str(HRP2)])
        for item in geometry.geometryObjects:
            if isinstance(item.geometry, pin.hppfcl.BVHModelBase):
                item.geometry.buildConvexHull(True, "Qt")
                item.geometry = item.geometry.convex
        front, width, height = motion.obstacle[:3]
        beam = pin.hppfcl.Box(width, 2.0, height)
        place = pin.SE3(np.eye(3), np.array([front + width / 2.0, 0.0, height / 2.0]))
        geometry.addGeometryObject(pin.GeometryObject("beam", 0, place, beam))
        last = geometry.ngeoms - 1
        for index in range(last):
            geometry.addCollisionPair(pin.CollisionPair(index, last))
        data, geometry_data = pin_model.createData(), geometry.createData()
        smallest = np.inf
        for q in motion.q[::4]:
            pin.updateGeometryPlacements(pin_model, data, geometry, geometry_data, q)
            pin.computeDistances(geometry, geometry_data)
            smallest = min(smallest, *(result.min_distance for result in geometry_data.distanceResults))
        assert smallest >= 0.030
        assert measures.clearance_min >= 0.030
        assert measures.clearance_min == pytest.approx(smallest, abs=1e-3)
        assert measures.clearance_min <= smallest + 1e-6

    def test_zmp_after_the_filter(self, motion, measures):
        after, before = rms(motion.zmp - motion.zmp_reference), rms(motion.zmp_first_stage - motion.zmp_reference)
        assert (after <= 3e-3).all()
        assert (before >= 3.0 * after).all()
        np.testing.assert_allclose(measures.zmp_rms, after)
        np.testing.assert_allclose(measures.zmp_rms_first_stage, before)
        largest = np.abs(motion.zmp - motion.zmp_reference).max(axis=0)
        np.testing.assert_allclose(measures.zmp_error_max, largest)
        assert (largest < 0.04).all()

    def test_one_pass_of_the_filter_and_nothing_to_adapt(self, planned):
        assert planned.adaptations["filter_passes"] == 1
        json.dumps(planned.adaptations)

    def test_zmp_inside_the_support_polygon_by_20_mm(self, robot, motion, measures):
        margins = zmp_margin(robot, motion.zmp, motion.support, motion.left_foot, motion.right_foot)
        assert margins[stepping(motion)].min() >= 0.020
        assert measures.zmp_margin_min == pytest.approx(margins.min())

    def test_zmp_inside_the_stance_foots_patch_by_plain_comparison(self, motion):
        """In single support, from the published patch: x -0.096 .. 0.126, y 0.059 inwards and 0.079 outwards."""
        for side, foot in ((1, motion.left_foot), (-1, motion.right_foot)):
            local = (motion.zmp - foot[:, :2])[motion.support == side]
            assert local[:, 0].min() >= -0.096 + 0.02
            assert local[:, 0].max() <= 0.126 - 0.02
            assert (side * local[:, 1]).min() >= -0.059 + 0.02
            assert (side * local[:, 1]).max() <= 0.079 - 0.02

    def test_zmp_and_com_recomputed_outside_the_library(self, motion):
        """From q and the URDF: differences on the manifold, RNEA and the wrench's transport, all by pinocchio."""
        model = pin.buildModelFromUrdf(str(URDF), pin.JointModelFreeFlyer())
        data, dt, q = model.createData(), 0.005, motion.q
        steps = np.array([pin.difference(model, a, b) for a, b in itertools.pairwise(q)])
        zmps, coms = [], []
        for k in range(1, len(q) - 1):
            velocity = (steps[k] + steps[k - 1]) / (2.0 * dt)
            acceleration = (steps[k] - steps[k - 1]) / dt**2
            wrench = pin.Force(pin.rnea(model, data, q[k], velocity, acceleration)[:6])
            coms.append(pin.centerOfMass(model, data, q[k]).copy())
            world = data.oMi[1].act(wrench)
            zmps.append([-world.angular[1] / world.linear[2], world.angular[0] / world.linear[2]])
        error_zmp, error_com = np.array(zmps) - motion.zmp[1:-1], np.array(coms) - motion.com[1:-1]
        assert (rms(error_zmp) <= 1e-3).all()
        assert (rms(error_com) <= 1e-3).all()
        assert np.abs(error_zmp).max() < 1e-6
        assert np.abs(error_com).max() < 1e-9

    def test_stored_feet_are_the_ankle_roll_links_105_mm_down(self, motion, pin_model):
        data = pin_model.createData()
        down = pin.SE3(np.eye(3), np.array([0.0, 0.0, -0.105]))
        for name, foot in (("LLEG_JOINT5", motion.left_foot), ("RLEG_JOINT5", motion.right_foot)):
            joint = pin_model.getJointId(name)
            for q, stored in zip(motion.q[::5], foot[::5], strict=True):
                pin.forwardKinematics(pin_model, data, q)
                place = pin.XYZQUATToSE3(stored).actInv(data.oMi[joint] * down)
                assert np.linalg.norm(place.translation) < 1e-4
                assert np.linalg.norm(pin.log3(place.rotation)) < 1e-4

    def test_stored_waist_is_the_root(self, motion):
        np.testing.assert_allclose(motion.waist, motion.q[:, :7], atol=1e-12)

    def test_quaternions_have_unit_length_and_no_sign_jumps(self, motion):
        for poses in (motion.waist, motion.left_foot, motion.right_foot, motion.q[:, :7]):
            np.testing.assert_allclose(np.linalg.norm(poses[:, 3:7], axis=1), 1.0, atol=1e-9)
            assert np.abs(np.diff(poses[:, 3:7], axis=0)).max() < 0.02
            assert poses[0, 6] > 0.9

    def test_it_starts_and_ends_in_half_sitting_at_rest(self, robot, motion):
        rest = robot.half_sitting()
        np.testing.assert_allclose(motion.q[0], rest, atol=1e-3)
        end = motion.q[-1].copy()
        end[:2] -= (motion.left_foot[-1, :2] + motion.right_foot[-1, :2]) / 2.0
        np.testing.assert_allclose(end, rest, atol=2e-3)
        speed = robot.body.velocities(motion.q, motion.dt)
        assert np.abs(speed[[0, -1]]).max() < 5e-3
        np.testing.assert_allclose(motion.left_foot[-1, 0], motion.right_foot[-1, 0], atol=1e-9)

    def test_nothing_jumps(self, robot, motion):
        assert np.abs(np.diff(motion.q, axis=0)).max() < 0.05
        assert np.abs(robot.body.accelerations(motion.q, motion.dt)[:, 6:]).max() < 150.0

    def test_the_leading_leg_is_the_right_one_and_the_left_one_follows(self, motion):
        """Which foot is where, by the poses alone: swapped feet or sides show."""
        assert (motion.left_foot[:, 1] > 0.05).all()
        assert (motion.right_foot[:, 1] < -0.05).all()
        front, width = motion.obstacle[:2]
        over = {1: motion.phase == 1, 3: motion.phase == 3}
        for foot, phase in ((motion.right_foot, 1), (motion.left_foot, 3)):
            crossing = np.flatnonzero((foot[:, 0] > front) & (foot[:, 0] < front + width))
            assert over[phase][crossing].all()
            assert foot[crossing, 2].min() > 0.15
        lifted = {1: motion.left_foot[:, 2] > 1e-3, -1: motion.right_foot[:, 2] > 1e-3}
        for side in (1, -1):
            assert (motion.support[lifted[side]] == -side).all()

    def test_the_waist_turns_the_leading_hip_ahead_over_the_obstacle(self, motion, pin_model):
        data = pin_model.createData()
        middle = np.flatnonzero(motion.phase == 2)[0]
        pin.forwardKinematics(pin_model, data, motion.q[middle])
        hips = [data.oMi[pin_model.getJointId(name)].translation for name in ("RLEG_JOINT0", "LLEG_JOINT0")]
        assert hips[0][0] - hips[1][0] == pytest.approx(0.12 * np.sin(np.radians(25.0)), abs=1e-3)
        assert yaw_of(motion.waist).max() == pytest.approx(np.radians(25.0), abs=1e-3)
        assert yaw_of(motion.waist).min() > -1e-9

    def test_com_stays_at_its_height_and_moves_on_in_double_support(self, motion, measures):
        assert motion.com[0, 2] == pytest.approx(0.8105, abs=0.005)
        assert 0.0 < measures.com_travel_double_support < 0.05
        assert measures.com_acceleration_ratio_max < 0.15

    def test_timing_and_steps(self, motion, measures, planned):
        assert measures.samples == len(motion.time)
        assert measures.step_over_duration == pytest.approx(3.04)
        assert measures.duration == pytest.approx(motion.time[-1])
        assert motion.footsteps.side.tolist() == [-1, 1, -1, 1, -1, 1, -1]
        assert motion.footsteps.kind.tolist() == [0, 1, 2, 3, 4, 0, 0]
        for when, side, x, y, yaw, _ in motion.footsteps.rows():
            sample = round(when / motion.dt)
            np.testing.assert_allclose(motion.foot(int(side))[sample], [x, y, 0, 0, 0, np.sin(yaw / 2), 1], atol=1e-9)
        assert set(planned.planning_time) == {"feasibility", "trajectories", "total"}

    def test_obstacle_and_names_are_stored(self, motion, obstacle):
        front, width, height, margin_width, margin_height, half_extent = motion.obstacle
        assert (width, height, margin_width, margin_height) == (0.05, 0.15, 0.03, 0.03)
        assert half_extent >= 0.5
        assert front > 0.5
        assert motion.robot == "hrp2"
        np.testing.assert_allclose(motion.bare_obstacle[[0, 1, 3]], [front, front + width, height])

    def test_twice_the_same(self, motion):
        again = crossing(load_robot("hrp2"), Obstacle(0.15, 0.05))
        assert again.hash() == motion.hash()
        np.testing.assert_array_equal(again.q, motion.q)

    def test_the_same_in_another_process(self, motion, tmp_path):
        code = (
            "from stepover import Obstacle, load_robot\n"
            "from stepover.planning.algorithm_1.planner import plan_in_detail\n"
            "found = plan_in_detail(load_robot('hrp2'), Obstacle(0.15, 0.05), look_for_nearest=False);"
            "print(found.motion.hash())"
        )
        found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        assert found.stdout.strip() == motion.hash()


@pytest.mark.parametrize(("height", "width"), CORNERS + [tuple(size) for size in BETWEEN])
def test_up_to_15_by_8_cm_everything_crosses(robot, height, width):
    motion = crossing(robot, Obstacle(height, width))
    found = measure(robot, motion)
    assert found.clearance_min >= 0.030
    assert found.zmp_margin_min >= 0.020
    assert max(found.zmp_rms) <= 3e-3
    assert found.joint_margin_min >= 0.0


@pytest.mark.parametrize(("height", "width"), [(0.2498, 0.05), (0.249, 0.0497), (0.2195, 0.0698), (0.149, 0.129)])
def test_just_inside_the_corners_of_what_must_cross(robot, height, width):
    found = measure(robot, crossing(robot, Obstacle(height, width)))
    assert found.clearance_min >= 0.030
    assert found.zmp_margin_min >= 0.015
    assert max(found.zmp_rms) <= 4e-3
    assert found.joint_margin_min >= 0.0


def test_the_distance_is_kept(robot):
    motion = crossing(robot, Obstacle(0.15, 0.05, distance=1.1))
    assert motion.obstacle[0] == pytest.approx(1.1)
    assert measure(robot, motion).clearance_min >= 0.030


def test_wider_margins_are_kept(robot):
    motion = crossing(robot, Obstacle(0.10, 0.05, margin_height=0.05, margin_width=0.04))
    assert measure(robot, motion).clearance_min >= 0.04


@pytest.mark.parametrize(
    ("obstacle", "way", "constraint"),
    [
        (Obstacle(0.9, 0.05), "height", r"LEG_LINK\d is \d+\.\d mm too near"),
        (Obstacle(0.15, 0.9), "width", r"longest is 0\.600 m"),
    ],
    ids=["high", "wide"],
)
def test_what_cannot_be_crossed_names_the_constraint_and_the_nearest_that_can(coarse, obstacle, way, constraint):
    with pytest.raises(Infeasible, match=constraint) as caught:
        plan(coarse, obstacle, arms="off", extras=False)
    nearest = caught.value.nearest
    assert nearest is not None
    assert nearest.as_advice() in str(caught.value)
    assert nearest.height <= obstacle.height
    assert nearest.width <= obstacle.width
    assert (nearest.margin_height, nearest.margin_width) == (obstacle.margin_height, obstacle.margin_width)
    motion = plan_in_detail(coarse, nearest, arms="off", extras=False, look_for_nearest=False).motion
    assert measure(coarse, motion).clearance_min >= 0.030
    assert "\n" not in str(caught.value)
    more = {name: getattr(nearest, name) + 0.006 * (name == way) for name in ("height", "width")}
    with pytest.raises(Infeasible):
        plan_in_detail(coarse, Obstacle(**more), arms="off", extras=False, look_for_nearest=False)


def test_too_near_names_the_distance_that_does(robot):
    with pytest.raises(Infeasible, match="nearer than the first step") as caught:
        plan(robot, Obstacle(0.15, 0.05, distance=0.2))
    motion = crossing(robot, caught.value.nearest)
    assert motion.obstacle[0] == pytest.approx(caught.value.nearest.distance)
    assert "at a distance of" in str(caught.value)


@pytest.mark.parametrize(("height", "width"), [(0.25, 0.05), (0.225, 0.05), (0.2221, 0.0244)])
def test_a_key_configuration_that_is_passed_over_would_not_have_done(robot, monkeypatch, height, width):
    """With all options, every key configuration before the one that was found, whether it was tried or not."""
    obstacle, attempts = Obstacle(height, width), []
    monkeypatch.setattr(planner, "algorithm_1", lambda *args: attempts.append(args) or algorithm_1(*args))
    found = plan_in_detail(robot, obstacle)
    keys, apart = key_configurations(robot, obstacle), robot.feasibility.step_length_more_step
    steps = [(key.x_ads - keys[0].x_ads) / apart for key in keys]
    keys = [key for key, step in zip(keys, steps, strict=True) if abs(step - round(step)) < 1e-6]
    options = [Options("off"), Options("auto"), Options("auto", level=1), Options("auto", level=2)]
    every = [(some, key) for some in options for key in keys]
    before = every[: every.index((found.options, found.key))]
    assert len(attempts) - 1 < len(before), "some were passed over"
    for some, key in before:
        with pytest.raises(Infeasible):
            algorithm_1(robot, obstacle, key, some)


def test_the_error_is_what_lacks_least_with_all_that_may_be_used(robot):
    with pytest.raises(Infeasible, match="FTA cannot free the trailing leg: LLEG_LINK") as caught:
        plan_in_detail(robot, Obstacle(0.27, 0.05), look_for_nearest=False)
    assert 0.0 < caught.value.short < 0.04


def test_without_looking_for_the_nearest_there_is_none(robot):
    with pytest.raises(Infeasible) as caught:
        plan_in_detail(robot, Obstacle(0.9, 0.05), look_for_nearest=False)
    assert caught.value.nearest is None


@pytest.mark.parametrize("option", ["arms", "speed_limits"])
def test_unknown_options_are_named(robot, obstacle, option):
    with pytest.raises(InvalidInput, match=f"{option} = 'perhaps'"):
        plan(robot, obstacle, **{option: "perhaps"})


@pytest.mark.parametrize("how", [plan, quasi_static_plan])
def test_a_name_for_a_robot_and_a_size_for_an_obstacle_are_answered_with_what_is_wanted(robot, obstacle, how):
    with pytest.raises(InvalidInput, match=r"robot must be of type Robot, not str: give load_robot\(\.\.\.\)"):
        how("hrp2", obstacle)
    with pytest.raises(InvalidInput, match=r"obstacle must be of type Obstacle, not tuple: give Obstacle\("):
        how(robot, (0.15, 0.05))


def test_plan_returns_the_motion_alone(robot, obstacle, motion):
    alone = plan(robot, obstacle)
    assert isinstance(alone, Motion)
    assert alone.hash() == motion.hash()


def test_a_refusal_says_how_far_it_is(coarse):
    shares = []
    with pytest.raises(Infeasible):
        plan_in_detail(coarse, Obstacle(0.9, 0.05), arms="off", extras=False, progress=shares.append)
    assert len(shares) > 5
    assert shares == sorted(shares)
    assert 0.0 < shares[0] < 0.3
    assert 0.5 < shares[-1] <= 1.0


def attempts_of(monkeypatch, robot, obstacle):
    """How often Algorithm 1 is tried until it refuses an obstacle, and the refusal."""
    attempts = []
    monkeypatch.setattr(planner, "algorithm_1", lambda *args: attempts.append(args) or algorithm_1(*args))
    with pytest.raises(Infeasible) as caught:
        plan(robot, obstacle)
    return len(attempts), caught.value


def test_a_refusal_does_not_try_every_waist_and_says_the_same(robot, monkeypatch):
    """Over a wide obstacle the ZMP is shorter of its margin under each lower waist."""
    monkeypatch.setattr(planner, "_nearest", lambda *_: None)
    early = with_authors_swing(robot)
    count, refusal = attempts_of(monkeypatch, early, Obstacle(0.02, 0.2))
    monkeypatch.setattr(search, "_no_better", lambda *_: False)
    every, same = attempts_of(monkeypatch, early, Obstacle(0.02, 0.2))
    assert count < every / 2
    assert str(refusal) == str(same)


def test_what_fails_as_the_robot_walks_is_refused_at_once(robot, monkeypatch):
    """With its arm at its side the hand meets the thigh in every step, whatever the obstacle."""
    angles = types.MappingProxyType({**robot.posture.angles_deg, "LARM_JOINT1": 0.0})
    close = dataclasses.replace(robot, posture=dataclasses.replace(robot.posture, angles_deg=angles))
    count, refusal = attempts_of(monkeypatch, close, Obstacle(0.05, 0.05))
    assert (count, refusal.nearest, refusal.walking) == (1, None, True)
    assert "LARM_LINK5 and LLEG_LINK2 meet" in str(refusal)


@pytest.mark.parametrize("most", [0, 3])
def test_the_search_for_the_nearest_ends_after_its_attempts(robot, monkeypatch, most):
    with monkeypatch.context() as without:
        without.setattr(planner, "_nearest", lambda *_: None)
        alone, _ = attempts_of(without, robot, Obstacle(0.3, 0.1))
    monkeypatch.setattr(planner, "SEARCH", most)
    count, refusal = attempts_of(monkeypatch, robot, Obstacle(0.3, 0.1))
    assert count == alone + most
    assert (refusal.nearest is None) == (most == 0)
