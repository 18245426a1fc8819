"""model/body.py: forward kinematics, CoM, derivatives and the multi-body ZMP, each against an independent oracle."""

from __future__ import annotations

import shutil
from itertools import pairwise

import numpy as np
import pinocchio as pin
import pytest
from conftest import HRP2, random_q
from scipy.spatial.transform import Rotation

from stepover import InvalidInput
from stepover.model import pose
from stepover.model.body import Body
from stepover.model.kinematics import axis_rotation
from stepover.robots.urdf import read_urdf

G = 9.81
BRICK = """<robot name="brick"><link name="BRICK"><inertial><origin xyz="{lever}"/><mass value="7"/>
<inertia ixx="0.3" iyy="0.2" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


def waving(model: pin.Model, count: int, dt: float, seed: int = 0) -> np.ndarray:
    """A smooth motion (count, nq) of everything: the root travels and turns about all axes, every joint waves."""
    rng = np.random.default_rng(seed)
    time = np.arange(count) * dt

    def waves(size: float, width: int) -> np.ndarray:
        phases, speeds = rng.uniform(0.0, 6.0, width), rng.uniform(2.0, 6.0, width)
        return size * np.sin(phases + np.outer(time, speeds))

    turn = Rotation.from_euler("ZYX", waves(0.5, 3)).as_quat()
    return np.column_stack([waves(0.1, 3) + np.array([0.3, -0.2, 0.7]), turn, waves(0.6, model.nq - 7)])


def momenta(model: pin.Model, q: np.ndarray, dt: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """CoM, linear and angular momentum about the world's origin, from nothing but the places of the links.

    Velocities are central differences of positions and rotations of each link, on the samples 1 ... N - 2.
    """
    data = model.createData()
    places = []
    for sample in q:
        pin.forwardKinematics(model, data, sample)
        places.append([data.oMi[j].homogeneous for j in range(1, model.njoints)])
    places = np.array(places)
    masses = np.array([i.mass for i in model.inertias])[1:]
    levers = np.array([i.lever for i in model.inertias])[1:]
    inertias = np.array([i.inertia for i in model.inertias])[1:]
    turns = places[:, :, :3, :3]
    centres = places[:, :, :3, 3] + np.einsum("njab,jb->nja", turns, levers)
    speeds = (centres[2:] - centres[:-2]) / (2.0 * dt)
    step = turns[2:] @ np.swapaxes(turns[:-2], 2, 3)
    rates = Rotation.from_matrix(step.reshape(-1, 3, 3)).as_rotvec().reshape(speeds.shape) / (2.0 * dt)
    middle = turns[1:-1]
    spin = np.einsum("njab,jbc,njdc,njd->nja", middle, inertias, middle, rates)
    linear = np.einsum("j,nja->na", masses, speeds)
    angular = (np.cross(centres[1:-1], masses[:, None] * speeds) + spin).sum(axis=1)
    return np.einsum("j,nja->na", masses, centres[1:-1]) / masses.sum(), linear, angular


def zmp_from_momenta(model: pin.Model, q: np.ndarray, dt: float) -> np.ndarray:
    """ZMP of Eqs. (20) and (21), L about the world's origin, on the samples 2 ... N - 3."""
    com, linear, angular = momenta(model, q, dt)
    mass = pin.computeTotalMass(model)
    force = mass * G + (linear[2:, 2] - linear[:-2, 2]) / (2.0 * dt)
    rate = (angular[2:] - angular[:-2]) / (2.0 * dt)
    com = com[1:-1]
    return np.column_stack([mass * G * com[:, 0] - rate[:, 1], mass * G * com[:, 1] + rate[:, 0]]) / force[:, None]


@pytest.fixture
def brick(tmp_path):
    """One rigid body of 7 kg whose centre of mass is at a given place in its frame."""

    def make(lever: str = "0 0 0") -> Body:
        (tmp_path / "brick.urdf").write_text(BRICK.format(lever=lever))
        return Body(read_urdf(tmp_path / "brick.urdf")[0])

    return make


