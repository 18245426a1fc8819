"""What many tests share: the robot, the plan of the 15 cm case, robot.toml as a table that may be spoilt."""

from __future__ import annotations

import copy
import json
import math
import tomllib
from collections.abc import Callable, Generator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from stepover.errors import InvalidInput
from stepover.locations import data_folder
from stepover.model import pose
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.planning.algorithm_1.plan import Plan
from stepover.planning.algorithm_1.planner import plan_in_detail
from stepover.robots.loading import load_robot

HRP2 = data_folder() / "hrp2"
PYBULLET = find_spec("pybullet") is not None
"""Python 3.12 and later have none. There, the tests that need it are left out, and all others run."""
collect_ignore = [] if PYBULLET else [
    path.name for path in Path(__file__).parent.glob("test_*.py")
    if any(line.startswith("from stepover.simulation.pybullet") for line in path.read_text().splitlines())
]  # fmt: skip


@pytest.hookimpl(wrapper=True)
def pytest_pyfunc_call() -> Generator[None, object, object]:
    """Skip a test that finds no PyBullet."""
    return (yield from _skipped_without_pybullet())


@pytest.hookimpl(wrapper=True)
def pytest_fixture_setup() -> Generator[None, object, object]:
    """The same for what a test builds on."""
    return (yield from _skipped_without_pybullet())


def _skipped_without_pybullet() -> Generator[None, object, object]:
    """What pytest does next, unless it needs PyBullet and there is none."""
    try:
        return (yield)
    except InvalidInput as error:
        if PYBULLET or "needs PyBullet" not in str(error):
            raise
        pytest.skip(str(error))


def yaw_of(poses: np.ndarray) -> np.ndarray:
    """Heading (N,) [rad] of poses (N, 7): angle of their x axis in the floor plane."""
    matrices = pose.rotation(poses)
    return np.arctan2(matrices[:, 1, 0], matrices[:, 0, 0])


@pytest.fixture(scope="session")
def robot() -> Robot:
    """HRP-2."""
    return load_robot("hrp2")


@pytest.fixture(scope="session")
def obstacle() -> Obstacle:
    """The paper's obstacle: 15 cm high, 5 cm wide."""
    return Obstacle(height=0.15, width=0.05)


@pytest.fixture(scope="session")
def planned(robot: Robot, obstacle: Obstacle) -> Plan:
    """The 15 cm case with everything that the units handed to each other."""
    return plan_in_detail(robot, obstacle, look_for_nearest=False)


@pytest.fixture(scope="session")
def motion(planned: Plan) -> Motion:
    """The 15 cm motion."""
    return planned.motion


@pytest.fixture(scope="session")
def pin_model() -> pin.Model:
    """The URDF as pinocchio alone reads it: the oracle of the library's own reading."""
    return pin.buildModelFromUrdf(str(HRP2 / "hrp2.urdf"), pin.JointModelFreeFlyer())


@pytest.fixture(scope="session")
def robot_table() -> dict[str, Any]:
    """robot.toml of HRP-2 as a table."""
    return tomllib.loads((HRP2 / "robot.toml").read_text())


@pytest.fixture
def spoilt(tmp_path: Path, robot_table: dict[str, Any]) -> Callable[..., Path]:
    """Make a robot.toml from HRP-2's, changed at some places: spoilt({("walk", "lift"): -1.0}); DROP removes."""

    def make(changes: dict[tuple[str, ...], Any]) -> Path:
        table = copy.deepcopy(robot_table)
        table["urdf"] = str(HRP2 / table["urdf"])
        for keys, value in changes.items():
            place = table
            for key in keys[:-1]:
                place = place.setdefault(key, {})
            if value is DROP:
                del place[keys[-1]]
            else:
                place[keys[-1]] = value
        path = tmp_path / "robot.toml"
        path.write_text(as_toml(table))
        return path

    return make


DROP = object()
"""Value for spoilt: the key goes away."""


def as_toml(table: dict[str, Any], prefix: str = "") -> str:
    """Write a table as TOML."""
    plain = [f"{json.dumps(k)} = {_value(v)}\n" for k, v in table.items() if not isinstance(v, dict)]
    nested = [
        f"\n[{prefix}{json.dumps(k)}]\n{as_toml(v, f'{prefix}{json.dumps(k)}.')}"
        for k, v in table.items()
        if isinstance(v, dict)
    ]
    return "".join(plain + nested)


def _value(value: Any) -> str:
    """A TOML value."""
    if isinstance(value, list):
        return f"[{', '.join(_value(item) for item in value)}]"
    if isinstance(value, float) and not math.isfinite(value):
        return "nan" if math.isnan(value) else "inf" if value > 0 else "-inf"
    return json.dumps(value)


def random_q(model: pin.Model, count: int, seed: int) -> np.ndarray:
    """Random configurations (count, nq): root anywhere, joints within their limits."""
    rng = np.random.default_rng(seed)
    quaternions = rng.normal(size=(count, 4))
    quaternions /= np.linalg.norm(quaternions, axis=1, keepdims=True)
    joints = rng.uniform(model.lowerPositionLimit[7:], model.upperPositionLimit[7:], (count, model.nq - 7))
    return np.column_stack([rng.normal(size=(count, 3)), quaternions, joints])
