"""Quasi-static against dynamic: numbers of a crossing for both strategies. Sec. I, II-A and II-B3."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stepover.model.robot import Robot
from stepover.model.support import zmp_margin
from stepover.motion.motion import Motion


@dataclass(frozen=True)
class Strategy:
    """Numbers of a crossing in SI units.

    Attributes:
        whole: duration of the whole motion, from rest to rest [s].
        over: duration from lift-off of leg 1 to touch-down of leg 2 [s].
        double_support: duration of the double support with the obstacle between the feet [s].
        com_travel: distance in x that the CoM travels in that double support [m].
        apart: largest distance of the multi-body ZMP from the CoM's projection, from lift-off of leg 1 to touch-down
            of leg 2 [m].
        com_margin: smallest distance of the CoM's projection from the edge of the support polygon in that time,
            negative outside [m].
        zmp_margin: the same for the ZMP [m].
    """

    whole: float
    over: float
    double_support: float
    com_travel: float
    apart: float
    com_margin: float
    zmp_margin: float


def strategy(robot: Robot, motion: Motion) -> Strategy:
    """The numbers of a motion."""
    first, between, second = (motion.samples(phase) for phase in (1, 2, 3))
    crossing = slice(first.start, second.stop + 1)
    com, zmp = motion.com[:, :2], motion.zmp
    margins = [
        float(zmp_margin(robot, point, motion.support, motion.left_foot, motion.right_foot)[crossing].min())
        for point in (com, zmp)
    ]
    return Strategy(
        whole=float(motion.time[-1] - motion.time[0]),
        over=(second.stop - first.start) * motion.dt,
        double_support=(between.stop - between.start) * motion.dt,
        com_travel=float(com[between.stop, 0] - com[between.start, 0]),
        apart=float(np.linalg.norm(zmp - com, axis=1)[crossing].max()),
        com_margin=margins[0],
        zmp_margin=margins[1],
    )


PAPER = {
    "whole motion [s]": ("40", "-", 1.0, "whole"),
    "lift-off of leg 1 to touch-down of leg 2 [s]": ("40", "3.04 in V, 4 in the abstract", 1.0, "over"),
    "double support over the obstacle [s]": ("15", "0.04", 1.0, "double_support"),
    "CoM's travel ahead in it [mm]": ("-", "5", 1e3, "com_travel"),
    "multi-body ZMP from the CoM's projection, at most [mm]": ("-", "-", 1e3, "apart"),
    "CoM's projection inside the support polygon, by [mm]": ("inside", "-", 1e3, "com_margin"),
    "ZMP inside it, by [mm]": ("-", "inside", 1e3, "zmp_margin"),
}
"""The paper's numbers for each strategy, quasi-static and dynamic, and the attribute with its scale."""


def compared(slow: Strategy, fast: Strategy) -> list[tuple[object, ...]]:
    """Rows: quantity, paper's quasi-static number, ours, paper's dynamic number, ours, ratio of ours."""
    rows: list[tuple[object, ...]] = []
    for name, (quasi_static, dynamic, scale, key) in PAPER.items():
        one, other = scale * getattr(slow, key), scale * getattr(fast, key)
        rows.append((name, quasi_static, one, dynamic, other, one / other if name.endswith("[s]") else "-"))
    return rows


def spans(errors: np.ndarray, epsilons: np.ndarray) -> dict[str, np.ndarray]:
    """Durations (n,) [s] over epsilons (n,) [m], of segments with ZMP errors (5,) [m] if they took 1 s: Eq. (15)."""
    each = np.sqrt(np.outer(1.0 / epsilons, errors))
    return {
        "whole motion": each.sum(axis=1),
        "leg 1 lifts off to leg 2 lands": each[:, 1:4].sum(axis=1),
        "double support": each[:, 2],
    }


def paper_marks(errors: np.ndarray) -> dict[str, tuple[float, float]]:
    """The paper's durations on the curves: epsilon [m] and duration [s] by name."""
    known = {name: float(one[0]) for name, one in spans(errors, np.ones(1)).items()}  # at an epsilon of 1 m
    asked = (
        ("40 s, whole motion", 40.0, "whole motion"), ("40 s, lift-off to landing", 40.0, list(known)[1]),
        ("15 s of double support", 15.0, "double support"), ("4 s, whole motion", 4.0, "whole motion"),
    )  # fmt: skip
    return {name: ((known[span] / duration) ** 2, duration) for name, duration, span in asked}


SHARES = {1: (0.0, 0.55), 2: (0.0, 1.0), 3: (0.45, 1.0)}
"""Times of a crossing, as shares of its phases."""


def moments(motion: Motion) -> np.ndarray:
    """Six times of a crossing for pictures [s], at fixed shares of its phases."""
    spans = {phase: motion.samples(phase) for phase in SHARES}
    return np.array(
        [
            motion.time[spans[phase].start] + share * (spans[phase].stop - spans[phase].start) * motion.dt
            for phase, shares in SHARES.items()
            for share in shares
        ]
    )
