"""python -m stepover.studies: run or resume all studies, and print the paths of their tables."""

from __future__ import annotations

from stepover.studies.breaking_points import study as breaking_points
from stepover.studies.engines.convergence import study as convergence
from stepover.studies.engines.samples import study as samples
from stepover.studies.landing import study as landing
from stepover.studies.obstacle_plane import study as obstacle_plane
from stepover.studies.robustness import study as robustness
from stepover.studies.strategies import study as strategies
from stepover.studies.trials import study as trials

if __name__ == "__main__":
    for study in (obstacle_plane, strategies, trials, robustness, breaking_points, landing, convergence, samples):
        print(study())
