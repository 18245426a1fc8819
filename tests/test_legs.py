"""model/legs.py: inverse kinematics against the forward kinematics and against each other, and what is out of reach."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from scipy.spatial.transform import Rotation

from stepover import Infeasible, InvalidInput
from stepover.model import pose
from stepover.model.body import Body
from stepover.model.legs import Leg
from stepover.robots.urdf import read_urdf

SIDES = (1, -1)
MIRROR = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0])
# A leg as other humanoids have it: pitch, roll, yaw at the hip, ankle roll before pitch, every axis in another place.
OTHER_LEG = (
    ("hip_pitch", "0 1 0", "0 0.09 0"), ("hip_roll", "1 0 0", "0.02 0 0"), ("hip_yaw", "0 0 1", "0 0.01 -0.05"),
    ("knee", "0 1 0", "-0.02 0 -0.35"), ("ankle_roll", "1 0 0", "0.03 0 -0.36"), ("ankle_pitch", "0 1 0", "0 0 -0.02"),
)  # fmt: skip


def reachable(leg: Leg, count: int, seed: int, knee_min: float = np.radians(3.0)) -> tuple[np.ndarray, np.ndarray]:
    """Waists (N, 7) anywhere, and angles (N, 6) that a walking leg may have, far beyond those of walking."""
    rng = np.random.default_rng(seed)
    waist = pose.from_matrices(Rotation.random(count, random_state=rng).as_matrix(), rng.normal(size=(count, 3)))
    columns = np.array(leg.columns) - 7
    low, high = leg.body.lower[columns], leg.body.upper[columns]
    low[3] = knee_min
    low[2] = np.radians(-80.0)
    high[3] = np.radians(110.0)
    return waist, rng.uniform(low, high, (count, 6))


def sole_by_pinocchio(model: pin.Model, leg: Leg, waist: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Sole poses (N, 7): ankle-roll link times (0, 0, -0.105), by pinocchio alone."""
    data, joint = model.createData(), model.getJointId(leg.joints[-1])
    poses = []
    for root, own in zip(waist, angles, strict=True):
        q = pin.neutral(model)
        q[:7] = root
        q[leg.columns] = own
        pin.forwardKinematics(model, data, q)
        place = data.oMi[joint] * pin.SE3(np.eye(3), np.array([0.0, 0.0, -0.105]))
        poses.append(pin.SE3ToXYZQUAT(place))
    return np.array(poses)


def same_poses(ours: np.ndarray, theirs: np.ndarray, atol: float) -> None:
    """Compare poses as positions and rotations."""
    np.testing.assert_allclose(ours[:, :3], theirs[:, :3], atol=atol)
    np.testing.assert_allclose(pose.rotation(ours), pose.rotation(theirs), atol=atol)


@pytest.fixture
def other_leg(tmp_path) -> Leg:
    """A leg whose chain is pitch-roll-yaw-knee-roll-pitch."""
    parts, parent = [], "base"
    mass = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    for name, axis, origin in OTHER_LEG:
        parts.append(
            f'<link name="{name}_link">{mass}</link><joint name="{name}" type="revolute"><parent link="{parent}"/>'
            f'<child link="{name}_link"/><origin xyz="{origin}"/><axis xyz="{axis}"/>'
            f'<limit lower="-2" upper="2" velocity="5" effort="100"/></joint>'
        )
        parent = f"{name}_link"
    urdf = tmp_path / "other.urdf"
    urdf.write_text(f'<robot name="other"><link name="base">{mass}</link>{"".join(parts)}</robot>')
    rest = np.radians([-26.0, 0.0, 0.0, 50.0, 0.0, -24.0])
    return Leg(Body(read_urdf(urdf)[0]), 1, tuple(name for name, *_ in OTHER_LEG), 0.11, rest)


@pytest.mark.parametrize("side", SIDES)
def test_forward_kinematics_are_the_urdfs(robot, pin_model, side):
    leg = robot.leg(side)
    waist, angles = reachable(leg, 20, seed=side + 10)
    rotations, positions = leg.sole(waist, angles)
    same_poses(pose.from_matrices(rotations, positions), sole_by_pinocchio(pin_model, leg, waist, angles), 1e-9)


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("solver", ["_closed_form", "_newton"])
def test_inverse_kinematics_reach_their_targets(robot, pin_model, side, solver):
    leg = robot.leg(side)
    waist, angles = reachable(leg, 300, seed=side + 20)
    soles = sole_by_pinocchio(pin_model, leg, waist, angles)
    found, excess = getattr(leg, solver)(waist, soles)
    assert (excess == 0.0).all()
    same_poses(sole_by_pinocchio(pin_model, leg, waist, found), soles, 1e-7)


