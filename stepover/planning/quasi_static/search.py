"""Is there a quasi-static path over the obstacle? Sec. II-A, Eqs. (6)-(8) and Remark 1.

First the postures at both ends of the double support: with the CoM over the rear foot (6) and over the front foot (8),
for every step length and place of the obstacle between the feet, the waist as high as leaves the legs the most room.
Then the paths between them: (7) along the double support, (6) while leg 1 steps over, (8) while leg 2 does. The CoM
stays as near to the ankles as it can: only where that fails does it move towards the toe of the rear foot and the heel
of the front one.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from stepover.errors import Infeasible
from stepover.model.obstacle import Obstacle
from stepover.model.pose import pose
from stepover.model.robot import Robot
from stepover.planning.leg_check import LegCheck, LegLimits, check_legs
from stepover.planning.quasi_static.balance import Targets, balanced, joined
from stepover.planning.quasi_static.path import LEG_1_OVER, LEG_2_OVER, SWINGS, TO_FRONT, CrossingPath, targets
from stepover.planning.trajectories import FeetTrajectories, WaistAndFeet

CONDITIONS = {LEG_1_OVER: (1, 6), TO_FRONT: (2, 7), LEG_2_OVER: (3, 8)}
"""Phase of Sec. II and condition of Sec. II-A that each segment over the obstacle is under."""
LIMIT_SPARE = 0.01
"""Further from a joint's limit than asked for, since a joint may come nearer to it between the looks [rad]."""
DIGITS = 9
"""Of a separation in m; what lies behind is rounding, which may differ between machines, and decides nothing."""


class Grid(NamedTuple):
    """The postures of the search: step lengths (S,), places of the obstacle (P,), waist heights (H,), all in m."""

    steps: np.ndarray
    faces: np.ndarray
    heights: np.ndarray
    valid: np.ndarray


def find_path(robot: Robot, obstacle: Obstacle) -> CrossingPath:
    """The path over an obstacle with its margins.

    Raises:
        Infeasible: names the phase, the condition, (6), (7) or (8), and what prevents it.
    """
    reason = ""
    for share in np.linspace(0.0, 1.0, robot.quasi_static.com_parts + 1):
        try:
            return _path_with(robot, obstacle, float(share))
        except Infeasible as error:
            reason = error.constraint
    above, beside = 1e3 * obstacle.margin_height, 1e3 * obstacle.margin_width
    raise Infeasible(f"quasi-static, with margins of {above:g} mm above and {beside:g} mm beside: {reason}")


def _path_with(robot: Robot, obstacle: Obstacle, share: float) -> CrossingPath:
    """The path with the CoM as far from the ankles as a share of what is allowed."""
    reason = ""
    for path in _ends(robot, obstacle, share):
        for segment in (TO_FRONT, LEG_1_OVER, LEG_2_OVER):
            found, why = _first_free(robot, obstacle, _variants(robot, path, segment), segment)
            if found is None:
                reason = reason or why
                break
            path = found
        else:
            return path
    raise Infeasible(reason)


def _ends(robot: Robot, obstacle: Obstacle, share: float) -> Iterator[CrossingPath]:
    """Paths whose double support begins and ends in postures that the legs can take, the most free ones first.

    Of waists that leave as much room the lowest, which bends the knees most.
    """
    p = robot.quasi_static
    grid = _grid(robot, obstacle)
    com = share * p.com_ahead, share * p.com_behind
    checks = [_postures(robot, obstacle, grid, com, at_end) for at_end in (False, True)]
    shape = grid.valid.shape
    separations = [np.round(c.separation, DIGITS) for c in checks]
    good = [c.good(p.spare) & grid.valid.ravel() for c in checks]
    room = [np.where(*pair, -np.inf).reshape(shape) for pair in zip(good, separations, strict=True)]
    missing = [k for k in (0, 1) if not np.isfinite(room[k]).any()]
    if missing:
        why = _why_no_end(robot, grid, checks[missing[0]], (6, 8)[missing[0]])
        raise Infeasible(why + "; nor is there one for the beginning of phase 3, (8)" * (len(missing) == 2))
    best = np.minimum(*(free.max(axis=2) for free in room))
    order = np.argsort(-best, axis=None, kind="stable")[: p.tries]
    if not np.isfinite(best.ravel()[order[0]]):
        raise Infeasible("phase 2, (6) and (8): each has its postures, but no step length and place has both")
    for which in order:
        step, place = np.unravel_index(which, best.shape)
        if np.isfinite(best[step, place]):
            here = [free[step, place] for free in room]
            heights = [float(grid.heights[free == free.max()].min()) for free in here]
            yield CrossingPath(float(grid.steps[step]), float(grid.faces[step, place]), *com, *heights)


