"""Servos and rubber: static deflections, limits, frequencies, and that they stay calm."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from still import samples_of, standing

from stepover.errors import InvalidInput
from stepover.model.description.urdf_text import urdf_text
from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.robots.loading import load_robot
from stepover.simulation.disturbances import NONE
from stepover.simulation.engine import Scene
from stepover.simulation.pybullet.motors import Servos
from stepover.simulation.pybullet.world import World, pybullet
from stepover.simulation.run import simulate
from stepover.simulation.servos import springs, within_limits
from stepover.simulation.simulated import simulated_robot
from stepover.simulation.soles import BUSH, plate, with_plate_shapes, with_plates
from stepover.simulation.trajectory import straight

DT = 0.001


@contextmanager
def hung_up(robot: Robot, sole: str = "rigid", limited: bool = True) -> Iterator[tuple[World, np.ndarray]]:
    """A world in which the robot hangs by its waist, a metre above its place, with servos in its joints."""
    q = robot.half_sitting()
    q[2] += 1.0
    scene = Scene(robot, actuators="limited" if limited else "ideal", sole=sole)
    with World(scene) as world:
        if not limited:
            world.motors = Servos(scene, world.robot, simulated_robot(robot, "rigid", NONE))
        world.reset(q)
        number = world.robot.number
        place = pybullet.getBasePositionAndOrientation(number, world.client)
        pybullet.createConstraint(
            number, -1, -1, -1, pybullet.JOINT_FIXED, (0, 0, 0), (0, 0, 0), place[0], (0, 0, 0, 1), place[1],
            physicsClientId=world.client,
        )  # fmt: skip
        yield world, q


def go(world: World, goal: np.ndarray, steps: int, start: np.ndarray | None = None) -> np.ndarray:
    """Angles (steps, 2, J) and speeds of all joints on the way to angles, which are held unless there is a start."""
    found = []
    for target in straight(goal if start is None else start, goal, steps, DT * steps):
        world.command(*target)
        world.step()
        found.append(world.robot.joint_motion(world.robot.joints + world.robot.passive))
    return np.array(found)


def test_gains_are_those_of_robot_toml(robot: Robot) -> None:
    stiffness, damping = springs(robot, 2)
    knee, elbow = (robot.body.column(joint) - 7 for joint in ("RLEG_JOINT3", "RARM_JOINT3"))
    assert (stiffness[knee], damping[knee]) == (4000.0, pytest.approx(60.0))
    assert stiffness[elbow] == pytest.approx(40.0 * robot.body.effort_limits[elbow])
    assert stiffness[30:].tolist() == [40e3, 600.0, 600.0] * 2
    assert damping[30:].tolist() == [600.0, 60.0, 60.0] * 2


def test_a_servo_gives_way_by_torque_over_stiffness(motion: Motion, robot: Robot) -> None:
    run = simulate(standing(motion, 2.0), robot=robot, actuators="limited", obstacle=False)
    late = slice(300, None)
    error = (run.motion.q[late, 7:] - run.series.q[late, 7:]).mean(axis=0)
    torque = run.series.torque[late].mean(axis=0)
    stiffness, _ = springs(robot, 0)
    assert np.abs(torque).max() > 20.0, "the knees bear the weight"
    np.testing.assert_allclose(error * stiffness, torque, atol=0.4)


def test_a_servo_bears_what_hangs_on_it(robot: Robot) -> None:
    """Against the weight of the forearm that is computed by hand from the masses of the URDF."""
    with hung_up(robot) as (world, q):
        q[robot.body.column("LARM_JOINT3")] = np.radians(-90.0)
        world.reset(q)
        go(world, q[7:], 400)
        state = q.copy()
        state[7:] = world.joints()[0]
        torque = world.torque
    placed = robot.body.placements(state[None])
    elbow = robot.body.index("LARM_JOINT3")
    links = robot.body.model.inertias
    moment = np.zeros(3)
    for i in robot.body.beyond(["LARM_JOINT3"], 0):
        lever = placed.positions[0, i] + placed.rotations[0, i] @ links[i].lever - placed.positions[0, elbow]
        moment += links[i].mass * np.cross(lever, [0.0, 0.0, -9.81])
    axis = placed.rotations[0, elbow] @ [0.0, 1.0, 0.0]
    assert torque[robot.body.column("LARM_JOINT3") - 7] == pytest.approx(-moment @ axis, rel=0.02)
    assert abs(moment @ axis) > 2.0


@pytest.mark.parametrize("joint", ["RLEG_JOINT5", "LLEG_JOINT4", "LARM_JOINT6", "HEAD_JOINT1"])
def test_light_links_stay_calm(robot: Robot, joint: str) -> None:
    """Explicit torques would shake a free foot: its damping turns the velocity around within one step."""
    column = robot.body.column(joint) - 7
    with hung_up(robot) as (world, q):
        goal = q[7:].copy()
        goal[column] += 0.05
        angles = go(world, goal, 400)[:, 0, column]
    assert abs(angles[-1] - goal[column]) < 0.002
    assert angles.max() < goal[column] + 0.01
    assert np.abs(np.diff(angles[200:])).max() < 1e-5


def test_a_servo_keeps_pace(robot: Robot) -> None:
    column = robot.body.column("HEAD_JOINT0") - 7
    with hung_up(robot) as (world, q):
        begin, goal = q[7:].copy(), q[7:].copy()
        begin[column], goal[column] = -0.5, 0.5
        world.reset(np.concatenate([q[:7], begin]))
        angles = go(world, goal, 400, start=begin)[200:, 0, column]
    planned = np.linspace(-0.5, 0.5, 401)[201:]
    assert np.abs(angles - planned).max() < 0.3 * (planned[1] - planned[0]), "not a step behind"


def test_torques_end_at_the_limit(motion: Motion) -> None:
    weak = load_robot("hrp2")
    knee = weak.body.column("LLEG_JOINT3") - 7
    weak.body.effort_limits[knee] = 20.0
    run = simulate(standing(motion, 0.5), robot=weak, actuators="limited", obstacle=False)
    assert np.abs(run.series.torque[:, knee]).max() == pytest.approx(20.0)
    assert run.torque_ratio_max == pytest.approx(1.0)
    assert run.torque_saturated_samples["LLEG_JOINT3"] > 50
    assert run.series.q[-1, 7 + knee] > motion.q[0, 7 + knee] + 2.0 * 20.0 / 4000.0, "the knee gives way further"


@pytest.mark.parametrize("limited", [True, False])
def test_no_torque_drives_a_joint_beyond_its_speed_limit(robot: Robot, limited: bool) -> None:
    column = robot.body.column("HEAD_JOINT0") - 7
    with hung_up(robot, limited=limited) as (world, q):
        begin, goal = q[7:].copy(), q[7:].copy()
        begin[column], goal[column] = -0.7, 0.7
        world.reset(np.concatenate([q[:7], begin]))
        way = go(world, goal, 100, start=begin)
    share = way[:, 1, column] / robot.body.speed_limits[column]
    if limited:
        assert np.diff(share[:4]).min() > 0.15, "it accelerates as long as it may"
        assert 0.99 < share.max() < 1.003, "and no further"
    else:
        assert share.max() > 1.8


def test_a_knee_at_its_speed_limit_keeps_its_speed(robot: Robot) -> None:
    """The fading torque is a stiff damper: taken from the beginning of a step, it would throw the speed about."""
    column = robot.body.column("LLEG_JOINT3") - 7
    with hung_up(robot) as (world, q):
        goal = q[7:].copy()
        goal[column] += 0.25 * robot.body.speed_limits[column]
        way = go(world, goal, 100, start=q[7:])
    share = way[6:20, 1, column] / robot.body.speed_limits[column]
    assert share.min() > 0.9
    assert share.max() < 1.0
    assert np.abs(np.diff(share)).max() < 0.02


def test_limits_are_those_of_the_side_that_accelerates(robot: Robot) -> None:
    wanted, limit, fast = np.full(30, 1e4), robot.body.effort_limits, robot.body.speed_limits
    np.testing.assert_allclose(within_limits(robot, wanted, 0.0 * fast), limit)
    np.testing.assert_allclose(within_limits(robot, wanted, fast), 0.0)
    np.testing.assert_allclose(within_limits(robot, -wanted, fast), -limit, err_msg="it may brake")
    np.testing.assert_allclose(within_limits(robot, wanted, (1.0 - 0.5 * robot.servo.speed_fade) * fast), 0.5 * limit)


def test_the_bush_sinks_under_the_weight_and_tilts_under_a_moment(motion: Motion, robot: Robot) -> None:
    ahead = standing(motion, 3.0)
    run = simulate(ahead, robot=robot, sole="compliant", actuators="limited", obstacle=False)
    late = slice(300, None)
    bush, series = run.series.bush[late].mean(axis=0), run.series
    for wrench, deflection, sole in (
        (series.left_wrench, bush[:3], series.left_foot), (series.right_wrench, bush[3:], series.right_foot)
    ):  # fmt: skip
        force, moment = wrench[late, :3].mean(axis=0), wrench[late, 3:].mean(axis=0)
        here = sole[late, :3].mean(axis=0) + np.array([0.0, 0.0, 0.03])
        about = moment - np.cross(here, force)
        assert deflection[0] == pytest.approx(force[2] / robot.sole.vertical_stiffness, rel=0.02)
        assert deflection[1:] * robot.sole.tilt_stiffness == pytest.approx(about[:2], abs=0.25)
    waist = series.q[late, 2].mean()
    assert waist == pytest.approx(motion.waist[0, 2] - 0.0071, abs=0.0015)
    assert series.left_foot[late, 2] == pytest.approx(0.0, abs=5e-4), "the sole beyond the rubber stays on the floor"


def test_a_free_sole_swings_as_its_spring_says(robot: Robot) -> None:
    """The plate of a hanging foot, pushed up: damped oscillation of its mass on the rubber."""
    soft = replace(robot, sole=replace(robot.sole, vertical_damping=8.0))
    with hung_up(soft, "compliant") as (world, q):
        pybullet.resetJointState(world.robot.number, world.robot.passive[0], 0.003, 0.0, world.client)
        lift = go(world, q[7:], 120)[:, 0, 30]
    mass = soft.sole.mass + 2.0 * soft.sole.bush_mass
    lift = lift - lift[-20:].mean()
    crossings = np.flatnonzero(np.diff(np.sign(lift[:60])))
    assert np.pi / np.diff(crossings).mean() / DT == pytest.approx(np.sqrt(40e3 / mass), rel=0.12)
    assert abs(lift[60:]).max() < 0.3 * abs(lift[:20]).max()


def test_on_rubber_the_robot_begins_where_its_weight_presses_it(motion: Motion, robot: Robot) -> None:
    run = simulate(standing(motion, 0.05), robot=robot, sole="compliant", actuators="limited", obstacle=False)
    force = (run.series.left_wrench + run.series.right_wrench)[2:, 2]  # servos begin without torque
    assert run.series.bush[0, [0, 3]] == pytest.approx(58.0 * 9.81 / 2.0 / 40e3, rel=1e-3)
    assert run.series.left_foot[0, 2] == pytest.approx(0.0, abs=1e-6)
    np.testing.assert_allclose(force, robot.body.mass * 9.81, rtol=0.15)


def test_the_bush_is_stiff_to_what_is_stiff(motion: Motion, robot: Robot) -> None:
    stiff = replace(robot, sole=replace(robot.sole, vertical_stiffness=4e6, tilt_stiffness=6e4))
    still = standing(motion, 0.5)
    soft, rigid = (
        simulate(still, robot=stiff, actuators="limited", sole=sole, obstacle=False) for sole in ("compliant", "rigid")
    )
    np.testing.assert_allclose(soft.series.q[:, :3], rigid.series.q[:, :3], atol=1.5e-3)


def test_foot_parts_make_up_the_foot(robot: Robot) -> None:
    soft_robot = simulated_robot(robot, "compliant", NONE)
    model = pin.buildModelFromXML(urdf_text(soft_robot.description), pin.JointModelFreeFlyer())
    whole = robot.body.model
    assert model.nv == whole.nv + 6
    rest, soft = (pin.crba(m, m.createData(), pin.neutral(m))[:6, :6] for m in (whole, model))
    np.testing.assert_allclose(soft, rest, atol=1e-12)
    assert soft_robot.passive == tuple(f"{foot}_{part}" for foot in ("LLEG_LINK5", "RLEG_LINK5") for part in BUSH)
    assert soft_robot.bush_depth == pytest.approx(0.075)


def test_a_plate_that_is_too_heavy_is_refused(robot: Robot) -> None:
    with pytest.raises(InvalidInput, match=r"sole\.mass"):
        simulated_robot(replace(robot, sole=replace(robot.sole, mass=1.6)), "compliant", NONE)


def test_soft_feet_carry_their_shapes_with_them(robot: Robot) -> None:
    q = robot.half_sitting()[None]
    placed = with_plates(robot, robot.body.placements(q), np.array([[0.01, 0.0, 0.1, 0.0, 0.0, 0.0]]), 0.075)
    shapes = with_plate_shapes(robot)
    moved = [new for new, old in zip(shapes, robot.shapes, strict=True) if new.joint != old.joint]
    assert {(shape.link, shape.joint) for shape in moved} == {
        ("LLEG_LINK5", plate(robot, 1)),
        ("RLEG_LINK5", plate(robot, -1)),
    }
    left, right = (
        placed.positions[0, plate(robot, side)] + placed.rotations[0, plate(robot, side)] @ [0.0, 0.0, -0.105]
        for side in (1, -1)
    )
    assert right[2] == pytest.approx(0.0, abs=1e-6)
    assert left[2] == pytest.approx(0.01 + 0.03 * (1.0 - np.cos(0.1)), abs=1e-6), "up, and turned about the bush"
    assert left[0] - right[0] == pytest.approx(-0.03 * np.sin(0.1), abs=1e-6), "pitched toe down: the sole goes back"


def test_ideal_motors_on_rubber_hold_still(motion: Motion, robot: Robot) -> None:
    run = simulate(standing(motion, 1.5), robot=robot, sole="compliant", obstacle=False)
    assert np.abs(run.series.q[:, 7:] - run.motion.q[:, 7:]).max() < 0.005
    assert np.abs(run.series.q[-60:, 0] - run.motion.q[-60:, 0]).max() < 0.01


@pytest.mark.parametrize("options", [{"actuators": "limited"}, {"actuators": "limited", "sole": "compliant"}])
def test_runs_are_equal_to_the_bit(motion: Motion, robot: Robot, options: dict) -> None:
    part = samples_of(motion, np.arange(360, 480))
    first, second = (simulate(part, robot=robot, **options) for _ in range(2))
    assert first.state_hash == second.state_hash
    assert first.state_hash != simulate(part, robot=robot).state_hash


def test_faster_than_time(motion: Motion, robot: Robot) -> None:
    run = simulate(standing(motion, 1.0), robot=robot, actuators="limited", sole="compliant", obstacle=False)
    assert run.realtime_factor > 0.2, "on a loaded core; about 3 on a free one"
