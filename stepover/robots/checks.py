"""Does what robot.toml says agree with the URDF, and with itself?"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from stepover.errors import InvalidInput
from stepover.model.legs import KNEE

if TYPE_CHECKING:
    from stepover.model.robot import Robot

SIDES = {"left": 1, "right": -1}
FLAT, ON_FLOOR = 0.5, 1e-3
"""Degrees and m that a sole may be off in half-sitting: what rounded figures leave."""


def require_agreement(robot: Robot) -> None:
    """Refuse joints and links that the URDF lacks, legs that are none, and a half-sitting that does not stand.

    Raises:
        InvalidInput: names the key, and what is wrong with it.
    """
    if robot.root != robot.body.link_names[0]:
        raise InvalidInput(f"root = {robot.root!r}: the root link of the URDF is {robot.body.link_names[0]!r}")
    named = {
        "legs.knee": robot.legs.knee,
        "posture.angles_deg": robot.posture.angles_deg,
        "upper_body.chest_yaw": (robot.upper_body.chest_yaw,),
        "upper_body.shoulders": robot.upper_body.shoulders,
    }
    for where, joints in named.items():
        for joint in joints:
            if joint not in robot.body.joint_names:
                raise InvalidInput(f"{where}: the URDF has no joint {joint!r}")
    for name, side in SIDES.items():
        if side * robot.body.origin(robot.leg(side).joints[0])[1][1] < 0.0:
            raise InvalidInput(f"legs.{name}: {robot.leg(side).joints[0]!r} is not on the {name} side of the root")
        _require_standing(robot, side)
    for knee in robot.legs.knee:
        if knee not in (*robot.legs.left, *robot.legs.right):
            raise InvalidInput(f"legs.knee: {knee!r} is in neither leg")
        if knee not in (bends := [leg[KNEE] for leg in (robot.legs.right, robot.legs.left)]):
            raise InvalidInput(f"legs.knee: {knee!r} is no knee: the fourth joints of the legs are {bends}")
    _require_possible(robot)
    if robot.feasibility.waist_height_min >= robot.posture.waist_height:
        raise InvalidInput("feasibility.waist_height_min must be less than posture.waist_height")


def _require_possible(robot: Robot) -> None:
    """Refuse a half-sitting beyond joint limits, and lengths that no other length of the robot agrees with."""
    angles = np.degrees(robot.half_sitting()[7:])
    lower, upper = np.degrees(robot.body.lower), np.degrees(robot.body.upper)
    for k in np.flatnonzero((angles < lower - 1e-6) | (angles > upper + 1e-6)):
        raise InvalidInput(
            f"posture.angles_deg: {robot.body.joint_names[k]!r} stands at {angles[k]:.1f} degrees "
            f"in half-sitting, its range is {lower[k]:.1f} to {upper[k]:.1f}"
        )
    (back, front), foot = robot.foot.contact_x, robot.foot
    if back < -foot.heel or front > foot.toe:
        raise InvalidInput(f"foot.contact_x = {[back, front]} must lie between heel and toe, in m")


def _require_standing(robot: Robot, side: int) -> None:
    """Refuse a half-sitting in which a sole does not lie on the floor: it is seen from the last joint's frame."""
    leg, rest = robot.leg(side), robot.half_sitting()[None]
    turn, place = (part[0] for part in leg.sole(rest[:, :7], rest[:, leg.columns]))
    tilt = float(np.degrees(np.arccos(np.clip((np.trace(turn) - 1.0) / 2.0, -1.0, 1.0))))
    where = f"posture: in half-sitting the sole under {leg.joints[-1]!r}"
    if tilt > FLAT:
        raise InvalidInput(f"{where} is turned by {tilt:.1f} degrees from x ahead and z up; angles must cancel")
    if abs(place[2]) > ON_FLOOR:
        wanted = robot.posture.waist_height - place[2]
        raise InvalidInput(
            f"{where} is at z = {1e3 * place[2]:.1f} mm; check waist_height and foot.ankle_height, in m: "
            f"with this one a waist_height of {wanted:.6f} puts it on the floor"
        )
