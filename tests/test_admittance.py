"""control/admittance.py: each loop gives way in the right direction, comes back, and never leaves its bounds."""

from __future__ import annotations

import numpy as np
import pytest

from stepover.control.admittance import Integral, Swaying, damped

DT = 0.005


def test_damping_follows_its_law():
    state = damped(np.array([0.02]), np.array([3.0]), 0.01, 0.5, 1.0, DT)
    assert state[0] == pytest.approx(0.02 + DT * (0.01 * 3.0 - 0.02 / 0.5))


def test_damping_comes_back_and_stops_at_its_bound():
    state = np.array([0.05, -0.05])
    for _ in range(2000):
        state = damped(state, np.zeros(2), 0.01, 0.5, 0.1, DT)
    np.testing.assert_allclose(state, 0.0, atol=1e-6)
    for _ in range(2000):
        state = damped(state, np.array([1e4, -1e4]), 0.01, 0.5, 0.1, DT)
    np.testing.assert_array_equal(state, [0.1, -0.1])


def test_the_integral_leaks_and_is_bounded():
    integral = Integral(leak=2.0, most=0.03, dt=DT)
    for _ in range(20000):
        integral.add(np.array([0.01, 1.0]), np.zeros(2))
    np.testing.assert_allclose(integral.value, [0.02, 0.03], rtol=1e-3)
    for _ in range(400):
        integral.add(np.zeros(2), np.zeros(2))
    assert integral.value[0] == pytest.approx(0.02 * np.exp(-1.0), rel=0.01)


def test_the_integral_does_not_wind_up():
    """An error that is cut off anyway is not collected; one that leads back is."""
    integral = Integral(leak=2.0, most=0.03, dt=DT)
    for _ in range(400):
        integral.add(np.array([0.05, 0.05]), np.array([0.01, 0.0]))
    assert integral.value[0] == 0.0
    assert integral.value[1] > 0.0
    integral.add(np.array([-0.05, 0.0]), np.array([0.01, 0.0]))
    assert integral.value[0] < 0.0


def test_the_com_goes_where_the_zmp_is_too_far():
    """A body that accelerates ahead pushes its ZMP back: so a ZMP too far ahead asks for just that."""
    sway = Swaying(20.0, 4.0, 0.05, DT)
    for _ in range(10):
        sway.add(np.array([0.01, -0.01]))
    assert sway.offset[0] > 0.0 > sway.offset[1]
    assert sway.offset[0] == pytest.approx(0.5 * 20.0 * 0.01 * (10 * DT) ** 2, rel=0.25)


def test_the_com_comes_back_without_swinging_over():
    sway = Swaying(20.0, 4.0, 0.05, DT)
    for _ in range(40):
        sway.add(np.array([0.05, 0.0]))
    way = []
    for _ in range(1000):
        sway.add(np.zeros(2))
        way.append(sway.offset[0])
    assert abs(way[-1]) < 1e-6
    assert min(way) > -1e-9


def test_the_com_stays_within_its_bound_and_comes_away_from_it_at_once():
    sway = Swaying(20.0, 4.0, 0.05, DT)
    for _ in range(2000):
        sway.add(np.array([5.0, 0.0]))
    assert sway.offset[0] == 0.05
    sway.add(np.zeros(2))
    assert sway.offset[0] < 0.05
