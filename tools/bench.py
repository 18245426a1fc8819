"""The report of `make bench`: times, their ratios to a yardstick, and the history of all runs.

The benchmarks are in bench/, timed by pytest-benchmark. This module turns its file into a table and a new entry of
bench/history.json. Each time is a median of calls that each plan another obstacle. It is also given in multiples of the
yardstick of the same run: one sweep of the rigid-body dynamics over the motion's samples, on one thread. So runs on
different machines, or under different loads, can be compared.
"""

from __future__ import annotations

import json
import math
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from stepover.errors import InvalidInput
from stepover.output import write_whole
from stepover.report.tables.table import Table, table
from stepover.reproduction.marked import with_block

YARDSTICK = "yardstick"
MARK = "bench"
"""Around the tables of docs/speed.md."""
GROWTH = {"walk", "obstacles"}
"""Marks of a benchmark of longer walks, or of many obstacles."""


@dataclass(frozen=True)
class Timed:
    """One benchmark.

    Attributes:
        what: the name of the timed call.
        group: benchmarks with the same yardstick, such as "15 cm".
        median, spread: of a call, and its interquartile range [s].
        rounds: how often it was called.
        ratio: of the median to that of the yardstick; None without a yardstick.
        more: other numbers by name: bytes, samples, simulated seconds.
    """

    what: str
    group: str
    median: float
    spread: float
    rounds: int
    ratio: float | None
    more: dict[str, float]


@dataclass(frozen=True)
class Benchmark:
    """One run of the benchmarks.

    Attributes:
        date: of the run, in UTC.
        version, commit: of stepover; a "+" at the end marks uncommitted changes.
        machine: processor, cores, load of the last minute, BLAS threads, Python, packages.
        times: the benchmarks.
    """

    date: str
    version: str
    commit: str
    machine: dict[str, Any]
    times: tuple[Timed, ...]


def read(path: Path) -> Benchmark:
    """A run from the file of pytest-benchmark.

    Raises:
        InvalidInput: the file is missing or damaged.
    """
    try:
        found = json.loads(path.read_text())
        info, commit = found["machine_info"], found["commit_info"]
        yardsticks = {
            one["group"]: one["stats"]["median"]
            for one in found["benchmarks"]
            if one["extra_info"]["what"] == YARDSTICK
        }
        machine = {"processor": info["cpu"].get("brand_raw", info["machine"]), "cores": info["cpu"].get("count")}
        machine |= {name: info[name] for name in ("load", "threads", "python_version", "packages")}
        made_by = (commit.get("id") or "") + "+" * bool(commit.get("dirty"))
        return Benchmark(
            found["datetime"][:19], info["packages"]["stepover"], made_by, machine,
            tuple(_timed(one, yardsticks.get(one["group"])) for one in found["benchmarks"]),
        )  # fmt: skip
    except OSError as error:
        raise InvalidInput(f"{path} cannot be read: {error.strerror}; 'make bench' writes it") from error
    except (KeyError, TypeError, ValueError) as error:
        raise InvalidInput(f"{path} is no file of 'make bench' ({error})") from error


def _timed(one: dict[str, Any], yardstick: float | None) -> Timed:
    """One benchmark of pytest-benchmark."""
    stats, more = one["stats"], dict(one["extra_info"])
    ratio = stats["median"] / yardstick if yardstick else None
    return Timed(more.pop("what"), one["group"], stats["median"], stats["iqr"], stats["rounds"], ratio, more)


def times_table(run: Benchmark) -> Table:
    """Medians and their ratios to the yardstick, a column for each group; without the growth."""
    times = [one for one in run.times if not GROWTH & set(one.more)]
    groups = list(dict.fromkeys(one.group for one in times))
    cells = {(one.what, one.group): one for one in times}
    rows = [
        (what, *(text for group in groups for text in _cells(cells.get((what, group)))))
        for what in dict.fromkeys(one.what for one in times)
    ]
    return table(" | ".join(["median", *(f"{group} [ms] | of yardstick" for group in groups)]), rows)


def _cells(one: Timed | None) -> tuple[str, str]:
    """Milliseconds and ratio."""
    if one is None:
        return "", ""
    return _short(1e3 * one.median), "-" if one.ratio is None else _short(one.ratio)


def _short(value: float) -> str:
    """Three significant digits, without a power of ten."""
    return f"{value:.{max(0, 2 - math.floor(math.log10(value)))}f}"


