"""report/trials.py, report/trial_tables.py: the trials with servos, their table, and what is said of them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from stepover import Obstacle, plan
from stepover.report.tables import trials as trial_tables
from stepover.simulation.disturbances import Disturbances
from stepover.studies import trials
from stepover.studies.trials import DISTURBED, HEIGHTS, UNDISTURBED, Outcome, Trial


@pytest.fixture(scope="module")
def rows():
    """The stored table."""
    return trials.read_table()


def row(**changes):
    """A row of somebody who crossed."""
    plain = Outcome(
        "hrp2", "0", UNDISTURBED, 0.15, 0.05, "rigid", True, "ignore", "{}", "m", True, 0.02, 0.01, 0.01, 0.01, 0.8,
        "RLEG_JOINT3", None, 1.05, "LLEG_JOINT3", 5.58, "", "s",
    )  # fmt: skip
    return dataclasses.replace(plain, **changes)


def test_every_disturbance_is_one_that_simulate_knows(motion):
    for values in DISTURBED.values():
        Disturbances.read(values, motion)


def test_what_must_be_survived_is_tried_on_both_soles_with_and_without_stabilizer():
    wanted = {"foothold of leg 1 +10 mm", "foothold of leg 1 -10 mm", "slope +1.5 degrees ahead", "friction 0.4",
              "slope -1.5 degrees to the left", "+5 % mass at the chest", "push +100 N in x, normal walking",
              "push -100 N in y, phase 3", "obstacle +20 mm ahead", "obstacle -20 mm ahead",
              "obstacle 20 mm higher"}  # fmt: skip
    assert wanted < set(DISTURBED)
    all_of_them = trials.trials()
    for name in DISTURBED:
        how = {(t.sole, t.stabilizer) for t in all_of_them if t.name == name}
        assert how == {(sole, on) for sole in ("rigid", "compliant") for on in (True, False)}
    assert len(all_of_them) == len({dataclasses.astuple(t) for t in all_of_them})


def test_pushes_fall_where_they_are_said_to(motion):
    walking, third = (motion.phase[np.searchsorted(motion.time, when)] for when in trials.PUSHES.values())
    assert (walking, third) == (0, 3)


def test_the_joint_that_first_comes_to_its_limit():
    ratios = np.array([[0.1, 0.5], [0.995, 0.5], [0.9, 1.4]])
    assert trials._first(ratios, np.array([0.0, 0.1, 0.2]), ["a", "b"]) == (1.4, "a", 0.1)
    assert trials._first(ratios[:1], np.zeros(1), ["a", "b"]) == (0.5, "b", None)


def test_highest_stops_at_the_first_failure():
    some = [row(height=0.15), row(height=0.16), row(height=0.17, crossed=False), row(height=0.18)]
    assert trial_tables.highest(some, "rigid", "ignore") == 0.16
    assert trial_tables.highest(some, "compliant", "ignore") == 0.0


def test_cells_say_how_it_ended():
    failed = "hit the obstacle at t = 6.175 s: LLEG_LINK3 touches it"
    fell = "fell at t = 3.900 s: the waist is tilted"
    assert trial_tables._ended(row()) == "20 mm"
    assert trial_tables._ended(row(crossed=False, reason=failed)) == "touches at 6.175 s"
    assert trial_tables._ended(row(crossed=False, reason=fell)) == "falls at 3.900 s"
    assert trial_tables._ended(row(motion=None)) == "no plan"


def test_a_table_where_nobody_survives():
    some = [row(sole=sole, stabilizer=on, crossed=on) for sole in ("rigid", "compliant") for on in (True, False)]
    cells = trial_tables.survivors_table(some).rows
    assert [line[1] for line in cells] == ["0 of 1", "1 of 1", "0 of 1", "1 of 1"]
    assert cells[0][2:] == ("-", "-", "-")


def test_an_obstacle_without_a_plan_is_a_row_too():
    found = Outcome(**trials.carry_out(Trial(UNDISTURBED, height=0.6)))
    assert (found.motion, found.crossed) == (None, None)
    assert "no key configuration" in found.reason


def test_the_stored_table_is_whole_and_of_todays_motions(robot, rows):
    keys = [(t.name, t.height, t.sole, t.stabilizer, t.speed_limits) for t in trials.trials()]
    assert [(r.name, r.height, r.sole, r.stabilizer, r.speed_limits) for r in rows] == keys
    assert {t.height for t in trials.trials()} == set(HEIGHTS)
    stored = {(r.height, r.speed_limits): r.motion for r in rows}
    for height, limits in ((0.15, "ignore"), (0.18, "respect")):
        motion = plan(robot, Obstacle(height, 0.05), speed_limits=limits)
        assert motion.hash() == stored[height, limits], "the planner has changed: run 'make studies'"


def test_the_stabilized_robot_never_falls_and_seldom_touches_the_obstacle(rows):
    """With servos the trailing foot uses half of the margin. What brings the obstacle nearer can use the rest."""
    some = [r for r in trial_tables.disturbed(rows) if r.stabilizer]
    failed = [r for r in some if not r.crossed]
    assert {r.name for r in failed} == {"slope +1.5 degrees ahead", "obstacle -20 mm ahead"}
    assert all(r.reason.startswith("hit the obstacle") and "fell" not in r.reason for r in failed)
    assert max(r.torque_ratio for r in some) <= 1.0 + 1e-9
