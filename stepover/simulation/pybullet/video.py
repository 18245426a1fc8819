"""Pictures and videos of a run or a motion from the side. They show the configurations q, without physics.

The renderer is PyBullet's TinyRenderer, on the CPU. A single picture is drawn at twice its size and averaged. Frames of
a video are not, because that would take four times as long.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager
from pathlib import Path

import imageio_ffmpeg
import numpy as np
from scipy.ndimage import gaussian_filter1d

from stepover.errors import InvalidInput
from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.output import replaced
from stepover.robots.loading import load_robot
from stepover.simulation.measurements import Run
from stepover.simulation.pybullet.client import load_body, local_of, names_of, place_body, pybullet, silenced

EYE, TARGET_HEIGHT, FIELD_OF_VIEW = (0.0, -7.5, 1.75), 0.72, 13.5
"""Camera: place against the robot [m], height it looks at [m], vertical angle [deg]. From the right: x to the right."""
NEAR, FAR = 1.0, 20.0
"""Nearest and furthest distance that the camera sees, along its axis [m]."""
FOLLOW = 0.4
"""Time over which the camera's path is smoothed [s]."""
AMBER, FLOOR, TILE = (0.98, 0.62, 0.10, 1.0), (0.93, 0.94, 0.95, 1.0), (0.80, 0.83, 0.86, 1.0)
"""Colours: obstacle, floor, and its tiles of TILE_SIZE."""
LEFT, RIGHT = (0.800, 0.475, 0.655, 1.0), (0.337, 0.706, 0.914, 1.0)
"""Colours of the legs, as in the figures."""
TILE_SIZE, DRAWN_HALF_WIDTH = 0.25, 0.45
"""Size of the floor's tiles, and drawn half extent of the obstacle along y [m].

The true obstacle is longer. It is drawn shorter so that its near end does not hide the feet.
"""
LIGHT = {
    "lightDirection": (-2.0, -5.0, 6.0), "lightColor": (1.0, 1.0, 1.0), "lightDistance": 6.0, "shadow": 0,
    "lightAmbientCoeff": 0.62, "lightDiffuseCoeff": 0.42, "lightSpecularCoeff": 0.05,
}  # fmt: skip


def frames(
    source: Run | Motion, times: Sequence[float] | np.ndarray, size: tuple[int, int] = (640, 480),
    robot: Robot | None = None,
) -> list[np.ndarray]:  # fmt: skip
    """Pictures from the side. The camera follows the waist.

    Args:
        source: a run, to show the measured q, or a motion, to show the planned q.
        times: (K,) [s]; times outside the motion show its first or last sample.
        size: width and height in pixels.
        robot: the robot; default: the one named in the motion.

    Returns:
        K arrays (height, width, 3) of uint8.
    """
    return list(_pictures(source, np.asarray(times, dtype=float), size, robot, fineness=2))


def record(
    source: Run | Motion, path: str | Path, *, size: tuple[int, int] = (640, 480), rate: int = 25,
    robot: Robot | None = None, progress: Callable[[float], None] | None = None,
) -> None:  # fmt: skip
    """Write a video of a run or a motion from the side, in real time, as mp4 (H.264).

    Args:
        source: a run, to show the measured q, or a motion, to show the planned q.
        path: path of the mp4. The file appears only when it is complete.
        size: width and height in pixels, both even.
        rate: frames per second.
        robot: the robot; default: the one named in the motion.
        progress: called after each frame with the share done, 0 to 1.

    Raises:
        InvalidInput: the folder does not exist or cannot be written to, or the name does not end in .mp4.
    """
    path = Path(path)
    if path.suffix != ".mp4":
        raise InvalidInput(f"{path}: a video's name must end in .mp4")
    if not path.parent.is_dir() or not os.access(path.parent, os.W_OK):
        raise InvalidInput(f"{path} cannot be written: the folder {path.parent} does not exist or is read-only")
    time, _ = _states(source)
    times = np.arange(time[0], time[-1] + 1e-9, 1.0 / rate)
    with replaced(path) as beside:
        film = imageio_ffmpeg.write_frames(
            beside, size, fps=rate, codec="libx264", quality=8, macro_block_size=2, ffmpeg_log_level="error"
        )
        with closing(film):
            film.send(None)
            for k, picture in enumerate(_pictures(source, times, size, robot, fineness=1), start=1):
                film.send(np.ascontiguousarray(picture))
                if progress:
                    progress(k / len(times))


def _states(source: Run | Motion) -> tuple[np.ndarray, np.ndarray]:
    """Times (M,) and configurations (M, nq) to show."""
    shown = source.series if isinstance(source, Run) else source
    return shown.time, shown.q


def _pictures(
    source: Run | Motion, times: np.ndarray, size: tuple[int, int], robot: Robot | None, fineness: int
) -> Iterator[np.ndarray]:
    """Pictures (height, width, 3), one by one. Each is drawn `fineness` times as large and averaged."""
    motion = source.motion if isinstance(source, Run) else source
    time, q = _states(source)
    step = float(time[1] - time[0])
    way = gaussian_filter1d(q[:, 0], FOLLOW / step, mode="nearest")[samples_at(source, times)]
    with stage() as client:
        draw_surroundings(client, motion, source.obstacle if isinstance(source, Run) else motion.bare_obstacle)
        for _, x in zip(replay(client, source, times, robot), way, strict=True):
            yield _picture(client, float(x), size, fineness)


