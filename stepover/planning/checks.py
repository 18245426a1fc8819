"""Is a motion what was asked for? The limits that a finished motion of any planner must keep."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stepover.errors import Infeasible, LimitBroken
from stepover.model.collision import least_separation
from stepover.model.kinematics import Placements
from stepover.model.parameters.planning import samples
from stepover.model.robot import Robot
from stepover.model.self_collision import self_clearance
from stepover.model.support import zmp_margin
from stepover.motion.footsteps import NORMAL
from stepover.motion.motion import Motion
from stepover.planning.measures import seen_from, speed_ratio


@dataclass(frozen=True)
class Finding:
    """How near a motion comes to one limit.

    Attributes:
        check: what is looked at, such as "joint limits".
        part: the joint, the links or the point that comes nearest to the limit.
        margin: how far the value stays on the right side of the limit; negative where it breaks it. Rad, m or, of
            speeds, a share of the limit.
        limit: what the value must not fall below; a joint speed must not rise above it.
        unit: "rad", "m" or "1".
        time: when it comes nearest [s].
        kept: whether the limit is kept.
        refusal: what is wrong, in one line, where it is not kept.
    """

    check: str
    part: str
    margin: float
    limit: float
    unit: str
    time: float
    kept: bool
    refusal: str

    @property
    def value(self) -> float:
        """What is measured: limit and margin together, in their unit."""
        return self.limit - self.margin if self.unit == "1" else self.limit + self.margin


def check(robot: Robot, motion: Motion) -> list[Finding]:
    """Everything that is checked of a finished motion, whether it is kept or not.

    Distances from obstacles are lower bounds; within the margins they are exact.
    """
    return [*_must_keep(robot, motion), _joint_speeds(robot, motion)]


def require(robot: Robot, motion: Motion, placements: Placements | None = None) -> None:
    """Refuse a motion that breaks a limit. The speed limits are another matter: require_speeds.

    Args:
        robot: the robot.
        motion: the motion of any planner; its obstacles say with which margins they must stay free.
        placements: of its configurations, where they are at hand already.

    Raises:
        Infeasible: names the joint, link or ZMP, by how much and when.
    """
    for found in _must_keep(robot, motion, placements, up_to=0.0):
        if not found.kept:
            measured = found.unit == "m" and found.check != SELF_COLLISION
            short, walking = -found.margin if measured else np.inf, _is_walking(motion, found)
            if _between_legs(robot, found):  # how near the legs come to each other follows no trend
                raise Infeasible(found.refusal, short=short, walking=walking)
            raise LimitBroken(found.refusal, f"{found.check}: {found.part}", -found.margin, short, walking)


def require_speeds(robot: Robot, motion: Motion) -> None:
    """Refuse a motion in which a joint exceeds its speed limit.

    Raises:
        Infeasible: names the joint that moves fastest for its limit, its share of it and when.
    """
    found = _joint_speeds(robot, motion)
    if not found.kept:
        raise Infeasible(found.refusal)


def _between_legs(robot: Robot, found: Finding) -> bool:
    """Whether the links that meet are both of a leg."""
    joints = {robot.body.index(joint) for leg in (robot.legs.left, robot.legs.right) for joint in leg}
    links = {shape.link for shape in robot.shapes if shape.joint in joints}
    return found.check == SELF_COLLISION and set(found.part.split(" and ")) <= links


def _is_walking(motion: Motion, found: Finding) -> bool:
    """Whether a limit is broken where the obstacle hardly matters: in a normal step; where links meet, before phase 1.

    The step before the obstacle brings the waist down for it, which may cost reach or balance, but moves no arm.
    """
    if found.check.startswith(OBSTACLE):
        return False
    steps = motion.footsteps
    kinds = steps.kind[steps.time >= found.time - 1e-9][:1]
    before = motion.has_phases and found.time < motion.time[motion.samples(1).start]
    return NORMAL in kinds or (before and found.check == SELF_COLLISION)


ZMP, SELF_COLLISION, OBSTACLE = "ZMP", "self-collision", "obstacle"


def _must_keep(
    robot: Robot, motion: Motion, placements: Placements | None = None, up_to: float = np.inf
) -> Iterator[Finding]:
    """The limits that every motion must keep, cheap ones first; distances above up_to [m] are not told apart."""
    body, kept, angles = robot.body, robot.checks, motion.q[:, 7:]
    limits = np.minimum(angles - body.lower, body.upper - angles)
    yield _least(motion, "joint limits", limits, body.joint_names, "beyond its limit")
    knees, straight = [body.column(knee) - 7 for knee in robot.legs.knee], float(np.radians(kept.knee_margin_deg))
    bent, wanted = np.abs(angles[:, knees]) - straight, f"nearer to straight than {kept.knee_margin_deg:g}"
    yield _least(motion, "knees", bent, list(robot.legs.knee), wanted, straight)
    inside = zmp_margin(robot, motion.zmp, motion.support, motion.left_foot, motion.right_foot) - kept.zmp_margin
    short = "short of its margin to the support polygon's edge"
    yield _least(motion, ZMP, inside[:, None], ["the ZMP"], short, kept.zmp_margin, "m")
    placements = placements or body.placements(motion.q)
    apart, one, other, sample = self_clearance(
        robot.own_pairs, placements, samples(kept.self_look_every, motion.dt), up_to
    )
    time = float(motion.time[sample])
    meet = f"{one} and {other} meet, {-1e3 * apart:.1f} mm deep, at t = {time:.3f} s"
    yield Finding(SELF_COLLISION, f"{one} and {other}", apart, 0.0, "m", time, apart > 0.0, meet)
    for number in range(len(motion.obstacles)):
        seen, safe = seen_from(placements, motion.obstacles[number]), motion.profile(number, margins=True)
        free, which = least_separation(robot.shapes, seen, safe, up_to)
        link, named = robot.shapes[which[free.argmin()]].link, _named(motion, number)
        yield _least(motion, named, free[:, None], [link], f"inside the {named}'s safety margin", 0.0, "m")


def _joint_speeds(robot: Robot, motion: Motion) -> Finding:
    """The joint that moves fastest for its limit."""
    ratio, joint, when = speed_ratio(robot, motion)
    refusal = f"{joint} moves at {ratio:.2f} of its speed limit at t = {when:.3f} s"
    return Finding("joint speeds", joint, 1.0 - ratio, 1.0, "1", when, ratio <= 1.0, refusal)


def _least(
    motion: Motion, check: str, margin: np.ndarray, parts: list[str], what: str, limit: float = 0.0, unit: str = "rad"
) -> Finding:
    """The finding for the smallest margin (N, len(parts)), with what is said where it is negative."""
    sample, which = np.unravel_index(margin.argmin(), margin.shape)
    least, time, phase = float(margin[sample, which]), float(motion.time[sample]), motion.phase[sample]
    amount = f"{-1e3 * least:.1f} mm" if unit == "m" else f"{-least * 180.0 / np.pi:.1f} degrees"
    where = f"phase {phase}" if phase else "walking"
    refusal = f"{parts[which]} is {amount} {what} at t = {time:.3f} s ({where})"
    return Finding(check, parts[which], least, limit, unit, time, least >= -1e-9, refusal)


def _named(motion: Motion, number: int) -> str:
    """An obstacle in words: by its number, from 1, where there are several."""
    return OBSTACLE if len(motion.obstacles) == 1 else f"{OBSTACLE} {number + 1}"
