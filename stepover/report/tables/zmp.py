"""The ZMP of the notebook on 15 cm: two forms of preview control, and the claims on the dynamic filter. Sec. V."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stepover.analysis import zmp_errors
from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.planning.algorithm_1.preview_control import CartMotion
from stepover.planning.measures import measure
from stepover.report.tables.table import Table, table


def forms_table(motion: Motion, forms: Sequence[CartMotion]) -> Table:
    """Kajita's form of preview control and that of the paper's equations, on the cart model."""
    off = [1e3 * (form.zmp - motion.zmp_reference) for form in forms]
    apart, com = np.abs(off[0] - off[1]), 1e3 * np.abs(forms[0].position - forms[1].position)
    rows = [
        ("ZMP error, rms [mm]", *(float(np.sqrt((error**2).mean())) for error in off)),
        ("ZMP error, largest [mm]", *(float(np.abs(error).max()) for error in off)),
        ("ZMPs apart, largest [mm]", float(apart.max()), f"at {motion.time[apart.max(axis=1).argmax()]:.2f} s"),
        ("CoMs apart, largest [mm]", float(com.max()), f"at {motion.time[com.max(axis=1).argmax()]:.2f} s"),
    ]
    return table("cart model, x and y together | Kajita [13] | Eqs. (16)-(18)", rows)


def filter_claims(robot: Robot, motion: Motion) -> list[tuple[str, np.ndarray | str, str]]:
    """The claims on the ZMP before and after the dynamic filter: id, measured value, and what it depends on."""
    found = measure(robot, motion)
    first, after, most = (1e3 * np.array(e) for e in (found.zmp_rms_first_stage, found.zmp_rms, found.zmp_error_max))
    over, walking = (1e3 * rms for rms in zmp_errors.crossing_and_walking(motion))
    share = first / 1e3 / (np.ptp(robot.contact_patch(1), axis=0) / 2.0)
    beyond = zmp_errors.beyond(motion, 0.004)
    return [
        ("first-stage-jerky", over, ""),
        ("jerky-over-obstacle", over / walking,
         "over the obstacle {:.1f} and {:.1f} mm rms, in the other steps {:.1f} and {:.1f} mm".format(*over, *walking)),
        ("second-stage", zmp_errors.peak_over_support(robot, motion),
         "peaks of {:.0f} and {:.0f} mm at corners of the reference, beyond 4 mm for {:.2f} s; rms {:.1f}, {:.1f} mm"
         .format(*most, beyond, *after)),
        ("filter-axis", "xy"[first.argmax()],
         "rms x {:.1f}, y {:.1f} mm; over half a sole, as the support is narrow in y, {:.2f} and {:.2f}"
         .format(*first, *share)),
    ]  # fmt: skip
