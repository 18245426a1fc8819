"""control/force_distribution.py: the closed form against a numerical optimum, and its limits."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from stepover.control.force_distribution import distribute
from stepover.control.support_region import patch

SOLES = np.array([[0.4, 0.095], [0.0, -0.095]])  # left ahead of right, as after a long step


@pytest.fixture(scope="module")
def ends(robot):
    """Least and largest x and y of both patches."""
    soles = np.stack([patch(robot, side, 0.0) for side in (1, -1)])
    return soles.min(axis=1), soles.max(axis=1)


def cost(share, first, second):
    """Sum of w_i |d_i|^2."""
    return share * first @ first + (1.0 - share) * second @ second


def optimum(zmp, low, high):
    """Cost and share of the best sharing, by a quadratic programme in the moments for each share, and its best share.

    For a given share w the moments m_i = w_i d_i have the cost sum |m_i|^2 / w_i, which is quadratic.
    """

    def best(share):
        weights = np.array([share, 1.0 - share])
        total = zmp - weights @ SOLES
        start = np.concatenate([weights[0] * total, weights[1] * total])
        found = minimize(
            lambda m: (m[:2] @ m[:2]) / weights[0] + (m[2:] @ m[2:]) / weights[1],
            start,
            bounds=[(w * a, w * b) for w, lo, hi in zip(weights, low, high, strict=True)
                    for a, b in zip(lo, hi, strict=True)],
            constraints={"type": "eq", "fun": lambda m: m[:2] + m[2:] - total},
            method="SLSQP",
            options={"ftol": 1e-14, "maxiter": 200},
        )  # fmt: skip
        return found.fun if found.success else np.inf

    shares = np.linspace(0.001, 0.999, 201)
    costs = [best(share) for share in shares]
    k = int(np.argmin(costs))
    fine = np.linspace(shares[max(k - 1, 0)], shares[min(k + 1, 200)], 41)
    return min((best(share), share) for share in fine)


@pytest.mark.parametrize("zmp", [(0.2, 0.0), (0.05, -0.07), (0.35, 0.05), (0.22, 0.03), (0.18, -0.04)], ids=str)
def test_as_good_as_the_quadratic_programme(ends, zmp):
    shares, cops = distribute(np.array(zmp), SOLES, *ends)
    least, share = optimum(np.array(zmp), *ends)
    assert cost(shares[0], *cops) == pytest.approx(least, rel=1e-3, abs=1e-8)
    assert shares[0] == pytest.approx(share, abs=2e-3)


def test_the_whole_zmp_is_where_it_shall_be(ends):
    rng = np.random.default_rng(5)
    low, high = ends
    for _ in range(300):
        share = rng.uniform()
        zmp = share * (SOLES[0] + rng.uniform(low[0], high[0])) + (1.0 - share) * (
            SOLES[1] + rng.uniform(low[1], high[1])
        )
        shares, cops = distribute(zmp, SOLES, low, high)
        whole = shares @ (SOLES + cops)
        assert shares.sum() == pytest.approx(1.0)
        assert ((shares >= 0.0) & (shares <= 1.0)).all()
        assert ((cops >= low - 1e-12) & (cops <= high + 1e-12)).all()
        miss = np.linalg.norm(whole - zmp)
        assert miss < 0.021, "patches that mirror each other leave a strip of their difference in y, no more"


def test_between_the_ankles_no_ankle_bears_a_moment(ends):
    shares, cops = distribute(0.3 * SOLES[0] + 0.7 * SOLES[1], SOLES, *ends)
    np.testing.assert_allclose(shares, [0.3, 0.7], atol=1e-12)
    np.testing.assert_allclose(cops, 0.0, atol=1e-12)


@pytest.mark.parametrize(("foot", "shares"), [(0, [1.0, 0.0]), (1, [0.0, 1.0])])
def test_under_one_ankle_that_foot_bears_all(ends, foot, shares):
    found = distribute(SOLES[foot], SOLES, *ends)
    np.testing.assert_allclose(found.shares, shares, atol=1e-12)


def test_further_left_the_left_foot_bears_more(ends):
    lower, higher = (distribute(np.array([0.2, y]), SOLES, *ends).shares[0] for y in (-0.02, 0.02))
    assert higher > lower


def test_beyond_the_soles_the_centres_stay_on_the_edge(ends):
    low, high = ends
    shares, cops = distribute(np.array([0.9, 0.095]), SOLES, low, high)
    np.testing.assert_allclose(shares, [1.0, 0.0], atol=1e-12)
    assert cops[0, 0] == pytest.approx(high[0, 0])