def _grid(robot: Robot, obstacle: Obstacle) -> Grid:
    """Step lengths, front faces (S, P) and waist heights; which of them leave room for both feet (S, P, H)."""
    p, foot, fu = robot.quasi_static, robot.foot, robot.feasibility
    nearest = obstacle.margin_width + foot.toe + fu.foothold_clearance  # front face ahead of the rear ankle, at least
    room = foot.heel + fu.foothold_clearance + obstacle.margin_width + obstacle.width  # before the front ankle
    steps = np.arange(nearest + room, fu.step_length_max + 1e-9, p.step_length_step)
    heights = np.arange(robot.posture.waist_height, fu.waist_height_min - 1e-9, -p.waist_height_step)
    slack = steps - nearest - room
    faces = steps[:, None] - room - np.outer(slack, np.linspace(0.0, p.place_max, p.places))
    if obstacle.distance is not None:
        faces = np.full((len(steps), 1), obstacle.distance)
    valid = (faces >= nearest - 1e-9) & (faces + room <= steps[:, None] + 1e-9)
    if not valid.any():
        farthest = fu.step_length_max - room
        place = "" if obstacle.distance is None else f" at a distance of {obstacle.distance:.3f} m"
        wanted = f"; its front face may be {nearest:.3f} to {farthest:.3f} m ahead" if farthest > nearest else ""
        raise Infeasible(
            f"phase 1, (6): no step of up to {fu.step_length_max:.3f} m takes the obstacle{place} "
            f"between the feet{wanted}"
        )
    return Grid(steps, faces, heights, np.repeat(valid[:, :, None], len(heights), axis=2))


def _postures(robot: Robot, obstacle: Obstacle, grid: Grid, com: tuple[float, float], at_end: bool) -> LegCheck:
    """Judge all postures with the CoM over the rear foot, or over the front foot."""
    step, place, height = (a.ravel() for a in np.indices(grid.valid.shape))
    x_ads, zero, beside = grid.steps[step], np.zeros(len(step)), robot.posture.feet_apart / 2.0
    front, rear = SWINGS[LEG_1_OVER], SWINGS[LEG_2_OVER]
    soles = {
        front: pose(np.column_stack([x_ads, zero + front * beside, zero])),
        rear: pose(np.tile([0.0, rear * beside, 0.0], (len(step), 1))),
    }
    over = np.column_stack([x_ads - com[1], zero + front * beside]) if at_end else [com[0], rear * beside]
    yaw = np.full(len(step), np.radians(robot.feasibility.waist_yaw_deg))
    wanted = Targets(np.broadcast_to(over, (len(step), 2)), grid.heights[height], yaw, soles[1], soles[-1])
    return _checked(robot, obstacle, wanted, grid.faces[step, place], robot.quasi_static.knee_spare_deg)


def _checked(
    robot: Robot, obstacle: Obstacle, wanted: Targets, faces: np.ndarray | float, knee_spare_deg: float = 0.0
) -> LegCheck:
    """Balance postures and judge their legs against the obstacle with its margins, front face at faces (N,) [m]."""
    waist = balanced(robot, wanted, robot.quasi_static.search_rounds)[:, :7]
    rectangles = obstacle.profile(0.0, margins=True) + np.outer(np.broadcast_to(faces, len(waist)), [1, 1, 0, 0])
    knee_margin = np.radians(robot.checks.knee_margin_deg + knee_spare_deg)
    poses = WaistAndFeet(waist, FeetTrajectories(wanted.left, wanted.right))
    return check_legs(robot, poses, LegLimits(rectangles, knee_margin))


