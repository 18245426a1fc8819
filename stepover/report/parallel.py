"""Work spread over the cores. The only door to joblib."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from joblib import Parallel, cpu_count, delayed

Row = dict[str, Any]
Work = Callable[[Any], Row]
"""From a point to a row of plain values: a function, or an object that can be called, that a process can be handed."""


def computed(points: Sequence[Any], work: Work, workers: int | None = None) -> Iterator[tuple[Any, Row]]:
    """Points with their rows, as they are finished.

    Args:
        points: what work takes.
        work: a function at the top of a module, or an object that can be called.
        workers: processes, 1: this one; one a core unless given.
    """
    count = min(len(points), workers or cpu_count())
    if count > 0:
        pool = Parallel(
            count, return_as="generator_unordered", batch_size=1, max_nbytes=None, initializer=_serve,
            initargs=(os.getpid(),),
        )  # fmt: skip
        yield from pool(delayed(_with_row)(work, point) for point in points)


def _with_row(work: Work, point: Any) -> tuple[Any, Row]:
    """A point and its row."""
    return point, work(point)


def _serve(parent: int) -> None:
    """Let a process leave Ctrl-C to its parent, and end when the parent does, even one that is killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
