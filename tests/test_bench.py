"""report/bench.py and bench/: the table comes out, beside its yardstick, and the history grows by one run."""

import json
import os
import subprocess
import sys

import pytest

from stepover.errors import InvalidInput
from stepover.locations import data_folder
from tools.bench import (
    Benchmark,
    Timed,
    append,
    last,
    main,
    other_numbers,
    page,
    read,
    sweeps_table,
    times_table,
    walks_table,
)

ROOT = data_folder().parent


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """The file of a run of three benchmarks, once each, with as many BLAS threads as the environment likes."""
    path = tmp_path_factory.mktemp("bench") / "bench.json"
    plain = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
    threads = {"OMP_NUM_THREADS": "2", "OPENBLAS_NUM_THREADS": "2"}
    subprocess.run(
        [sys.executable, "-m", "pytest", ROOT / "bench" / "bench_algorithm_1.py", "-k",
         "5cm and not 15cm and not 25cm and (yardstick or whole or feasibility)", "--rounds", "1",
         "--benchmark-json", path, "--benchmark-quiet", "-p", "no:cacheprovider"],
        check=True, capture_output=True, env=plain | threads, cwd=ROOT,
    )  # fmt: skip
    return path


def test_a_run_beside_its_yardstick(found):
    run = read(found)
    times = {one.what: one for one in run.times}
    assert set(times) == {"yardstick", "plan, the whole", "1 FU"}
    assert times["yardstick"].ratio == 1.0
    for one in run.times:
        assert one.group == "5 cm"
        assert one.median > 0.0
        assert one.ratio == pytest.approx(one.median / times["yardstick"].median)
    assert times["plan, the whole"].more["samples"] > 1000
    assert times["plan, the whole"].more["peak_bytes"] > 2**20
    assert run.machine["threads"] == 1, "the benchmark sets it"
    assert set(run.machine) == {"processor", "cores", "load", "threads", "python_version", "packages"}


def test_the_table_comes_out_and_the_history_grows(found, tmp_path, capsys):
    shown = tmp_path / "speed.md"
    shown.write_text("<!-- bench -->\n<!-- /bench -->")
    for count in (1, 2):
        main(str(found), str(tmp_path / "history.json"), str(shown))
        runs = json.loads((tmp_path / "history.json").read_text())
        assert len(runs) == count
    assert runs[0] == runs[1]
    assert last(tmp_path / "history.json") == read(found)
    assert "| yardstick |" in shown.read_text()
    assert {"date", "version", "commit", "machine", "times"} == set(runs[0])
    printed = capsys.readouterr().out
    for part in ("5 cm [ms]  of yardstick", "plan, the whole", "us a sample", "1 BLAS thread", "kept as run 2 of"):
        assert part in printed


def test_what_was_not_measured_is_left_empty():
    times = (
        Timed("yardstick", "5 cm", 0.01, 0.0, 3, 1.0, {}),
        Timed("simulate", "15 cm", 2.0, 0.0, 3, None, {"simulated": 8.0, "resident_bytes": 2**21}),
    )
    run = Benchmark("2026-01-01T00:00:00", "0", "", {}, times)
    assert times_table(run).rows == (("yardstick", "10.0", "1.00", "", ""), ("simulate", "", "", "2000", "-"))
    assert other_numbers(run) == [
        "simulate, 15 cm: 2 MiB resident at most, libraries included",
        "simulate, 15 cm: 4.00 times faster than real time",
    ]


def test_growth_stands_apart():
    times = (
        Timed("yardstick", "15 cm", 0.01, 0.0, 3, 1.0, {}),
        Timed("plan", "15 cm", 0.2, 0.0, 3, 20.0, {"walk": 30, "samples": 4000, "resident_bytes": 2**20}),
        Timed("sweep", "15 cm", 8.0, 0.0, 1, 800.0, {"obstacles": 100, "jobs": 1}),
        Timed("sweep", "15 cm", 5.0, 0.0, 1, 500.0, {"obstacles": 100, "jobs": 2}),
    )  # fmt: skip
    run = Benchmark("2026-01-01T00:00:00", "0", "", {}, times)
    assert times_table(run).rows == (("yardstick", "10.0", "1.00"),)
    assert other_numbers(run) == []
    assert walks_table(run).rows == (("plan", "4000", "0.200", "50.0", "1"),)
    assert sweeps_table(run).rows == (("100", "1", "8.00", "80.0", "1.00"), ("100", "2", "5.00", "50.0", "1.60"))


def test_the_page_shows_the_last_run():
    shown = ROOT / "docs" / "speed.md"
    assert page(last(ROOT / "bench" / "history.json"), shown) == shown.read_text()


def test_damaged_files_are_refused(found, tmp_path):
    with pytest.raises(InvalidInput, match="make bench"):
        read(tmp_path / "none.json")
    (tmp_path / "cut.json").write_text(found.read_text()[:100])
    with pytest.raises(InvalidInput, match="no file of"):
        read(tmp_path / "cut.json")
    (tmp_path / "other.json").write_text("{}")
    with pytest.raises(InvalidInput, match="machine_info"):
        read(tmp_path / "other.json")
    with pytest.raises(InvalidInput, match="damaged"):
        append(read(found), tmp_path / "cut.json")


def test_the_stored_history_can_be_read():
    runs = json.loads((ROOT / "bench" / "history.json").read_text())
    assert runs
    for run in runs:
        assert {"date", "version", "commit", "machine", "times"} == set(run)
        assert {"yardstick", "plan, the whole"} <= {one["what"] for one in run["times"]}
