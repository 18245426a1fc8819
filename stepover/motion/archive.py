"""Arrays of an npz file from anybody: sizes and types are checked before anything is read; pickles are not opened."""

from __future__ import annotations

import math
import zipfile
from collections.abc import Collection
from pathlib import Path
from typing import IO

import numpy as np
from numpy.lib import format as npy

from stepover.errors import CorruptMotion

LARGEST = 200_000_000
"""Bytes of all arrays together."""
TYPES = {"f": "float64", "i": "int64", "u": "int64", "U": "text"}
"""What is read, by numpy's kind of type; floats have 8 bytes."""
READERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}


def read_arrays(path: Path, keys: Collection[str]) -> tuple[dict[str, np.ndarray], list[str]]:
    """Read the arrays of an npz file.

    Args:
        path: a regular file.
        keys: names of the arrays that are read.

    Returns:
        The arrays by name, in the machine's byte order, and the names of other members.

    Raises:
        CorruptMotion: an array of another type, twice, or arrays that are too large.
        Exception: whatever zip, zlib and numpy make of bytes that are no such file.
    """
    with zipfile.ZipFile(path) as archive:
        members = {member.filename.removesuffix(".npy"): member for member in archive.infolist()}
        if len(members) < len(archive.infolist()):
            raise CorruptMotion("holds a member twice")
        wanted = {key: member for key, member in members.items() if key in keys}
        size = sum(member.file_size for member in wanted.values())
        if size > LARGEST:
            raise CorruptMotion(f"holds {size:,} bytes, a motion has {LARGEST:,} at most")
        arrays = {}
        for key, member in wanted.items():
            with archive.open(member) as stream:
                _require_honest_header(key, stream, member.file_size)
            with archive.open(member) as stream:
                array = np.asarray(npy.read_array(stream, allow_pickle=False))
                if stream.read(1):  # reads to the end, so that the checksum is compared
                    raise CorruptMotion(f"{key} is longer than it says")
            arrays[key] = array.astype(array.dtype.newbyteorder("="), copy=False)
    return arrays, sorted(members.keys() - wanted.keys())


def _require_honest_header(key: str, stream: IO[bytes], size: int) -> None:
    """Refuse an array of a type that no motion has, or that is larger than its member of the archive."""
    shape, _, dtype = READERS[npy.read_magic(stream)](stream)
    if dtype.kind not in TYPES or (dtype.kind == "f" and dtype.itemsize != 8):
        raise CorruptMotion(
            f"{key} has the type {dtype.name}: it must be one of {', '.join(sorted(set(TYPES.values())))}"
        )
    if math.prod(shape) * dtype.itemsize > size:
        raise CorruptMotion(f"{key} is shorter than it says")
