"""The format npz: the complete motion, without pickle. Numpy alone can read it.

Format 2 adds `obstacles`, `robot_fingerprint` and `planner` to format 1. It leaves out `zmp_first_stage` and
`key_configuration` if the planner does not give them. It keeps `obstacle` for readers of format 1. Files of format 1
still load.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from stepover.errors import CorruptMotion, InvalidInput
from stepover.locations import require_regular
from stepover.model.obstacle import LARGEST
from stepover.motion.archive import read_arrays
from stepover.motion.footsteps import Footsteps, Kind
from stepover.motion.motion import Motion
from stepover.output import write_whole

FORMAT = 2
"""The format of written files. Older formats are still read."""
LARGEST_FILE = 50_000_000
"""Largest file that is read, in bytes. A motion of eight seconds has half a million."""
SHAPES: dict[str, tuple[str | int, ...]] = {
    "time": ("N",), "q": ("N", "Q"), "joint_names": ("J",), "left_foot": ("N", 7), "right_foot": ("N", 7),
    "waist": ("N", 7), "com": ("N", 3), "zmp_reference": ("N", 2), "zmp_first_stage": ("N", 2), "zmp": ("N", 2),
    "support": ("N",), "phase": ("N",), "footsteps": ("K", 6), "key_configuration": (3,), "obstacle": (6,),
    "obstacles": ("M", 7), "robot": (), "robot_fingerprint": (), "planner": (), "format": (), "version": (),
}  # fmt: skip
"""Every key of a motion file with its shape: N samples, Q coordinates, J = Q - 7 joints, K steps, M obstacles."""
TEXTS = ("joint_names", "robot", "robot_fingerprint", "planner", "version")
WHOLE = ("support", "phase", "format")
"""Keys of whole numbers; all others but TEXTS hold floats of 8 bytes."""
LONGEST_TEXT = 200
"""Characters of a name."""
BOUND = 1e6
"""Every number is smaller, in SI units."""
SAMPLE_TIMES = 1e-4, 0.05
"""Least and largest sample time [s]."""
SINCE_2 = ("obstacles", "robot_fingerprint", "planner")
"""Keys that format 1 does not have."""
OPTIONAL = ("zmp_first_stage", "key_configuration")
"""Keys that a file of format 2 may leave out."""


def export(motion: Motion, path: Path) -> None:
    """Write the motion.

    Raises:
        InvalidInput: the folder does not exist or cannot be written to.
    """
    own = {"footsteps": motion.footsteps.rows(), "format": FORMAT}
    values = {key: own[key] if key in own else getattr(motion, key) for key in SHAPES}
    arrays = {key: np.asarray(value) for key, value in values.items() if value is not None}
    write_whole(path, lambda file: np.savez_compressed(file, **arrays))  # type: ignore[arg-type]


def load(path: Path) -> Motion:
    """Read a motion.

    Raises:
        InvalidInput: no such file, not a regular file, or too large.
        CorruptMotion: it is cut short, not a motion, lacks a key, has an unknown one, or contradicts itself.
    """
    try:
        require_regular(path, LARGEST_FILE)
    except OSError as error:
        raise InvalidInput(f"{path}: no such file; 'python -m stepover plan' writes one") from error
    try:
        arrays, others = read_arrays(path, SHAPES)
        arrays = _as_format_2(arrays)
        if others:
            raise CorruptMotion(f"holds unknown members, such as {others[0][:LONGEST_TEXT]!r}")
        _check(arrays)
    except CorruptMotion as error:
        raise CorruptMotion(f"{path}: {error}") from None
    except Exception as error:  # whatever numpy, zip and zlib make of arbitrary bytes
        raise CorruptMotion(f"{path} is not a complete motion file ({type(error).__name__}); plan it again") from error
    values: dict[str, Any] = {key: str(value) if value.ndim == 0 else value for key, value in arrays.items()}
    for key in ("obstacle", "format"):  # obstacles contains the first; the second only concerns the file
        del values[key]
    return Motion(**(values | {"footsteps": Footsteps.from_rows(arrays["footsteps"])}))


def _as_format_2(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The arrays of a file of format 1 or 2, converted to format 2."""
    if "format" not in arrays:
        raise CorruptMotion("lacks format")
    number = arrays["format"]
    if number.shape != () or number.dtype.kind not in "iu" or not 1 <= int(number) <= FORMAT:
        raise CorruptMotion(f"has format {number}, this version reads 1 to {FORMAT}")
    later, optional = (SINCE_2, ()) if int(number) == 1 else ((), OPTIONAL)
    missing = [key for key in SHAPES if key not in arrays and key not in (*later, *optional)]
    if missing:
        raise CorruptMotion(f"lacks {', '.join(missing)}")
    if int(number) > 1:
        return arrays
    _require_shape("obstacle", arrays["obstacle"], {})
    straight = {"obstacles": np.append(arrays["obstacle"], 0.0)[None]}
    return arrays | straight | {"robot_fingerprint": np.array(""), "planner": np.array("")}


