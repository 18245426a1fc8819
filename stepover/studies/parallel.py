"""Run work on all cores or on a Dask cluster, with joblib. No other module uses joblib or Dask."""

from __future__ import annotations

import _thread
import hashlib
import os
import signal
import threading
import time
import warnings
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from joblib import Parallel, cpu_count, delayed, parallel_config

from stepover.errors import InvalidInput, StepOverError
from stepover.extras import needs

Row = dict[str, Any]
Work = Callable[[Any], Row]
"""A function or callable object from a point to a row of plain values. It must be picklable."""


PATIENCE = 10.0
"""Longest time for a cluster to answer, and to have a worker [s]."""

_one_at_a_time = threading.Lock()


def computed(points: Sequence[Any], work: Work, workers: int | str | None = None) -> Generator[tuple[Any, Row]]:
    """Points with their rows, in the order in which they are finished.

    Args:
        points: inputs of work.
        work: a function at the top of a module, or a callable object.
        workers: number of processes, where 1 means only this one; default: one for each core. Or the address of a Dask
            scheduler, whose workers then do the work.

    Raises:
        InvalidInput: the cluster does not answer, has no worker, or its workers run a different stepover.
        StepOverError: the connection to the scheduler is lost. If a worker is lost, others do its work.
    """
    warnings.filterwarnings("ignore", r"\d+ tasks .*(not used|cancelled)")  # joblib's message after an interruption
    if len(points) > 0:
        with _cluster(workers) if isinstance(workers, str) else _cores(len(points), workers) as pool:
            yield from pool(delayed(_with_row)(work, point) for point in points)


@contextmanager
def _cores(count: int, workers: int | None) -> Iterator[Parallel]:
    """Processes on this machine, at most one for each point."""
    count = min(count, workers or cpu_count())
    yield Parallel(
        count, return_as="generator_unordered", batch_size=1, max_nbytes=None, initializer=_serve,
        initargs=(os.getpid(),),
    )  # fmt: skip


@contextmanager
def _cluster(address: str) -> Iterator[Parallel]:
    """The workers of a Dask scheduler, which keeps running afterwards."""
    with needs("a Dask cluster"):
        from distributed import Client
    start = "'dask scheduler' starts one, 'dask worker ADDRESS --nworkers -1 --nthreads 1' its workers"
    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, ImportError) as error:
        raise InvalidInput(f"no Dask scheduler answers at {address!r}: {start}") from error
    with client:
        try:
            client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError as error:
            raise InvalidInput(f"the Dask scheduler at {address} has no worker: {start}") from error
        _require_same_code(client)
        with parallel_config(backend="dask", client=client):
            pool = Parallel(-1, return_as="generator_unordered", batch_size=1)
        with _watched(client, address):
            yield pool


@contextmanager
def _watched(client: Any, address: str) -> Iterator[None]:
    """Give up if the scheduler is lost for longer than PATIENCE. Otherwise joblib would wait for ever."""
    over, lost = threading.Event(), threading.Event()

    def watch() -> None:
        while not over.wait(0.2):
            if client.status == "closed":
                lost.set()
                _thread.interrupt_main()
                return

    threading.Thread(target=watch, daemon=True).start()
    try:
        yield
    except KeyboardInterrupt:
        if not lost.is_set():
            raise
    finally:
        over.set()
    if lost.is_set():  # joblib may also end early, with rows missing
        raise StepOverError(f"the Dask scheduler at {address} is lost; finished rows are kept")


def _require_same_code(client: Any) -> None:
    """Reject workers that run a different stepover."""
    try:
        found = set(client.run(_code).values())
    except Exception as error:  # a worker without the package may raise any error
        raise InvalidInput(f"the Dask workers cannot load stepover: {type(error).__name__}, {error}") from error
    if found != {_code()}:
        raise InvalidInput("the Dask workers run another stepover than this one: install the same version everywhere")


def _code() -> str:
    """Digest of the package's code."""
    package, digest = Path(__file__).resolve().parents[1], hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
        digest.update(path.relative_to(package).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()


def _with_row(work: Work, point: Any) -> tuple[Any, Row]:
    """A point and its row. A process computes one at a time, since a robot's pools serve only one thread."""
    with _one_at_a_time:
        return point, work(point)


def _serve(parent: int) -> None:
    """Let a process ignore Ctrl-C, which its parent handles, and end when the parent ends or is killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