def test_com_is_pinocchios(robot, pin_model):
    q = random_q(pin_model, 20, seed=2)
    data = pin_model.createData()
    expected = [pin.centerOfMass(pin_model, data, sample) for sample in q]
    np.testing.assert_allclose(robot.body.com(robot.body.placements(q)), expected, atol=1e-12)


def test_axis_rotation_is_right_handed():
    axes = np.random.default_rng(5).normal(size=(5, 3))
    angles = np.linspace(-4.0, 4.0, 9)
    for axis in axes / np.linalg.norm(axes, axis=1, keepdims=True):
        expected = Rotation.from_rotvec(angles[:, None] * axis).as_matrix()
        np.testing.assert_allclose(axis_rotation(axis, angles), expected, atol=1e-12)


def test_velocities_and_accelerations_are_differences_on_the_manifold(robot, pin_model):
    dt, q = 0.005, waving(pin_model, 30, 0.005)
    steps = np.array([pin.difference(pin_model, a, b) for a, b in pairwise(q)])
    velocities, accelerations = robot.body.velocities(q, dt), robot.body.accelerations(q, dt)
    np.testing.assert_allclose(velocities[1:-1], (steps[1:] + steps[:-1]) / (2.0 * dt), atol=1e-9)
    np.testing.assert_allclose(accelerations[1:-1], (steps[1:] - steps[:-1]) / dt**2, atol=1e-7)
    np.testing.assert_allclose(velocities[[0, -1]], steps[[0, -1]] / dt, atol=1e-9)
    np.testing.assert_array_equal(accelerations[[0, -1]], 0.0)


def test_constant_velocity_is_found_again(robot, pin_model):
    dt = 0.005
    v = np.random.default_rng(7).normal(size=pin_model.nv)
    start = random_q(pin_model, 1, seed=8)[0]
    q = np.array([pin.integrate(pin_model, start, v * k * dt) for k in range(10)])
    np.testing.assert_allclose(robot.body.velocities(q, dt), np.tile(v, (10, 1)), atol=1e-9)
    np.testing.assert_allclose(robot.body.accelerations(q, dt), 0.0, atol=1e-6)


def test_velocity_of_the_root_is_in_its_own_frame(robot):
    q = np.tile(robot.half_sitting(), (5, 1))
    q[:, :7] = pose.pose(np.outer(np.arange(5) * 0.005, [0.0, 1.0, 0.0]), yaw=np.pi / 2.0)
    np.testing.assert_allclose(robot.body.velocities(q, 0.005)[2, :6], [1.0, 0.0, 0.0, 0.0, 0.0, 0.0], atol=1e-9)
    q[:, :7] = pose.pose(np.tile([0.0, 0.0, 0.65], (5, 1)), yaw=np.arange(5) * 0.005 * 2.0)
    np.testing.assert_allclose(robot.body.velocities(q, 0.005)[2, :6], [0.0, 0.0, 0.0, 0.0, 0.0, 2.0], atol=1e-9)


def test_zmp_of_a_robot_at_rest_is_under_its_centre_of_mass(robot, pin_model):
    for sample in random_q(pin_model, 5, seed=9):
        q = np.tile(sample, (4, 1))
        com = robot.body.com(robot.body.placements(q))
        np.testing.assert_allclose(robot.body.zmp(q, 0.005), com[:, :2], atol=1e-9)
        wrench = robot.body.contact_wrench(q, 0.005)
        np.testing.assert_allclose(wrench[:, :3], np.tile([0.0, 0.0, robot.body.mass * G], (4, 1)), atol=1e-6)


def test_zmp_is_that_of_the_momenta(robot, pin_model):
    dt = 0.001
    q = waving(pin_model, 400, dt)
    ours, oracle = robot.body.zmp(q, dt)[2:-2], zmp_from_momenta(pin_model, q, dt)
    swing = np.ptp(ours, axis=0)
    assert (swing > 0.2).all()
    np.testing.assert_allclose(ours, oracle, atol=1e-3 * swing.min())


