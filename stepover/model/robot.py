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

SIDES = {"left": 1, "right": -1}
FLAT, ON_FLOOR = 0.5, 1e-3
"""Degrees and m that a sole may be off in half-sitting: what rounded figures leave."""


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
        if self.root != self.body.link_names[0]:
            raise InvalidInput(f"root = {self.root!r}: the root link of the URDF is {self.body.link_names[0]!r}")
        named = {
            "legs.knee": self.legs.knee,
            "posture.angles_deg": self.posture.angles_deg,
            "upper_body.chest_yaw": (self.upper_body.chest_yaw,),
            "upper_body.shoulders": self.upper_body.shoulders,
        }
        for where, joints in named.items():
            for joint in joints:
                if joint not in self.body.joint_names:
                    raise InvalidInput(f"{where}: the URDF has no joint {joint!r}")
        for name, side in SIDES.items():
            if side * self.body.origin(self.leg(side).joints[0])[1][1] < 0.0:
                raise InvalidInput(f"legs.{name}: {self.leg(side).joints[0]!r} is not on the {name} side of the root")
            self._require_standing(side)
        for knee in self.legs.knee:
            if knee not in (*self.legs.left, *self.legs.right):
                raise InvalidInput(f"legs.knee: {knee!r} is in neither leg")
            if knee not in (bends := [leg[3] for leg in (self.legs.right, self.legs.left)]):
                raise InvalidInput(f"legs.knee: {knee!r} is no knee: the fourth joints of the legs are {bends}")
        self._require_possible()
        if self.feasibility.waist_height_min >= self.posture.waist_height:
            raise InvalidInput("feasibility.waist_height_min must be less than posture.waist_height")

    def _require_possible(self) -> None:
        """Refuse a half-sitting beyond joint limits, and lengths that no other length of the robot agrees with."""
        angles = np.degrees(self._half_sitting[7:])
        lower, upper = np.degrees(self.body.lower), np.degrees(self.body.upper)
        for k in np.flatnonzero((angles < lower - 1e-6) | (angles > upper + 1e-6)):
            raise InvalidInput(
                f"posture.angles_deg: {self.body.joint_names[k]!r} stands at {angles[k]:.1f} degrees "
                f"in half-sitting, its range is {lower[k]:.1f} to {upper[k]:.1f}"
            )
        (back, front), foot = self.foot.contact_x, self.foot
        if back < -foot.heel or front > foot.toe:
            raise InvalidInput(f"foot.contact_x = {[back, front]} must lie between heel and toe, in m")

    def _require_standing(self, side: int) -> None:
        """Refuse a half-sitting in which a sole does not lie on the floor: it is seen from the last joint's frame."""
        leg, rest = self.leg(side), self.half_sitting()[None]
        turn, place = (part[0] for part in leg.sole(rest[:, :7], rest[:, leg.columns]))
        tilt = float(np.degrees(np.arccos(np.clip((np.trace(turn) - 1.0) / 2.0, -1.0, 1.0))))
        where = f"posture: in half-sitting the sole under {leg.joints[-1]!r}"
        if tilt > FLAT:
            raise InvalidInput(f"{where} is turned by {tilt:.1f} degrees from x ahead and z up; angles must cancel")
        if abs(place[2]) > ON_FLOOR:
            wanted = self.posture.waist_height - place[2]
            raise InvalidInput(
                f"{where} is at z = {1e3 * place[2]:.1f} mm; check waist_height and foot.ankle_height, in m: "
                f"with this one a waist_height of {wanted:.6f} puts it on the floor"
            )

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