def _check(arrays: dict[str, np.ndarray]) -> None:
    """Reject arrays with a wrong shape or type, or with values that are not finite or contradict each other."""
    sizes: dict[str, int] = {}
    for key, array in arrays.items():
        _require_shape(key, array, sizes)
    if sizes["Q"] != sizes["J"] + 7:
        raise CorruptMotion(f"q has {sizes['Q']} columns for {sizes['J']} joints")
    steps = np.diff(arrays["time"])
    if len(steps) < 2 or steps.min() <= 0.0 or np.ptp(steps) > 1e-6:
        raise CorruptMotion("time is not uniform")
    least, most = SAMPLE_TIMES
    if not least <= steps.mean() <= most:
        raise CorruptMotion(f"time goes in steps of {steps.mean():g} s, it must be {least:g} to {most:g} s")
    for key in ("q", "waist", "left_foot", "right_foot"):
        if np.abs(np.linalg.norm(arrays[key][:, 3:7], axis=1) - 1.0).max() > 1e-6:
            raise CorruptMotion(f"{key} holds quaternions that have no unit length")
    if np.abs(arrays["q"][:, :3] - arrays["waist"][:, :3]).max() > 1e-4:
        raise CorruptMotion("waist and q disagree")
    _check_meaning(arrays)


def _require_shape(key: str, array: np.ndarray, sizes: dict[str, int]) -> None:
    """Reject an array of the wrong shape or type, or with values that are not finite. Stores N, Q, J, K, M in sizes."""
    shape, actual = SHAPES[key], array.shape
    bound = [sizes.setdefault(n, size) if isinstance(n, str) else n for n, size in zip(shape, actual, strict=False)]
    if len(actual) != len(shape) or tuple(bound) != actual:
        raise CorruptMotion(f"{key} has the shape {actual}, expected {shape}")
    if array.dtype.kind not in ("U" if key in TEXTS else "iu" if key in WHOLE else "f"):
        raise CorruptMotion(f"{key} has the type {array.dtype.name}")
    if key in TEXTS:
        if not all(len(text) <= LONGEST_TEXT and text.isprintable() for text in array.ravel().tolist()):
            raise CorruptMotion(f"{key} holds a text that is no name: too long, or with characters that do not print")
    elif not np.isfinite(array).all():
        raise CorruptMotion(f"{key} holds values that are not finite")
    elif not ((array < BOUND) & (array > -BOUND)).all():
        raise CorruptMotion(f"{key} holds values beyond {BOUND:g}")


def _check_meaning(arrays: dict[str, np.ndarray]) -> None:
    """Refuse phases, supports, footsteps and obstacles that do not exist."""
    phase = arrays["phase"]
    begins = np.flatnonzero(np.append(True, np.diff(phase) != 0))
    if phase[begins[:6]].tolist() not in ([0], [0, 1, 2, 3, 0]):
        raise CorruptMotion("phase must be 0 throughout, or go from 0 through 1, 2 and 3, and end with 0")
    if not np.isin(arrays["support"], (-1, 0, 1)).all():
        raise CorruptMotion("support holds other values than -1, 0 and 1")
    side, kind = arrays["footsteps"][:, [1, 5]].T
    if not (np.isin(side, (-1, 1)).all() and np.isin(kind, list(Kind)).all()):
        raise CorruptMotion("footsteps hold a side that is not -1 or 1, or an unknown kind")
    obstacles = arrays["obstacles"]
    if len(obstacles) == 0 or not np.array_equal(obstacles[0, :6], arrays["obstacle"]):
        raise CorruptMotion("obstacle is not the first row of obstacles")
    if not (obstacles[:, 1:3] > 0.0).all():
        raise CorruptMotion("the obstacle has no positive width and height")
    if not ((obstacles[:, 3:6] >= 0.0).all() and (np.abs(obstacles[:, 6]) < np.pi / 2.0).all()):
        raise CorruptMotion("the obstacle has a negative margin or extent, or is turned by 90 degrees or more")
    if not (obstacles[:, 1:5] <= LARGEST).all():
        raise CorruptMotion(f"the obstacle has a size or a margin of more than {LARGEST:g} m")
