"""PyBullet, silenced, and what a world needs of it: loading a robot, naming its parts, placing it."""

from __future__ import annotations

import ctypes
import os
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from stepover.extras import needs
from stepover.model.collision import hull_of
from stepover.model.description.links import MESH, Description
from stepover.model.description.urdf_text import numbers, urdf_text
from stepover.model.pose import Rotation

LIBC = ctypes.CDLL(None)
QUIET = threading.Lock()
"""Held while C code is silenced: two threads that put its streams back must not mix up whose they are."""


@contextmanager
def silenced() -> Iterator[None]:
    """Let C code print to nowhere: its `stdout` and `stderr` point to another file for a while.

    The process's descriptors stay as they are, so that other threads of Python print as ever. GNU's C library alone
    lets its streams be replaced; with another one PyBullet's notes are seen.
    """
    if not hasattr(LIBC, "gnu_get_libc_version"):
        yield
        return
    LIBC.fopen.restype = ctypes.c_void_p
    with QUIET:
        streams = [ctypes.c_void_p.in_dll(LIBC, name) for name in ("stdout", "stderr")]
        kept = [stream.value for stream in streams]
        nowhere = LIBC.fopen(os.devnull.encode(), b"w")
        try:
            for stream in streams:
                stream.value = nowhere
            yield
        finally:
            for stream, value in zip(streams, kept, strict=True):
                stream.value = value
            LIBC.fclose(ctypes.c_void_p(nowhere))


with needs("simulate"), silenced():
    import pybullet


def load_body(description: Description, client: int) -> int:
    """Load a robot into a client, and give its number.

    Self-collision stays off: neighbouring boxes overlap at the joints by design, and the planner keeps the legs apart.
    """
    with tempfile.TemporaryDirectory() as folder:
        place = {link.name: Path(folder) / str(k) for k, link in enumerate(description.links)}
        for link in description.links:
            for number, solid in enumerate(link.solids):
                if solid.kind == MESH:
                    hull = _obj(*hull_of(solid.corners))
                    place[link.name].with_suffix(f".{number}.obj").write_text(hull)
        text = urdf_text(description, lambda link, n: str(place[link.name].with_suffix(f".{n}.obj")))
        (Path(folder) / "robot.urdf").write_text(text, encoding="utf-8")
        flags = pybullet.URDF_USE_INERTIA_FROM_FILE
        return int(pybullet.loadURDF(str(Path(folder) / "robot.urdf"), flags=flags, physicsClientId=client))


def _obj(corners: np.ndarray, faces: np.ndarray) -> str:
    """A hull as the text of an obj file."""
    lines = [f"v {numbers(corner)}" for corner in corners] + [f"f {a} {b} {c}" for a, b, c in faces + 1]
    return "\n".join([*lines, ""])


def names_of(body: int, client: int) -> tuple[dict[int, str], dict[str, int]]:
    """Names of all links by PyBullet's index, and that of each joint by its name: a link has that of its joint."""
    infos = [pybullet.getJointInfo(body, i, client) for i in range(pybullet.getNumJoints(body, client))]
    links = {-1: pybullet.getBodyInfo(body, client)[0].decode(), **{i[0]: i[12].decode() for i in infos}}
    return links, {info[1].decode(): info[0] for info in infos}


def local_of(body: int, client: int) -> tuple[np.ndarray, Rotation]:
    """Position and rotation of the root link's inertial frame, PyBullet's base, in the root link."""
    position, quaternion = pybullet.getDynamicsInfo(body, -1, client)[3:5]
    return np.array(position), Rotation.from_quat(quaternion)


def place_body(body: int, client: int, joints: list[int], local: tuple[np.ndarray, Rotation], q: np.ndarray) -> None:
    """Put a body at rest at a configuration (nq,).

    Args:
        body: its number.
        client: its client.
        joints: its joints in the order of q[7:].
        local: as from local_of.
        q: where to.
    """
    turn = Rotation.from_quat(q[3:7])
    position, quaternion = q[:3] + turn.apply(local[0]), (turn * local[1]).as_quat()
    pybullet.resetBasePositionAndOrientation(body, position, quaternion, client)
    pybullet.resetBaseVelocity(body, [0.0] * 3, [0.0] * 3, client)
    pybullet.resetJointStatesMultiDof(
        body, joints, [[angle] for angle in q[7:]], [[0.0]] * len(joints), physicsClientId=client
    )
