"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import uuid
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from stepover.errors import InvalidInput


def part_of(path: Path) -> Path:
    """A name beside a file for what is written of it so far: another one each time, for any thread and machine."""
    return path.with_name(f".{path.stem[:40]}.{uuid.uuid4().hex}.part{path.suffix[:10]}")


@contextmanager
def replaced(path: Path) -> Iterator[Path]:
    """Give a path beside another one to write to; what is there in the end takes the other one's place, or nothing.

    Raises:
        InvalidInput: the folder does not exist or cannot be written to, or the disk is full.
    """
    beside = part_of(path)
    try:
        yield beside
        os.replace(beside, path)
    except OSError as error:
        raise InvalidInput(f"{path} cannot be written: {error.strerror or str(error).partition(chr(10))[0]}") from error
    finally:
        with suppress(OSError):
            beside.unlink(missing_ok=True)


def write_whole(path: Path, write: Callable[[Any], None]) -> None:
    """Write a file beside its place and rename it: whole or not at all.

    Raises:
        InvalidInput: the folder does not exist or cannot be written to, or the disk is full.
    """
    with replaced(path) as beside, open(beside, "wb") as file:
        write(file)