@pytest.mark.parametrize("side", SIDES)
def test_closed_form_finds_the_angles_themselves(robot, pin_model, side):
    leg = robot.leg(side)
    assert leg.is_closed_form
    waist, angles = reachable(leg, 500, seed=side + 30)
    standing = np.cos(angles[:, 4]) + np.cos(angles[:, 3] + angles[:, 4]) > 0.05  # the hip is above the foot
    waist, angles = waist[standing], angles[standing]
    assert len(angles) > 400
    found = leg.inverse(waist, sole_by_pinocchio(pin_model, leg, waist, angles))
    np.testing.assert_allclose(found, angles, atol=1e-6)


@pytest.mark.parametrize("side", SIDES)
def test_both_solvers_agree_on_the_planned_motion(robot, motion, side):
    leg, some = robot.leg(side), slice(None, None, 7)
    closed, _ = leg._closed_form(motion.waist[some], motion.foot(side)[some])
    numerical, excess = leg._newton(motion.waist[some], motion.foot(side)[some])
    assert (excess == 0.0).all()
    np.testing.assert_allclose(numerical, closed, atol=1e-7)
    np.testing.assert_allclose(closed, motion.q[some][:, leg.columns], atol=1e-9)


@pytest.mark.parametrize("side", SIDES)
def test_both_solvers_agree_on_random_targets(robot, pin_model, side):
    leg = robot.leg(side)
    rng = np.random.default_rng(side + 40)
    angles = leg.rest + rng.uniform(-0.3, 0.3, (200, 6))
    waist, _ = reachable(leg, 200, seed=side + 40)
    soles = sole_by_pinocchio(pin_model, leg, waist, angles)
    closed, numerical = leg._closed_form(waist, soles)[0], leg._newton(waist, soles)[0]
    np.testing.assert_allclose(numerical, closed, atol=1e-7)


def test_left_mirrors_right(robot, pin_model):
    right, left = robot.leg(-1), robot.leg(1)
    waist, angles = reachable(right, 100, seed=50)
    soles = sole_by_pinocchio(pin_model, right, waist, angles)
    mirrored = left.inverse(waist * MIRROR, soles * MIRROR)
    np.testing.assert_allclose(mirrored, right.inverse(waist, soles) * [-1, -1, 1, 1, 1, -1], atol=1e-9)
    assert not np.allclose(mirrored, right.inverse(waist, soles), atol=0.1)


@pytest.mark.parametrize("side", SIDES)
def test_half_sitting_puts_the_soles_on_the_floor(robot, side):
    q, leg = robot.half_sitting(), robot.leg(side)
    _, positions = leg.sole(q[None, :7], q[None, leg.columns])
    np.testing.assert_allclose(positions[0], [0.0, 0.095 * side, 0.0], atol=1e-5)
    found = leg.inverse(q[None, :7], pose.pose(np.array([[0.0, 0.095 * side, 0.0]])))
    np.testing.assert_allclose(found[0], leg.rest, atol=1e-3)


def test_a_foot_further_out_or_ahead_bends_the_right_joints(robot):
    waist = pose.pose(np.array([[0.0, 0.0, 0.62]]))
    for side in SIDES:
        leg = robot.leg(side)
        outward = leg.inverse(waist, pose.pose(np.array([[0.0, 0.15 * side, 0.0]])))[0]
        assert np.sign(outward[1]) == side
        assert np.sign(outward[5]) == -side
        ahead = leg.inverse(waist, pose.pose(np.array([[0.1, 0.095 * side, 0.0]])))[0]
        behind = leg.inverse(waist, pose.pose(np.array([[-0.1, 0.095 * side, 0.0]])))[0]
        assert ahead[2] < behind[2]
        assert ahead[3] > 0.0
        turned = leg.inverse(waist, pose.pose(np.array([[0.0, 0.095 * side, 0.0]]), yaw=0.2))[0]
        assert turned[0] == pytest.approx(0.2, abs=0.05)


