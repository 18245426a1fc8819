"""A page that plays a motion in 3-D, in any browser, offline. No other module uses meshcat.

meshcat turns shapes into commands for its viewer and sends them to its own server, which writes them into a page.
Here the commands are collected and written without the server, so no process, port or browser is needed. scene
holds the content of the scene, and viewer_page the page around it.
"""

from __future__ import annotations

import base64
import html
from dataclasses import dataclass, field
from functools import singledispatch
from importlib.resources import files
from pathlib import Path
from typing import Any

import meshcat.path
import numpy as np
from meshcat import geometry as forms
from meshcat.animation import Animation, AnimationClip, AnimationTrack
from scipy.spatial import ConvexHull

from stepover.errors import InvalidInput
from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.output import write_whole
from stepover.report import scene, viewer_page
from stepover.report.render.gif import PHASES

ROOT = meshcat.path.Path(("meshcat",))
BALL = 0.022
"""Radius of the ball that runs along a trace [m]. It shines faintly through solids in front of it."""
FAINT = 0.3


@dataclass(frozen=True)
class Page:
    """A page. It appears inline if it is the last value of a notebook's cell.

    Attributes:
        html: the whole page.
        height: height of its frame in a notebook, in pixels.
    """

    html: str = field(repr=False)
    height: int

    def _repr_html_(self) -> str:
        """An inline frame that holds the whole page, so that an executed notebook needs no other file."""
        style = f"width: 100%; height: {self.height}px; border: 0"
        return f'<iframe srcdoc="{html.escape(self.html)}" style="{style}"></iframe>'


def show(robot: Robot, motion: Motion, time: float | None = None, height: int = 480) -> Page:
    """The motion in 3-D inside a notebook: the result of page() in a frame with a height in pixels."""
    return Page(page(robot, motion, time), height)


def save_page(robot: Robot, motion: Motion, path: str | Path, time: float | None = None) -> None:
    """Write the result of page() to a file. The file appears only when it is complete.

    Raises:
        InvalidInput: as in page, or the folder does not exist or cannot be written to.
    """
    content = page(robot, motion, time).encode()
    write_whole(Path(path), lambda file: file.write(content))


def page(robot: Robot, motion: Motion, time: float | None = None) -> str:
    """A stand-alone HTML page: robot, obstacle with its margins, soles, traces of ZMP and CoM; play, pause, scrub.

    The same motion gives the same page, to the byte.

    Args:
        robot: robot of the motion.
        motion: from plan or Motion.load.
        time: time shown when the page opens [s]; default: the start.

    Raises:
        InvalidInput: the motion is for another robot, or the time lies outside the motion.
    """
    motion.require_robot(robot)
    first, last = float(motion.time[0]), float(motion.time[-1])
    shown = first if time is None else time
    if not first <= shown <= last:
        raise InvalidInput(f"time = {shown} must lie within the motion, from {first:.2f} s to {last:.2f} s")
    recorder = _Recorder()
    view = meshcat.Visualizer.view_into(recorder, ROOT)
    for thing in (*scene.surroundings(robot, motion), *scene.links(robot), *scene.traces(motion)):
        _put(thing, view)
    view.set_animation(_animation(robot, motion), play=False, repetitions=float("inf"))
    for name in ("/Axes", "/Grid"):
        view[name].set_property("visible", False)
    for name, colour in (("top_color", [1.0, 1.0, 1.0]), ("bottom_color", [0.92, 0.93, 0.95])):
        view["/Background"].set_property(name, colour)
    width, height = 1e2 * motion.obstacle[1:3]
    title = f"{robot.name} steps over an obstacle {height:.3g} cm high, {width:.3g} cm wide"
    viewer = files("meshcat") / "viewer"
    commands = [base64.b64encode(command).decode() for command in recorder.commands]
    return viewer_page.compose(title, scene.LEGEND, viewer, commands, scene.camera(motion), _phases(motion),
                               first, shown - first)  # fmt: skip