def test_zmp_of_the_planned_motion_is_that_of_the_momenta(robot, pin_model, motion):
    oracle = zmp_from_momenta(pin_model, motion.q, motion.dt)
    error = robot.body.zmp(motion.q, motion.dt)[2:-2] - oracle
    assert (np.sqrt((error**2).mean(axis=0)) < 5e-4).all()


def test_contact_wrench_is_the_change_of_momentum_about_the_worlds_origin(robot, pin_model):
    dt = 0.001
    q = waving(pin_model, 100, dt, seed=4)
    com, linear, angular = momenta(pin_model, q, dt)
    weight = robot.body.mass * np.array([0.0, 0.0, -G])
    force = (linear[2:] - linear[:-2]) / (2.0 * dt) - weight
    moment = (angular[2:] - angular[:-2]) / (2.0 * dt) - np.cross(com[1:-1], weight)
    wrench = robot.body.contact_wrench(q, dt)[2:-2]
    np.testing.assert_allclose(wrench[:, :3], force, atol=2e-3 * np.abs(force).max())
    np.testing.assert_allclose(wrench[:, 3:], moment, atol=2e-3 * np.abs(moment).max())


def test_the_turning_of_the_waist_counts(robot, pin_model, motion):
    """The planned motion's ZMP is that of RNEA with the root's full velocity, and measurably not without its turn."""
    velocities = robot.body.velocities(motion.q, motion.dt)
    accelerations = robot.body.accelerations(motion.q, motion.dt)
    stepping = np.flatnonzero(motion.phase > 0)
    full = rnea_zmp(pin_model, motion.q[stepping], velocities[stepping], accelerations[stepping])
    velocities[:, 3:6] = accelerations[:, 3:6] = 0.0
    without = rnea_zmp(pin_model, motion.q[stepping], velocities[stepping], accelerations[stepping])
    np.testing.assert_allclose(robot.body.zmp(motion.q, motion.dt)[stepping], full, atol=1e-9)
    assert np.abs(full - without).max() > 1e-3