@pytest.mark.parametrize("side", SIDES)
def test_the_reach_ends_where_thigh_and_shank_are_straight(robot, side):
    """The hip's height 0.705 m is straight; no clamp in silence one millimetre beyond, and no error one before."""
    leg, name = robot.leg(side), {1: "left", -1: "right"}[side]
    foot = pose.pose(np.array([[0.0, 0.095 * side, 0.0]] * 3))
    time = np.array([1.0, 1.5, 2.25])
    near = leg.inverse(pose.pose(np.array([[0.0, 0.0, 0.704]] * 3)), foot, time)
    assert 0.0 < near[0, 3] < np.radians(10.0)
    waist = pose.pose(np.array([[0.0, 0.0, 0.7], [0.0, 0.0, 0.704], [0.0, 0.0, 0.706]]))
    with pytest.raises(Infeasible) as caught:
        leg.inverse(waist, foot, time)
    message = str(caught.value)
    assert leg.joints[3] in message
    assert name in message
    assert "1.0 mm" in message
    assert "t = 2.250 s" in message
    with pytest.raises(Infeasible, match="sample 2"):
        leg.inverse(waist, foot)
    assert leg.attempt(waist, foot)[1] == pytest.approx([0.0, 0.0, 1e-3], abs=1e-9)


@pytest.mark.parametrize("which", ["closed form", "numerical"])
def test_the_knee_alone_is_that_of_the_whole_leg(robot, other_leg, which):
    leg = robot.leg(1) if which == "closed form" else other_leg
    angles = leg.rest + np.random.default_rng(8).uniform(-0.2, 0.2, (50, 6))
    waist = pose.pose(np.random.default_rng(9).normal(size=(50, 3)))
    soles = pose.from_matrices(*leg.sole(waist, angles))
    soles[0, :3] = waist[0, :3] - [0.0, 0.0, 2.0]
    everything, excess = leg.attempt(waist, soles)
    knee, short = leg.knee(waist, soles)
    np.testing.assert_array_equal(knee, everything[:, 3])
    np.testing.assert_array_equal(short, excess)
    assert short[0] > 0.5
    assert not short[1:].any()


@pytest.mark.parametrize("side", SIDES)
def test_a_foot_beside_its_reach_is_no_exception(robot, side):
    far = pose.pose(np.array([[0.0, 0.9 * side, 0.0]]))
    with pytest.raises(Infeasible, match="out of reach"):
        robot.leg(side).inverse(pose.pose(np.array([[0.0, 0.0, 0.6]])), far)


def test_other_legs_go_to_the_numerical_solver(other_leg):
    assert not other_leg.is_closed_form
    rng = np.random.default_rng(60)
    waist = pose.pose(rng.normal(size=(100, 3)), yaw=rng.normal(size=100))
    angles = other_leg.rest + rng.uniform(-0.4, 0.4, (100, 6))
    soles = pose.from_matrices(*other_leg.sole(waist, angles))
    found = other_leg.inverse(waist, soles)
    same_poses(pose.from_matrices(*other_leg.sole(waist, found)), soles, 1e-7)
    np.testing.assert_allclose(found, angles, atol=1e-5)
    data, q = other_leg.body.placements(np.column_stack([waist, found])), other_leg.body.index("ankle_pitch")
    ankle = data.positions[:, q] + data.rotations[:, q] @ [0.0, 0.0, -0.11]
    np.testing.assert_allclose(ankle, soles[:, :3], atol=1e-7)


def test_out_of_reach_of_another_leg_names_its_knee(other_leg):
    waist = pose.pose(np.array([[0.0, 0.0, 0.8], [0.0, 0.0, 1.2]]))
    foot = pose.pose(np.array([[0.0, 0.1, 0.0], [0.0, 0.1, 0.0]]))
    with pytest.raises(Infeasible, match=r"^knee .* left sole .* t = 0\.005 s"):
        other_leg.inverse(waist, foot, np.array([0.0, 0.005]))


def test_length_is_thigh_shank_and_ankle(robot, other_leg):
    assert robot.leg(1).length == pytest.approx(0.3 + 0.3 + 0.105)
    assert other_leg.length == pytest.approx(np.hypot(0.02, 0.35) + np.hypot(0.03, 0.36) + 0.02 + 0.11, abs=1e-9)


def test_five_joints_or_another_limb_are_no_leg(robot):
    leg = robot.leg(1)
    for joints in (leg.joints[:5], leg.joints[::-1], (*leg.joints[:5], "RLEG_JOINT5")):
        with pytest.raises(InvalidInput, match="six joints of one chain"):
            Leg(robot.body, 1, joints, 0.105, leg.rest)
