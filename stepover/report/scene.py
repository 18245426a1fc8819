"""What is seen of a motion, as plain values: solids, lines, traces, their motion, and the 3-D view's camera.

The module viewer passes them to meshcat, and render/ draws them.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import NamedTuple

import numpy as np

from stepover.model import pose
from stepover.model.robot import Robot
from stepover.model.support import corners_on_floor
from stepover.motion.motion import Motion
from stepover.report.figures.style import FIRST_STAGE, LEFT, OBSTACLE, PLANNED, RIGHT
from stepover.report.rods import rods

RATE = 50.0
"""Poses per second. The browser interpolates between them; standing feet stay in place to a millimetre."""
COM, ZMP = FIRST_STAGE, PLANNED
MARGIN, BODY, JOINT, FLOOR = "#DB3826", "#D6D8DD", "#8A9099", ("#F3F4F6", "#DCE0E6")
VEIL = 0.3
"""Opacity of a margin."""
LEGEND = {LEFT: "left", RIGHT: "right", COM: "CoM, and its projection", ZMP: "ZMP", OBSTACLE: "obstacle",
          MARGIN: "safety margin"}  # fmt: skip
TILE_SIZE, AROUND = 0.25, (1.0, 1.25)
"""Size of the floor's tiles, and how far the floor reaches beyond the path, ahead and to the side [m]."""
DRAWN_HALF_WIDTH = 0.32
"""Drawn half extent of the obstacle along y [m]. It is shortened, so that its near end does not hide the feet."""
TRACE = 0.010
"""Width of a trace [m]."""
LENS, EYE, TARGET_HEIGHT = 28.0, (-0.8, -4.5, 1.15), 0.70
"""Camera: vertical angle [deg]; its place relative to its target, to the right of the path and a little above [m];
height of the target, which is the middle of the path [m]."""
LIFT = 0.002
"""Distance between surfaces that would otherwise coincide and flicker [m]."""


class Solid(NamedTuple):
    """A solid of convex hulls, given by their corners (V, 3), in the frame of a joint of Placements; 0: the world."""

    name: str
    hulls: list[np.ndarray]
    colour: str
    opacity: float = 1.0
    joint: int = 0


class Lines(NamedTuple):
    """Thin lines between pairs of points (2 L, 3)."""

    name: str
    ends: np.ndarray
    colour: str


class Trace(NamedTuple):
    """The path of a point over all samples (N, 3), with a ball that runs along it."""

    name: str
    points: np.ndarray
    colour: str


class Move(NamedTuple):
    """Positions (M, 3) and, if the object turns, quaternions (M, 4)."""

    positions: np.ndarray
    quaternions: np.ndarray | None = None


class Camera(NamedTuple):
    """Vertical angle [deg], target point [m], and place relative to the target [m]."""

    lens: float
    target: tuple[float, float, float]
    eye: tuple[float, float, float]


def camera(motion: Motion) -> Camera:
    """A camera that shows the whole path from the side."""
    return Camera(LENS, ((motion.waist[0, 0] + motion.waist[-1, 0]) / 2.0, 0.0, TARGET_HEIGHT), EYE)


def surroundings(robot: Robot, motion: Motion) -> Iterator[Solid | Lines]:
    """Floor, obstacle, margins, and the soles at all places where they stand."""
    x = np.arange(motion.waist[:, 0].min() - AROUND[0], motion.waist[:, 0].max() + AROUND[0], TILE_SIZE)
    y = np.arange(-AROUND[1], AROUND[1], TILE_SIZE)
    for kind, colour in enumerate(FLOOR):
        lows = [(a, b) for i, a in enumerate(x) for k, b in enumerate(y) if (i + k) % 2 == kind]
        tiles = [_box((a, b, -2.0 * LIFT), (a + TILE_SIZE, b + TILE_SIZE, -LIFT)) for a, b in lows]
        yield Solid(f"floor/{kind}", tiles, colour)
    yield from obstacles(motion.obstacles)
    for name, side, colour in (("left", 1, LEFT), ("right", -1, RIGHT)):
        for k, sole in enumerate(soles(motion, side)):
            yield from _print(f"soles/{name} {k}", corners_on_floor(robot, side, sole), colour)


