"""Does a robot.toml agree with its URDF, and with itself?"""

from __future__ import annotations

import numpy as np

from stepover.model.legs import KNEE
from stepover.model.robot import Robot
from stepover.model.self_collision import self_clearance
from stepover.robots.reading import WrongEntry

SIDES = {"left": 1, "right": -1}
BELOW_SOLE = 2e-3
"""m that a foot's shape may reach below its sole: what thinned meshes leave."""
FLAT, ON_FLOOR = 0.5, 1e-3
"""Degrees and m that a sole may be off in half-sitting: what rounded figures leave."""


def require_joints(robot: Robot) -> None:
    """Refuse joints and links that the URDF lacks, and legs and knees that are none.

    Raises:
        WrongEntry: names the key, and what is wrong with it.
    """
    if robot.root != robot.body.link_names[0]:
        message = f"root = {robot.root!r}: the root link of the URDF is {robot.body.link_names[0]!r}"
        raise WrongEntry(message, "root")
    named = {
        "legs.knee": robot.legs.knee,
        "posture.angles_deg": robot.posture.angles_deg,
        "upper_body.chest_yaw": (robot.upper_body.chest_yaw,),
        "upper_body.shoulders": robot.upper_body.shoulders,
    }
    for where, joints in named.items():
        for joint in joints:
            if joint not in robot.body.joint_names:
                raise WrongEntry(f"{where}: the URDF has no joint {joint!r}", f"{where}.{joint}", where)
    _require_free(robot)
    for name, side in SIDES.items():
        hip = robot.leg(side).joints[0]
        if side * robot.body.origin(hip)[1][1] < 0.0:
            raise WrongEntry(f"legs.{name}: {hip!r} is not on the {name} side of the root", f"legs.{name}")
    for knee in robot.legs.knee:
        if knee not in (*robot.legs.left, *robot.legs.right):
            raise WrongEntry(f"legs.knee: {knee!r} is in neither leg", "legs.knee")
        if knee not in (bends := [leg[KNEE] for leg in (robot.legs.right, robot.legs.left)]):
            message = f"legs.knee: {knee!r} is no knee: the fourth joints of the legs are {bends}"
            raise WrongEntry(message, "legs.knee")


def _require_free(robot: Robot) -> None:
    """Refuse coupled joints among those that move, and a half-sitting that breaks a coupling."""
    moved = {*robot.legs.left, *robot.legs.right, robot.upper_body.chest_yaw, *robot.upper_body.shoulders}
    for hinge in robot.description.joints:
        if hinge.mimic and {hinge.name, hinge.mimic[0]} & moved:
            message = f"the URDF's joint {hinge.name!r} mimics {hinge.mimic[0]!r}: joints that move must not be coupled"
            raise WrongEntry(message)
        if hinge.mimic and hinge.name in (angles := robot.posture.angles_deg):
            leader, factor, offset = hinge.mimic
            follows = factor * angles.get(leader, 0.0) + float(np.degrees(offset))
            if abs(follows - angles[hinge.name]) > FLAT:
                message = (
                    f"posture.angles_deg: {hinge.name!r} mimics {leader!r}: in half-sitting it must be "
                    f"{follows:.1f} degrees, not {angles[hinge.name]:.1f}; it may be left out"
                )
                raise WrongEntry(message, f"posture.angles_deg.{hinge.name}")


