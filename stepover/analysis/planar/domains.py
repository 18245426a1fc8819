"""Feasibility domains as masks over a grid of X_ads and Z_hds, and the measures for the remarks of Sec. II-A."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Domains:
    """Feasible pairs of X_ads and Z_hds.

    Attributes:
        x_ads: (M,) ascending, equal steps [m].
        z_hds: (N,) ascending, equal steps [m].
        masks: (N, M) bool by the number of the equation: 6, 7, 8, or 22 for (7) with X_hds = delta_DS X_ads.
    """

    x_ads: np.ndarray
    z_hds: np.ndarray
    masks: dict[int, np.ndarray]

    @property
    def cell(self) -> tuple[float, float]:
        """Steps of the grid along X_ads and Z_hds [m]."""
        return float(self.x_ads[1] - self.x_ads[0]), float(self.z_hds[1] - self.z_hds[0])

    def area(self, equation: int) -> float:
        """Area of a domain [m^2]. Remark 1 compares areas."""
        return float(self.masks[equation].sum() * np.prod(self.cell))

    def ranges(self, equation: int) -> np.ndarray:
        """Width of the feasible range of X_ads at each height (N,) [m]."""
        return np.asarray(self.masks[equation].sum(axis=1) * self.cell[0])

    def limits(self, equation: int, z_hds: float) -> tuple[float, float]:
        """Shortest and longest feasible X_ads [m] at the nearest height of the grid; NaN if none is feasible."""
        found = self.x_ads[self.masks[equation][np.abs(self.z_hds - z_hds).argmin()]]
        return (float(found[0]), float(found[-1])) if len(found) else (np.nan, np.nan)

    def trend(self, equation: int) -> tuple[float, float, float]:
        """Remark 2: the heights over which a lower hip widens the range of X_ads.

        Returns:
            The highest feasible Z_hds; the lowest Z_hds to which the range never shrinks by more than a step of the
            grid; the Z_hds with the widest range [m]. NaN if nothing is feasible.
        """
        ranges, heights = self.ranges(equation)[::-1], self.z_hds[::-1]
        if not ranges.any():
            return np.nan, np.nan, np.nan
        shrinks = np.append(ranges < np.maximum.accumulate(ranges) - 1.001 * self.cell[0], True)
        top, end, widest = np.flatnonzero(ranges)[0], shrinks.argmax() - 1, ranges.argmax()
        return float(heights[top]), float(heights[end]), float(heights[widest])

    def common_steps(self, first: int = 6, second: int = 8) -> np.ndarray:
        """X_ads (K,) [m] in both of two domains, at any heights. Phase 2 begins and ends with the same step length."""
        return np.asarray(self.x_ads[self.masks[first].any(axis=0) & self.masks[second].any(axis=0)])
