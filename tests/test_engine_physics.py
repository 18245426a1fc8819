"""Every engine against mechanics that can be written down: falls, friction, springs, impulses, and who bears what."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.special import ellipk

from stepover.model.body import Body
from stepover.model.description.corners import corners_of
from stepover.model.description.links import BOX, ORIGIN, SPHERE, Description, Hinge, Inertia, Link, Place, Solid
from stepover.model.gravity import GRAVITY
from stepover.model.parameters.physics import Servo, Simulation, SoleRubber
from stepover.model.robot import Robot
from stepover.simulation.disturbances import NONE, Disturbances
from stepover.simulation.engine import Engine, Scene, engine_named

ENGINES = ["pybullet", "mujoco"]
DT = Simulation.time_step
SIDE, BASE, BOB, LENGTH = 0.4, 40.0, 0.5, 0.3
"""The toy: side [m] and mass [kg] of its box; mass [kg] and length [m] of each of its two pendulums."""
BOB_INERTIA = 0.01
"""Of each pendulum's bob about its centre, about every axis [kg m^2]."""
TOY_MASS = BASE + 2.0 * BOB


@pytest.fixture(params=ENGINES)
def engine(request: pytest.FixtureRequest) -> str:
    """The name of an engine."""
    return str(request.param)


def toy(
    axis: tuple[float, float, float] = (0.0, 1.0, 0.0), servo: Servo | None = None, balls: bool = False
) -> SimpleNamespace:
    """A box with a pendulum on each side, which hangs at angle 0; as much of a robot as an engine needs.

    With balls, it stands on four of them, at its lower corners, instead of its underside.
    """
    ball, half = BASE * SIDE**2 / 6.0, SIDE / 2.0
    corners = half * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    box = Solid(BOX, (SIDE, SIDE, SIDE), ORIGIN, corners, "box")
    solids = [box]
    if balls:
        radius = 0.05
        raised = corners[corners[:, 2] < 0.0] + [0.0, 0.0, radius]
        solids = [
            Solid(SPHERE, (radius,), Place(np.eye(3), place), corners_of(SPHERE, (radius,)), "ball") for place in raised
        ]
    links = [Link("base", Inertia(BASE, np.zeros(3), ball * np.eye(3)), tuple(solids))]
    joints = []
    for name, y in (("left", 1.0), ("right", -1.0)):
        place = Place(np.eye(3), np.array([0.0, y * (half + 0.1), half]))
        bob = Inertia(BOB, np.array([0.0, 0.0, -LENGTH]), BOB_INERTIA * np.eye(3))
        joints.append(Hinge(name, "base", f"{name} bob", place, np.array(axis), -3.0, 3.0, 100.0, 1000.0))
        links.append(Link(f"{name} bob", bob))
    description = Description("toy", tuple(links), tuple(joints))
    legs = SimpleNamespace(left=("left",), right=("right",))
    foot = SimpleNamespace(ankle_height=LENGTH)
    return SimpleNamespace(
        description=description, body=Body(description), legs=legs, foot=foot, simulation=Simulation(),
        servo=servo or Servo(), sole=SoleRubber(), contact_patch=lambda side: np.zeros((4, 2)),
        leg=lambda side: SimpleNamespace(joints=legs.left if side > 0 else legs.right),
    )  # fmt: skip


@contextmanager
def world(
    name: str, robot: SimpleNamespace | Robot, height: float, disturbances: Disturbances = NONE, **how: Any
) -> Iterator[Engine]:
    """A world with the toy at rest, its box's underside at a height [m]; or a robot at its half-sitting."""
    q = np.zeros(7 + len(robot.body.joint_names))
    q[2], q[6] = height + SIDE / 2.0, 1.0
    if isinstance(robot, Robot):
        q = robot.half_sitting()
        q[2] += height
    with engine_named(name)(Scene(robot, disturbances=disturbances, **how)) as built:  # type: ignore[arg-type]
        built.reset(q)
        yield built


def hold(
    engine: Engine, duration: float, push: tuple[float, ...] | None = None, goal: np.ndarray | None = None
) -> np.ndarray:
    """Let the motors keep angles, those of now by default, for a duration [s]: poses (S + 1, 7) of the base."""
    goal = engine.joints()[0] if goal is None else goal
    poses = [engine.base_pose()]
    for _ in range(round(duration / DT)):
        engine.command(goal, goal, 0.0 * goal)
        if push is not None:
            engine.push(np.array(push))
        engine.step()
        poses.append(engine.base_pose())
    return np.array(poses)


