"""The crossing before it was adapted, and what each unit contributes."""

import re

import numpy as np
import pytest

from stepover.analysis import limits, stages
from stepover.model.obstacle import Obstacle
from stepover.motion.footsteps import LEG_1, LEG_2
from stepover.planning.algorithm_1.planner import plan_in_detail


@pytest.fixture(scope="module")
def high():
    """The paper's high obstacle."""
    return Obstacle(0.25, 0.05)


@pytest.fixture(scope="module")
def crossing(robot, high):
    """Its plan."""
    return plan_in_detail(robot, high, look_for_nearest=False)


def test_before_adaptation_the_waist_lags_and_the_lead_knee_over_stretches(robot, high, crossing):
    before, arms, *_, after = stages.lead_leg_stages(crossing)
    angle, missing = stages.before_landing(robot, before)
    assert np.isnan(angle), "nothing is clamped in silence"
    assert missing > 0.005
    assert stages.before_landing(robot, arms)[1] < missing, "the arms help"
    angle, missing = stages.before_landing(robot, after)
    assert missing == 0.0
    assert angle > 5.0
    assert stages.waist_ahead(after, before) > 0.01


def test_what_fta_was_given_and_what_it_made_of_it(robot, crossing):
    before, after = stages.before_feet_adaptor(robot, crossing), stages.after_adaptation(crossing)
    third = before.swing(LEG_2)
    raised = after.waist[:, 2] - before.waist[:, 2]
    assert raised.max() == pytest.approx(crossing.adaptation.raised, abs=1e-4)
    assert not raised[: third.start].any()
    back = before.feet.left[third, 0] - after.feet.left[third, 0]
    assert back.max() == pytest.approx(crossing.adaptation.shift, abs=0.05)
    np.testing.assert_array_equal(before.feet.right, after.feet.right)
    assert stages.lift(before, LEG_1) == stages.lift(after, LEG_1)


def test_postures_are_those_of_the_plan(robot, crossing):
    after = stages.after_adaptation(crossing)
    q, missing = stages.postures(robot, after, slice(None))
    assert not missing.any()
    for side in (1, -1):
        columns = robot.leg(side).columns
        np.testing.assert_allclose(q[:, columns], crossing.motion.q[:, columns], atol=1e-9)


def test_at_15_cm_nothing_is_needed(robot, obstacle, planned):
    rows = stages.contributions(robot, obstacle, planned.key, 0)
    assert [row.reason for row in rows] == [""] * len(stages.COMBINATIONS)
    assert min(row.free for row in rows) >= 0.0


def test_at_25_cm_each_unit_contributes_something_and_only_all_of_it_is_enough(robot, high, crossing):
    rows = {row.units: row for row in stages.contributions(robot, high, crossing.key, crossing.options.level)}
    *some, everything = rows.values()
    assert all(re.search("LINK|out of reach|over-stretches|limit", row.reason) for row in some)
    assert everything.reason == ""
    assert everything.free >= 0.0
    assert everything.clearance >= 0.03
    assert rows["none"].free < -0.03
    assert rows["(1), (2)"].free > rows["(2)"].free + 0.01
    assert rows["FTA, UBMG"].missing < rows["(1), (2), (3)"].missing


def test_highest_is_found_by_bisection():
    assert limits.highest(lambda height: height < 0.1234, 0.0, 1.0, 1e-4) == pytest.approx(0.1234, abs=1e-4)
    assert np.isnan(limits.highest(lambda height: False, 0.0, 1.0, 1e-4))
    assert limits.highest(lambda height: True, 0.0, 1.0, 1e-4) == pytest.approx(1.0, abs=1e-4)


def test_speeds_of_a_plan_and_of_none(robot, obstacle):
    fast = limits.speeds(robot, obstacle)
    assert fast.ratio > 1.0
    assert fast.duration == pytest.approx(3.04)
    none = limits.speeds(robot, Obstacle(0.4, 0.05))
    assert np.isnan(none.ratio)
    assert none.reason
