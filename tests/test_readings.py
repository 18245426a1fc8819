"""What the claims on ZMP errors, upper body and outline measure: each one sees the other side, too."""

import dataclasses

import numpy as np
import pytest

from stepover.analysis import outline, simplifications, zmp_errors
from stepover.analysis.upper_body import chest_and_arms, com_back, trunk_joints, upper_links, upper_momentum_share
from stepover.errors import InvalidInput
from stepover.reproduction.claims import read_claims

CLAIMS = read_claims()


def with_first_stage(motion, error):
    return dataclasses.replace(motion, zmp_first_stage=motion.zmp_reference + error)


class TestZmpErrors:
    def test_an_error_that_is_the_same_everywhere_is_not_specific_to_the_obstacle(self, motion):
        over, walking = zmp_errors.crossing_and_walking(with_first_stage(motion, 0.01))
        assert over == pytest.approx([0.01, 0.01])
        assert not CLAIMS["jerky-over-obstacle"].holds((over / walking).tolist())
        over, walking = zmp_errors.crossing_and_walking(motion)
        assert CLAIMS["jerky-over-obstacle"].holds((over / walking).tolist())

    def test_a_perfect_first_stage_is_not_jerky(self, motion):
        over, _ = zmp_errors.crossing_and_walking(with_first_stage(motion, 0.0))
        assert not CLAIMS["first-stage-jerky"].holds((1e3 * over).tolist())

    def test_the_peak_is_judged_against_the_support(self, robot, motion):
        perfect = dataclasses.replace(motion, zmp=motion.zmp_reference)
        assert CLAIMS["second-stage"].holds(zmp_errors.peak_over_support(robot, perfect).tolist())
        assert zmp_errors.beyond(perfect, 1e-9) == 0.0
        one = perfect.zmp.copy()
        one[500, 0] += 0.5 * np.ptp(robot.contact_patch(1), axis=0)[0]
        peaks = zmp_errors.peak_over_support(robot, dataclasses.replace(motion, zmp=one))
        assert peaks == pytest.approx([1.0, 0.0]), "a single sample counts: half a sole ahead is its edge"

    def test_a_motion_without_a_filter_is_refused(self, motion):
        with pytest.raises(InvalidInput, match="no first stage"):
            zmp_errors.first_stage(dataclasses.replace(motion, zmp_first_stage=None))


class TestUpperBody:
    def test_its_links_are_all_but_the_legs(self, robot):
        links = robot.description.links
        share = sum(links[k].inertia.mass for k in upper_links(robot)) / robot.body.mass
        assert share == pytest.approx(simplifications.upper_body_share(robot))

    def test_arms_that_swing_fast_break_the_claim(self, robot, motion):
        assert CLAIMS["momentum-21"].holds(upper_momentum_share(robot, motion).tolist())
        q = motion.q.copy()
        for joint in robot.upper_body.shoulders:
            q[:, robot.body.column(joint)] += 0.5 * np.sin(2.0 * np.pi * 2.0 * motion.time)
        moving = dataclasses.replace(motion, q=q, com=robot.body.com(robot.body.placements(q)))
        assert not CLAIMS["momentum-21"].holds(upper_momentum_share(robot, moving).tolist())

    def test_arms_and_chest_move_the_com_and_stop_at_their_limits(self, robot):
        arms = com_back(robot, list(robot.upper_body.shoulders), np.radians(25.0))
        chest = [com_back(robot, ["CHEST_JOINT1"], -angle) for angle in (0.2, 0.4)]
        assert arms == pytest.approx(0.0166, abs=2e-4)
        assert chest == pytest.approx([0.0023, 0.0023], abs=1e-4), "5 degrees back, whatever is asked for"
        assert trunk_joints(robot) == ["CHEST_JOINT1"]
        assert chest_and_arms(robot) == pytest.approx((chest[-1], arms))

    def test_a_chest_that_leans_further_breaks_the_claim(self, robot):
        chest, arms = chest_and_arms(robot)
        assert CLAIMS["chest-for-arms"].holds(chest / arms)
        assert not CLAIMS["chest-for-arms"].holds(0.6)


class TestOutline:
    def test_the_knee_is_deeper_than_the_shank_in_a_box_around_it(self, robot):
        q = robot.half_sitting()[None]
        placed = robot.body.placements(q)
        knee = placed.positions[0, robot.body.index(robot.legs.knee[0])]
        box = np.array([knee[0] - 0.3, knee[0] + 0.3, 0.0, knee[2] + 0.3])
        deep = outline.depth_of_parts(robot, placed, -1, box)
        assert 0.0 < deep["knee"] < 0.3
        low = outline.depth_of_parts(robot, placed, -1, np.array([*box[:3], knee[2] - 0.1]))
        assert low["knee"] == 0.0 < low["shank"]


class TestWhatIsPlanned:
    def test_a_hop_is_no_small_acceleration(self, motion):
        rise = 0.05 * np.sin(2.0 * np.pi * motion.time)
        assert not CLAIMS["vertical-acceleration"].holds(simplifications.vertical_acceleration(rise, motion.dt))

    def test_a_waist_that_leaves_the_com_breaks_remark_4(self, motion):
        waist = motion.waist.copy()
        waist[motion.samples(2), 2] -= 0.03
        sunk = 1e3 * abs(simplifications.waist_rise_over_com(dataclasses.replace(motion, waist=waist)))
        assert not CLAIMS["remark-4"].holds(sunk)
