"""Files that are written whole or not at all, and by one run at a time."""

from __future__ import annotations

import fcntl
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


@contextmanager
def alone(lock: Path, what: str) -> Iterator[None]:
    """Keep other runs from doing the same meanwhile. A run that is killed lets go of the lock.

    Args:
        lock: an empty file that is there meanwhile; its folder is made where it is missing.
        what: what is done, for the message, such as "figures/ is being written".

    Raises:
        InvalidInput: another run is doing it, or the file cannot be opened.
    """
    try:
        lock.parent.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(lock, os.O_RDWR | os.O_CREAT)
    except OSError as error:
        raise InvalidInput(f"{lock} cannot be written: {error.strerror}") from error
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise InvalidInput(f"{what} by another run: wait for it to end, or stop it") from error
        except OSError:
            pass  # a file system without locks
        try:
            yield
        finally:
            lock.unlink(missing_ok=True)
    finally:
        os.close(descriptor)
