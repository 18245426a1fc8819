"""Engines: what every one must keep, and the registry that finds them. The standing robot against its weight."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from stepover import simulation
from stepover.errors import InvalidInput, StepOverError
from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.robots.loading import load_robot
from stepover.simulation.engine import FLOOR, NO_CONTACTS, NO_FOOT, Contacts, Engine, Scene, engine_named
from stepover.simulation.pybullet import world as pybullet_world
from stepover.simulation.pybullet.client import pybullet
from stepover.simulation.run import simulate
from stepover.simulation.touch import summed_up

ENGINES = ["pybullet", "mujoco"]


@pytest.fixture(params=ENGINES)
def engine(request: pytest.FixtureRequest, robot: Robot) -> Iterator[Engine]:
    """A world with the robot in half-sitting, between two obstacles."""
    rows = np.array([0.5, 0.05, 0.15]), np.array([-0.6, 0.1, 0.2])
    with engine_named(request.param)(Scene(robot, rows)) as world:
        world.reset(robot.half_sitting())
        yield world


def stand(engine: Engine, steps: int) -> Contacts:
    """Hold the posture: the contacts of all steps."""
    angles = engine.joints()[0]
    for _ in range(steps):
        engine.command(angles, angles, np.zeros(len(angles)))
        engine.step()
    return engine.contacts()


def test_it_begins_where_it_is_put_and_at_rest(engine: Engine, robot: Robot) -> None:
    q = robot.half_sitting()
    np.testing.assert_allclose(engine.base_pose(), q[:7], atol=1e-12)
    angles, speeds = engine.joints()
    np.testing.assert_allclose(angles, q[7:], atol=1e-12)
    assert not speeds.any()
    turn, rate = engine.imu()
    np.testing.assert_allclose(turn, q[3:7], atol=1e-12)
    assert not rate.any()
    placed = robot.body.placements(q[None])
    for foot, side in enumerate((1, -1)):
        joint = robot.body.index(robot.leg(side).joints[-1])
        place, axes = engine.ankle(foot)
        np.testing.assert_allclose(place, placed.positions[0, joint], atol=1e-6)
        np.testing.assert_allclose(axes, placed.rotations[0, joint], atol=1e-6)
    assert engine.bush_depth == 0.0
    assert not engine.bush().any()
    assert not engine.torque.any()


def test_the_soles_bear_the_weight_as_contacts(engine: Engine, robot: Robot) -> None:
    stand(engine, 200)
    contacts, steps = stand(engine, 200), range(200)
    assert set(contacts.step.tolist()) == set(steps), "counted from the last call"
    assert set(contacts.touched.tolist()) == {FLOOR}
    each = [np.mean([contacts.floor_force(foot, step) for step in steps], axis=0) for foot in (0, 1)]
    force = each[0] + each[1]
    np.testing.assert_allclose(force, [0.0, 0.0, robot.body.mass * 9.81], rtol=5e-3, atol=1.0)
    assert np.abs(contacts.position[:, 2]).max() < 1e-3
    for foot, name in enumerate(("LLEG_LINK5", "RLEG_LINK5")):
        mine = contacts.foot == foot
        assert {engine.links[link] for link in contacts.link[mine]} == {name}
        assert (np.sign(contacts.position[mine, 1]) == (1.0, -1.0)[foot]).all()
        assert each[foot][2] > 0.4 * force[2]
    touch = summed_up(contacts, engine.links, len(steps))
    np.testing.assert_allclose(touch.total[:3], force, atol=1e-9)
    zmp = np.array([-touch.total[4], touch.total[3]]) / touch.total[2]
    com = robot.body.com(robot.body.placements(robot.half_sitting()[None]))[0, :2]
    np.testing.assert_allclose(zmp, com, atol=3e-3, err_msg="a moment about the world's origin")
    assert (touch.others, touch.obstacle) == (set(), {})


@pytest.mark.parametrize(("x", "number"), [(0.5, 0), (-0.6, 1)])
def test_each_obstacle_is_touched_by_its_number(engine: Engine, robot: Robot, x: float, number: int) -> None:
    q = robot.half_sitting()
    q[0] += x
    engine.reset(q)
    contacts = stand(engine, 1)
    on_obstacle = contacts.touched != FLOOR
    assert set(contacts.touched[on_obstacle].tolist()) == {number}
    assert (contacts.depth[on_obstacle] >= 0.0).all()
    assert contacts.depth[on_obstacle].max() > 0.005
    touch = summed_up(contacts, engine.links, 1)
    assert {"LLEG_LINK5", "RLEG_LINK5"} <= set(touch.obstacle)
    assert max(touch.obstacle.values()) == contacts.depth[on_obstacle].max()


def test_a_push_gives_its_impulse(engine: Engine, robot: Robot) -> None:
    q = robot.half_sitting()
    q[2] += 1.0
    engine.reset(q)
    before = engine.base_pose()[:3]
    for _ in range(50):
        engine.push(np.array([0.0, 200.0, 0.0]))
        stand(engine, 1)
    moved = engine.base_pose()[:3] - before
    fallen = 9.81 * 0.05**2 / 2.0
    assert moved[2] == pytest.approx(-fallen, rel=0.1)
    assert moved[1] == pytest.approx(200.0 / robot.body.mass * 0.05**2 / 2.0, rel=0.3), "it turns a little as well"
    assert len(engine.contacts().link) == 0
    assert summed_up(NO_CONTACTS, engine.links, 1).others == set()


def test_the_floor_of_a_foot_moves_alone(engine: Engine) -> None:
    engine.set_ground(0, -0.02)
    contacts = stand(engine, 5)
    assert set(contacts.foot.tolist()) == {1}, "the left foot hangs over its own floor"
    engine.set_ground(0, 0.0)
    assert {0, 1} <= set(stand(engine, 50).foot.tolist())


def test_links_that_are_no_feet_are_told_apart() -> None:
    two = np.array([3, 5])
    contacts = Contacts(
        0 * two, two, np.array([NO_FOOT, 1]), np.array([FLOOR, FLOOR]), np.eye(3)[:2], np.eye(3)[1:], two / 1e3
    )
    touch = summed_up(contacts, tuple("abcdef"), 1)
    assert touch.others == {"d"}
    np.testing.assert_array_equal(touch.feet, [np.zeros(6), [0.0, 0.0, 1.0, 1.0, 0.0, 0.0]])
    np.testing.assert_array_equal(touch.total[:3], [0.0, 1.0, 1.0])


def test_unknown_engines_are_refused(motion: Motion) -> None:
    with pytest.raises(InvalidInput, match="engine = 'bullet' is not available; available: pybullet"):
        simulate(motion, engine="bullet")


def test_a_missing_library_is_named_with_its_extra(motion: Motion, tmp_path: Path) -> None:
    motion.save(tmp_path / "m.npz")
    code = (
        "import sys; sys.modules['pybullet'] = None\n"
        "from stepover import InvalidInput, Motion, simulate\n"
        f"try:\n    simulate(Motion.load({str(tmp_path / 'm.npz')!r}))\n"
        "except InvalidInput as error:\n    print(error)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "simulate needs PyBullet: pip install 'stepover[pybullet]', or take --engine mujoco\n"


@pytest.mark.parametrize("name", ENGINES)
def test_a_robot_that_weighs_something_else_is_refused(name: str) -> None:
    robot = load_robot("hrp2")
    robot.body.mass *= 1.1
    with pytest.raises(InvalidInput, match=r"hrp2\.urdf weighs 57\.999 kg in \w+ and 63\.\d+ kg in pinocchio"):
        engine_named(name)(Scene(robot))


def test_an_unstable_simulation_ends_in_one_line(robot: Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with engine_named("mujoco")(Scene(robot)) as world:
        world.reset(robot.half_sitting())
        world.push(np.array([np.inf, 0.0, 0.0]))
        with pytest.raises(StepOverError, match="MuJoCo cannot integrate this"):
            stand(world, 2)
    assert list(tmp_path.iterdir()) == [], "no log file"


@pytest.mark.parametrize("fails", ["surroundings", "mass"])
def test_a_world_that_fails_half_way_closes_its_client(fails: str, monkeypatch: pytest.MonkeyPatch) -> None:
    robot, opened = load_robot("hrp2"), []
    connect = pybullet.connect

    def counted(kind: int) -> int:
        opened.append(connect(kind))
        return opened[-1]

    monkeypatch.setattr(pybullet, "connect", counted)
    if fails == "surroundings":
        monkeypatch.setattr(pybullet_world, "Surroundings", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
    else:
        robot.body.mass *= 1.1
    with pytest.raises((KeyboardInterrupt, InvalidInput), match=r"weighs|^$"):
        engine_named("pybullet")(Scene(robot))
    assert len(opened) == 1
    assert not pybullet.isConnected(opened[0])


def test_nothing_else_in_the_simulation_knows_an_engine() -> None:
    folder = Path(simulation.__file__).parent
    for path in folder.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import | ast.ImportFrom):
                assert "pybullet" not in ast.unparse(node), path.name
