"""The optimising planner: what its motions keep, what it refuses, and that it gives the same again."""

from __future__ import annotations

import dataclasses

import numpy as np
import pinocchio as pin
import pytest

from stepover.errors import Infeasible, InvalidInput
from stepover.model.body import Body
from stepover.model.course import Course
from stepover.model.description.links import Inertia
from stepover.model.obstacle import Obstacle
from stepover.model.parameters.optimal import Optimal
from stepover.model.self_collision import self_clearance
from stepover.motion.footsteps import LEG_1, LEG_2
from stepover.planning.checks import check
from stepover.planning.measures import measure
from stepover.planning.optimal import search
from stepover.planning.optimal.constraints.own_links import thigh_pairs
from stepover.planning.optimal.planner import EVERY, optimal_in_detail, optimal_plan
from stepover.planning.optimal.torques import torques
from stepover.planning.planner import find_planner

RESERVES = Optimal()


@pytest.fixture(scope="module")
def best(robot, obstacle):
    """The 15 cm case with how it came about."""
    return optimal_in_detail(robot, obstacle)


def test_every_limit_is_kept(robot, best):
    assert [found.check for found in check(robot, best.motion) if not found.kept] == []
    measured = measure(robot, best.motion)
    assert measured.joint_speed_ratio_max < RESERVES.speed_share + 0.01
    assert measured.clearance_min > 0.0345
    assert measured.zmp_margin_min > 0.017
    assert best.torque.ratio < RESERVES.torque_share + 0.02
    apart = self_clearance(thigh_pairs(robot), robot.body.placements(best.motion.q), 1)[0]
    assert apart > 0.004
    pairs = [*thigh_pairs(robot), *robot.own_pairs]
    assert best.self_clearance == self_clearance(pairs, robot.body.placements(best.motion.q), EVERY)[0]


def test_it_begins_and_ends_in_the_walk(robot, best):
    q, rest = best.motion.q, robot.half_sitting()
    assert np.abs(q[0] - rest).max() < 1e-3
    feet = [best.motion.foot(side)[-1, :2] for side in (1, -1)]
    assert abs(feet[0][0] - feet[1][0]) < 1e-9
    speed = np.gradient(best.motion.com[:, 0], best.motion.dt)
    walking = slice(best.motion.samples(1).start, best.motion.samples(3).stop)
    assert speed[walking].min() > 0.0  # it never stops


@pytest.mark.parametrize("kind", [LEG_1, LEG_2])
def test_landings_are_no_faster_than_algorithm_1s(best, kind):
    step = best.motion.footsteps.of_kind(kind)
    sole = best.motion.foot(int(step.side[0]))[:, 2]
    landing = round(float(step.time[0]) / best.motion.dt)
    low = np.flatnonzero(sole[:landing] > 0.010)[-1]
    assert -(sole[low + 1] - sole[low]) / best.motion.dt < 0.276


def test_soles_stay_above_the_floor(best):
    for sole in (best.motion.left_foot, best.motion.right_foot):
        assert sole[:, 2].min() > -2e-4


def test_power_of_the_joints_is_the_change_of_energy(robot, best):
    """While the bearing feet stand still the floor does no work, however two feet share its force."""
    motion, body = best.motion, robot.body
    model, dt = body.model, motion.dt
    data, speeds = model.createData(), body.velocities(motion.q, dt)
    energy = np.array([pin.computeMechanicalEnergy(model, data, q, v) for q, v in zip(motion.q, speeds, strict=True)])
    change = np.gradient(energy, dt)
    power = np.einsum("nj,nj->n", torques(robot, motion), speeds[:, 6:])
    calm = np.flatnonzero(motion.support != 0)
    calm = calm[np.isin(calm - 3, calm) & np.isin(calm + 3, calm)]
    assert np.abs(change[calm]).max() > 50.0
    assert np.abs(power - change)[calm].max() < 0.05 * np.abs(change[calm]).max()
    both = motion.samples(2)
    inner = slice(both.start + 2, both.stop - 2)
    assert np.abs(power - change)[inner].max() < 0.1 * np.abs(change[inner]).max()


