"""Studies: many points, planned and simulated in parallel. They can be resumed. `make studies` runs all of them.

Each finished point is appended to a part file. The file's name contains a fingerprint of all that the rows depend on:
the code that computes them, and the robot. So an interrupted study continues where it stopped, and a study whose code
has changed begins anew. At the end the whole table is written and the part file removed. A row is a frozen dataclass
of plain values.
"""

from __future__ import annotations

import contextlib
import csv
import dataclasses
import hashlib
import io
import json
import os
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar

from tqdm import tqdm

from stepover.errors import InvalidInput
from stepover.locations import checkout
from stepover.model.robot import Robot
from stepover.output import alone, write_whole
from stepover.robots.loading import load_robot
from stepover.studies.fingerprint import fingerprint
from stepover.studies.parallel import Row, Work, computed

Kind = TypeVar("Kind")
ENGINE = "mujoco"
"""The engine of the stored tables of many simulations: the faster one. two_engines.py repeats samples in the other."""


def make_table(
    name: str, points: Sequence[Any], work: Work, kind: type[Any], table: Path | None = None,
    build: Path | None = None, workers: int | str | None = None, more: Sequence[object] = (),
) -> Path:  # fmt: skip
    """Run or resume a study, write its table, and remove the part file.

    If the part file and the table are in different folders, a stamp file stays beside the former. It prevents that a
    finished study is run again.

    Args:
        name: name of the study.
        points: the points, each with the name of its robot.
        work: see run_study.
        kind: dataclass of a row.
        table: path of the table; default: in figures/.
        build: folder of the part file; default: build/.
        workers: number of processes, or a Dask cluster; see run_study.
        more: further values that the rows depend on, beside the code and the robot.

    Returns:
        Path of the table.

    Raises:
        InvalidInput: another run is making this table, or the part file is damaged.
    """
    table, build = table or stored_table(name), build or checkout() / "build"
    made_by = fingerprint(work, points[0].robot, *more)
    stamp, stamped = build / f"{name}.stamp", table.parent != build
    if stamped and stamp.is_file() and stamp.read_text() == _stamp(made_by, points, table):
        return table
    part = build / f"{name}-{made_by}.part"
    with alone(build / f".{name}.lock", f"{table} is being made"):
        rows = run_study(points, work, part, workers=workers, name=name)
        write_rows(_as_rows(rows, kind, part), table)
        part.unlink()
    if stamped:
        stamp.write_text(_stamp(made_by, points, table))
    return table


def _as_rows(rows: Sequence[Row], kind: type[Any], part: Path) -> list[Any]:
    """Rows as dataclasses. Raises InvalidInput where a part file holds a row of another kind."""
    try:
        return [kind(**row) for row in rows]
    except TypeError as error:
        raise InvalidInput(f"{part} is damaged: {error}; delete it to begin anew") from error


def _stamp(made_by: str, points: Sequence[Any], table: Path) -> str:
    """Text that identifies a finished table: the fingerprint, and digests of the points and of the table."""
    parts = repr(list(points)).encode(), table.read_bytes() if table.is_file() else b""
    return " ".join([made_by, *(hashlib.sha256(part).hexdigest() for part in parts)])


def stored_table(name: str) -> Path:
    """Path of a study's table in figures/."""
    return checkout() / "figures" / f"{name}.csv"


def write_rows(rows: Sequence[Any], path: Path) -> None:
    """Write rows of one dataclass as CSV. The file appears only when it is complete."""
    text = io.StringIO()
    lines = csv.DictWriter(text, [field.name for field in dataclasses.fields(rows[0])], lineterminator="\n")
    lines.writeheader()
    lines.writerows(dataclasses.asdict(row) for row in rows)
    write_whole(path, lambda file: file.write(text.getvalue().encode()))


def read_rows(kind: type[Kind], path: Path) -> list[Kind]:
    """Rows of a table.

    Raises:
        InvalidInput: there is no such table, or its rows are of another kind.
    """
    types = {field.name: str(field.type) for field in dataclasses.fields(kind)}  # type: ignore[arg-type]
    try:
        with open(path, newline="") as file:
            lines = list(csv.DictReader(file))
        return [kind(**{name: _value(types[name], text) for name, text in line.items()}) for line in lines]
    except OSError as error:
        raise InvalidInput(f"{path} cannot be read: {error.strerror}; 'make studies' writes it") from error
    except (KeyError, TypeError, ValueError) as error:
        raise InvalidInput(f"{path} is not a table of this study ({error}); 'make studies' writes it anew") from error


@lru_cache(maxsize=2)
def robot_of(name: str) -> Robot:
    """A robot, loaded once in each process."""
    return load_robot(name)


def rounded(value: float, digits: int = 5) -> float:
    """A length [m] for a table, rounded to hundredths of a millimetre."""
    return round(float(value), digits)


def run_study(
    points: Sequence[Any], work: Work, part: Path, *, workers: int | str | None = None, name: str = "study"
) -> list[Row]:
    """Rows of all points in their order. Rows that are already in the part file are not computed again.

    Args:
        points: inputs of work, each with a different repr.
        work: a function at the top of a module, from a point to a row of plain values.
        part: file that keeps finished rows until the study is complete.
        workers: number of processes, where 1 means only this one; the address of a Dask scheduler; None: one process
            for each core.
        name: name in the progress bar, which goes to stderr.

    Raises:
        InvalidInput: the part file is damaged. A last line that was cut short is allowed.
    """
    part.parent.mkdir(parents=True, exist_ok=True)
    done = _read_part(part)
    missing = [point for point in points if repr(point) not in done]
    with (
        open(part, "ab") as file,
        tqdm(total=len(points), initial=len(points) - len(missing), desc=name, unit="point", disable=None) as bar,
        contextlib.closing(computed(missing, work, workers)) as rows,
    ):
        for point, row in rows:
            file.write(json.dumps([repr(point), row]).encode() + b"\n")
            file.flush()
            os.fsync(file.fileno())
            done[repr(point)] = json.loads(json.dumps(row))
            bar.update()
    return [done[repr(point)] for point in points]


def _read_part(part: Path) -> dict[str, Row]:
    """Rows of a part file by their points. A last line that was cut short is removed from the file."""
    if not part.is_file():
        return {}
    content = part.read_bytes()
    whole = content[: content.rfind(b"\n") + 1]
    if whole != content:
        os.truncate(part, len(whole))
    try:
        return dict(json.loads(line) for line in whole.splitlines())
    except (TypeError, ValueError) as error:
        raise InvalidInput(f"{part} is damaged: a line is no row of a study; delete it to begin anew") from error


def _value(kind: str, text: str) -> Any:
    """A cell of a table: nothing for None, True or False, a number, a text."""
    if text == "" and "None" in kind:
        return None
    if "bool" in kind:
        return {"True": True, "False": False}[text]
    return int(text) if "int" in kind else float(text) if "float" in kind else text
