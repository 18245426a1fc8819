"""The one value that leaves the planner: a motion, with everything a reader needs to judge it without the planner."""

from __future__ import annotations

import csv
import hashlib
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from stepover.errors import CorruptMotion, InvalidInput
from stepover.model.obstacle import LATERAL_HALF_EXTENT, Obstacle
from stepover.output import write_whole

FORMAT = 1
SHAPES: dict[str, tuple[str | int, ...]] = {
    "time": ("N",), "q": ("N", "Q"), "joint_names": ("J",), "left_foot": ("N", 7), "right_foot": ("N", 7),
    "waist": ("N", 7), "com": ("N", 3), "zmp_reference": ("N", 2), "zmp_first_stage": ("N", 2), "zmp": ("N", 2),
    "support": ("N",), "phase": ("N",), "footsteps": ("K", 6), "key_configuration": (3,), "obstacle": (6,),
    "robot": (), "format": (), "version": (),
}  # fmt: skip
"""Every key of a motion file with its shape: N samples, Q coordinates, J = Q - 7 joints, K steps."""


@dataclass(frozen=True, eq=False)
class Motion:
    """A whole-body motion, N samples in SI units. World: origin between the ankles at the start, x ahead, y left, z up.

    Attributes:
        time: (N,) [s], uniform.
        q: (N, nq) configurations in pinocchio's order, free-flyer first (x y z, quaternion x y z w).
        joint_names: (nq - 7,) names of the joints behind q[7:].
        left_foot, right_foot: (N, 7) poses of the sole frames, under the ankle, on the sole.
        waist: (N, 7) pose of the root body.
        com: (N, 3) centre of mass of the multi-body model [m].
        zmp_reference: (N, 2) desired ZMP [m].
        zmp_first_stage, zmp: (N, 2) multi-body ZMP before and after the dynamic filter [m].
        support: (N,) 0 double, +1 left foot only, -1 right foot only.
        phase: (N,) 0 walking, 1, 2, 3 the phases of Sec. II.
        footsteps: (K, 6) touch-down time, side (+1 left), x, y, yaw, kind
            (0 normal, 1 before, 2 leg 1, 3 leg 2, 4 after).
        key_configuration: (3,) X_ads, X_hds, Z_hds [m].
        obstacle: (6,) front face x, width, height, margin_width, margin_height, lateral half extent [m].
        robot: its name, or the path of its robot.toml.
        format, version: of the file, of stepover.
    """

    time: np.ndarray
    q: np.ndarray
    joint_names: np.ndarray
    left_foot: np.ndarray
    right_foot: np.ndarray
    waist: np.ndarray
    com: np.ndarray
    zmp_reference: np.ndarray
    zmp_first_stage: np.ndarray
    zmp: np.ndarray
    support: np.ndarray
    phase: np.ndarray
    footsteps: np.ndarray
    key_configuration: np.ndarray
    obstacle: np.ndarray
    robot: str
    format: int
    version: str

    @property
    def dt(self) -> float:
        """Sample time [s]."""
        return float(self.time[-1] - self.time[0]) / (len(self.time) - 1)

    @property
    def bare_obstacle(self) -> np.ndarray:
        """Rectangle (4,) x_min, x_max, z_min, z_max of the obstacle without margins [m]."""
        front, width, height = self.obstacle[:3]
        return Obstacle(height, width).profile(front, margins=False)

    def foot(self, side: int) -> np.ndarray:
        """Sole poses (N, 7) of a side: +1 left, -1 right."""
        return self.left_foot if side > 0 else self.right_foot

    def samples(self, phase: int) -> slice:
        """Samples of a phase of Sec. II: 1, 2 or 3."""
        inside = np.flatnonzero(self.phase == phase)
        return slice(int(inside[0]), int(inside[-1]) + 1)

    def hash(self) -> str:
        """SHA-256 of q rounded to a micrometre (microradian): tells whether two motions are the same."""
        rounded = np.round(self.q * 1e6).astype(np.int64) + 0
        return hashlib.sha256(rounded.tobytes()).hexdigest()

    def save(self, path: str | Path) -> None:
        """Write an npz file that numpy alone can read.

        Raises:
            InvalidInput: the folder does not exist or cannot be written to.
        """
        arrays = {field.name: np.asarray(getattr(self, field.name)) for field in fields(self)}
        write_whole(Path(path), lambda file: np.savez_compressed(file, **arrays))  # type: ignore[arg-type]

    def save_csv(self, path: str | Path) -> None:
        """Write time, waist, CoM, ZMPs, feet and joints as a table, one sample a row.

        Raises:
            InvalidInput: the folder does not exist or cannot be written to.
        """
        axes = ["x", "y", "z", "qx", "qy", "qz", "qw"]
        parts = [("waist", 7), ("com", 3), ("zmp_reference", 2), ("zmp", 2), ("left_foot", 7), ("right_foot", 7)]
        header = ["time", *(f"{name}_{axis}" for name, n in parts for axis in axes[:n]), *self.joint_names]
        table = np.column_stack([self.time, *(getattr(self, name) for name, _ in parts), self.q[:, 7:]])

        def write(file: Any) -> None:
            lines = csv.writer(_Text(file))
            lines.writerow(header)
            lines.writerows([f"{value:.9g}" for value in row] for row in table)

        write_whole(Path(path), write)

    @staticmethod
    def load(path: str | Path) -> Motion:
        """Read a motion file.

        Raises:
            InvalidInput: no such file.
            CorruptMotion: it is cut short, not a motion, lacks a key, or contradicts itself.
        """
        if not Path(path).is_file():
            raise InvalidInput(f"{path}: no such file; 'python -m stepover plan' writes one")
        try:
            with np.load(path, allow_pickle=False) as archive:
                arrays = {key: archive[key] for key in archive.files}
        except Exception as error:  # whatever numpy, zip and zlib make of arbitrary bytes
            raise CorruptMotion(f"{path} is not a whole motion file ({type(error).__name__}); plan it anew") from error
        try:
            _check(arrays)
        except CorruptMotion as error:
            raise CorruptMotion(f"{path}: {error}") from None
        scalars = {"robot": str(arrays["robot"]), "format": int(arrays["format"]), "version": str(arrays["version"])}
        return Motion(**{key: arrays[key] for key in SHAPES if key not in scalars}, **scalars)  # type: ignore[arg-type]


