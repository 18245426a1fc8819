"""A robot: its URDF, the facts that a URDF cannot contain, and the parameters for planning and simulation."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from stepover.model.body import Body
from stepover.model.collision import Shape, shapes_of
from stepover.model.description.links import Description
from stepover.model.description.urdf_text import urdf_text
from stepover.model.legs import KNEE, Leg
from stepover.model.parameters.facts import Foot, Legs, Outline, Posture, UpperBody
from stepover.model.parameters.optimal import Optimal
from stepover.model.parameters.physics import Servo, Simulation, SoleRubber
from stepover.model.parameters.planning import (
    Adaptor,
    BeyondPaper,
    Checks,
    Feasibility,
    LateSwing,
    Preview,
    SteppingOver,
    Walk,
)
from stepover.model.parameters.quasi_static import QuasiStatic
from stepover.model.parameters.scaling import Size
from stepover.model.parameters.stabilizer import Stabilization

FACTS = ("root", "legs", "foot", "outline", "posture", "upper_body")
"""Facts that enter the fingerprint, beside URDF and meshes."""


@dataclass(frozen=True, eq=False)
class Robot:
    """A robot for the planner and the simulation: its facts, and its parameters, whose defaults are HRP-2's.

    Attributes:
        name: name of the robot; motions store it.
        urdf_path: path of the URDF.
        body: multi-body model described by the URDF.
        root: name of the root link, the waist.
        legs, foot, outline, posture, upper_body: facts that a URDF cannot contain.
        walk, feasibility, stepping_over, late_swing, preview, adaptor, beyond_paper, checks: parameters of Algorithm 1
            and of the checks.
        optimal, quasi_static: parameters of the other two planners.
        simulation, servo, sole, stabilizer: parameters of the physics and of the stabilizer.
        slow: tables that replace others if the plan must keep the joints' speed limits.
    """

    name: str
    urdf_path: Path
    body: Body = field(repr=False)
    root: str
    legs: Legs
    foot: Foot
    outline: Outline
    posture: Posture
    upper_body: UpperBody
    walk: Walk = field(default_factory=Walk)
    feasibility: Feasibility = field(default_factory=Feasibility)
    stepping_over: SteppingOver = field(default_factory=SteppingOver)
    preview: Preview = field(default_factory=Preview)
    adaptor: Adaptor = field(default_factory=Adaptor)
    late_swing: LateSwing = field(default_factory=LateSwing)
    beyond_paper: BeyondPaper = field(default_factory=BeyondPaper)
    checks: Checks = field(default_factory=Checks)
    optimal: Optimal = field(default_factory=Optimal)
    quasi_static: QuasiStatic = field(default_factory=QuasiStatic)
    simulation: Simulation = field(default_factory=Simulation)
    servo: Servo = field(default_factory=Servo)
    sole: SoleRubber = field(default_factory=SoleRubber)
    stabilizer: Stabilization = field(default_factory=Stabilization)
    slow: Mapping[str, Any] = field(default_factory=dict)

    def __getstate__(self) -> dict[str, Any]:
        """What pickle and deepcopy take: the fields; what follows from them is computed anew."""
        return {one.name: getattr(self, one.name) for one in fields(self)} | {"slow": dict(self.slow)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Take it back."""
        self.__dict__.update(state, slow=MappingProxyType(state["slow"]))

    @cached_property
    def description(self) -> Description:
        """Links, joints and shapes, as they were read."""
        return self.body.description

    @cached_property
    def fingerprint(self) -> str:
        """What the robot is, whatever its name: 16 digits of SHA-256 over links, joints, shapes and facts."""
        found = hashlib.sha256(urdf_text(replace(self.description, name="")).encode())
        for link in self.description.links:
            for solid in link.solids:
                place = solid.place.rotation.tobytes() + solid.place.translation.tobytes()
                found.update(link.name.encode() + b"\0" + place + solid.corners.tobytes())
        found.update(repr([getattr(self, name) for name in FACTS]).encode())
        return found.hexdigest()[:16]

    @cached_property
    def shapes(self) -> list[Shape]:
        """Convex collision shapes of all links."""
        return shapes_of(self.body)

    @cached_property
    def leg_shapes(self) -> dict[int, list[int]]:
        """Indices of the shapes on the leg of a side, +1 left, -1 right."""
        joints = {side: {self.body.index(joint) for joint in self.leg(side).joints} for side in (1, -1)}
        return {side: [k for k, shape in enumerate(self.shapes) if shape.joint in own] for side, own in joints.items()}

    @cached_property
    def own_pairs(self) -> list[tuple[Shape, Shape]]:
        """Pairs of shapes that must not touch: of the two legs, and of the arms with trunk and legs.

        An arm is all that moves with a shoulder of upper_body. Its first link with a shape, the shoulder, touches the
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
        """The robot with the parameters for plans that keep the joints' speed limits."""
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
        for hinge in self.description.joints:
            if hinge.mimic and hinge.name not in self.posture.angles_deg:
                leader, factor, offset = hinge.mimic
                if follows := factor * q[self.body.column(leader)] + offset:
                    q[self.body.column(hinge.name)] = follows
        placed = self.body.placements(q[None])
        ankles = np.array([placed.positions[0, self.body.index(leg[-1])] for leg in (self.legs.left, self.legs.right)])
        q[:3] = [*-ankles.mean(axis=0)[:2], self.posture.waist_height]
        return q

    @cached_property
    def size(self) -> Size:
        """The sizes that defaults scale with."""
        leg, (back, front) = self.leg(1), self.foot.contact_x
        turn = leg.meeting_axes.signs[KNEE] * leg.meeting_axes.straight if leg.meeting_axes else 0.0
        return Size(
            leg=leg.length,
            toe=front,
            heel=-back,
            mass=self.body.mass,
            straight_deg=float(np.degrees(np.copysign(1.0, leg.rest[KNEE]) * turn)),
            above_hips=-float(self.body.origin(leg.joints[0])[1][2]),
        )

    def rest_zmp(self) -> np.ndarray:
        """ZMP in half-sitting (2,), from the midpoint of the ankles [m]. It is under the CoM."""
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
