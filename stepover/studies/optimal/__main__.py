"""python -m stepover.studies.optimal: run or resume the optimiser's studies, and print the paths of their tables."""

from __future__ import annotations

from stepover.studies.optimal.disturbed import study as disturbed
from stepover.studies.optimal.frontier import study as frontier

if __name__ == "__main__":
    for study in (frontier, disturbed):
        print(study())