def rnea_zmp(model: pin.Model, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
    """ZMP by pinocchio's own recursion, sample by sample, the root's wrench moved to the world by pinocchio."""
    data, zmps = model.createData(), []
    for sample in zip(q, v, a, strict=True):
        wrench = pin.Force(pin.rnea(model, data, *sample)[:6])
        pin.forwardKinematics(model, data, sample[0])
        world = data.oMi[1].act(wrench)
        zmps.append([-world.angular[1] / world.linear[2], world.angular[0] / world.linear[2]])
    return np.array(zmps)


def test_cart_on_a_table(brick):
    """A body that moves on one height without turning: p = c - z_c c'' / g, Eq. (15)."""
    dt, height = 0.005, 0.814
    time = np.arange(400) * dt
    com = np.column_stack([0.1 * np.sin(3.0 * time), 0.05 * np.cos(4.0 * time), np.full(400, height)])
    zmp = brick().zmp(pose.pose(com), dt)[1:-1]
    second = (com[2:] - 2.0 * com[1:-1] + com[:-2]) / dt**2
    np.testing.assert_allclose(zmp, com[1:-1, :2] - height / G * second[:, :2], atol=1e-9)
    assert np.abs(zmp - com[1:-1, :2]).max() > 0.05


def test_a_body_that_accelerates_upwards_draws_the_zmp_under_itself(brick):
    dt, time = 0.005, np.arange(200) * 0.005
    com = np.column_stack([0.2 * time**2, np.zeros(200), 0.8 + 1.5 * time**2])
    zmp = brick().zmp(pose.pose(com), dt)[1:-1]
    expected = com[1:-1, 0] - com[1:-1, 2] * 0.4 / (G + 3.0)
    np.testing.assert_allclose(zmp[:, 0], expected, atol=1e-6)
    np.testing.assert_allclose(zmp[:, 1], 0.0, atol=1e-9)


def test_a_body_that_begins_to_fall_forward_pushes_its_zmp_back(brick):
    """Turning about y with an increasing rate needs a moment I_yy w' = -p_x F_z."""
    dt, time = 0.001, np.arange(200) * 0.001
    q = pose.pose(np.tile([0.0, 0.0, 0.8], (200, 1)), pitch=0.5 * 2.0 * time**2)
    np.testing.assert_allclose(brick().zmp(q, dt)[1:-1, 0], -0.2 * 2.0 / (7.0 * G), rtol=1e-4)
    sideways = np.column_stack([q[:, :3], Rotation.from_euler("x", time[:, None] ** 2).as_quat()])
    np.testing.assert_allclose(brick().zmp(sideways, dt)[1:-1, 1], 0.3 * 2.0 / (7.0 * G), rtol=1e-4)


def test_a_lopsided_body_that_yaws_swings_its_zmp_around(brick):
    """Yaw about a vertical axis beside the centre of mass: centripetal acceleration, nothing but the rate at work."""
    dt, rate = 0.001, 2.0
    angle = np.arange(1500) * dt * rate
    zmp = brick("0.1 0 0").zmp(pose.pose(np.tile([0.0, 0.0, 0.8], (1500, 1)), yaw=angle), dt)[1:-1]
    radius = 0.1 * (1.0 + 0.8 * rate**2 / G)
    expected = radius * np.column_stack([np.cos(angle), np.sin(angle)])[1:-1]
    np.testing.assert_allclose(zmp, expected, atol=1e-5)


def test_mirrored_motion_has_the_mirrored_zmp(tmp_path, pin_model):
    """On an HRP-2 whose trunk is symmetrical too: three published centres of mass lie up to 7 mm beside the middle."""
    urdf = (HRP2 / "hrp2.urdf").read_text()
    for beside in ("-0.016 0.005 -0.025", "-0.029 0.007 0.121", "-0.001 0.004 -0.008"):
        assert urdf.count(f'xyz="{beside}"') == 1
        x, _, z = beside.split()
        urdf = urdf.replace(f'xyz="{beside}"', f'xyz="{x} 0 {z}"')
    for mesh in HRP2.glob("*.obj"):
        shutil.copy(mesh, tmp_path)
    (tmp_path / "even.urdf").write_text(urdf)
    body = Body(read_urdf(tmp_path / "even.urdf")[0])
    q = waving(pin_model, 60, 0.005, seed=6)
    mirrored = q.copy()
    mirrored[:, [1, 3, 5]] *= -1.0
    for name in body.joint_names:
        other = {"R": "L", "L": "R"}[name[0]] + name[1:] if name[1:4] in ("LEG", "ARM") else name
        sign = 1.0 if body.axes[body.column(name) - 7][1] > 0.5 else -1.0
        mirrored[:, body.column(other)] = sign * q[:, body.column(name)]
    zmp, mirror = body.zmp(q, 0.005), body.zmp(mirrored, 0.005)
    np.testing.assert_allclose(mirror, zmp * [1.0, -1.0], atol=1e-9)


def test_unknown_joint_is_named(robot):
    for ask in (robot.body.column, robot.body.index, robot.body.origin):
        with pytest.raises(InvalidInput, match="'NECK'"):
            ask("NECK")


def test_placements_begin_at_the_root(robot):
    q = robot.half_sitting()[None]
    placements = robot.body.placements(q)
    np.testing.assert_allclose(placements.positions[:, 1], q[:, :3])
    assert robot.body.link_names[0] == "BODY"
    assert robot.body.origin("RLEG_JOINT4")[2] == "RLEG_JOINT3"
    np.testing.assert_allclose(robot.body.origin("RLEG_JOINT4")[1], [0.0, -0.035, -0.3])


def test_a_sweep_of_the_dynamics_is_that_of_each_sample(robot, motion, pin_model):
    few = motion.q[600:640]
    velocities, accelerations = robot.body.velocities(few, motion.dt), robot.body.accelerations(few, motion.dt)
    sweep = robot.body.dynamics_sweep(few, motion.dt)
    torques = sweep().copy()
    data = pin_model.createData()
    expected = [pin.rnea(pin_model, data, *sample) for sample in zip(few, velocities, accelerations, strict=True)]
    np.testing.assert_allclose(torques.T, expected, atol=1e-6)
    np.testing.assert_array_equal(sweep(), torques)
