"""Pictures and films of a run or a motion. They show the configurations q, without physics."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from pathlib import Path

import imageio_ffmpeg
import numpy as np
from scipy.ndimage import gaussian_filter1d

from stepover.errors import InvalidInput
from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.output import replaced
from stepover.report import scene
from stepover.report.render.camera import Camera, checked
from stepover.report.render.mesh import Mesh
from stepover.report.render.picture import draw
from stepover.robots.loading import load_robot
from stepover.simulation.measurements import Run

HD = (1280, 720)
TOWARDS = (-0.24, 1.0, -0.13)
"""Direction in which the camera looks: from the right, from ahead and from above."""
AMBER = "#F5A11C"
"""Colour of the obstacle; that of the figures, a grey, would not stand out from the robot."""
FOLLOW, BORDER = 0.4, 0.1
"""Time over which the path of a camera that follows is smoothed [s]; its border, as in Camera.around."""
BESIDE = 0.3
"""Distance from the robot up to which a camera that stands still shows an obstacle [m]."""


class Shown:
    """What a run or a motion shows: the robot, times (N,) [s], configurations (N, nq), rows of obstacles (M, 7)."""

    def __init__(self, source: Run | Motion, robot: Robot | None = None) -> None:
        """Take the measured q of a run, or the planned q of a motion."""
        motion = source.motion if isinstance(source, Run) else source
        states = source.series if isinstance(source, Run) else source
        self.robot = robot or load_robot(motion.robot_name)
        motion.require_robot(self.robot)
        self.time, self.q, self.obstacles = states.time, states.q, motion.obstacles.copy()
        if isinstance(source, Run):
            x_min, x_max, _, z_max = source.obstacle
            self.obstacles[0, :3] = x_min, x_max - x_min, z_max

    def at(self, times: np.ndarray) -> np.ndarray:
        """Samples (K,) nearest to times (K,) [s]."""
        step = float(self.time[1] - self.time[0])
        return np.clip(np.round((times - self.time[0]) / step), 0, len(self.time) - 1).astype(int)


def frames(
    source: Run | Motion, times: Sequence[float] | np.ndarray, size: tuple[int, int] = HD, robot: Robot | None = None
) -> list[np.ndarray]:
    """Pictures from the side. The camera stands still and sees all of them, the robot as large as possible.

    Args:
        source: a run, to show the measured q, or a motion, to show the planned q.
        times: (K,) [s]; times outside the motion show its first or last sample.
        size: width and height in pixels.
        robot: the robot; default: the one named in the motion.

    Returns:
        K arrays (height, width, 3) of uint8.

    Raises:
        InvalidInput: no times, a size that cannot be drawn, or a motion for another robot.
    """
    stage = _Stage(Shown(source, robot), np.asarray(times, dtype=float))
    camera = Camera.around(stage.extent(), TOWARDS, checked(size))
    return list(stage.pictures([camera] * len(stage.samples)))


def record(
    source: Run | Motion, path: str | Path, *, size: tuple[int, int] = HD, rate: int = 25,
    robot: Robot | None = None, progress: Callable[[float], None] | None = None,
) -> None:  # fmt: skip
    """Write a video of a run or a motion from the side, in real time, as mp4 (H.264). The camera follows the waist.

    Args:
        source: a run, to show the measured q, or a motion, to show the planned q.
        path: path of the mp4. The file appears only when it is complete.
        size: width and height in pixels, both even.
        rate: frames per second.
        robot: the robot; default: the one named in the motion.
        progress: called after each frame with the share done, 0 to 1.

    Raises:
        InvalidInput: the folder does not exist or cannot be written to, the name does not end in .mp4, or a size that
            cannot be drawn.
    """
    path, size = Path(path), checked(size, even=True)
    if path.suffix != ".mp4":
        raise InvalidInput(f"{path}: a video's name must end in .mp4")
    if not path.parent.is_dir() or not os.access(path.parent, os.W_OK):
        raise InvalidInput(f"{path} cannot be written: the folder {path.parent} does not exist or is read-only")
    shown = Shown(source, robot)
    times = np.arange(shown.time[0], shown.time[-1] + 1e-9, 1.0 / rate)
    stage = _Stage(shown, times)
    with replaced(path) as beside:
        film = imageio_ffmpeg.write_frames(
            beside, size, fps=rate, codec="libx264", quality=8, macro_block_size=2, ffmpeg_log_level="error"
        )
        with closing(film):
            film.send(None)
            for k, picture in enumerate(stage.pictures(stage.following(size)), start=1):
                film.send(picture)
                if progress:
                    progress(k / len(times))


class _Stage:
    """The robot and its surroundings as triangles, at some samples."""

    def __init__(self, shown: Shown, times: np.ndarray) -> None:
        """Build them for times (K,) [s]."""
        if not len(times) or not np.isfinite(times).all():
            raise InvalidInput("pictures need times, as finite numbers of seconds")
        self._shown, self.samples = shown, shown.at(times)
        self._placed = shown.robot.body.placements(shown.q[self.samples])
        around = [thing for thing in scene.obstacles(shown.obstacles, AMBER) if isinstance(thing, scene.Solid)]
        self._solid = Mesh.of([*scene.links(shown.robot), *(thing for thing in around if thing.opacity == 1.0)])
        veils = [thing for thing in around if thing.opacity < 1.0]
        self._veil = Mesh.of(veils) if veils else None

    def extent(self) -> np.ndarray:
        """Points (N, 3) that all pictures show: the robot at all samples, and the obstacles on its way."""
        robot = [self._solid.placed(self._placed, k).corners for k in range(len(self.samples))]
        points = np.concatenate([corners[self._solid.joints > 0].reshape(-1, 3) for corners in robot])
        fixed = self._solid.corners[self._solid.joints == 0] if self._veil is None else self._veil.corners
        fixed = fixed.reshape(-1, 3)
        near = (fixed[:, 0] > points[:, 0].min() - BESIDE) & (fixed[:, 0] < points[:, 0].max() + BESIDE)
        return np.concatenate([points, fixed[near]])

    def following(self, size: tuple[int, int]) -> list[Camera]:
        """A camera for each sample, which sees the robot and follows its waist along x."""
        step = float(self._shown.time[1] - self._shown.time[0])
        way = gaussian_filter1d(self._shown.q[:, 0], FOLLOW / step, mode="nearest")[self.samples]
        first = self._solid.placed(self._placed, 0)
        points = first.corners[first.joints > 0].reshape(-1, 3)
        camera = Camera.around(points, TOWARDS, checked(size), BORDER)
        return [camera.moved(np.array([x - self._shown.q[self.samples[0], 0], 0.0, 0.0])) for x in way]

    def pictures(self, cameras: Sequence[Camera]) -> Iterator[np.ndarray]:
        """Pictures (height, width, 3) of uint8, one by one."""
        for k, camera in enumerate(cameras):
            yield draw(camera, self._solid.placed(self._placed, k), self._veil)
