"""A robot: a URDF and a robot.toml beside it that says what the URDF cannot. Sec. III."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from stepover.model.body import Body
from stepover.model.collision import Shape, shapes_of
from stepover.model.description import Description
from stepover.model.legs import Leg
from stepover.model.parameters.physics import Servo, Simulation, SoleRubber
from stepover.model.parameters.planning import (
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
from stepover.model.parameters.stabilizer import Stabilization


@dataclass(frozen=True, eq=False)
class Robot:
    """Everything that the planner and the simulation know of a robot.

    Attributes:
        name: as it goes into a motion.
        urdf_path: where its URDF is.
        description: what was read of it.
        root: name of the root link, the waist.
        legs, foot, outline, posture, upper_body, walk, feasibility, stepping_over, preview, adaptor, beyond_paper,
            verdict, quasi_static, simulation, servo, sole, stabilizer: the tables of robot.toml, each a dataclass of
            model.parameters or, the last four, of model.physics_parameters and model.control_parameters.
        slow: those of them that differ where the joints' speed limits are to be kept.
    """

    name: str
    urdf_path: Path
    description: Description
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

    @cached_property
    def body(self) -> Body:
        """The multi-body model."""
        return Body(self.description)

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