def obstacles(rows: np.ndarray, colour: str = OBSTACLE) -> Iterator[Solid | Lines]:
    """Obstacles with their margins, from rows as in Motion.obstacles. The names of the first one have no number."""
    for number, (front, width, height, beside, above, _, yaw) in enumerate(rows, start=1):
        name, aside = f" {number}" if number > 1 else "", DRAWN_HALF_WIDTH
        place = np.array([front, 0.0, 0.0]), pose.rotation(pose.pose(np.zeros((1, 3)), yaw))[0]
        yield Solid(f"obstacle{name}", [_placed(_box((0.0, -aside, 0.0), (width, aside, height)), *place)], colour)
        if beside > 0.0 or above > 0.0:
            aside -= LIFT
            margin = _box((-beside, -aside, 0.0), (width + beside, aside, height + above))
            yield Solid(f"margin{name}/inside", [_placed(margin, *place)], MARGIN, opacity=VEIL)
            yield Lines(f"margin{name}/edges", _placed(_edges(margin), *place), MARGIN)


def _placed(points: np.ndarray, place: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Points (N, 3) of a frame that lies at a place (3,), turned by (3, 3)."""
    return np.asarray(points @ turn.T + place)


def soles(motion: Motion, side: int) -> np.ndarray:
    """Poses (K, 7) in which a sole stands on the floor, the first one at the start."""
    steps = motion.footsteps.of_side(side)
    places = pose.pose(np.column_stack([steps.x, steps.y, np.zeros(len(steps))]), steps.yaw)
    return np.vstack([motion.foot(side)[0], places])


def _print(name: str, corners: np.ndarray, colour: str) -> Iterator[Solid | Lines]:
    """The print of a sole on the floor, from its corners (4, 2). Overlapping prints can be told apart."""
    low, high = (np.column_stack([corners, np.full(4, z)]) for z in (-LIFT, 0.0))
    yield Solid(f"{name}/inside", [np.vstack([low, high])], colour, opacity=0.6)
    yield Lines(f"{name}/edges", high[[0, 1, 1, 2, 2, 3, 3, 0]], colour)


def _box(low: tuple[float, ...], high: tuple[float, ...]) -> np.ndarray:
    """Corners (8, 3) of a box, from two opposite ones."""
    return np.array(np.meshgrid(*zip(low, high, strict=True))).reshape(3, -1).T


def _edges(corners: np.ndarray) -> np.ndarray:
    """Ends (24, 3) of the edges of a box: pairs of corners that differ in one coordinate."""
    return np.array([pair for pair in combinations(corners, 2) if (pair[0] != pair[1]).sum() == 1]).reshape(-1, 3)


def links(robot: Robot) -> Iterator[Solid]:
    """The robot's links in the frames of their joints, and its joints. The legs have the colours of their soles."""
    sides = ((robot.legs.left, LEFT), (robot.legs.right, RIGHT))
    legs = {robot.body.index(joint): colour for joints, colour in sides for joint in joints}
    filling = rods(robot)
    for joint, name in _moved(robot).items():
        hulls = [shape.vertices for shape in robot.shapes if shape.joint == joint]
        yield Solid(name, hulls, legs.get(joint, BODY), joint=joint)
        if filling[joint]:
            yield Solid(f"{name}/joints", filling[joint], JOINT, joint=joint)


def _moved(robot: Robot) -> dict[int, str]:
    """The shapes that each joint moves, by the joint's index in Placements."""
    return {shape.joint: f"robot/{shape.link}" for shape in robot.shapes}


def traces(motion: Motion) -> Iterator[Trace]:
    """ZMP, CoM and its projection. Traces on the floor lie above the soles' prints."""
    floor = np.full(len(motion.time), TRACE)
    yield Trace("CoM", motion.com, COM)
    yield Trace("CoM's projection", np.column_stack([motion.com[:, :2], floor]), COM)
    yield Trace("ZMP", np.column_stack([motion.zmp, floor + LIFT]), ZMP)


def evenly(points: np.ndarray, apart: float) -> np.ndarray:
    """Points (M, 3) at equal distances along a path (N, 3), whatever the speed along it."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    places = np.linspace(0.0, along[-1], 1 + int(np.ceil(along[-1] / apart)))
    return np.column_stack([np.interp(places, along, column) for column in points.T])


def moves(robot: Robot, motion: Motion) -> tuple[np.ndarray, dict[str, Move]]:
    """Times (M,) since the first sample [s], RATE per second and the last one, with the tracks of links and balls."""
    stride = max(1, round(1.0 / (RATE * motion.dt)))
    samples = np.unique(np.append(np.arange(0, len(motion.time), stride), len(motion.time) - 1))
    placed = robot.body.placements(motion.q[samples])
    result = {f"{trace.name}/now": Move(trace.points[samples]) for trace in traces(motion)}
    for joint, name in _moved(robot).items():
        poses = pose.from_matrices(placed.rotations[:, joint], placed.positions[:, joint])
        result[name] = Move(poses[:, :3], poses[:, 3:])
    return motion.time[samples] - motion.time[0], result
