"""Runs side by side: threads, processes, and two runs that write to one place."""

from __future__ import annotations

import ctypes
import json
import multiprocessing
import os
import sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import dataclass

import pytest
from still import samples_of
from test_reproduce import DRAW, write

from stepover import Obstacle, load_robot, plan, simulate
from stepover.errors import InvalidInput
from stepover.reproduction import run as module
from stepover.reproduction.run import reproduce
from stepover.studies.study import make_table

HEIGHTS = (0.05, 0.10, 0.15, 0.20)


def planned(height: float) -> str:
    """Hash of a motion."""
    return plan(load_robot("hrp2"), Obstacle(height, 0.05)).hash()


def simulated(motion) -> str:
    """Hash of what comes of a motion in the physics."""
    return simulate(motion, actuators="limited").state_hash


@pytest.fixture(scope="module")
def short(motion):
    """The first half second of a motion."""
    return samples_of(motion, range(100))


@pytest.fixture(scope="module")
def alone(short):
    """What comes of it with nothing beside it."""
    return simulated(short)


def test_plans_in_eight_threads():
    serial = [planned(height) for height in HEIGHTS]
    with ThreadPoolExecutor(8) as pool:
        assert list(pool.map(planned, HEIGHTS * 2)) == serial * 2


def test_simulations_in_four_threads_leave_the_streams_alone(short, alone, capfd):
    places = [os.fstat(descriptor).st_ino for descriptor in (1, 2)]
    with ThreadPoolExecutor(4) as pool:
        runs = [pool.submit(simulated, short) for _ in range(4)]
        for k in range(200):
            os.write(1, f"line {k}\n".encode())
        assert [run.result() for run in runs] == [alone] * 4
    assert [os.fstat(descriptor).st_ino for descriptor in (1, 2)] == places
    ctypes.CDLL(None).puts(b"C prints again")
    ctypes.CDLL(None).fflush(None)
    assert capfd.readouterr().out == "".join(f"line {k}\n" for k in range(200)) + "C prints again\n"


def test_simulations_in_spawned_processes(short, alone):
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        assert list(pool.map(simulated, [short] * 4)) == [alone] * 4


def test_an_experiment_beside_the_reference(tmp_path, monkeypatch):
    write(tmp_path, "good", DRAW)
    heights = []

    def drawn(notebook, executed, staging, values, label):
        heights.append(values.get("height"))
        (staging / "drawn.txt").write_text(str(values))
        if len(heights) == 1:
            reproduce(tmp_path, "good", {"height": "0.1"})
            with pytest.raises(InvalidInput, match=r"figures/ is being written by another run"):
                reproduce(tmp_path)

    monkeypatch.setattr(module, "run_notebook", drawn)
    reproduce(tmp_path)
    assert heights == [None, 0.1]
    assert (tmp_path / "figures" / "drawn.txt").read_text() == "{}"
    assert (tmp_path / "build" / "figures" / "drawn.txt").read_text() == "{'height': 0.1}"
    assert [path.name for path in (tmp_path / "build").rglob("*.lock")] == []
    reproduce(tmp_path)


@dataclass(frozen=True)
class Point:
    """A number, and the robot whose files count for the table's fingerprint."""

    number: int
    robot: str = "hrp2"


@dataclass(frozen=True)
class Square:
    """A row."""

    square: int


def square(point):
    """Work."""
    return {"square": point.number**2}


def test_two_runs_do_not_make_one_table(tmp_path):
    table = tmp_path / "table.csv"

    def work(point):
        with pytest.raises(InvalidInput, match=r"table\.csv is being made by another run"):
            make_table("table", [Point(1)], square, Square, table, tmp_path, 1)
        return square(point)

    work.__module__ = __name__
    make_table("table", [Point(3)], work, Square, table, tmp_path, 1)
    assert table.read_text() == "square\n9\n"
    assert list(tmp_path.iterdir()) == [table]


def test_a_part_row_of_another_kind_is_one_line(tmp_path):
    def interrupted(point):
        raise KeyboardInterrupt

    interrupted.__module__ = __name__
    with pytest.raises(KeyboardInterrupt):
        make_table("table", [Point(1)], interrupted, Square, tmp_path / "table.csv", tmp_path, 1)
    (part,) = tmp_path.glob("*.part")
    part.write_text(json.dumps([repr(Point(1)), {"square": 1, "cube": 1}]) + "\n")
    with pytest.raises(InvalidInput, match=r"is damaged: .*'cube'; delete it to begin anew"):
        make_table("table", [Point(1)], square, Square, tmp_path / "table.csv", tmp_path, 1)


def test_the_kernel_is_this_python_whatever_is_installed_as_python3(tmp_path, monkeypatch):
    kernel = tmp_path / "jupyter" / "kernels" / "python3"
    kernel.mkdir(parents=True)
    other = {"argv": ["/bin/false", "{connection_file}"], "display_name": "another", "language": "python"}
    (kernel / "kernel.json").write_text(json.dumps(other))
    monkeypatch.setenv("JUPYTER_PATH", str(tmp_path / "jupyter"))
    monkeypatch.setenv("JUPYTER_DATA_DIR", str(tmp_path / "jupyter"))
    write(tmp_path, "good", DRAW + "\nimport sys\nPath(output, 'python.txt').write_text(sys.executable)")
    reproduce(tmp_path)
    assert (tmp_path / "figures" / "python.txt").read_text() == sys.executable
