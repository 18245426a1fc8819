"""The animation of the front page: the camera stands still, and the safety margin is a transparent veil.

Three layers are drawn and combined by their distance from the camera: floor and obstacle, the margin, and the robot.
Only the robot is drawn anew for each picture. That is faster than drawing everything, and it makes the veil possible.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.simulation.measurements import Run
from stepover.simulation.pybullet.video import DRAWN_HALF_WIDTH, averaged, box, draw_surroundings, replay, seen, stage

EYE, TARGET, FIELD_OF_VIEW = (1.8, -5.6, 1.4), (0.06, 0.0, 0.69), 17.4
"""Camera: place and what it looks at, against the middle of the obstacle [m], and its vertical angle [deg]."""
VEIL, OPACITY = (0.86, 0.22, 0.15, 1.0), 0.32
"""Colour of the safety margin, and its opacity."""
HAZE = (6.2, 8.6)
"""Distances between which the floor fades into the background [m]."""
FINENESS = 2


def crossing_frames(
    source: Run | Motion,
    times: Sequence[float] | np.ndarray,
    size: tuple[int, int] = (640, 440),
    robot: Robot | None = None,
) -> list[np.ndarray]:
    """Pictures from the side and slightly ahead. The camera stands still before the obstacle.

    Args:
        source: a run, to show the measured q, or a motion, to show the planned q.
        times: (K,) [s].
        size: width and height in pixels.
        robot: the robot; default: the one named in the motion.

    Returns:
        K arrays (height, width, 3) of uint8.
    """
    motion, obstacle = (source.motion, source.obstacle) if isinstance(source, Run) else (source, source.bare_obstacle)
    middle = np.array([obstacle[:2].mean(), 0.0, 0.0])
    fine = FINENESS * size[0], FINENESS * size[1]
    camera = (middle + EYE).tolist(), (middle + TARGET).tolist(), FIELD_OF_VIEW, fine
    with stage() as client:
        draw_surroundings(client, motion, obstacle)
        scene, far = seen(client, *camera)
    with stage() as client:
        (side, top), end = motion.obstacle[3:5], DRAWN_HALF_WIDTH - 0.002  # the obstacle's own end stays without veil
        box(client, (obstacle[0] - side, -end, 0.0), (obstacle[1] + side, end, obstacle[3] + top), VEIL)
        veil, veil_distance = seen(client, *camera)
    haze = np.clip((far - HAZE[0]) / (HAZE[1] - HAZE[0]), 0.0, 1.0)[..., None]
    scene = _veiled(scene + haze * (255.0 - scene), veil, veil_distance < far)
    pictures = []
    with stage() as client:
        for _ in replay(client, source, np.asarray(times, dtype=float), robot):
            figure, distance = seen(client, *camera)
            where, picture = distance < far, scene.copy()
            picture[where] = _veiled(figure[where], veil[where], (veil_distance < distance)[where])
            pictures.append(averaged(picture, FINENESS))
    return pictures


def _veiled(colours: np.ndarray, veil: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Colours (..., 3) of uint8, with the veil drawn over them where it is nearer."""
    return np.asarray(colours + OPACITY * where[..., None] * (veil - 1.0 * colours) + 0.5, dtype=np.uint8)
