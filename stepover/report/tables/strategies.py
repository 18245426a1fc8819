"""Tables of both strategies, quasi-static and dynamic, from the rows of the stored study."""

from __future__ import annotations

from collections.abc import Sequence

from stepover.report.tables.table import Table, table
from stepover.studies.strategies import EPSILON, Crossed, by_height


def carried_out(rows: Sequence[Crossed]) -> Table:
    """Results of some crossings in the physics."""
    return table(
        "strategy | epsilon [mm] | whole motion [s] | leg 1 lifts to leg 2 lands [s] | double support [s] | outcome | "
        "nearest to the obstacle [mm] | ZMP from its plan, rms [mm] | waist from its plan, at most [mm] | "
        "knee torque, at most [N m]",
        [
            (
                "dynamic" if row.epsilon is None else "quasi-static",
                "-" if row.epsilon is None else 1e3 * row.epsilon,
                row.duration, row.over, row.double_support, "crossed" if row.crossed else row.reason or "not simulated",
                *(_scaled(value) for value in (row.simulated_clearance, row.zmp_rms, row.waist_error)),
                _scaled(row.knee_torque, 1.0),
            )
            for row in rows
        ],
    )  # fmt: skip


def reach(rows: Sequence[Crossed]) -> Table:
    """The highest obstacle that each strategy crosses in the physics, and why it fails one centimetre higher."""
    kinds = {"quasi-static, requested margins": (EPSILON, True), "quasi-static, 1 cm of margin": (EPSILON, False),
             "dynamic, requested margins": (None, True)}  # fmt: skip
    lines = []
    for name, (epsilon, with_margins) in kinds.items():
        line = by_height(rows, epsilon)
        good = [bool(row.crossed) and not (with_margins and row.not_with_margins) for row in line]
        last = good.index(False) - 1
        lines.append((name, f"{1e2 * line[last].height:.0f}", line[last + 1].not_with_margins or line[last + 1].reason))
    return table("strategy | highest [cm] | reason for failure 1 cm higher", lines)


def _scaled(value: float | None, scale: float = 1e3) -> float | str:
    """A value for a table, lengths in mm."""
    return "-" if value is None else scale * value