def borne(engine: Engine, duration: float) -> tuple[np.ndarray, np.ndarray]:
    """Mean force (3,) [N] of the floor on the robot while it keeps its angles, and the ZMP (2,) [m]."""
    engine.contacts()
    hold(engine, duration)
    contacts, steps = engine.contacts(), round(duration / DT)
    force = contacts.force.sum(axis=0) / steps
    zmp = (contacts.force[:, 2:] * contacts.position[:, :2]).sum(axis=0) / contacts.force[:, 2].sum()
    return force, zmp


def test_a_box_falls_and_lies(engine: str) -> None:
    with world(engine, toy(), 0.5) as falling:
        heights = hold(falling, 0.3)[:, 2] - SIDE / 2.0
        np.testing.assert_allclose(heights[-1], 0.5 - GRAVITY * 0.3 * (0.3 + DT) / 2.0, atol=1e-6)
        hold(falling, 1.0)
        force, _ = borne(falling, 0.5)
        np.testing.assert_allclose(force, [0.0, 0.0, TOY_MASS * GRAVITY], rtol=2e-3, atol=0.5)
        assert abs(falling.base_pose()[2] - SIDE / 2.0) < 1e-3
        assert not falling.joints()[1].any() or np.abs(falling.joints()[1]).max() < 1e-2


@pytest.mark.parametrize("balls", [False, True], ids=["on its face", "on balls"])
def test_an_obstacle_pushes_up_whatever_lies_on_it(engine: str, balls: bool) -> None:
    """A box on a beam and balls on a beam: in MuJoCo's pairs, the ball comes before the beam, the box after it."""
    beam = np.array([-1.0, 2.0, 0.3])
    with world(engine, toy(balls=balls), 0.3, obstacles=(beam,)) as lying:
        hold(lying, 0.5)
        lying.contacts()
        hold(lying, 0.5)
        contacts = lying.contacts()
        assert (contacts.touched == 0).all()
        np.testing.assert_allclose(contacts.force.sum(axis=0) * DT / 0.5, [0.0, 0.0, TOY_MASS * GRAVITY], atol=2.0)
        assert abs(lying.base_pose()[2] - 0.3 - SIDE / 2.0) < 1e-3


def test_a_pendulum_keeps_its_energy_and_its_period(engine: str) -> None:
    """Without servos. The period of a large swing is an elliptic integral, and it comes back to where it began."""
    begin = 1.0
    free = toy(servo=Servo(leg_stiffness=1e-9, stiffness_per_torque=1e-9))
    with world(engine, free, 0.0, actuators="limited") as swinging:
        hold(swinging, 0.2)
        q = np.concatenate([swinging.base_pose(), [begin, -begin]])  # in step against each other, so the box stays
        swinging.reset(q)
        angles = []
        for _ in range(4000):
            swinging.command(q[7:], q[7:], 0.0 * q[7:])
            swinging.step()
            angles.append(swinging.joints()[0, 0])
    inertia = BOB * LENGTH**2 + BOB_INERTIA
    period = 4.0 * np.sqrt(inertia / (BOB * GRAVITY * LENGTH)) * ellipk(np.sin(begin / 2.0) ** 2)
    falling = np.flatnonzero((np.array(angles[:-1]) > 0.0) & (np.array(angles[1:]) <= 0.0))
    assert np.diff(falling).mean() * DT == pytest.approx(period, rel=3e-3)
    assert max(angles[-round(period / DT) :]) == pytest.approx(begin, rel=0.01)


@pytest.mark.parametrize(("slope", "sign"), [("slope_ahead", 1.0), ("slope_left", -1.0)])
def test_a_block_slides_where_friction_ends(engine: str, slope: str, sign: float) -> None:
    angle = np.radians(8.0)
    row = 0 if slope == "slope_ahead" else 1
    moved = {}
    for share in (0.9, 1.1):
        friction = share * np.tan(angle)
        disturbances = Disturbances(**{slope: sign * 8.0}, friction=friction)
        with world(engine, toy(), 0.0, disturbances) as sliding:
            way = hold(sliding, 1.0)[:, row]
        moved[share] = way[-1] - way[200] - 0.8 * (way[200] - way[199]) / DT
    downhill = -sign * GRAVITY * (np.sin(angle) - 0.9 * np.tan(angle) * np.cos(angle)) * 0.8**2 / 2.0
    assert moved[0.9] == pytest.approx(downhill, rel=0.03)
    assert abs(moved[1.1]) < 5e-4


def test_a_push_gives_its_impulse(engine: str) -> None:
    push, lasts, coasts = (30.0, -20.0, 50.0), 0.1, 0.2
    with world(engine, toy(), 2.0) as pushed:
        begin = hold(pushed, lasts, push)[0]
        end = hold(pushed, coasts)[-1]
    speed = np.array(push) * lasts / TOY_MASS
    moved = speed * (lasts + DT) / 2.0 + speed * coasts
    moved[2] -= GRAVITY * (lasts + coasts) * (lasts + coasts + DT) / 2.0
    np.testing.assert_allclose(end[:3] - begin[:3], moved, rtol=0.02, atol=1e-4)