class _Text:
    """A binary file as csv wants it."""

    def __init__(self, file: Any) -> None:
        self.write = lambda text: file.write(text.encode())


def _check(arrays: dict[str, np.ndarray]) -> None:
    """Refuse what lacks a key, has a wrong shape or a value that is not finite, or contradicts itself."""
    missing = [key for key in SHAPES if key not in arrays]
    if missing:
        raise CorruptMotion(f"lacks {', '.join(missing)}")
    sizes: dict[str, int] = {}
    for key, shape in SHAPES.items():
        actual = arrays[key].shape
        bound = [sizes.setdefault(n, size) if isinstance(n, str) else n for n, size in zip(shape, actual, strict=False)]
        if len(actual) != len(shape) or tuple(bound) != actual:
            raise CorruptMotion(f"{key} has the shape {actual}, expected {shape}")
        if arrays[key].dtype.kind not in ("U" if key in ("joint_names", "robot", "version") else "iuf"):
            raise CorruptMotion(f"{key} has the type {arrays[key].dtype}")
        if arrays[key].dtype.kind == "f" and not np.isfinite(arrays[key]).all():
            raise CorruptMotion(f"{key} holds values that are not finite")
    if int(arrays["format"]) != FORMAT:
        raise CorruptMotion(f"has format {arrays['format']}, this version reads {FORMAT}")
    if sizes["Q"] != sizes["J"] + 7:
        raise CorruptMotion(f"q has {sizes['Q']} columns for {sizes['J']} joints")
    steps = np.diff(arrays["time"])
    if len(steps) < 2 or steps.min() <= 0.0 or np.ptp(steps) > 1e-6:
        raise CorruptMotion("time is not uniform")
    for key in ("waist", "left_foot", "right_foot"):
        if np.abs(np.linalg.norm(arrays[key][:, 3:], axis=1) - 1.0).max() > 1e-6:
            raise CorruptMotion(f"{key} holds quaternions that have no unit length")
    if np.abs(arrays["q"][:, :3] - arrays["waist"][:, :3]).max() > 1e-4:
        raise CorruptMotion("waist and q disagree")
    if not (arrays["obstacle"][1:3] > 0.0).all():
        raise CorruptMotion("the obstacle has no positive width and height")


def obstacle_row(obstacle: Obstacle, front_face: float) -> np.ndarray:
    """The six numbers (6,) of an obstacle as stored in a motion."""
    sizes = [obstacle.width, obstacle.height, obstacle.margin_width, obstacle.margin_height]
    return np.array([front_face, *sizes, LATERAL_HALF_EXTENT])
