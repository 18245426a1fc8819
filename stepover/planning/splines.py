"""Cubic splines for feet that start and end at rest. Sec. III-B."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline


def clamped_spline(knots: list[tuple[float, float]], at: np.ndarray) -> np.ndarray:
    """Cubic spline through (time, value) knots with zero speed at both ends, at rest beyond them."""
    times, values = np.array(sorted(knots)).T
    if len(times) == 2:  # a single cubic: evaluating it is faster than solving for a spline
        share = np.clip((at - times[0]) / (times[1] - times[0]), 0.0, 1.0)
        return np.asarray(values[0] + (values[1] - values[0]) * share**2 * (3.0 - 2.0 * share))
    return np.asarray(CubicSpline(times, values, bc_type="clamped")(np.clip(at, times[0], times[-1])))


def landing(start: float, value: float, end: float, target: float, points: int) -> list[tuple[float, float]]:
    """Knots whose speed falls linearly to zero: from (start, value), excluded, to (end, target), included."""
    rest = 1.0 - np.arange(1, points + 1) / points
    return [(end - (end - start) * r, target + (value - target) * r**2) for r in rest]