def _phases(motion: Motion) -> list[tuple[float, str]]:
    """Start of each phase of Sec. II, since the first sample [s], and its name."""
    begins = [(0, 0), *((motion.samples(phase).start, phase) for phase in (1, 2, 3)), (motion.samples(3).stop, 0)]
    return [(float(motion.time[sample] - motion.time[0]), PHASES[phase]) for sample, phase in begins]


class _Recorder:
    """Replaces meshcat's server: keeps the commands, packed for the viewer."""

    def __init__(self) -> None:
        self.commands: list[bytes] = []

    def send(self, command: Any) -> None:
        """Take a command, packed with what meshcat packs its arrays with."""
        self.commands.append(forms.umsgpack.packb(command.lower()))


@singledispatch
def _put(thing: Any, view: Any) -> None:
    """Put something into the view, under its name."""
    raise NotImplementedError(type(thing))


@_put.register
def _(thing: scene.Solid, view: Any) -> None:
    corners = np.vstack(thing.hulls)
    begins = np.cumsum([0, *(len(hull) for hull in thing.hulls[:-1])])
    faces = np.vstack([ConvexHull(hull).simplices + k for hull, k in zip(thing.hulls, begins, strict=True)])
    # A transparent solid hides nothing behind it.
    look = _surface(thing.colour, opacity=thing.opacity, depthWrite=thing.opacity == 1.0)
    _named(view, thing.name, forms.Mesh(forms.TriangularMeshGeometry(corners, faces), look))


@_put.register
def _(thing: scene.Lines, view: Any) -> None:
    look = forms.LineBasicMaterial(color=_number(thing.colour))
    _named(view, thing.name, forms.LineSegments(forms.PointsGeometry(thing.ends.astype(np.float32).T), look))


@_put.register
def _(thing: scene.Trace, view: Any) -> None:
    points = scene.evenly(thing.points, scene.TRACE / 3.0).astype(np.float32)
    shade = np.array([int(thing.colour[k : k + 2], 16) / 255.0 for k in (1, 3, 5)], dtype=np.float32)
    size = scene.TRACE / np.tan(np.radians(scene.LENS / 2.0))  # the viewer draws points as if the lens were 90 degrees
    way = forms.PointsGeometry(points.T, np.tile(shade, (len(points), 1)).T)
    _named(view, f"{thing.name}/way", forms.Points(way, forms.PointsMaterial(float(size))))
    hidden = _surface(thing.colour, opacity=FAINT, depthTest=False, depthWrite=False)
    for part, look in (("ball", _surface(thing.colour)), ("hidden", hidden)):
        _named(view, f"{thing.name}/now/{part}", forms.Mesh(forms.Sphere(BALL), look))


def _named(view: Any, name: str, thing: Any) -> None:
    """Put an object there. Its identifiers are names, not random, so that the same motion gives the same page."""
    for part, element in (("form", thing.geometry), ("look", thing.material), ("thing", thing)):
        element.uuid = f"{name} {part}"
    view[name].set_object(thing)


def _surface(colour: str, **options: Any) -> Any:
    """A matt surface with hard edges."""
    return forms.MeshPhongMaterial(_number(colour), shininess=0.0, specular=0, flatShading=True, **options)


def _number(colour: str) -> int:
    """Convert "#0072B2" to 0x0072B2."""
    return int(colour[1:], 16)


class _Track(AnimationTrack):
    """A track that stores its numbers as two arrays. It takes a sixth of the bytes of meshcat's table of frames."""

    def lower(self) -> dict[str, Any]:
        """The track in the viewer's format."""
        times, values = (forms.pack_numpy_array(np.asarray(x).T)["array"] for x in (self.frames, self.values))
        return {"name": f".{self.name}", "type": self.jstype, "times": times, "values": values}


def _animation(robot: Robot, motion: Motion) -> Animation:
    """Everything that moves."""
    times, moves = scene.moves(robot, motion)
    clips = {}
    for name, move in moves.items():
        tracks = {"position": _Track("position", "vector3", times, move.positions)}
        if move.quaternions is not None:
            tracks["quaternion"] = _Track("quaternion", "quaternion", times, move.quaternions)
        clips[ROOT.append(name)] = AnimationClip(tracks, fps=1)  # a frame a second: its times are in seconds
    return Animation(clips)
