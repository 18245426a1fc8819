"""How two feet share a desired ZMP, in closed form: after the ZMP distributor of Kajita et al. (IROS 2010), Sec. III.

A foot under the ankle a_i that bears the share w_i of the whole force F with its pressure's centre at a_i + d_i loads
the ankle with the moment w_i F d_i. Of all shares and centres that put the whole ZMP where it shall be, those are
taken that cost least in `sum_i w_i |d_i|^2`: both centres lie off their ankles by the same d, and the shares are those
of the point between the ankles that is nearest to the ZMP. If d leaves the soles, the nearest shares are taken with
which it does not; where there are none, along the hull's outer sides, the centres stop at the soles' edges.
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
    """Share a ZMP between two standing feet.

    Args:
        zmp: (2,) desired, on the floor [m].
        soles: (2, 2) middles of the left and the right sole, under the ankles [m].
        low: (2, 2) least x and y of each contact patch, from there [m].
        high: (2, 2) largest [m].
    """
    between = soles[0] - soles[1]
    offset = zmp - soles[1]
    best = offset @ between / (between @ between)
    share = min(max(_within(best, offset, between, low.max(axis=0), high.min(axis=0)), 0.0), 1.0)
    common = offset - share * between
    return Distribution(np.array([share, 1.0 - share]), bounded(common, low, high))


def _within(best: float, offset: np.ndarray, between: np.ndarray, low: np.ndarray, high: np.ndarray) -> float:
    """The left foot's share nearest to the best one with which the centres stay inside both soles."""
    first, last = -np.inf, np.inf
    for rest, step, least, most in zip(offset, between, low, high, strict=True):
        if abs(step) > 1e-9:
            ends = sorted(((rest - least) / step, (rest - most) / step))
            first, last = max(first, ends[0]), min(last, ends[1])
    return best if first > last else min(max(best, first), last)
