"""Distribute a desired ZMP between two feet in closed form: after Kajita et al. (IROS 2010), Sec. III.

Foot i under the ankle a_i bears the share w_i of the total force F. If its centre of pressure is a_i + d_i, the ankle
bears the moment w_i F d_i. Many shares and centres give the desired ZMP. The best ones minimise `sum_i w_i |d_i|^2`:
both centres have the same offset d from their ankles, and the shares are those of the point between the ankles that is
nearest to the ZMP. If d leaves the soles, the nearest shares with d inside are used. If there are none, along the outer
sides of the hull, the centres stop at the soles' edges.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stepover.control.admittance import bounded


class Distribution(NamedTuple):
    """Shares (2,) of the vertical force, and centres of pressure (2, 2) from under the ankles [m]; left, right."""

    shares: np.ndarray
    cops: np.ndarray


def distribute(zmp: np.ndarray, soles: np.ndarray, low: np.ndarray, high: np.ndarray) -> Distribution:
    """Distribute a ZMP between two standing feet.

    Args:
        zmp: (2,) desired ZMP on the floor [m].
        soles: (2, 2) middles of the left and the right sole, under the ankles [m].
        low: (2, 2) least x and y of each contact patch, from the middle of its sole [m].
        high: (2, 2) largest x and y of each contact patch, from the middle of its sole [m].
    """
    between = soles[0] - soles[1]
    offset = zmp - soles[1]
    best = offset @ between / (between @ between)
    share = min(max(_within(best, offset, between, low.max(axis=0), high.min(axis=0)), 0.0), 1.0)
    common = offset - share * between
    return Distribution(np.array([share, 1.0 - share]), bounded(common, low, high))


def _within(best: float, offset: np.ndarray, between: np.ndarray, low: np.ndarray, high: np.ndarray) -> float:
    """The left foot's share that keeps the centres inside both soles and is nearest to the best share."""
    first, last = -np.inf, np.inf
    for rest, step, least, most in zip(offset, between, low, high, strict=True):
        if abs(step) > 1e-9:
            ends = sorted(((rest - least) / step, (rest - most) / step))
            first, last = max(first, ends[0]), min(last, ends[1])
    return best if first > last else min(max(best, first), last)
