"""How long the optimiser's single supports last: given, or the shortest that keeps all limits."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from stepover.errors import Infeasible, InvalidInput
from stepover.model.parameters.optimal import Optimal
from stepover.planning.checks import check
from stepover.planning.optimal.durations import BEST, lasting, require_time, shortest
from stepover.planning.optimal.planner import optimal_in_detail

P = Optimal()


def planner_from(least):
    """A planner that can do whatever takes at least some time [s], and the durations that it was asked for."""
    asked = []

    def plan(robot, look_for_nearest):
        duration = robot.walk.single_support_over
        asked.append((duration, look_for_nearest))
        if duration < least - 1e-9:
            raise Infeasible(f"too fast at {duration}")
        return duration

    return plan, asked


@pytest.mark.parametrize("least", [0.1, 0.7, 0.72, 0.85, 1.1, 1.45, 1.48, 1.5])
def test_the_shortest_is_found(robot, least):
    plan, asked = planner_from(least)
    found, trials = shortest(robot, plan)
    on_grid = P.duration_least + P.duration_step * np.ceil(
        (max(least, P.duration_least) - P.duration_least) / 0.05 - 1e-6
    )
    assert found == pytest.approx(on_grid)
    assert found == min(trial.duration for trial in trials if not trial.refused)
    assert [trial.duration for trial in trials] == [duration for duration, _ in asked]
    assert all(trial.duration < found for trial in trials if trial.refused)
    assert len(trials) <= 2 + np.ceil(np.log2((P.duration_most - P.duration_least) / P.duration_step))
    assert [look for _, look in asked] == [True] + [False] * (len(asked) - 1), "one search for the nearest obstacle"


def test_what_cannot_be_done_slowly_is_refused(robot):
    plan, asked = planner_from(1.6)
    with pytest.raises(Infeasible, match=r"too fast at 1\.5"):
        shortest(robot, plan)
    assert len(asked) == 1


def test_a_given_time(robot, obstacle):
    """All limits are kept, in less time than the robot walks with."""
    told = []
    found = optimal_in_detail(robot, obstacle, time=1.1, progress=told.append)
    assert [one.check for one in check(robot, found.motion) if not one.kept] == []
    dt = found.motion.dt
    for phase in (1, 3):
        taken = found.motion.samples(phase)
        assert (taken.stop - taken.start) * dt == pytest.approx(1.1, abs=1.5 * dt)
    assert {attempt.duration for attempt in found.attempts} == {1.1} == {now.duration for now in told}
    assert found.torque.ratio < P.torque_share + 0.02
    assert found.motion.robot_fingerprint == robot.fingerprint, "the robot is the same, whatever its walk"
    assert found.trials == ()


def test_only_the_steps_over_the_obstacle_are_changed(robot):
    quick = lasting(robot, 0.9)
    changed = {
        field.name
        for field in dataclasses.fields(robot.walk)
        if getattr(quick.walk, field.name) != getattr(robot.walk, field.name)
    }
    assert changed == {"single_support_over", "single_support_leg_2"}


@pytest.mark.parametrize("time", [0.0, -1.0, 0.69, 1.51, np.nan, np.inf, "fast", "", True, [1.0], 1j], ids=str)
def test_what_is_no_time(robot, obstacle, time):
    with pytest.raises(InvalidInput, match=r"from 0\.7 to 1\.5 s"):
        optimal_in_detail(robot, obstacle, time=time)


@pytest.mark.parametrize("time", [None, BEST, 0.7, 1, np.float32(0.75), 1.5], ids=str)
def test_what_is_one(time):
    require_time(time, P)
