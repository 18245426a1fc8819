"""What the benchmarks share: one BLAS thread, the clock, and what their times hang on.

The planner's ZMP takes all cores, as it does for a user who does not set OMP_NUM_THREADS; the yardstick takes one.
"""

from __future__ import annotations

import os
import sys

if "numpy" in sys.modules:
    raise RuntimeError("numpy is loaded already: its number of threads can no longer be set; run 'make bench'")
os.environ["OPENBLAS_NUM_THREADS"] = "1"
os.environ.pop("OMP_NUM_THREADS", None)

from collections.abc import Callable, Iterator
from importlib.metadata import version
from itertools import count
from typing import Any

import pytest
from prepared import load

from stepover.model.robot import Robot


def pytest_addoption(parser: pytest.Parser) -> None:
    """How often each benchmark runs."""
    parser.addoption("--rounds", type=int, help="rounds of every benchmark; each has its own number unless given")


def pytest_benchmark_update_machine_info(config: pytest.Config, machine_info: dict[str, Any]) -> None:
    """What the times hang on, beside the processor."""
    machine_info["load"] = os.getloadavg()[0]
    machine_info["threads"] = int(os.environ["OPENBLAS_NUM_THREADS"])
    machine_info["packages"] = {name: version(name) for name in ("stepover", "numpy", "scipy", "pin", "pybullet")}


@pytest.fixture(scope="session")
def robot() -> Robot:
    """HRP-2."""
    return load()


@pytest.fixture
def measure(benchmark: Any, request: pytest.FixtureRequest) -> Callable[..., Any]:
    """Time a call: measure(what, group, call, setup, rounds) with new arguments from setup(number) each time."""

    def timed(
        what: str, group: str, call: Callable[..., Any], setup: Callable[[int], tuple], rounds: int, warmup: int = 1
    ) -> Any:
        rounds = request.config.getoption("--rounds") or rounds
        numbers: Iterator[int] = count()
        benchmark.group, benchmark.extra_info["what"] = group, what
        return benchmark.pedantic(call, setup=lambda: (setup(next(numbers)), {}), rounds=rounds, warmup_rounds=warmup)

    return timed
