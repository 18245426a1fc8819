"""Disturbances: each one moves what it says, in the direction it says, and nothing else."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest
from still import samples_of, standing

from stepover.control.sensors import Sensed
from stepover.errors import InvalidInput
from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.simulation.disturbances import NONE, Disturbances, explained
from stepover.simulation.engine import Scene
from stepover.simulation.loop import floor_changes
from stepover.simulation.measurements import Run
from stepover.simulation.pybullet.world import World, pybullet
from stepover.simulation.run import simulate
from stepover.simulation.sensing import Senses
from stepover.simulation.touch import NOTHING, Touch


def stood(motion: Motion, robot: Robot, duration: float = 0.5, **perturb: float) -> Run:
    """Standing still on servos, disturbed."""
    still = standing(motion, duration)
    return simulate(still, robot=robot, actuators="limited", obstacle=False, perturb=perturb)


def test_none_is_as_planned(motion: Motion) -> None:
    assert Disturbances.read({}, motion) == NONE
    np.testing.assert_array_equal(NONE.gravity, [0.0, 0.0, -9.81])
    np.testing.assert_array_equal(NONE.obstacle(motion.obstacle), motion.obstacle)
    assert not NONE.pushes
    assert not NONE.loads
    assert floor_changes(motion, NONE) == {}


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"wind": 1.0}, ["'wind'", "friction", "push_x", "ground_1 to ground_"]),
        ({"ground_0": 0.01}, ["'ground_0'"]),
        ({"ground_99": 0.01}, ["'ground_99'", "ground_1 to ground_"]),
        ({"friction": 0.0}, ["friction = 0.0", "0.01 to 2"]),
        ({"ground_1": 1.0}, ["ground_1 = 1.0", "-0.05 to 0.05 m"]),
        ({"slope_ahead": float("nan")}, ["slope_ahead", "-10 to 10 deg"]),
        ({"push_x": "hard"}, ["push_x = 'hard'"]),
        ({"latency": -0.001}, ["latency", "0 to 0.1 s"]),
        ({"seed": 1.5}, ["seed", "whole"]),
        ({"obstacle_height": -0.2}, ["0.15 m high"]),
    ],
)
def test_what_makes_no_sense_is_refused(motion: Motion, values: dict, words: list[str]) -> None:
    with pytest.raises(InvalidInput) as error:
        simulate(motion, perturb=values)
    assert all(word in str(error.value) for word in words), error.value


def test_help_names_all_of_them() -> None:
    named = dict(explained())
    assert set(named) == {f.name for f in fields(Disturbances) if f.metadata} | {"ground_1, ..."}
    assert all(text.startswith("[") for text in named.values())


def test_a_run_keeps_its_disturbances(motion: Motion, robot: Robot) -> None:
    run = stood(motion, robot, 0.02, friction=0.5)
    assert run.to_json()["perturb"] == {"friction": 0.5}


def test_friction(motion: Motion, robot: Robot) -> None:
    """A push of 100 N slides the robot where the floor bears 0.1 of its weight sideways, not where it bears 0.8."""
    push = {"push_x": 100.0, "push_duration": 0.1}
    slippery, rough = (stood(motion, robot, 0.15, friction=mu, **push) for mu in (0.1, 0.8))
    assert slippery.series.left_foot[-1, 0] > 0.003
    assert abs(rough.series.left_foot[-1, 0]) < 1e-3
    sideways = np.abs(slippery.series.left_wrench + slippery.series.right_wrench)[5:]
    assert (np.hypot(sideways[:, 0], sideways[:, 1]) < 0.16 * sideways[:, 2].max()).all()


@pytest.mark.parametrize(("name", "axis"), [("push_x", 0), ("push_y", 1)])
@pytest.mark.parametrize("force", [60.0, -60.0])
def test_a_push_moves_the_centre_of_mass_its_way(
    motion: Motion, robot: Robot, name: str, axis: int, force: float
) -> None:
    calm = stood(motion, robot, 0.14)
    run = stood(motion, robot, 0.14, **{name: force, "push_time": 0.05, "push_duration": 0.08})
    shift = run.series.com[-1, :2] - calm.series.com[-1, :2]
    assert shift[axis] * np.sign(force) > 0.001
    assert abs(shift[1 - axis]) < 0.2 * abs(shift[axis])
    np.testing.assert_array_equal(run.series.q[:10], calm.series.q[:10], "not before it begins")
    floor = (run.series.left_wrench + run.series.right_wrench - calm.series.left_wrench - calm.series.right_wrench)[1:]
    impulse = floor[:, axis].sum() * 0.005 + force * 0.08
    speed = np.diff(run.series.com[-2:, axis] - calm.series.com[-2:, axis])[0] / 0.005
    assert impulse == pytest.approx(robot.body.mass * speed, abs=0.35)


@pytest.mark.parametrize(("name", "axis"), [("slope_ahead", 0), ("slope_left", 1)])
def test_uphill_the_weight_is_behind(motion: Motion, robot: Robot, name: str, axis: int) -> None:
    level, run = (stood(motion, robot, 1.5, **perturb) for perturb in ({}, {name: 1.0}))
    late = slice(-100, None)
    shift = (run.series.zmp[late] - level.series.zmp[late]).mean(axis=0)
    assert shift[axis] == pytest.approx(-0.81 * np.tan(np.radians(1.0)), rel=0.35)
    assert abs(shift[1 - axis]) < 0.003
    friction = (run.series.left_wrench + run.series.right_wrench)[late, axis].mean()
    way = run.series.com[:, axis]
    gained = robot.body.mass * ((way[-1] - way[-2]) - (way[-101] - way[-102])) / 0.005 / 0.5
    down = robot.body.mass * 9.81 * np.sin(np.radians(1.0))
    assert friction == pytest.approx(down + gained, rel=0.05), "the floor holds it, but for the sway"


def test_an_imu_on_a_slope_knows_what_is_up(motion: Motion, robot: Robot) -> None:
    for name, axis, sign in (("slope_ahead", 1, -1.0), ("slope_left", 0, 1.0)):
        reading = sensed(motion, robot, Disturbances.read({name: 2.0}, motion))
        turn = 2.0 * reading.attitude[:3] / reading.attitude[3]
        assert turn[axis] == pytest.approx(sign * np.radians(2.0), rel=1e-3), "uphill: the nose goes up"


def sensed(motion: Motion, robot: Robot, disturbances: Disturbances, touch: Touch = NOTHING) -> Sensed:
    """What the senses of a robot in its first posture read."""
    with World(Scene(robot, disturbances=disturbances)) as world:
        world.reset(motion.q[0])
        senses = Senses(world, motion.dt)
        senses.read(touch)
        return senses.late(0.0)


def test_mass_on_the_chest(motion: Motion, robot: Robot) -> None:
    heavy, ahead = (Disturbances.read(p, motion) for p in ({"chest_mass": 0.05}, {"chest_com_x": 0.02}))
    masses, centres = {}, {}
    for name, what in (("plain", NONE), ("heavy", heavy), ("ahead", ahead)):
        with World(Scene(robot, disturbances=what)) as world:
            world.reset(motion.q[0])
            body = world.robot
            links = {body.links[i]: i for i in body.links}
            masses[name] = {n: pybullet.getDynamicsInfo(body.number, i, world.client)[0] for n, i in links.items()}
            chest = pybullet.getLinkState(body.number, links["CHEST_LINK1"], 0, 1, world.client)
            centres[name] = np.array(chest[0])
    more = {n: m - masses["plain"][n] for n, m in masses["heavy"].items() if m != masses["plain"][n]}
    assert more == {"CHEST_LINK1": pytest.approx(0.05 * robot.body.mass)}
    assert masses["ahead"] == masses["plain"]
    np.testing.assert_allclose(centres["ahead"] - centres["plain"], [0.02, 0.0, 0.0], atol=1e-9)
    run = stood(motion, robot, 0.5, chest_mass=0.05)
    force = (run.series.left_wrench + run.series.right_wrench)[60:, 2].mean()
    assert force == pytest.approx(1.05 * robot.body.mass * 9.81, rel=0.005)


def test_obstacle_moves_and_grows(motion: Motion, robot: Robot) -> None:
    part = samples_of(motion, np.arange(3))
    plain, moved, higher = (
        simulate(part, robot=robot, perturb=p) for p in ({}, {"obstacle_x": 0.02}, {"obstacle_height": 0.02})
    )
    np.testing.assert_allclose(moved.obstacle - plain.obstacle, [0.02, 0.02, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(higher.obstacle - plain.obstacle, [0.0, 0.0, 0.0, 0.02], atol=1e-12)
    assert higher.clearance_min + 0.005 < plain.clearance_min < moved.clearance_min - 0.005, (
        "it stands before the robot"
    )
    assert moved.motion is part
    with World(Scene(robot, (Disturbances.read({"obstacle_x": 0.02}, motion).obstacle(motion.obstacle),))) as world:
        low, high = pybullet.getAABB(world.surroundings.obstacles[0], -1, world.client)
        assert low[0] == pytest.approx(motion.obstacle[0] + 0.02, abs=2e-3)
        assert high[0] - low[0] == pytest.approx(0.05, abs=2e-3)


def test_ground_is_higher_where_it_is_named(motion: Motion) -> None:
    steps = motion.footsteps
    leg_1 = int(np.flatnonzero(steps.kind == 2)[0])
    floor = Disturbances.read({"ground_leg_1": 0.01, "ground_2": -0.005}, motion).floor(motion)
    assert floor[leg_1] == 0.01
    assert floor[1] == -0.005
    assert np.count_nonzero(floor) == 2


def test_floors_move_while_their_foot_is_in_the_air(motion: Motion) -> None:
    changes = floor_changes(motion, Disturbances.read({"ground_leg_1": 0.01}, motion))
    moved = [(sample, side, height) for sample, entries in changes.items() for side, height in entries]
    assert len(moved) == len(motion.footsteps)
    assert sum(height for *_, height in moved) == 0.01
    for sample, side, _ in moved:
        assert motion.foot(side)[sample, 2] > 0.03
        assert motion.support[sample] == -side


@pytest.mark.parametrize("height", [0.008, -0.008])
def test_a_foot_lands_on_its_own_ground(motion: Motion, robot: Robot, height: float) -> None:
    """The first step: the foot touches down earlier on higher ground, and comes to rest at its height."""
    landing, side = motion.footsteps.time[0], motion.footsteps.side[0]
    touch_down = round(landing / motion.dt)
    part = samples_of(motion, np.arange(touch_down + (10 if height > 0.0 else 60)))
    run = simulate(part, robot=robot, obstacle=False, actuators="limited", perturb={"ground_1": height})
    assert side == -1.0
    series = run.series
    loaded = np.flatnonzero(series.right_wrench[touch_down - 60 :, 2] > 20.0)[0] + touch_down - 60
    assert (loaded < touch_down - 5) if height > 0.0 else (loaded > touch_down + 2)
    assert series.right_foot[loaded + 3, 2] == pytest.approx(height, abs=0.003)
    assert abs(series.left_foot[loaded - 20, 2]) < 1e-3, "the other foot's floor stays"


def test_senses_read_the_truth(motion: Motion, robot: Robot) -> None:
    force = np.array([30.0, -20.0, 280.0])
    place = np.array([0.02, 0.1, 0.0])
    touch = Touch(np.array([[*force, *np.cross(place, force)], np.zeros(6)]), np.zeros(6), set(), {})
    reading = sensed(motion, robot, NONE, touch)
    np.testing.assert_allclose(reading.joints, motion.q[0, 7:], atol=1e-12)
    np.testing.assert_allclose(np.abs(reading.attitude[3]), 1.0, atol=1e-12)
    np.testing.assert_allclose(reading.rate, 0.0, atol=1e-12)
    ankle = motion.left_foot[0, :3] + [0.0, 0.0, robot.foot.ankle_height]
    np.testing.assert_allclose(reading.left_wrench, [*force, *np.cross(place - ankle, force)], atol=1e-3)
    np.testing.assert_allclose(reading.right_wrench, 0.0, atol=1e-12)


def test_wrenches_are_in_the_ankles_axes(motion: Motion, robot: Robot) -> None:
    q = motion.q[0].copy()
    q[3:7] = [0.0, 0.0, np.sin(np.pi / 4.0), np.cos(np.pi / 4.0)]  # turned left by 90 degrees
    touch = Touch(np.array([[10.0, 0.0, 0.0, 0.0, 0.0, 0.0], np.zeros(6)]), np.zeros(6), set(), {})
    with World(Scene(robot)) as world:
        world.reset(q)
        senses = Senses(world, motion.dt)
        senses.read(touch)
    np.testing.assert_allclose(senses.late(0.0).left_wrench[:3], [0.0, -10.0, 0.0], atol=1e-3)


def test_noise_is_seeded_and_as_large_as_said(motion: Motion, robot: Robot) -> None:
    values = {"noise_joints": 0.001, "noise_attitude": 0.1, "noise_rate": 0.01, "noise_force": 2.0, "noise_moment": 0.3}
    first, again = (sensed(motion, robot, Disturbances.read(values, motion)) for _ in range(2))
    other = sensed(motion, robot, Disturbances.read({**values, "seed": 7}, motion))
    for name in ("joints", "attitude", "rate", "left_wrench", "right_wrench"):
        np.testing.assert_array_equal(getattr(first, name), getattr(again, name))
        assert not np.array_equal(getattr(first, name), getattr(other, name))
    with World(Scene(robot, disturbances=Disturbances.read(values, motion))) as world:
        world.reset(motion.q[0])
        senses = Senses(world, motion.dt)
        many = []
        for _ in range(100):
            senses.read(NOTHING)
            many.append(senses.late(0.0))
    assert np.std([r.joints - motion.q[0, 7:] for r in many]) == pytest.approx(0.001, rel=0.1)
    assert np.std([2.0 * r.attitude[:3] for r in many]) == pytest.approx(np.radians(0.1), rel=0.2)
    assert np.std([r.rate for r in many]) == pytest.approx(0.01, rel=0.2)
    assert np.std([r.left_wrench[:3] for r in many]) == pytest.approx(2.0, rel=0.2)
    assert np.std([r.right_wrench[3:] for r in many]) == pytest.approx(0.3, rel=0.2)


@pytest.mark.parametrize(("latency", "expected"), [(0.0, 2.0), (0.005, 1.0), (0.0025, 1.5), (0.004, 1.2), (0.05, 0.0)])
def test_readings_are_as_old_as_said(motion: Motion, robot: Robot, latency: float, expected: float) -> None:
    """Readings 0, 1, 2, 3 of the neck; one period old they are of 2."""
    disturbances = Disturbances.read({"latency": latency}, motion)
    q = motion.q[0].copy()
    with World(Scene(robot, disturbances=disturbances)) as world:
        senses = Senses(world, motion.dt)
        for angle in range(4):
            q[robot.body.column("HEAD_JOINT0")] = 0.1 * angle
            world.reset(q)
            senses.read(NOTHING)
    found = senses.late(motion.dt)
    assert found.joints[robot.body.column("HEAD_JOINT0") - 7] == pytest.approx(0.1 * expected, abs=1e-9)
    assert np.linalg.norm(found.attitude) == pytest.approx(1.0)
