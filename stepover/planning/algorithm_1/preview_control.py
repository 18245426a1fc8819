"""Preview control of the ZMP of the cart model, Eqs. (15)-(18), in both forms that Sec. III-C2 refers to.

Kajita's form ([13]) is a linear quadratic servo: it weighs the ZMP error and the jerk's increment, and integrates
the error. It plans. Wieber's form, Eqs. (16)-(18), weighs error and jerk over the window and has no integral; it
stands beside it. In both the command is the jerk of the CoM (the printed text says acceleration, but the state
already holds it: see the errata in ARCHITECTURE.md).

Over a whole motion either one is a linear recursion of the state, driven by the reference: solved at once as a
banded triangular system.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.linalg import solve_discrete_are
from scipy.linalg.lapack import dtbtrs

from stepover.model.gravity import GRAVITY
from stepover.model.parameters.planning import Preview, samples


class Gains(NamedTuple):
    """Jerk = -integral * sum of errors - state . (c, c', c'') + preview . (coming references).

    Attributes:
        integral: K_s [1/s^3] on the sum of errors.
        state: (3,) K_x.
        preview: (N_L,) on the references of the next samples.
    """

    integral: float
    state: np.ndarray
    preview: np.ndarray


@dataclass(frozen=True, eq=False)
class CartMotion:
    """Motion of the cart model along some axes, (N, axes) each.

    Attributes:
        position, velocity, acceleration: of the CoM [m], [m/s], [m/s^2].
        zmp: of the cart model, Eq. (15) [m].
    """

    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    zmp: np.ndarray


def cart(dt: float, com_height: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """State matrix (3, 3), input (3,) and output (3,) of Eq. (15), sampled with constant jerk over dt."""
    state = np.array([[1.0, dt, dt**2 / 2.0], [0.0, 1.0, dt], [0.0, 0.0, 1.0]])
    return state, np.array([dt**3 / 6.0, dt**2 / 2.0, dt]), np.array([1.0, 0.0, -com_height / GRAVITY])


@lru_cache(maxsize=16)
def kajita_gains(preview: Preview, dt: float) -> Gains:
    """Gains of Kajita et al. [13] from the discrete algebraic Riccati equation."""
    a, b, c = cart(dt, preview.com_height)
    augmented = np.block([[np.ones((1, 1)), (c @ a)[None]], [np.zeros((3, 1)), a]])
    command = np.concatenate([[c @ b], b])[:, None]
    weight = np.zeros((4, 4))
    weight[0, 0] = preview.zmp_weight
    cost = solve_discrete_are(augmented, command, weight, [[preview.jerk_weight]])
    scale = 1.0 / (preview.jerk_weight + (command.T @ cost @ command).item())
    feedback = scale * (command.T @ cost @ augmented)[0]
    closed = augmented - command @ feedback[None]
    ahead, costate = np.empty(samples(preview.window, dt)), cost[:, 0] * preview.zmp_weight
    for j in range(len(ahead)):
        ahead[j] = scale * (command[:, 0] @ costate)
        costate = closed.T @ costate
    return Gains(float(feedback[0]), feedback[1:], ahead)


def wieber_matrices(window: int, dt: float, com_height: float) -> tuple[np.ndarray, np.ndarray]:
    """P_x (N_L, 3) and P_u (N_L, N_L) of Eq. (16): the ZMPs ahead from the state and the jerks."""
    a, b, c = cart(dt, com_height)
    k = np.arange(1, window + 1)
    p_x = np.column_stack([np.ones(window), k * dt, (k * dt) ** 2 / 2.0 - com_height / GRAVITY])
    response = np.array([c @ np.linalg.matrix_power(a, n) @ b for n in range(window)])
    lag = k[:, None] - k[None, :]
    return p_x, np.where(lag >= 0, response[np.maximum(lag, 0)], 0.0)


@lru_cache(maxsize=16)
def wieber_gains(preview: Preview, dt: float) -> Gains:
    """First row of Eq. (18): the jerk that minimises Eq. (17) over the window, as feedback and preview."""
    window = samples(preview.window, dt)
    p_x, p_u = wieber_matrices(window, dt, preview.com_height)
    ratio = preview.jerk_weight / preview.zmp_weight
    first = np.linalg.solve(p_u.T @ p_u + ratio * np.eye(window), p_u.T)[0]
    return Gains(0.0, first @ p_x, first)


def track(gains: Gains, reference: np.ndarray, preview: Preview, dt: float) -> CartMotion:
    """Follow a ZMP reference (N, axes) [m], from rest above its first sample."""
    a, b, c = cart(dt, preview.com_height)
    rest = reference[0]
    ahead = np.vstack([reference[1:], np.tile(reference[-1:], (len(gains.preview), 1))]) - rest
    drive = np.column_stack([np.correlate(axis, gains.preview, "valid") for axis in ahead.T])
    inputs = np.concatenate([[c @ b], b])
    free = np.block([[np.ones((1, 1)), (c @ a)[None]], [np.zeros((3, 1)), a]])
    closed = free - np.outer(inputs, [gains.integral, *gains.state])
    forcing = drive[:-1, None, :] * inputs[:, None]
    forcing[:, 0] -= reference[1:] - rest
    states = np.concatenate([np.zeros((1, 4, reference.shape[1])), _recursion(closed, forcing)])
    position, velocity, acceleration = states[:, 1] + rest, states[:, 2], states[:, 3]
    return CartMotion(position, velocity, acceleration, position + c[2] * acceleration)


def _recursion(matrix: np.ndarray, forcing: np.ndarray) -> np.ndarray:
    """Solve s_k+1 = M s_k + f_k from s_0 = 0, for f (N, n, axes): s_1 ... s_N, as one banded triangular system."""
    count, size, axes = forcing.shape
    bands = np.zeros((2 * size, count, size))
    bands[0] = 1.0
    for row in range(size):
        for column in range(size):
            bands[size + row - column, :-1, column] = -matrix[row, column]
    solution, _ = dtbtrs(bands.reshape(2 * size, -1), forcing.reshape(-1, axes), uplo="L", diag="U")
    return np.asarray(solution).reshape(count, size, axes)
