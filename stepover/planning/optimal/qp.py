"""The quadratic program of one iteration, solved by PIQP (Schwan et al., CDC 2023): the one door to that library.

minimise   1/2 d' H d + g' d + rho sum(s) + mu/2 s' s   over d, s
subject to J d + c <= s,  s >= 0,  abs(d) <= t

The slacks s make it solvable whatever the constraints are: what cannot be kept costs rho for each unit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import piqp
import scipy.sparse as sp

ACCURACY = 1e-4
"""Absolute and relative accuracy of the solution."""
ITERATIONS = 60
"""Largest number of iterations of the interior-point method."""
CURVATURE = 1e-3
"""Weight mu of the slacks' squares, which makes them unique."""


@dataclass(frozen=True, eq=False)
class ElasticQP:
    """The program's data.

    Attributes:
        hessian: (n, n) sparse, positive definite.
        gradient: (n,).
        jacobian: (m, n) sparse.
        values: (m,) of the constraints at d = 0.
        sizes: (n,) largest change of each variable.
        penalty: rho.
    """

    hessian: sp.csc_matrix
    gradient: np.ndarray
    jacobian: sp.csr_matrix
    values: np.ndarray
    sizes: np.ndarray
    penalty: float


def solve(qp: ElasticQP) -> np.ndarray:
    """The change d (n,)."""
    m, n = qp.jacobian.shape
    solver = piqp.SparseSolver()
    solver.settings.eps_abs = solver.settings.eps_rel = ACCURACY
    solver.settings.max_iter = ITERATIONS
    hessian = sp.block_diag([qp.hessian, CURVATURE * sp.eye(m)]).tocsc()
    gradient = np.concatenate([qp.gradient, np.full(m, qp.penalty)])
    rows = sp.hstack([qp.jacobian, -sp.eye(m)]).tocsc()
    low = np.concatenate([-qp.sizes, np.zeros(m)])
    high = np.concatenate([qp.sizes, np.full(m, np.inf)])
    solver.setup(hessian, gradient, None, None, rows, None, -qp.values, low, high)
    solver.solve()
    return np.clip(solver.result.x[:n], -qp.sizes, qp.sizes)