def test_the_record(best):
    assert best.iterations == sum(attempt.iterations for attempt in best.attempts) > 3
    assert best.attempts[0].start == "base motion"
    assert best.attempts[-1].violation <= RESERVES.tolerance
    told = best.to_json()
    assert {"torque_ratio_max", "torque_ratio_joint", "self_clearance_min", "iterations"} <= told.keys()
    assert told["torque_ratio_max"] == best.torque.ratio


def test_the_same_again_and_progress(robot, obstacle, best):
    seen = []
    again = optimal_plan(robot, Course([obstacle]), progress=seen.append)
    assert again.hash() == best.motion.hash()
    assert np.array_equal(again.q, best.motion.q)
    assert len(seen) == best.iterations == seen[-1].iterations
    assert {(now.height, now.width) for now in seen} == {(obstacle.height, obstacle.width)}


def mirrored(robot):
    """The robot seen in a mirror: every link has the mirrored inertia of the one on the other side."""
    flip, links = np.diag([1.0, -1.0, 1.0]), {link.name: link for link in robot.description.links}

    def seen(link):
        swapped = {"L": "R", "R": "L"}.get(link.name[0], link.name[0]) + link.name[1:]
        other = links.get(swapped, link).inertia
        inertia = Inertia(other.mass, flip @ other.centre, flip @ other.matrix @ flip)
        return dataclasses.replace(link, inertia=inertia)

    description = dataclasses.replace(robot.description, links=tuple(map(seen, robot.description.links)))
    return dataclasses.replace(robot, body=Body(description))


def test_a_mirrored_plan(robot, obstacle, best):
    """The mirrored robot with its left leg first plans the mirrored motion."""
    plan, flip = optimal_in_detail(mirrored(robot), obstacle, leading=1), np.array([1.0, -1.0, 1.0])
    assert [attempt.iterations for attempt in plan.attempts] == [attempt.iterations for attempt in best.attempts]
    for side in (1, -1):
        there = best.motion.foot(side)[:, :3] * flip
        assert np.abs(plan.motion.foot(-side)[:, :3] - there).max() < 1e-3
    assert np.abs(plan.motion.waist[:, :3] - best.motion.waist[:, :3] * flip).max() < 1e-3
    assert np.abs(plan.motion.zmp - best.motion.zmp * flip[:2]).max() < 2e-3
    assert plan.motion.footsteps.of_kind(LEG_1).side[0] == 1


@pytest.mark.parametrize(
    ("obstacle", "word"),
    [
        ("15 cm", "Obstacle"),
        (Course([Obstacle(0.1, 0.05, distance=0.6), Obstacle(0.1, 0.05, distance=2.0)]), "takes one obstacle"),
        (Obstacle(0.1, 0.05, yaw=0.1), "square to the path"),
    ],
    ids=["text", "two", "turned"],
)
def test_bad_input(robot, obstacle, word):
    with pytest.raises(InvalidInput, match=word):
        optimal_plan(robot, obstacle)


def test_no_robot(obstacle):
    with pytest.raises(InvalidInput, match="load_robot"):
        optimal_plan("hrp2", obstacle)


def test_too_near(robot):
    with pytest.raises(Infeasible, match="nearer than the first step"):
        optimal_plan(robot, Obstacle(0.1, 0.05, distance=0.3))


def test_what_cannot_be_crossed(robot, monkeypatch):
    """Little patience, so that even a low obstacle is refused: the message says what stays violated, and when."""
    hasty = dataclasses.replace(robot, optimal=dataclasses.replace(Optimal(), iterations=1))
    monkeypatch.setattr(search, "DIRECT", 0)
    with pytest.raises(
        Infeasible, match=r" of .* stays violated by .* (mm|degrees|of its limit|weight).* at t = "
    ) as e:
        optimal_plan(hasty, Obstacle(0.15, 0.05))
    assert e.value.nearest is None


def test_it_is_found_by_its_name():
    assert find_planner("optimal") is optimal_plan