@contextmanager
def stage() -> Iterator[int]:
    """An empty PyBullet client for drawing."""
    with silenced():
        client = pybullet.connect(pybullet.DIRECT)
    try:
        yield client
    finally:
        pybullet.disconnect(client)


def draw_surroundings(client: int, motion: Motion, obstacle: np.ndarray) -> None:
    """Put the floor and an obstacle (4,) into a client."""
    ends = motion.waist[:, 0].min() - 2.0, motion.waist[:, 0].max() + 2.0
    box(client, (ends[0] - 3.0, -4.0, -0.1), (ends[1] + 3.0, 4.0, 0.0), FLOOR)
    columns = range(int(np.floor(ends[0] / TILE_SIZE)), int(np.ceil(ends[1] / TILE_SIZE)))
    for column in columns:
        for row in range(-4, 4):
            if (column + row) % 2:
                corner = np.array([column, row]) * TILE_SIZE
                box(client, (*corner, 0.0), (*(corner + TILE_SIZE), 0.001), TILE)
    x_min, x_max, _, z_max = obstacle
    box(client, (x_min, -DRAWN_HALF_WIDTH, 0.0), (x_max, DRAWN_HALF_WIDTH, z_max), AMBER)


def replay(client: int, source: Run | Motion, times: np.ndarray, robot: Robot | None) -> Iterator[None]:
    """Load the robot into a client and place it as at times (K,) [s], one after the other."""
    motion = source.motion if isinstance(source, Run) else source
    robot = robot or load_robot(motion.robot_name)
    with silenced():
        body = load_body(robot.description, client)
    index, local = names_of(body, client)[1], local_of(body, client)
    for names, colour in ((robot.legs.left, LEFT), (robot.legs.right, RIGHT)):
        for name in names:
            pybullet.changeVisualShape(body, index[name], rgbaColor=colour, physicsClientId=client)
    joints = [index[name] for name in robot.body.joint_names]
    _, q = _states(source)
    for sample in samples_at(source, times):
        place_body(body, client, joints, local, q[sample])
        yield


def samples_at(source: Run | Motion, times: np.ndarray) -> np.ndarray:
    """Samples (K,) nearest to times (K,) [s]."""
    time, _ = _states(source)
    step = float(time[1] - time[0])
    return np.clip(np.round((times - time[0]) / step), 0, len(time) - 1).astype(int)


def box(client: int, low: Sequence[float], high: Sequence[float], colour: Sequence[float]) -> None:
    """Draw a box between two corners."""
    middle, half = (np.add(low, high) / 2.0).tolist(), (np.subtract(high, low) / 2.0).tolist()
    look = pybullet.createVisualShape(
        pybullet.GEOM_BOX, halfExtents=half, rgbaColor=colour, specularColor=(0.0, 0.0, 0.0), physicsClientId=client
    )
    pybullet.createMultiBody(0.0, -1, look, middle, physicsClientId=client)


def _picture(client: int, x: float, size: tuple[int, int], fineness: int) -> np.ndarray:
    """One picture (height, width, 3), with the camera abreast of x."""
    width, height = size
    eye = (EYE[0] + x, EYE[1], EYE[2])
    fine = fineness * width, fineness * height
    return averaged(seen(client, eye, (x, 0.0, TARGET_HEIGHT), FIELD_OF_VIEW, fine)[0], fineness)


def seen(
    client: int, eye: Sequence[float], target: Sequence[float], field_of_view: float, size: tuple[int, int]
) -> tuple[np.ndarray, np.ndarray]:
    """The camera's picture: colours (height, width, 3) and distances (height, width) along its axis [m]."""
    width, height = size
    view = pybullet.computeViewMatrix(eye, target, (0.0, 0.0, 1.0))
    lens = pybullet.computeProjectionMatrixFOV(field_of_view, width / height, NEAR, FAR)
    image, depth = pybullet.getCameraImage(
        width, height, view, lens, renderer=pybullet.ER_TINY_RENDERER, flags=pybullet.ER_NO_SEGMENTATION_MASK,
        physicsClientId=client, **LIGHT,
    )[2:4]  # fmt: skip
    distance = FAR * NEAR / (FAR - (FAR - NEAR) * np.reshape(depth, (height, width)))
    return np.reshape(image, (height, width, 4))[..., :3], distance


def averaged(picture: np.ndarray, fineness: int) -> np.ndarray:
    """A picture (height, width, 3), reduced `fineness` times in size."""
    height, width, _ = picture.shape
    pixels = picture.reshape(height // fineness, fineness, width // fineness, fineness, 3)
    return np.asarray(pixels.mean(axis=(1, 3)) + 0.5, dtype=np.uint8)