def _variants(robot: Robot, path: CrossingPath, segment: int) -> list[CrossingPath]:
    """What a segment may look like between its ends, in the order in which it is tried."""
    p = robot.quasi_static
    if segment == TO_FRONT:
        return [dataclasses.replace(path, raised=raised) for raised in p.raises]
    if segment == LEG_1_OVER:
        return [path]
    return [
        dataclasses.replace(path, leg2_pitch=float(np.radians(pitch)), leg2_back=back)
        for pitch in p.leg2_pitches_deg
        for back in p.leg2_backs
    ]


def _first_free(
    robot: Robot, obstacle: Obstacle, paths: list[CrossingPath], segment: int
) -> tuple[CrossingPath | None, str]:
    """The first of some paths on which a segment is free, or None, and why the best one is not."""
    p = robot.quasi_static
    share = np.linspace(0.0, 1.0, p.look)
    wanted = joined([targets(robot, obstacle, path, segment, share) for path in paths])
    check = _checked(robot, obstacle, wanted, np.repeat([path.front_face for path in paths], p.look))
    free = check.good(p.spare) & (check.limit >= LIMIT_SPARE)
    good = free.reshape(len(paths), -1).all(axis=1)
    if good.any():
        return paths[int(good.argmax())], ""
    able = (check.reach <= 0.0) & (check.limit >= LIMIT_SPARE)
    room = np.where(able, check.separation, -1.0 - check.reach).reshape(len(paths), -1).min(axis=1)
    part = slice(int(room.argmax()) * p.look, (int(room.argmax()) + 1) * p.look)
    phase, condition = CONDITIONS[segment]
    what = _worst(robot, LegCheck(*(values[part] for values in check)))
    return None, f"phase {phase}, ({condition}): on the way {what}"


def _worst(robot: Robot, check: LegCheck) -> str:
    """What is worst along a path, in words."""
    if check.reach.max() > 0.0:
        return f"a sole is {1e3 * check.reach.max():.1f} mm out of reach"
    if check.limit.min() < LIMIT_SPARE:
        return f"a leg joint is {np.degrees(LIMIT_SPARE - check.limit.min()):.1f} degrees beyond its limit or margin"
    worst = int(check.separation.argmin())
    return f"{robot.shapes[check.shape[worst]].link} is {_inside(robot, check, worst)}"


def _inside(robot: Robot, check: LegCheck, which: int) -> str:
    """How far a posture's legs are inside of what must stay free."""
    spare = robot.quasi_static.spare
    return f"{1e3 * (spare - check.separation[which]):.1f} mm too near to the obstacle with its margins"


def _why_no_end(robot: Robot, grid: Grid, check: LegCheck, condition: int) -> str:
    """Why no posture ends phase 1 under (6), or begins phase 3 under (8)."""
    end = "the end of phase 1" if condition == 6 else "the beginning of phase 3"
    foot = "rear" if condition == 6 else "front"
    able = (check.reach <= 0.0) & (check.limit >= 0.0) & grid.valid.ravel()
    if not able.any():
        return f"{end}, ({condition}): with the CoM over the {foot} foot the legs do not reach"
    best = int(np.argmax(np.where(able, check.separation, -np.inf)))
    step, _, height = np.unravel_index(best, grid.valid.shape)
    link = robot.shapes[check.shape[best]].link
    return (
        f"{end}, ({condition}): with the CoM over the {foot} foot, at the best posture "
        f"(X_ads {grid.steps[step]:.3f} m, Z_hds {grid.heights[height]:.3f} m), {link} is {_inside(robot, check, best)}"
    )
