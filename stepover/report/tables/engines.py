"""The tables that compare the physics engines: one motion in both, samples of the studies, and the settings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from stepover.report.tables.table import Table, table
from stepover.simulation.engine import NAMES
from stepover.simulation.measurements import Run
from stepover.studies.engines import convergence, samples


def runs_table(runs: Mapping[str, Mapping[str, Run]]) -> Table:
    """What both engines measure of the same motion, by equipment and engine."""
    header, columns = ["quantity"], []
    for equipment, each in runs.items():
        for engine, run in each.items():
            header.append(f"{equipment}, {NAMES[engine]}")
            columns.append(_numbers(run))
    names = [name for name, _ in columns[0]]
    return table(" | ".join(header), [(name, *(column[k][1] for column in columns)) for k, name in enumerate(names)])


def _numbers(run: Run) -> list[tuple[str, str]]:
    """What one run measures, by name."""
    zmp, landing = 1e3 * np.array(run.zmp_rms), run.landing_force_peak
    return [
        ("outcome", "crosses" if run.crossed else run.explanation),
        ("clearance [mm]", f"{1e3 * run.clearance_min:.1f} ({run.clearance_link})"),
        ("ZMP error, rms in x, y [mm]", f"{zmp[0]:.1f}, {zmp[1]:.1f}"),
        ("waist from its plan, largest [mm]", f"{1e3 * run.waist_error_max:.1f}"),
        ("landing force of leg 1, leg 2 [N]", f"{landing['first']:.0f}, {landing['second']:.0f}"),
        ("largest torque over its limit", f"{run.torque_ratio_max:.2f}"),
        ("largest speed over its limit", f"{run.speed_ratio_max:.2f}"),
        ("times real time", f"{run.realtime_factor:.1f}"),
    ]


def apart_table(runs: Mapping[str, Mapping[str, Run]]) -> Table:
    """How far the two engines are apart at the same time, as root mean squares and at most."""
    lines = []
    for equipment, each in runs.items():
        first, second = (run.series for run in each.values())
        count = min(len(first.time), len(second.time))
        differences = {
            "waist [mm]": 1e3 * np.linalg.norm(first.q[:count, :3] - second.q[:count, :3], axis=1),
            "joints [deg]": np.degrees(np.abs(first.q[:count, 7:] - second.q[:count, 7:]).max(axis=1)),
            "ZMP [mm]": 1e3 * np.linalg.norm(first.zmp[:count] - second.zmp[:count], axis=1),
            "vertical force [N]": np.abs(_vertical(first, count) - _vertical(second, count)),
            "largest torque [N m]": np.abs(first.torque[:count] - second.torque[:count]).max(axis=1),
        }
        for name, values in differences.items():
            rms = np.sqrt(np.nanmean(values**2))
            lines.append((equipment, name, f"{rms:.2g}", f"{np.nanmax(values):.2g}"))
    return table("robot | difference of the engines | rms | largest", lines)


def _vertical(series: object, count: int) -> np.ndarray:
    """Vertical force on both feet (count,) [N]."""
    left, right = (np.asarray(getattr(series, f"{side}_wrench")) for side in ("left", "right"))
    return np.asarray((left + right)[:count, 2])


def samples_table(rows: Sequence[samples.Outcome]) -> Table:
    """The samples of all studies in both engines."""
    lines = []
    for pair in samples.pairs(rows):
        cells = [_outcome(row) for row in pair]
        lines.append((pair[0].study, pair[0].name, *cells, "yes" if samples.agree(pair) else "**no**"))
    return table("study | case | PyBullet | MuJoCo | same outcome", lines)


def _outcome(row: samples.Outcome) -> str:
    """The outcome of one simulation in a few words."""
    return f"crosses, {1e3 * row.clearance:.1f} mm" if row.crossed else f"fails, {row.reason.partition(':')[0]}"


def convergence_table(rows: Sequence[convergence.Outcome], equipment: str) -> Table:
    """What each setting of an engine changes."""
    lines = []
    for engine, settings in convergence.SETTINGS.items():
        for setting, _ in settings:
            for row in convergence.varied(rows, engine, setting, equipment):
                zmp = f"{1e3 * row.zmp_rms_x:.1f}, {1e3 * row.zmp_rms_y:.1f}"
                landing = f"{row.landing_first:.0f}, {row.landing_second:.0f}"
                cells = f"{1e3 * row.clearance:.1f}", zmp, f"{1e3 * row.waist_error:.2f}", landing
                lines.append((NAMES[engine], setting, f"{row.value:g}", *cells))
    return table(
        "engine | setting | value | clearance [mm] | ZMP error, rms [mm] | waist error [mm] | landing forces [N]", lines
    )


STATEMENTS: Mapping[str, tuple[tuple[str, ...], float]] = {
    "15 cm crosses, ideal motors": (("15 x 5 cm",), 0.0),
    "25 cm crosses, ideal motors": (("25 x 5 cm",), 0.0),
    "they keep 30 mm of clearance": (("15 x 5 cm", "25 x 5 cm"), 0.03),
    "servos cross 15 cm, on rigid soles and on rubber": (("15 cm, servos, rigid", "15 cm, servos, rubber"), 0.0),
    "servos cross 20 cm, which the real robot did not": (("20 cm, servos, rigid", "20 cm, servos, rubber"), 0.0),
    "servos keep 15 mm of clearance at 15 cm": (("15 cm, servos, rigid", "15 cm, servos, rubber"), 0.015),
    "on rubber the robot crosses without stabilizer": ((f"{samples.UNDISTURBED}, rubber, no stabilizer",), 0.0),
}
"""Statements: the cases that must cross, and the clearance that they must keep [m]."""


def statements_table(rows: Sequence[samples.Outcome]) -> Table:
    """Statements that a simulation can judge, and what each engine says."""
    known = {(row.name, row.engine): row for row in rows}
    lines = []
    for statement, (cases, least) in STATEMENTS.items():
        said = []
        for engine in samples.BOTH:
            some = [known[case, engine] for case in cases]
            said.append(all(row.crossed and row.clearance >= least for row in some))
        lines.append(
            (statement, *("true" if one else "false" for one in said), "" if said[0] == said[1] else "**yes**")
        )
    return table("statement | PyBullet | MuJoCo | depends on the engine", lines)
