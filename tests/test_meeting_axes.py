"""model/meeting_axes.py: the closed form for other legs, against forward kinematics and the solvers beside it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from stepover.errors import OutOfReach
from stepover.model import pose
from stepover.model.body import Body
from stepover.model.legs import Leg
from stepover.model.meeting_axes import MeetingAxes
from stepover.robots.urdf import read_urdf

AXES = {"X": "1 0 0", "Y": "0 1 0", "Z": "0 0 1", "x": "-1 0 0", "y": "0 -1 0", "z": "0 0 -1"}
ORIGINS = ["0.01 0.09 -0.02", "0 0 0", "0 0 0", "-0.02 0.01 -0.38", "0.04 0.02 -0.36", "0 0 0"]
ORDERS = ["YXZYXY", "YXZYYX", "ZXYYYX", "XZYYXY", "ZYXYYX", "YZXYXY", "yxZyXY", "YXzYyx"]
MASS = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'


def leg_of(folder: Path, order: str, origins: list[str] = ORIGINS) -> Leg:
    """A leg whose six axes come in an order; a small letter turns the other way. It bends its knee backwards."""
    parts, parent = [], "base"
    for k, (letter, origin) in enumerate(zip(order, origins, strict=True)):
        parts.append(
            f'<link name="link{k}">{MASS}</link><joint name="j{k}" type="revolute"><parent link="{parent}"/>'
            f'<child link="link{k}"/><origin xyz="{origin}"/><axis xyz="{AXES[letter]}"/>'
            f'<limit lower="-2" upper="2" velocity="5" effort="100"/></joint>'
        )
        parent = f"link{k}"
    path = folder / "leg.urdf"
    path.write_text(f'<robot name="leg"><link name="base">{MASS}</link>{"".join(parts)}</robot>')
    rest = np.zeros(6)
    rest[3] = -0.9 if order[3] == "y" else 0.9
    return Leg(Body(read_urdf(path)[0]), 1, tuple(f"j{k}" for k in range(6)), 0.11, rest)


def targets(leg: Leg, count: int = 300) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Waists (N, 7) anywhere, angles (N, 6) around half-sitting, and the soles (N, 7) that they give."""
    rng = np.random.default_rng(4)
    waist = pose.from_matrices(pose.Rotation.random(count, random_state=rng).as_matrix(), rng.normal(size=(count, 3)))
    angles = leg.rest + rng.uniform(-0.5, 0.5, (count, 6))
    return waist, angles, pose.from_matrices(*leg.sole(waist, angles))


@pytest.mark.parametrize("order", ORDERS)
def test_it_finds_the_angles_themselves(tmp_path, order):
    leg = leg_of(tmp_path, order)
    waist, angles, soles = targets(leg)
    np.testing.assert_allclose(leg.inverse(waist, soles), angles, atol=1e-9)


@pytest.mark.parametrize("order", ORDERS[:2])
def test_it_agrees_with_the_newton_iteration(tmp_path, order):
    leg = leg_of(tmp_path, order)
    waist, _, soles = targets(leg, 50)
    found, excess = leg._newton(waist, soles)
    assert (excess == 0.0).all()
    np.testing.assert_allclose(leg.inverse(waist, soles), found, atol=1e-7)


@pytest.mark.parametrize("side", [1, -1])
def test_it_agrees_with_the_other_closed_form(robot, motion, side):
    leg = robot.leg(side)
    found, excess = leg.meeting_axes.solve(motion.waist, motion.foot(side), leg.ankle_height, leg.rest[3])
    assert (excess == 0.0).all()
    np.testing.assert_allclose(found, motion.q[:, leg.columns], atol=1e-9)


@pytest.mark.parametrize("order", ["YXZYXY", "YXZYYX"])
def test_out_of_reach_is_told_to_the_millimetre(tmp_path, order):
    origins = [ORIGINS[0], "0 0 0", "0 0 0", "0 0 -0.38", "0 0 -0.36", "0 0 0"]
    leg = leg_of(tmp_path, order, origins)
    waist = np.array([[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]])
    sole = np.array([[0.01, 0.09, -0.02 - 0.74 - 0.11 - 0.005, 0.0, 0.0, 0.0, 1.0]])
    with pytest.raises(OutOfReach, match=r"5\.0 mm out of reach") as caught:
        leg.inverse(waist, sole)
    assert caught.value.short == pytest.approx(0.005)


def test_straight_is_where_hip_knee_and_ankle_are_in_line(tmp_path):
    axes = leg_of(tmp_path, "YXZYXY").meeting_axes
    assert axes.straight == pytest.approx(np.arctan2(0.02, 0.38) + np.arctan2(0.04, 0.36))


@pytest.mark.parametrize("k", [1, 2, 5])
def test_axes_that_do_not_meet_are_left_to_the_iteration(tmp_path, k):
    leg = leg_of(tmp_path, "YXZYXY", [*ORIGINS[:k], "0 0 -0.02", *ORIGINS[k + 1 :]])
    assert leg.meeting_axes is None
    waist, angles, soles = targets(leg, 20)
    np.testing.assert_allclose(leg.inverse(waist, soles), angles, atol=1e-6)


def test_axes_that_no_hip_has_are_left_to_the_iteration():
    chain = [(np.eye(3), np.zeros(3), np.eye(3)[k]) for k in (1, 0, 1, 1, 0, 1)]
    assert MeetingAxes.of(chain) is None
