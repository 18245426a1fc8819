"""The variables: coefficients of cubic B-splines that deviate from the base motion, footholds, the obstacle's place.

A spline without its first and last two or three coefficients vanishes at both ends with its speed, or with speed and
acceleration. Three are left out for waist and upper body, two for a swinging foot, which may land with deceleration.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy.sparse as sp
from scipy.interpolate import BSpline

from stepover.model.parameters.optimal import Optimal
from stepover.planning.algorithm_1.step_sequence import Step
from stepover.planning.optimal.base import Base
from stepover.planning.optimal.channels import UPPER, of_sole

POSITION, TURN, ARM, FOOT, PLACE = (0.03, 0.1, 0.25, 0.05, 0.02)
"""Size of a large step of a variable: of the waist [m], its rotations and the chest [rad], the arms [rad], a swinging
foot [m] or [rad], the obstacle's place [m]. They shape the trust region."""


@dataclass(frozen=True, eq=False)
class Variables:
    """The variables x (n,), and the channels (N, C) = base + basis x.

    Attributes:
        basis: (N C, n) sparse, the channels of a sample side by side.
        sizes: (n,) size of a large step of each.
        place: index of the obstacle's place, or None where it is fixed.
        names: of each variable.
    """

    basis: sp.csr_matrix
    sizes: np.ndarray
    place: int | None
    names: tuple[str, ...]

    @property
    def count(self) -> int:
        """Number n of variables."""
        return len(self.sizes)

    def rows(self, samples: np.ndarray, channels: int) -> sp.csr_matrix:
        """Rows of the basis for some samples (m,), each with all channels: (m channels, n)."""
        return self.basis[(samples[:, None] * channels + np.arange(channels)).ravel()]


def variables_of(base: Base, p: Optimal, free_place: bool) -> Variables:
    """Lay out the variables for a base motion."""
    count, time, steps = base.channels.shape[1], base.time, base.crossing
    corners = sorted({time[k] for step in steps for k in (step.lift_off, step.touch_down)})
    whole = corners[:1] + corners[-1:]
    blocks: list[tuple[str, int, sp.csr_matrix, float]] = []
    spacings = [p.knots_travel] * 2 + [p.knots_height] + [p.knots_turn] * 3
    for channel, spacing in enumerate(spacings):
        size = POSITION if channel < 3 else TURN
        blocks.append(("waist", channel, _splines(time, _knots(corners, spacing), 3), size))
    for channel in range(UPPER, count):
        blocks.append(("upper body", channel, _splines(time, _knots(whole, p.knots_upper), 3), ARM))
    for step in steps:
        first = of_sole(step.side).start
        knots = _knots([time[step.lift_off], time[step.touch_down]], p.knots_foot)
        axes = range(6) if step in steps[-3:-1] else range(3)
        blocks += [("swing", first + axis, _splines(time, knots, 2), FOOT) for axis in axes]
    for step in steps[:-1]:
        profile = sp.csr_matrix(_standing(base, step)[:, None])
        blocks += [("foothold", of_sole(step.side).start + axis, profile, POSITION) for axis in (0, 1)]
        blocks.append(("toe-out", of_sole(step.side).start + 3, profile, TURN))
    columns = [_lifted(matrix, channel, count) for _, channel, matrix, _ in blocks]
    sizes = [np.full(matrix.shape[1], size) for _, _, matrix, size in blocks]
    names = [name for name, _, matrix, _ in blocks for _ in range(matrix.shape[1])]
    if free_place:
        columns.append(sp.csr_matrix((len(time) * count, 1)))
        sizes.append(np.array([PLACE]))
        names.append("obstacle")
    basis = sp.hstack(columns).tocsr()
    return Variables(basis, np.concatenate(sizes), basis.shape[1] - 1 if free_place else None, tuple(names))


def _lifted(matrix: sp.csr_matrix, channel: int, count: int) -> sp.csr_matrix:
    """A block (N, n) of one channel as (N count, n)."""
    part = matrix.tocoo()
    return sp.csr_matrix((part.data, (part.row * count + channel, part.col)), (matrix.shape[0] * count, part.shape[1]))


def _splines(time: np.ndarray, knots: np.ndarray, dropped: int) -> sp.csr_matrix:
    """Clamped cubic B-splines (N, n) on knots [s], without some of the first and last ones; zero outside."""
    padded = np.concatenate([knots[:1].repeat(3), knots, knots[-1:].repeat(3)])
    inside = np.flatnonzero((time >= knots[0] - 1e-9) & (time <= knots[-1] + 1e-9))
    part = BSpline.design_matrix(np.clip(time[inside], knots[0], knots[-1]), padded, 3).tocoo()
    whole = sp.csr_matrix((part.data, (inside[part.row], part.col)), (len(time), len(padded) - 4))
    return whole[:, dropped : len(padded) - 4 - dropped]


def _knots(corners: Iterable[float], spacing: float) -> np.ndarray:
    """Knots [s] at all corners, and evenly between them about a spacing apart."""
    corners = list(corners)
    parts = [
        np.linspace(one, other, max(round((other - one) / spacing), 1) + 1)[1:] for one, other in pairwise(corners)
    ]
    return np.concatenate([corners[:1], *parts])


def _standing(base: Base, step: Step) -> np.ndarray:
    """How much (N,) the deviation of a foothold counts: it grows in the step there, and fades in the foot's next."""
    later = [other for other in base.sequence.steps if other.side == step.side and other.lift_off > step.lift_off]
    rise = _ramp(base.time, step)
    return rise - _ramp(base.time, later[0]) if later else rise


def _ramp(time: np.ndarray, step: Step) -> np.ndarray:
    """From 0 at lift-off to 1 at touch-down, at rest at both ends: (N,)."""
    begin, end = time[step.lift_off], time[step.touch_down]
    share = np.clip((time - begin) / (end - begin), 0.0, 1.0)
    return share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
