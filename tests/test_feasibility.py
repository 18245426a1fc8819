"""units/feasibility.py: the key configuration over the obstacle, Sec. III-A and Eq. (22)."""

from __future__ import annotations

import dataclasses
from types import MappingProxyType

import numpy as np
import pytest

from stepover import Infeasible, Obstacle
from stepover.model import pose
from stepover.model.collision import exact_distance
from stepover.planning.algorithm_1.feasibility import KeyCandidates, key_configurations, key_postures


def posture(robot, key, leading=-1):
    """Configuration (nq,) of a key configuration, the rear ankle at x = 0, from inverse kinematics alone."""
    q = robot.half_sitting()
    q[:7] = pose.pose(np.array([[key.x_hds, 0.0, key.z_hds]]), key.yaw)[0]
    for side in (1, -1):
        x = key.x_ads if side == leading else 0.0
        leg = robot.leg(side)
        q[leg.columns] = leg.inverse(q[None, :7], pose.pose(np.array([[x, 0.095 * side, 0.0]])))[0]
    return q


@pytest.fixture(scope="module")
def keys(robot, obstacle):
    """All key configurations of the 15 cm case."""
    return list(key_configurations(robot, obstacle))


@pytest.fixture(scope="module")
def key(keys):
    """The first one."""
    return keys[0]


def test_the_papers_step_of_about_40_cm_from_the_normal_waist_height(robot, key):
    assert 0.36 <= key.x_ads <= 0.43
    assert key.z_hds == pytest.approx(robot.posture.waist_height)
    assert key.x_hds == pytest.approx(0.5 * key.x_ads)


@pytest.mark.parametrize(("height", "low", "high"), [(0.20, 0.41, 0.47), (0.25, 0.45, 0.50)])
def test_higher_obstacles_need_the_known_longer_steps(robot, height, low, high):
    assert low <= key_configurations(robot, Obstacle(height, 0.05))[0].x_ads <= high


def test_a_wrong_start_shows(robot, obstacle, key):
    """Searched from a lower waist, the step comes out some 10 cm longer: the rear knee bends into the obstacle."""
    rest = robot.half_sitting()
    lower, angles = np.concatenate([rest[:2], [0.60], rest[3:7]])[None], dict(robot.posture.angles_deg)
    for side in (1, -1):
        leg = robot.leg(side)
        turn, place = leg.sole(rest[None, :7], rest[None, leg.columns])
        sole = pose.from_matrices(turn, place)
        angles |= dict(zip(leg.joints, np.degrees(leg.inverse(lower, sole)[0]).tolist(), strict=True))
    posture = dataclasses.replace(robot.posture, waist_height=0.60, angles_deg=MappingProxyType(angles))
    low = dataclasses.replace(robot, posture=posture)
    assert key_configurations(low, obstacle)[0].x_ads > key.x_ads + 0.05


@pytest.mark.parametrize("height", [0.05, 0.15, 0.25])
def test_the_search_finds_what_judging_every_posture_finds(robot, height):
    obstacle, search = Obstacle(height, 0.05), robot.feasibility
    found = key_configurations(robot, obstacle)
    shortest = obstacle.safe_depth + robot.foot.heel + robot.foot.toe + 2.0 * search.foothold_clearance
    steps = np.arange(shortest, search.step_length_max + 1e-9, search.step_length_step)
    heights = np.arange(robot.posture.waist_height, search.waist_height_min - 1e-9, -search.waist_height_step)
    x_ads, z_hds = (axis.ravel() for axis in np.meshgrid(steps, heights, indexing="ij"))
    good = key_postures(robot, obstacle, KeyCandidates(x_ads, 0.5 * x_ads, z_hds, found[0].yaw)).good(search.spare)
    good &= x_ads <= x_ads[good].min() + search.step_length_more + 1e-9
    assert [(key.x_ads, key.z_hds) for key in found] == list(zip(x_ads[good], z_hds[good], strict=True))


