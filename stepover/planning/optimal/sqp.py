"""Sequential quadratic programming with an exact penalty and a trust region (Nocedal and Wright, sec. 18.5).

The merit is the cost plus rho times the sum of scaled violations. Each iteration takes the step of an elastic QP with
the Gauss-Newton Hessian of the cost, and keeps it where the merit falls by a share of what the QP promised.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from stepover.planning.optimal.problem import Evaluation, Problem
from stepover.planning.optimal.qp import ElasticQP, solve

RIDGE = 1e-4
"""Added to the Hessian."""
KEPT, GOOD, POOR = 0.05, 0.7, 0.25
"""Share of the promised decrease from which a step is kept, the region grows, and below which it shrinks."""
LARGEST, SMALLEST = 2.0, 2e-3
"""Of the trust region."""
STUCK = 1e-3
"""Share of the merit below which a promised decrease is not worth another iteration."""


class Solution(NamedTuple):
    """What a search came to: the evaluation, and how many iterations it took."""

    found: Evaluation
    iterations: int


def minimise(
    problem: Problem,
    x: np.ndarray,
    tolerance: float,
    iterations: int,
    trust: float,
    look: Callable[[Evaluation], None] | None = None,
) -> Solution:
    """Search from x (n,), until the constraints are kept to a tolerance and little cost is left to gain.

    `trust` is the first size of the trust region, in units of each variable's own.
    """
    p = problem.scene.parameters
    here, iteration, done = problem.at(x), 0, False
    while not done and iteration < iterations:
        iteration += 1
        step, promised = _step(here, trust * problem.variables.sizes, p.penalty)
        there = problem.at(here.x + step)
        merit = _merit(here, p.penalty)
        gained = (merit - _merit(there, p.penalty)) / max(promised, 1e-9)
        kept = gained > KEPT
        here = there if kept else here
        trust = min(2.0 * trust, LARGEST) if gained > GOOD else (0.4 * trust if gained < POOR else trust)
        if look is not None:
            look(here)
        left = (0.05 if kept else 0.2) * merit
        stuck = promised < STUCK * merit and here.worst.value >= tolerance
        done = (here.worst.value < tolerance and promised < left) or trust < SMALLEST or stuck
    return Solution(here, iteration)


def _merit(found: Evaluation, penalty: float) -> float:
    """Cost plus penalty."""
    return found.cost + penalty * found.violation


def _step(here: Evaluation, sizes: np.ndarray, penalty: float) -> tuple[np.ndarray, float]:
    """The step of the elastic QP, and by how much it promises to lower the merit."""
    linear = here.linear()
    telling = np.flatnonzero(linear.values + abs(linear.jacobian) @ sizes > 0.0)  # others cannot be violated in there
    values, jacobian, slopes = linear.values[telling], linear.jacobian[telling], linear.slopes
    hessian = (slopes.T @ slopes + RIDGE * sp.eye(len(sizes))).tocsc()
    step = solve(ElasticQP(hessian, slopes.T @ linear.residuals, jacobian, values, sizes, penalty))
    after = linear.residuals + slopes @ step
    expected = 0.5 * after @ after + penalty * np.maximum(values + jacobian @ step, 0.0).sum()
    return step, _merit(here, penalty) - expected
