"""The floor with its grid, and the background above it."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from stepover.report.render.camera import Camera

FLOOR, LINE, HORIZON, ZENITH = (0.925, 0.935, 0.95), (0.74, 0.775, 0.825), (0.965, 0.972, 0.98), (1.0, 1.0, 1.0)
"""Colours, red, green, blue: of the floor, its lines, and the background behind it and above."""
GRID, THICKNESS = 0.25, 0.007
"""Distance between the floor's lines, and their width [m]."""
HAZE = (0.3, 2.5)
"""Distances beyond the path between which the floor fades into the background, as shares of the camera's distance."""
RISE = 0.25
"""Slope of a ray that sees the background's upper colour."""


@lru_cache(maxsize=1)
def ground(camera: Camera) -> np.ndarray:
    """Floor and background as a camera sees them: (height, width, 3) of float32, from 0 to 1. The last one is kept."""
    slope = camera.up[2] * camera.rows + camera.forward[2]  # the camera has no roll: a row has one slope, one distance
    plain = np.array(HORIZON) + np.clip(slope / RISE, 0.0, 1.0)[:, None] * np.subtract(ZENITH, HORIZON)
    lines = np.zeros((camera.size.height, camera.size.width), dtype=np.float32)
    below = slope < -1e-4
    if camera.eye[2] > 0.0 and below.any():
        distance = -camera.eye[2] / slope[below]
        there = abs(camera.eye[1] / camera.forward[1])
        haze = np.clip((distance / there - 1.0 - HAZE[0]) / (HAZE[1] - HAZE[0]), 0.0, 1.0)[:, None]
        plain[below] = np.array(FLOOR) + haze * (plain[below] - FLOOR)
        lines[below] = (1.0 - haze.astype(np.float32)) * _lines(camera, camera.rows[below], distance)
    picture = lines[..., None] * np.float32(np.subtract(LINE, FLOOR))
    picture += plain.astype(np.float32)[:, None]
    picture.flags.writeable = False
    return picture


def _lines(camera: Camera, rows: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """Share (R, width) of each pixel that the floor's lines cover, in rows (R,) as in Camera, at distances (R,)."""
    free = np.ones((len(rows), camera.size.width), dtype=np.float32)
    slope = camera.up[2] * rows + camera.forward[2]
    for axis in (0, 1):
        start = camera.up[axis] * rows + camera.forward[axis]
        place = _by_column(camera, camera.eye[axis] + distance * start, distance * camera.right[axis])
        turn = camera.up[2] / (camera.focal * slope)  # how a ray's crossing of the floor moves from row to row
        above = _by_column(
            camera, distance * (turn * start - camera.up[axis] / camera.focal), distance * turn * camera.right[axis]
        )
        beside = np.abs(distance * camera.right[axis] / camera.focal).astype(np.float32)[:, None]
        free *= 1.0 - _covered(place, np.abs(above) + beside)
    return np.asarray(1.0 - free)


def _by_column(camera: Camera, start: np.ndarray, step: np.ndarray) -> np.ndarray:
    """Values (R, width) that change evenly along rows: start (R,) in the middle, step (R,) for a slope of 1."""
    return np.asarray(start.astype(np.float32)[:, None] + step.astype(np.float32)[:, None] * camera.columns)


def _covered(place: np.ndarray, across: np.ndarray) -> np.ndarray:
    """Share of intervals that lines cover, from the intervals' middles and lengths [m]."""
    across = np.maximum(across, np.float32(1e-6))
    return np.asarray((_length(place + across / 2.0) - _length(place - across / 2.0)) / across)


def _length(place: np.ndarray) -> np.ndarray:
    """Length of all lines from 0 to a place, across them [m]."""
    shifted = (place + np.float32(THICKNESS / 2.0)) / np.float32(GRID)
    whole = np.floor(shifted)
    rest = np.minimum((shifted - whole) * np.float32(GRID), np.float32(THICKNESS))
    return np.asarray(whole * np.float32(THICKNESS) + rest)