def test_knees_keep_15_degrees_and_joints_their_limits(robot, keys):
    for key in keys[:: max(1, len(keys) // 10)]:
        q = posture(robot, key)
        for knee in robot.legs.knee:
            assert q[robot.body.column(knee)] >= np.radians(15.0) - 1e-9
        assert (q[7:] >= robot.body.lower - 1e-9).all()
        assert (q[7:] <= robot.body.upper + 1e-9).all()


def test_legs_thighs_and_feet_keep_out_of_the_margins(robot, obstacle, keys):
    """By coal, on both sides, from a posture put together here."""
    for key in keys[:: max(1, len(keys) // 10)]:
        placements = robot.body.placements(posture(robot, key)[None])
        rectangle = obstacle.profile(key.front_face(robot, obstacle), margins=True)
        distances = {s.link: exact_distance(s, placements, 0, rectangle) for s in robot.shapes if "LEG" in s.link}
        assert {link[1:] for link in distances} == {"LEG_LINK0", "LEG_LINK2", "LEG_LINK3", "LEG_LINK5"}
        assert min(distances.values()) >= 0.0, distances


def test_a_centimetre_less_and_a_shank_meets_the_margins(robot, obstacle, key):
    """The first one found is the shortest: it binds."""
    short = dataclasses.replace(key, x_ads=key.x_ads - 0.012, x_hds=key.x_hds - 0.006)
    placements = robot.body.placements(posture(robot, short)[None])
    rectangle = obstacle.profile(short.front_face(robot, obstacle), margins=True)
    touching = {s.link for s in robot.shapes if exact_distance(s, placements, 0, rectangle) < 0.003}
    assert touching
    assert touching <= {"LLEG_LINK3", "RLEG_LINK3", "LLEG_LINK2", "RLEG_LINK2"}


def test_obstacle_lies_between_the_feet(robot, obstacle, key):
    x_min, x_max, _, _ = obstacle.profile(key.front_face(robot, obstacle), margins=True)
    assert robot.foot.toe <= x_min
    assert x_max <= key.x_ads - robot.foot.heel
    assert x_max > key.x_ads - robot.foot.heel - 0.01  # the front foot's heel lands at the rear margin


def test_the_leading_hip_is_turned_ahead(robot, obstacle):
    for leading in (1, -1):
        key = key_configurations(robot, obstacle, leading)[0]
        assert abs(key.yaw) == pytest.approx(np.radians(25.0))
        placed = robot.body.placements(posture(robot, key, leading)[None]).positions[0]
        hips = {side: placed[robot.body.index(robot.leg(side).joints[0])] for side in (1, -1)}
        assert hips[leading][0] > hips[-leading][0] + 0.04
        assert np.sign(hips[1][1]) == 1


def test_both_sides_may_lead(robot, obstacle, key):
    left = key_configurations(robot, obstacle, leading=1)[0]
    assert (left.x_ads, left.x_hds, left.z_hds, left.yaw) == (key.x_ads, key.x_hds, key.z_hds, -key.yaw)


def test_search_goes_up_in_step_length_and_down_in_height(robot, keys):
    order = [(key.x_ads, -key.z_hds) for key in keys]
    assert order == sorted(order)
    assert len(keys) > 10
    assert max(key.x_ads for key in keys) <= robot.feasibility.step_length_max + 1e-9
    assert min(key.z_hds for key in keys) >= robot.feasibility.waist_height_min - 1e-9


def test_higher_wider_and_safer_never_need_a_shorter_step(robot):
    for obstacles in (
        [Obstacle(height, 0.05) for height in (0.05, 0.10, 0.15, 0.20, 0.25)],
        [Obstacle(0.15, width) for width in (0.02, 0.05, 0.08, 0.12)],
        [Obstacle(0.15, 0.05, margin, margin) for margin in (0.0, 0.02, 0.04)],
    ):
        lengths = [key_configurations(robot, obstacle)[0].x_ads for obstacle in obstacles]
        assert lengths == sorted(lengths)
        assert lengths[-1] > lengths[0]


def test_what_fits_under_no_leg_names_the_link_and_how_deep(robot):
    with pytest.raises(Infeasible, match=r"no key configuration.*LINK\d is \d+\.\d mm too near"):
        key_configurations(robot, Obstacle(0.9, 0.05))


def test_what_is_wider_than_a_step_names_both_lengths(robot):
    with pytest.raises(Infeasible, match=r"0\.900 m of width need a step of 1\.2\d\d m .* longest is 0\.600 m"):
        key_configurations(robot, Obstacle(0.15, 0.9))


def test_knees_that_must_stay_bent_too_much_are_named(robot, obstacle):
    stiff = dataclasses.replace(robot, feasibility=dataclasses.replace(robot.feasibility, knee_margin_deg=120.0))
    with pytest.raises(Infeasible, match="a knee is nearer to straight than 120 degrees"):
        key_configurations(stiff, obstacle)
