"""A robot: a URDF and a robot.toml beside it that says what the URDF cannot. Sec. III."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any, get_type_hints

import numpy as np

from stepover.errors import InvalidInput
from stepover.model.body import Body
from stepover.model.collision import Shape, shapes_of
from stepover.model.control_parameters import Stabilization
from stepover.model.files import data_folder, find_urdf
from stepover.model.legs import Leg
from stepover.model.parameters import (
    Adaptor,
    Beyond,
    Feasibility,
    Foot,
    Legs,
    Outline,
    Posture,
    Preview,
    QuasiStatic,
    SteppingOver,
    UpperBody,
    Verdict,
    Walk,
)
from stepover.model.physics_parameters import Servo, Simulation, SoleRubber
from stepover.model.reading import read_section
from stepover.model.robot_checks import require_agreement


@dataclass(frozen=True, eq=False)
class Robot:
    """Everything that the planner and the simulation know of a robot.

    Attributes:
        name: as it goes into a motion.
        folder: where robot.toml lies; the URDF is relative to it.
        urdf: file name of the URDF, or package://NAME/... for one in an installed Python package.
        root: name of the root link, the waist.
        legs, foot, outline, posture, upper_body, walk, feasibility, stepping_over, preview, adaptor, beyond_paper,
            verdict, quasi_static, simulation, servo, sole, stabilizer: the tables of robot.toml, each a dataclass of
            model.parameters or, the last four, of model.physics_parameters and model.control_parameters.
        slow: those of them that differ where the joints' speed limits are to be kept.
    """

    name: str
    folder: Path
    urdf: str
    root: str
    legs: Legs
    foot: Foot
    outline: Outline
    posture: Posture
    upper_body: UpperBody
    walk: Walk
    feasibility: Feasibility
    stepping_over: SteppingOver
    preview: Preview
    adaptor: Adaptor
    beyond_paper: Beyond
    verdict: Verdict
    quasi_static: QuasiStatic
    simulation: Simulation
    servo: Servo
    sole: SoleRubber
    stabilizer: Stabilization
    slow: Mapping[str, Any]

    def __post_init__(self) -> None:
        """Read the URDF, and refuse joints and links that it lacks."""
        require_agreement(self)

    @cached_property
    def urdf_path(self) -> Path:
        """Where the URDF is."""
        return find_urdf(self.urdf, self.folder)

    @cached_property
    def body(self) -> Body:
        """The multi-body model."""
        return Body(self.urdf_path)

    @cached_property
    def shapes(self) -> list[Shape]:
        """Convex collision shapes of all links."""
        return shapes_of(self.body)

    @cached_property
    def own_pairs(self) -> list[tuple[Shape, Shape]]:
        """Shapes that may not meet: of the two legs, and of the arms with trunk and legs.

        An arm is what moves with a shoulder of upper_body; its first link with a shape, the shoulder, sits on the
        trunk and is left out.
        """
        indices = [{self.body.index(joint) for joint in leg} for leg in (self.legs.left, self.legs.right)]
        left, right = ([shape for shape in self.shapes if shape.joint in leg] for leg in indices)
        arms = [shape for shape in self.shapes if shape.joint in self.body.beyond(self.upper_body.shoulders, 2)]
        apart = set().union(*indices) | self.body.beyond(self.upper_body.shoulders, 0)
        trunk = [shape for shape in self.shapes if shape.joint not in apart]
        return [(a, b) for a in left for b in right] + [(a, b) for a in arms for b in (*trunk, *left, *right)]

    @cached_property
    def _leg(self) -> dict[int, Leg]:
        """Both legs by their side."""
        rest = self.half_sitting()
        return {
            side: Leg(self.body, side, joints, self.foot.ankle_height, rest[[self.body.column(j) for j in joints]])
            for side, joints in ((1, self.legs.left), (-1, self.legs.right))
        }

    @cached_property
    def slowed(self) -> Robot:
        """The robot as it moves where the joints' speed limits are to be kept."""
        return replace(self, **self.slow)

    def leg(self, side: int) -> Leg:
        """The leg of a side: +1 left, -1 right."""
        return self._leg[side]

    def half_sitting(self) -> np.ndarray:
        """Configuration (nq,) of the half-sitting posture, with the origin midway between the ankles."""
        return self._half_sitting.copy()

    @cached_property
    def _half_sitting(self) -> np.ndarray:
        """The same, computed once."""
        q = np.zeros(7 + len(self.body.joint_names))
        q[6] = 1.0
        for joint, angle in self.posture.angles_deg.items():
            q[self.body.column(joint)] = np.radians(angle)
        placed = self.body.placements(q[None])
        ankles = np.array([placed.positions[0, self.body.index(leg[-1])] for leg in (self.legs.left, self.legs.right)])
        q[:3] = [*-ankles.mean(axis=0)[:2], self.posture.waist_height]
        return q

    def rest_zmp(self) -> np.ndarray:
        """Where the ZMP rests in half-sitting (2,): under the CoM, from the midpoint of the ankles [m]."""
        return self._rest_zmp.copy()

    @cached_property
    def _rest_zmp(self) -> np.ndarray:
        """The same, computed once."""
        return self.body.com(self.body.placements(self._half_sitting[None]))[0, :2]

    def contact_patch(self, side: int) -> np.ndarray:
        """Corners (4, 2) [m] of the flat contact patch in the sole frame, counter-clockwise."""
        x_back, x_front = self.foot.contact_x
        y_low, y_high = sorted(-side * y for y in self.foot.contact_y)
        return np.array([[x_back, y_low], [x_front, y_low], [x_front, y_high], [x_back, y_high]])


