"""The format csv: a table of time, waist, CoM, ZMPs, feet and joints, with one row for each sample, in SI units."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np

from stepover.motion.motion import Motion
from stepover.output import write_whole

AXES = ("x", "y", "z", "qx", "qy", "qz", "qw")
PARTS = (("waist", 7), ("com", 3), ("zmp_reference", 2), ("zmp", 2), ("left_foot", 7), ("right_foot", 7))
"""The values between time and joints, each with its number of columns."""


def export(motion: Motion, path: Path) -> None:
    """Write the table.

    Raises:
        InvalidInput: the folder does not exist or cannot be written to.
    """
    header = ["time", *(f"{name}_{axis}" for name, n in PARTS for axis in AXES[:n]), *motion.joint_names]
    table = np.column_stack([motion.time, *(getattr(motion, name) for name, _ in PARTS), motion.q[:, 7:]])

    def write(file: Any) -> None:
        lines = csv.writer(_Text(file))
        lines.writerow(header)
        lines.writerows([f"{value:.9g}" for value in row] for row in table)

    write_whole(path, write)


class _Text:
    """A binary file that the csv module can write text to."""

    def __init__(self, file: Any) -> None:
        self.write = lambda text: file.write(text.encode())
