"""How fast it is: medians of planning and simulation, on this machine. Run by `make bench`."""

from __future__ import annotations

import os
import platform
import time
from collections.abc import Callable

import numpy as np

from stepover.model.obstacle import Obstacle
from stepover.model.robot import load_robot
from stepover.planner import plan_in_detail
from stepover.report.tables import Table, table
from stepover.simulation.run import simulate
from stepover.units.feasibility import key_configurations

OBSTACLE = Obstacle(height=0.15, width=0.05)


def median_time(work: Callable[[], object], repeats: int) -> float:
    """Median duration of a call [s], after one that does not count."""
    work()
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return float(np.median(times))


def bench(repeats: int = 11) -> Table:
    """Measure the 15 cm case: the feasibility unit, the whole plan, the rigid-body dynamics, the physics."""
    robot = load_robot("hrp2")
    motion = plan_in_detail(robot, OBSTACLE).motion
    samples = len(motion.time)
    search = median_time(lambda: key_configurations(robot, OBSTACLE), repeats)
    whole = median_time(lambda: plan_in_detail(robot, OBSTACLE), repeats)
    dynamics = median_time(lambda: robot.body.contact_wrench(motion.q, motion.dt), repeats)
    factor = float(np.median([simulate(motion).realtime_factor for _ in range(max(1, repeats // 4))]))
    rows = [
        ("FU, the search of the key configuration", f"{1e3 * search:.1f} ms", "400 ms, steps 1 and 2"),
        ("plan, the whole of Algorithm 1", f"{1e3 * whole:.0f} ms", "-"),
        ("plan, steps 2 to 7, a sample", f"{1e6 * (whole - search) / samples:.0f} us", "500 us, steps 3 to 7"),
        ("rigid-body dynamics (RNEA), a sample", f"{1e6 * dynamics / samples:.1f} us", "-"),
        ("simulate, simulated over computing time", f"{factor:.1f}", "-"),
    ]
    return table("15 cm x 5 cm, median | here | paper (2009)", rows)


def main() -> None:
    """Print the table, with the machine that it is true for."""
    print(bench())
    threads = os.environ.get("OMP_NUM_THREADS", "all")
    machine = f"Python {platform.python_version()}, {platform.machine()}, {os.cpu_count()} cores"
    print(f"\n{machine}, {threads} BLAS thread(s)")


if __name__ == "__main__":
    main()