def load_robot(robot: str | Path) -> Robot:
    """Load a robot by name (a folder under data/) or by the path of a robot.toml.

    Raises:
        InvalidInput: unknown name, unreadable file, a key that is missing or makes no sense, a joint or link
            that the URDF lacks. The message names it.
    """
    path = Path(robot)
    if path.suffix != ".toml":
        known = sorted(file.parent.name for file in data_folder().glob("*/robot.toml"))
        if str(robot) not in known:
            inside = f", such as {path / 'robot.toml'}" if (path / "robot.toml").is_file() else ""
            raise InvalidInput(
                f"unknown robot {str(robot)!r}: known are {', '.join(known)}, or give a path to a robot.toml{inside}"
            )
        path = data_folder() / str(robot) / "robot.toml"
    try:
        table = tomllib.loads(path.read_text())
    except OSError as error:
        raise InvalidInput(f"{path} cannot be read: {error.strerror}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InvalidInput(f"{path} is not valid TOML: {error}") from error
    try:
        return Robot(folder=path.parent.resolve(), **_read(table))
    except InvalidInput as error:
        raise InvalidInput(f"{path}: {error}") from error


def _read(table: dict[str, Any]) -> dict[str, Any]:
    """Check the top level of robot.toml and each of its tables."""
    hints = {name: hint for name, hint in get_type_hints(Robot).items() if name != "folder"}
    names = [field.name for field in fields(Robot) if field.name != "folder"]
    for key in names:
        if key not in table:
            raise InvalidInput(f"lacks the {'key' if hints[key] is str else 'table'} {key!r}")
    for key in table:
        if key not in names:
            raise InvalidInput(f"has an unknown key {key!r}; known are {', '.join(names)}")
    texts = {key: table[key] for key in names if hints[key] is str}
    sections = [key for key in names if key not in texts and key != "slow"]
    for key, text in texts.items():
        if not isinstance(text, str) or not text:
            raise InvalidInput(f"{key} = {text!r} must be a name")
    whole = {key: read_section(hints[key], table[key], key) for key in sections}
    slow = {
        key: read_section(hints[key], table[key] | part, f"slow.{key}")
        for key, part in _changes(table["slow"], sections).items()
    }
    return texts | whole | {"slow": MappingProxyType(slow)}


def _changes(slow: Any, sections: list[str]) -> dict[str, dict[str, Any]]:
    """The tables under slow, each named as the one that it changes."""
    if not isinstance(slow, dict):
        raise InvalidInput("slow must be a table")
    for key, part in slow.items():
        if key not in sections:
            raise InvalidInput(f"slow has an unknown key {key!r}; known are {', '.join(sections)}")
        if not isinstance(part, dict):
            raise InvalidInput(f"slow.{key} must be a table")
    return slow
