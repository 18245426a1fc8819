"""Work on a Dask cluster: a real scheduler with two workers, on free ports. The cores are tested with the studies."""

import os
import socket
import sys
import time

import pytest

from stepover.errors import InvalidInput, StepOverError
from stepover.studies import parallel
from stepover.studies.parallel import computed
from stepover.studies.study import run_study


@pytest.fixture(scope="module")
def cluster():
    """A scheduler with two workers, each a process of its own."""
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=2, processes=True, scheduler_port=0, dashboard_address=":0"
    ) as found:
        yield found


@pytest.fixture
def address(cluster):
    """Of its scheduler."""
    return cluster.scheduler_address


def process(point):
    """Where a point was computed."""
    time.sleep(0.1)
    return {"square": point**2, "process": os.getpid()}


def failing(point):
    """Work that goes wrong."""
    return {"inverse": 1 / point}


def test_both_workers_do_it_and_each_point_once(address):
    rows = list(computed(range(8), process, address))
    assert sorted((point, row["square"]) for point, row in rows) == [(k, k**2) for k in range(8)]
    assert len({row["process"] for _, row in rows}) == 2


def test_one_row_at_a_time_in_a_process(address):
    assert all(row["alone"] for _, row in computed(range(8), alone, address))


def alone(point):
    """Whether nothing else is computed in this process meanwhile, though the worker has two threads."""
    running = globals().setdefault("running", [])
    running.append(point)
    time.sleep(0.1)
    found = running == [point]
    running.remove(point)
    return {"alone": found}


@pytest.mark.filterwarnings("ignore:.*tasks which were still:UserWarning")
def test_a_study_goes_on_elsewhere(address, tmp_path):
    begun = computed(range(6), process, address)
    assert next(begun)[1]["square"] in [k**2 for k in range(6)]
    begun.close()  # as Ctrl-C does
    first = run_study(range(3), process, tmp_path / "part", workers=1)
    rows = run_study(range(6), process, tmp_path / "part", workers=address)
    assert rows[:3] == first
    assert [row["square"] for row in rows] == [k**2 for k in range(6)]
    assert len((tmp_path / "part").read_bytes().splitlines()) == 6


def test_an_error_comes_back(address):
    with pytest.raises(ZeroDivisionError):
        list(computed([1, 0, 2], failing, address))
    assert len(list(computed([1, 2], failing, address))) == 2, "the cluster works on"


def test_workers_with_other_code_are_refused(address, monkeypatch):
    monkeypatch.setattr(parallel, "_code", lambda: os.getpid())  # not the same in all processes
    with pytest.raises(InvalidInput, match="another stepover"):
        list(computed([1], process, address))


def test_workers_without_stepover_are_refused(address, monkeypatch):
    def missing():
        raise ModuleNotFoundError("No module named 'stepover'")

    monkeypatch.setattr(parallel, "_code", missing)
    with pytest.raises(InvalidInput, match="cannot load stepover: ModuleNotFoundError"):
        list(computed([1], process, address))


def test_no_scheduler(monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr(parallel, "PATIENCE", 0.5)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    for nowhere in (f"tcp://127.0.0.1:{port}", "nonsense://here", "here"):
        with pytest.raises(InvalidInput, match="no Dask scheduler answers"):
            list(computed([1], process, nowhere))


@pytest.mark.filterwarnings("ignore:.*tasks which were still:UserWarning")
def test_a_scheduler_that_is_lost(monkeypatch):
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr(parallel, "PATIENCE", 1.0)
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=True, scheduler_port=0, dashboard_address=":0"
    ) as short_lived:
        begun = computed(range(1000), process, short_lived.scheduler_address)
        next(begun)
    with pytest.raises(StepOverError, match="is lost; finished rows are kept"):
        list(begun)


def test_no_worker(monkeypatch):
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr(parallel, "PATIENCE", 0.5)
    with (
        distributed.LocalCluster(n_workers=0, scheduler_port=0, dashboard_address=":0") as empty,
        pytest.raises(InvalidInput, match="has no worker"),
    ):
        list(computed([1], process, empty.scheduler_address))


def test_without_the_package(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InvalidInput, match=r"a Dask cluster needs distributed: pip install 'stepover\[dask\]'"):
        list(computed([1], process, "tcp://127.0.0.1:1"))