def require_standing(robot: Robot) -> None:
    """Refuse a half-sitting beyond joint limits or off the floor, and a patch that is not under the foot.

    Raises:
        WrongEntry: names the key, and what is wrong with it.
    """
    for side in SIDES.values():
        _require_sole_on_floor(robot, side)
    angles = np.degrees(robot.half_sitting()[7:])
    lower, upper = np.degrees(robot.body.lower), np.degrees(robot.body.upper)
    for k in np.flatnonzero((angles < lower - 1e-6) | (angles > upper + 1e-6)):
        joint = robot.body.joint_names[k]
        raise WrongEntry(
            f"posture.angles_deg: {joint!r} stands at {angles[k]:.1f} degrees "
            f"in half-sitting, its range is {lower[k]:.1f} to {upper[k]:.1f}",
            f"posture.angles_deg.{joint}", "posture.angles_deg",
        )  # fmt: skip
    (back, front), foot = robot.foot.contact_x, robot.foot
    if back < -foot.heel or front > foot.toe:
        message = f"foot.contact_x = {[back, front]} must lie between heel and toe, in m"
        raise WrongEntry(message, "foot.contact_x")
    if back >= 0.0 or front <= 0.0:
        message = f"foot.contact_x = {[back, front]} must reach from behind the ankle, below 0, to ahead of it"
        raise WrongEntry(message, "foot.contact_x")


def require_apart(robot: Robot) -> None:
    """Refuse a half-sitting in which links overlap, or a shape of a foot reaches below its sole.

    Raises:
        WrongEntry: names the links, and by how much.
    """
    placements = robot.body.placements(robot.half_sitting()[None])
    apart, one, other, _ = self_clearance(robot.own_pairs, placements, 1, up_to=0.0)
    if apart <= 0.0:
        message = f"posture.angles_deg: in half-sitting {one} and {other} overlap by {-1e3 * apart:.1f} mm"
        raise WrongEntry(message, "posture.angles_deg", "posture")
    for side in SIDES.values():
        ankle = robot.body.index(robot.leg(side).joints[-1])
        for shape in robot.shapes:
            below = -robot.foot.ankle_height - float(shape.vertices[:, 2].min())
            if shape.joint == ankle and below > BELOW_SOLE:
                message = (
                    f"foot.ankle_height: a collision shape of {shape.link} reaches {1e3 * below:.1f} mm below the sole"
                )
                raise WrongEntry(message, "foot.ankle_height")


def require_room_to_sink(robot: Robot) -> None:
    """Refuse a search over waist heights that begins below its end."""
    lowest, half_sitting = robot.feasibility.waist_height_min, robot.posture.waist_height
    if lowest >= half_sitting:
        raise WrongEntry(
            f"feasibility.waist_height_min = {lowest:g} must be less than posture.waist_height = {half_sitting:g}",
            "feasibility.waist_height_min", "posture.waist_height", "posture",
        )  # fmt: skip


def require_whole_steps(robot: Robot) -> None:
    """Refuse samples of a motion that the physics cannot meet: they come at ends of its time steps."""
    sample, step = robot.walk.sample_time, robot.simulation.time_step
    if abs(sample - max(round(sample / step), 1) * step) > 1e-9:
        raise WrongEntry(
            f"walk.sample_time = {sample:g} must be a multiple of simulation.time_step = {step:g}",
            "walk.sample_time", "simulation.time_step", "walk",
        )  # fmt: skip


def _require_sole_on_floor(robot: Robot, side: int) -> None:
    """Refuse a half-sitting in which a sole does not lie on the floor: it is seen from the last joint's frame."""
    leg, rest = robot.leg(side), robot.half_sitting()[None]
    turn, place = (part[0] for part in leg.sole(rest[:, :7], rest[:, leg.columns]))
    tilt = float(np.degrees(np.arccos(np.clip((np.trace(turn) - 1.0) / 2.0, -1.0, 1.0))))
    where = f"posture: in half-sitting the sole under {leg.joints[-1]!r}"
    if tilt > FLAT:
        message = f"{where} is turned by {tilt:.1f} degrees from x ahead and z up; angles must cancel"
        raise WrongEntry(message, "posture.angles_deg")
    if abs(place[2]) > ON_FLOOR:
        wanted = robot.posture.waist_height - place[2]
        raise WrongEntry(
            f"{where} is at z = {1e3 * place[2]:.1f} mm; check waist_height and foot.ankle_height, in m: "
            f"with this one a waist_height of {wanted:.6f} puts it on the floor",
            "posture.waist_height", "posture",
        )  # fmt: skip
