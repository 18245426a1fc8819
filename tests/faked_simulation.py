"""A simulation that takes no time, for tests of the study around it; as a script, `study` with it."""

from __future__ import annotations

import hashlib
import sys
import time
import types
from typing import Any

import numpy as np

from stepover.motion.motion import Motion


def faked(motion: Motion, *, stabilizer: bool, perturb: dict[str, float], **how: Any) -> Any:
    """A run whose outcome hangs on the push alone: from 30 N it falls, with the stabilizer from 70 N."""
    push = np.hypot(perturb["push_x"], perturb["push_y"])
    fell = push > (70.0 if stabilizer else 30.0)
    touched = fell and perturb["obstacle_x"] < 0.0
    depth = np.full(len(motion.time), np.nan)
    depth[400:402] = 0.001 if touched else np.nan
    return types.SimpleNamespace(
        crossed=not fell,
        fall_time=3.0 if fell else None,
        obstacle_contacts=2 if touched else 0,
        series=types.SimpleNamespace(time=motion.time, obstacle_depth=depth),
        clearance_min=-0.001 if touched else 0.02 + 0.1 * perturb["obstacle_x"],
        clearance_link="LLEG_LINK4",
        explanation="hit the obstacle; fell" if touched else "fell" if fell else "",
        state_hash=hashlib.sha256(repr((stabilizer, sorted(perturb.items()), sorted(how))).encode()).hexdigest(),
    )


def slow(point: int) -> dict[str, float]:
    """A row that takes a while."""
    time.sleep(0.3)
    return {"square": float(point**2)}


if __name__ == "__main__":
    from pathlib import Path

    from stepover.cli import main
    from stepover.studies import robustness
    from stepover.studies.study import run_study

    if sys.argv[1] == "--slow":
        from faked_simulation import slow as work  # by its module's name, which the workers can import

        print(run_study(range(12), work, Path(sys.argv[2]), workers=2))
    else:

        def lingering(motion: Motion, **how: Any) -> Any:
            """As the real one, it takes a while; a line beside the table for each."""
            time.sleep(0.1)
            with open(Path(sys.argv[-1]).with_name("simulated"), "a") as file:
                file.write("one\n")
            return faked(motion, **how)

        robustness.simulate = lingering  # type: ignore[assignment]
        main(sys.argv[1:])