def test_a_servo_steps_as_spring_and_damper(engine: str) -> None:
    """On a vertical axis, which gravity does not turn: a damped oscillation to the goal."""
    stiffness, damping_time, goal = 5.0, 0.02, 0.2
    servo = Servo(leg_stiffness=stiffness, damping_time=damping_time)
    with world(engine, toy((0.0, 0.0, 1.0), servo), 0.0, actuators="limited") as stepping:
        found = []
        for _ in range(800):
            stepping.command(*np.array([[goal, -goal], [goal, -goal], [0.0, 0.0]]))
            stepping.step()
            found.append([*stepping.joints()[0], *stepping.torque])
    left, right, torque, _ = np.array(found).T
    time, decay = DT * np.arange(1, 801), stiffness * damping_time / (2.0 * BOB_INERTIA)
    turns = np.sqrt(stiffness / BOB_INERTIA - decay**2 + 0.0j)
    wanted = goal * (1.0 - np.exp(-decay * time) * (np.cos(turns * time) + decay / turns * np.sin(turns * time))).real
    np.testing.assert_allclose(left, wanted, atol=0.025 * goal)
    np.testing.assert_allclose(right, -left, atol=1e-3 * goal)
    assert torque[0] == pytest.approx(stiffness * goal, rel=0.2)
    assert abs(torque[-1]) < 0.02 * stiffness * goal


def test_the_soles_bear_the_weight_below_the_centre_of_mass(engine: str, robot: Robot) -> None:
    with world(engine, robot, 0.0) as standing:
        hold(standing, 0.3)
        force, zmp = borne(standing, 0.2)
    com = robot.body.com(robot.body.placements(robot.half_sitting()[None]))[0]
    np.testing.assert_allclose(force, [0.0, 0.0, robot.body.mass * GRAVITY], rtol=5e-3, atol=1.0)
    np.testing.assert_allclose(zmp, com[:2], atol=2e-3)


@pytest.mark.parametrize(("slope", "row"), [("slope_ahead", 0), ("slope_left", 1)])
def test_the_zmp_of_a_static_lean(engine: str, robot: Robot, slope: str, row: int) -> None:
    """On a slope the weight bears on the floor where the plumb line from the centre of mass meets it."""
    with world(engine, robot, 0.0, Disturbances(**{slope: 3.0})) as leaning:
        hold(leaning, 0.3)
        force, zmp = borne(leaning, 0.2)
    com = robot.body.com(robot.body.placements(robot.half_sitting()[None]))[0]
    wanted = com[:2] - com[2] * np.tan(np.radians(3.0)) * np.eye(2)[row]
    np.testing.assert_allclose(zmp, wanted, atol=3e-3)
    assert force[row] == pytest.approx(robot.body.mass * GRAVITY * np.sin(np.radians(3.0)), rel=0.03)


def test_rubber_gives_way_by_force_over_stiffness(engine: str, robot: Robot) -> None:
    soft = replace(robot, sole=replace(robot.sole, vertical_stiffness=30e3, tilt_stiffness=900.0))
    downhill = Disturbances(slope_ahead=-1.5)  # so that the soles tilt
    with world(engine, soft, 0.0, downhill, sole="compliant", actuators="limited") as sinking:
        goal = sinking.joints()[0]
        hold(sinking, 1.2)
        sinking.contacts()
        bush = np.array([(hold(sinking, DT, goal=goal), sinking.bush())[1] for _ in range(200)])
        contacts, ankles = sinking.contacts(), [sinking.ankle(foot)[0] for foot in (0, 1)]
    plate = (soft.sole.mass + soft.sole.bush_mass) * GRAVITY  # what is below the spring
    mean, rate = bush.mean(axis=0), (bush[-1] - bush[0]) / (199.0 * DT)
    for foot, (up, _, pitch) in enumerate(mean.reshape(2, 3)):
        mine = contacts.foot == foot
        force, lever = contacts.force[mine], contacts.position[mine] - ankles[foot] + [0.0, 0.0, sinking.bush_depth]
        pressing = 30e3 * up + soft.sole.vertical_damping * rate[3 * foot]
        assert pressing == pytest.approx(force[:, 2].sum() / 200.0 - plate, rel=5e-3)
        moment = (lever[:, 2] * force[:, 0] - lever[:, 0] * force[:, 2]).sum() / 200.0
        turning = 900.0 * pitch + soft.sole.tilt_damping * rate[3 * foot + 2]
        assert turning == pytest.approx(moment, rel=0.05)
        assert moment < -3.0
    assert mean[[0, 3]].sum() == pytest.approx((soft.body.mass * GRAVITY - 2.0 * plate) / 30e3, rel=5e-3)
