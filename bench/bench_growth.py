"""How planning grows: with the duration of the walk before the obstacle, with its samples, with many obstacles."""

from __future__ import annotations

import dataclasses
import subprocess
import sys
from itertools import count

import pytest
from prepared import HIGHER, WIDTH

from stepover.model.obstacle import Obstacle
from stepover.planning.algorithm_1.planner import plan_in_detail

HEIGHT, GROUP = 0.15, "15 cm"
WALKS = {30: 6.5, 100: 28.1, 300: 90.6, 1000: 309.4}
"""Duration of the whole walk [s], and how far away the obstacle then stands [m]."""
SAMPLE_TIMES = (0.01, 0.0025)
COLD = """
import resource
from stepover import Obstacle, load_robot, plan
plan(load_robot("hrp2"), Obstacle(0.15, 0.05, distance={distance}))
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024)
"""


@pytest.mark.parametrize("seconds", WALKS)
def test_duration(measure, benchmark, robot, seconds):
    plan = measure(
        f"plan, {seconds} s of walking", GROUP, lambda obstacle: plan_in_detail(robot, obstacle),
        lambda k: (Obstacle(HEIGHT + HIGHER * k, WIDTH, distance=WALKS[seconds]),), 5 if seconds < 300 else 2,
    )  # fmt: skip
    motion = plan.motion
    assert motion.time[-1] == pytest.approx(seconds, rel=0.05)
    call = [sys.executable, "-c", COLD.format(distance=WALKS[seconds])]
    resident = int(subprocess.run(call, check=True, capture_output=True, text=True).stdout)
    benchmark.extra_info |= {"walk": seconds, "samples": len(motion.time), "resident_bytes": resident}


@pytest.mark.parametrize("sample_time", SAMPLE_TIMES)
def test_samples(measure, benchmark, robot, sample_time):
    finer = dataclasses.replace(robot, walk=dataclasses.replace(robot.walk, sample_time=sample_time))
    plan = measure(
        f"plan, a sample every {1e3 * sample_time:g} ms", GROUP, lambda obstacle: plan_in_detail(finer, obstacle),
        lambda k: (Obstacle(HEIGHT + HIGHER * k, WIDTH),), 9,
    )  # fmt: skip
    benchmark.extra_info |= {"walk": plan.motion.time[-1], "samples": len(plan.motion.time)}


@pytest.mark.parametrize("jobs", [1, 2])
@pytest.mark.parametrize("obstacles", [100, 1000])
def test_obstacles(measure, benchmark, tmp_path, obstacles, jobs):
    numbers, heights = count(), f"0.1:{0.1 + HIGHER / 2.0 * (obstacles - 1):.5f}:{HIGHER / 2.0}"

    def call(table):
        command = ["-m", "stepover", "sweep", "--heights", heights, "--widths", f"{WIDTH}", "--jobs", f"{jobs}"]
        subprocess.run([sys.executable, *command, "--output", table], check=True, capture_output=True)

    measure(f"sweep, {obstacles} obstacles, {jobs} job{'s' * (jobs > 1)}", GROUP, call,
            lambda _: (tmp_path / f"{next(numbers)}.csv",), 1, 0)  # fmt: skip
    benchmark.extra_info |= {"obstacles": obstacles, "jobs": jobs}
    assert len((tmp_path / "0.csv").read_text().splitlines()) == obstacles + 1