def walks_table(run: Benchmark) -> Table:
    """Planning time by the duration of the walk, and by its number of samples."""
    rows = [
        (one.what, int(one.more["samples"]), _short(one.median), _short(1e6 * one.median / one.more["samples"]),
         f"{one.more['resident_bytes'] / 2**20:.0f}" if "resident_bytes" in one.more else "")
        for one in run.times if "walk" in one.more
    ]  # fmt: skip
    return table("plan | samples | time [s] | a sample [us] | resident at most [MiB]", rows)


def sweeps_table(run: Benchmark) -> Table:
    """Time of a sweep by its number of obstacles, and the gain of a second core."""
    sweeps = [one for one in run.times if "obstacles" in one.more]
    alone = {one.more["obstacles"]: one.median for one in sweeps if one.more["jobs"] == 1}
    rows = [
        (int(one.more["obstacles"]), int(one.more["jobs"]), _short(one.median),
         _short(1e3 * one.median / one.more["obstacles"]), f"{alone[one.more['obstacles']] / one.median:.2f}")
        for one in sweeps
    ]  # fmt: skip
    return table("obstacles | jobs | time [s] | an obstacle [ms] | times as fast as one job", rows)


def other_numbers(run: Benchmark) -> list[str]:
    """Memory and the real-time factor, in words."""
    lines = []
    for one in run.times:
        name = f"{one.what}, {one.group}"
        if "samples" in one.more and "walk" not in one.more:
            lines.append(f"{name}: {1e6 * one.median / one.more['samples']:.1f} us a sample, "
                         f"{int(one.more['samples'])} samples")  # fmt: skip
        if "peak_bytes" in one.more:
            lines.append(f"{name}: {one.more['peak_bytes'] / 2**20:.0f} MiB allocated at most")
        if "resident_bytes" in one.more and "walk" not in one.more:
            lines.append(f"{name}: {one.more['resident_bytes'] / 2**20:.0f} MiB resident at most, libraries included")
        if "simulated" in one.more:
            lines.append(f"{name}: {one.more['simulated'] / one.median:.2f} times faster than real time")
    return lines


def append(run: Benchmark, history: Path) -> int:
    """Add a run to the history, completely or not at all.

    Returns:
        The number of runs in the history.

    Raises:
        InvalidInput: the history is damaged, or cannot be written to.
    """
    try:
        runs = json.loads(history.read_text()) if history.is_file() else []
    except ValueError as error:
        raise InvalidInput(f"{history} is damaged ({error}); put the committed one back") from error
    runs.append(asdict(run))
    write_whole(history, lambda file: file.write((json.dumps(runs, indent=1) + "\n").encode()))
    return len(runs)


def last(history: Path) -> Benchmark:
    """The latest run of a history."""
    run = json.loads(history.read_text())[-1]
    return Benchmark(**run | {"times": tuple(Timed(**one) for one in run["times"])})


def page(run: Benchmark, path: Path) -> str:
    """The text of a page with the tables of a run between its marks: see with_block."""
    lines = [_machine(run), "", times_table(run)._repr_markdown_(), ""]
    lines += [f"- {line}" for line in other_numbers(run)]
    lines += ["", walks_table(run)._repr_markdown_(), "", sweeps_table(run)._repr_markdown_()]
    return with_block(path, MARK, "\n".join(lines))


def _machine(run: Benchmark) -> str:
    """The machine and versions of a run."""
    machine = run.machine
    return (f"{machine['processor']}, {machine['cores']} cores, load {machine['load']:.1f} at the end, "
            f"{machine['threads']} BLAS thread, Python {machine['python_version']}, "
            f"stepover {run.version}, {run.date[:10]}.")  # fmt: skip


def main(found: str, history: str, shown: str) -> None:
    """Print a run with its machine, add it to the history, and update the page."""
    run = read(Path(found))
    print(times_table(run), "", *other_numbers(run), "", walks_table(run), "", sweeps_table(run), sep="\n")
    print(f"\n{_machine(run)}")
    if run.machine["load"] > 1.5:
        print("the machine was busy with other work: trust the ratios, not the times")
    text = page(run, Path(shown))
    print(f"kept as run {append(run, Path(history))} of {history}")
    write_whole(Path(shown), lambda file: file.write(text.encode()))


if __name__ == "__main__":
    main(*sys.argv[1:])
