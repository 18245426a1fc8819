"""Long tables: many points, planned and simulated in parallel, resumable. `make studies` runs all of them.

Each finished point is appended to a part file in build/, whose name carries a fingerprint of everything that the
result depends on: the code of the planner and the physics, and the robot. So a study that is interrupted, or killed,
goes on where it stopped, and one whose planner has changed begins anew. The table itself is written at the end, whole.
"""

from __future__ import annotations

import hashlib
import json
import multiprocessing
import os
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any

from tqdm import tqdm

from stepover.model.robot import data_folder

Row = dict[str, Any]
Work = Callable[[Any], Row]

DEPENDS_ON = ("model", "units", "simulation", "errors.py", "motion.py", "planner.py", "verdict.py")
"""Code that a result depends on."""


def fingerprint(robot: str, *more: object) -> str:
    """Twelve digits that change with the code, the robot's files, or anything else that is named."""
    package = Path(__file__).resolve().parents[1]
    found = (path for name in DEPENDS_ON for path in ([package / name] if name.endswith(".py")
                                                      else (package / name).rglob("*.py")))  # fmt: skip
    files = [*sorted(found), *sorted(path for path in (data_folder() / robot).iterdir() if path.suffix != ".md")]
    digest = hashlib.sha256(repr(more).encode())
    for path in files:
        digest.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()[:12]


def run_study(
    points: Sequence[Any], work: Work, part: Path, *, workers: int | None = None, name: str = "study"
) -> list[Row]:
    """Rows of all points in their order; those that the part file has already are not computed again.

    Args:
        points: what work takes, each with a repr of its own.
        work: a function at the top of a module, from a point to a row of plain values.
        part: where finished rows are kept until the study is whole.
        workers: processes, 1: this one; None: one a core.
        name: for the progress bar, which goes to stderr.
    """
    part.parent.mkdir(parents=True, exist_ok=True)
    done = _read_part(part)
    missing = [point for point in points if repr(point) not in done]
    with (
        open(part, "ab") as file,
        tqdm(total=len(points), initial=len(points) - len(missing), desc=name, unit="point", disable=None) as bar,
    ):
        for point, row in _computed(missing, work, workers):
            file.write(json.dumps([repr(point), row]).encode() + b"\n")
            file.flush()
            os.fsync(file.fileno())
            done[repr(point)] = json.loads(json.dumps(row))
            bar.update()
    return [done[repr(point)] for point in points]


def _computed(points: Sequence[Any], work: Work, workers: int | None) -> Iterator[tuple[Any, Row]]:
    """Points with their rows, as they are finished."""
    if workers == 1 or len(points) < 2:
        yield from ((point, work(point)) for point in points)
        return
    context = multiprocessing.get_context("spawn")
    count = min(len(points), workers or os.cpu_count() or 1)
    with ProcessPoolExecutor(count, mp_context=context, initializer=_end_with_parent) as pool:
        waiting = {pool.submit(work, point): point for point in points}
        try:
            for future in as_completed(waiting):
                yield waiting[future], future.result()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _end_with_parent() -> None:
    """Let a worker end when its parent does, even one that is killed."""
    parent = multiprocessing.parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _read_part(part: Path) -> dict[str, Row]:
    """Rows of a part file by their points; a last line that was cut short is cut off."""
    if not part.is_file():
        return {}
    content = part.read_bytes()
    whole = content[: content.rfind(b"\n") + 1]
    if whole != content:
        os.truncate(part, len(whole))
    return dict(json.loads(line) for line in whole.splitlines())


def run_all(studies: Iterable[Callable[[], Path]]) -> None:
    """Run studies one after the other, and name the tables that they wrote."""
    for study in studies:
        print(study())


if __name__ == "__main__":
    from stepover.report.plane import study as obstacle_plane

    run_all([obstacle_plane])
