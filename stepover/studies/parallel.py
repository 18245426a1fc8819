"""Work spread over the cores, or over a Dask cluster, by joblib. The only door to joblib and Dask."""

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
"""From a point to a row of plain values: a function, or an object that can be called, that a process can be handed."""


PATIENCE = 10.0
"""How long a cluster may take to answer, and to have a worker [s]."""

_one_at_a_time = threading.Lock()


def computed(points: Sequence[Any], work: Work, workers: int | str | None = None) -> Generator[tuple[Any, Row]]:
    """Points with their rows, as they are finished.

    Args:
        points: what work takes.
        work: a function at the top of a module, or an object that can be called.
        workers: processes, 1: this one; one a core unless given; or the address of a Dask scheduler, whose workers
            do the work then.

    Raises:
        InvalidInput: the cluster does not answer, has no worker, or its workers run other code than this.
        StepOverError: its scheduler is lost on the way. Workers may be: others do their work.
    """
    warnings.filterwarnings("ignore", r"\d+ tasks .*(not used|cancelled)")  # joblib's word on an interruption
    if len(points) > 0:
        with _cluster(workers) if isinstance(workers, str) else _cores(len(points), workers) as pool:
            yield from pool(delayed(_with_row)(work, point) for point in points)


@contextmanager
def _cores(count: int, workers: int | None) -> Iterator[Parallel]:
    """Processes on this machine, no more than there are points."""
    count = min(count, workers or cpu_count())
    yield Parallel(
        count, return_as="generator_unordered", batch_size=1, max_nbytes=None, initializer=_serve,
        initargs=(os.getpid(),),
    )  # fmt: skip


@contextmanager
def _cluster(address: str) -> Iterator[Parallel]:
    """The workers of a Dask scheduler, which is left running."""
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
    """Give up where the scheduler is lost for longer than PATIENCE: joblib would wait for its rows for ever."""
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
    if lost.is_set():  # joblib may also just end, with rows missing
        raise StepOverError(f"the Dask scheduler at {address} is lost; what is finished is kept")


def _require_same_code(client: Any) -> None:
    """Refuse workers whose rows would be those of another stepover."""
    try:
        found = set(client.run(_code).values())
    except Exception as error:  # whatever a worker makes of a package that it does not have
        raise InvalidInput(f"the Dask workers cannot load stepover: {type(error).__name__}, {error}") from error
    if found != {_code()}:
        raise InvalidInput("the Dask workers run another stepover than this one: install the same everywhere")


def _code() -> str:
    """Digest of the package's code."""
    package, digest = Path(__file__).resolve().parents[1], hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
        digest.update(path.relative_to(package).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()


def _with_row(work: Work, point: Any) -> tuple[Any, Row]:
    """A point and its row. One at a time in a process: a Dask worker may have threads, a robot's pools are for one."""
    with _one_at_a_time:
        return point, work(point)


def _serve(parent: int) -> None:
    """Let a process leave Ctrl-C to its parent, and end when the parent does, even one that is killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
