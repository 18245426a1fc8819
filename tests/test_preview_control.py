"""units/preview_control.py: Eqs. (15)-(18) and Kajita's form, against plain loops and least squares."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.linalg import lstsq, solve_discrete_are

from stepover.model.gravity import GRAVITY
from stepover.model.parameters.planning import Preview
from stepover.planning.algorithm_1.preview_control import cart, kajita_gains, track, wieber_gains, wieber_matrices

DT, WINDOW, Q, R, Z_C = 0.005, 320, 1.0, 1e-6, 0.814


@pytest.fixture(scope="module")
def preview(robot) -> Preview:
    """The paper's parameters, whatever else robot.toml keeps beside them."""
    return dataclasses.replace(robot.preview, window=WINDOW * DT, zmp_weight=Q, jerk_weight=R, com_height=Z_C)


def rolled_out(state: np.ndarray, jerks: np.ndarray, dt: float = DT) -> np.ndarray:
    """States (N + 1, 3) of position, velocity, acceleration under constant jerks (N,), by hand."""
    states = [np.array(state, dtype=float)]
    for jerk in jerks:
        x, v, a = states[-1]
        states.append(np.array([
            x + v * dt + a * dt**2 / 2.0 + jerk * dt**3 / 6.0, v + a * dt + jerk * dt**2 / 2.0, a + jerk * dt
        ]))  # fmt: skip
    return np.array(states)


def zmp_of(states: np.ndarray) -> np.ndarray:
    """ZMP of the cart, Eq. (15)."""
    return states[:, 0] - Z_C / 9.81 * states[:, 2]


def followed(gains, reference: np.ndarray) -> np.ndarray:
    """States of a servo along one axis, sample by sample, from rest above the first reference."""
    ahead = np.concatenate([reference, np.full(len(gains.preview), reference[-1])])
    state, errors, states = np.array([reference[0], 0.0, 0.0]), 0.0, []
    for k in range(len(reference)):
        states.append(state)
        errors += zmp_of(state[None])[0] - reference[k]
        local = state - [reference[0], 0.0, 0.0]
        coming = gains.preview @ (ahead[k + 1 : k + 1 + len(gains.preview)] - reference[0])
        jerk = -gains.integral * errors - gains.state @ local + coming
        state = rolled_out(state, [jerk])[1]
    return np.array(states)


def test_the_robots_parameters_are_the_papers(robot, preview):
    assert robot.preview == preview
    assert robot.walk.sample_time == DT
    assert GRAVITY == 9.81


def test_kajitas_gains_are_the_published_ones(preview):
    gains = kajita_gains(preview, DT)
    assert gains.integral == pytest.approx(618.7, abs=0.05)
    assert gains.state[0] == pytest.approx(72719.0, abs=0.5)
    assert gains.state[1] == pytest.approx(21550.0, abs=0.5)
    assert gains.state[2] == pytest.approx(177.01, abs=0.005)
    assert len(gains.preview) == WINDOW


def test_kajitas_gains_by_the_formulas_of_the_servo(preview):
    """Kajita et al. 2003, Eqs. (17)-(25), written out with loops."""
    a = np.array([[1.0, DT, DT**2 / 2.0], [0.0, 1.0, DT], [0.0, 0.0, 1.0]])
    b, c = np.array([[DT**3 / 6.0], [DT**2 / 2.0], [DT]]), np.array([[1.0, 0.0, -Z_C / 9.81]])
    big_b = np.vstack([c @ b, b])
    big_i = np.array([[1.0], [0.0], [0.0], [0.0]])
    big_f = np.vstack([c @ a, a])
    big_a = np.hstack([big_i, big_f])
    big_q = np.diag([Q, 0.0, 0.0, 0.0])
    k = solve_discrete_are(big_a, big_b, big_q, np.array([[R]]))
    np.testing.assert_allclose(
        k, big_a.T @ k @ big_a - big_a.T @ k @ big_b @ np.linalg.inv([[R]] + big_b.T @ k @ big_b) @ big_b.T @ k @ big_a
        + big_q, rtol=1e-7, atol=1e-7 * np.abs(k).max(),
    )  # fmt: skip
    inverse = 1.0 / (R + (big_b.T @ k @ big_b)).item()
    integral = inverse * (big_b.T @ k @ big_i).item()
    state = inverse * (big_b.T @ k @ big_f)[0]
    closed = big_a - big_b @ (inverse * big_b.T @ k @ big_a)
    x, ahead = -closed.T @ k @ big_i, [-integral]
    for _ in range(1, WINDOW):
        ahead.append(inverse * (big_b.T @ x).item())
        x = closed.T @ x
    gains = kajita_gains(preview, DT)
    assert gains.integral == pytest.approx(integral, rel=1e-9)
    np.testing.assert_allclose(gains.state, state, rtol=1e-9)
    np.testing.assert_allclose(gains.preview, -np.array(ahead), rtol=1e-7, atol=1e-7)


def test_the_window_is_long_enough(preview):
    gains = kajita_gains(preview, DT).preview
    assert gains[-1] < 0.01 * gains.max()
    assert gains.sum() == pytest.approx(kajita_gains(preview, DT).state[0], rel=0.01)


@pytest.mark.parametrize("make", [kajita_gains, wieber_gains])
def test_track_is_the_servo_sample_by_sample(preview, make):
    rng = np.random.default_rng(1)
    steps = np.repeat(rng.normal(size=(8, 2)) * 0.2, 60, axis=0)
    gains = make(preview, DT)
    cart_motion = track(gains, steps, preview, DT)
    for axis in (0, 1):
        states = followed(gains, steps[:, axis])
        np.testing.assert_allclose(cart_motion.position[:, axis], states[:, 0], atol=1e-9)
        np.testing.assert_allclose(cart_motion.velocity[:, axis], states[:, 1], atol=1e-8)
        np.testing.assert_allclose(cart_motion.acceleration[:, axis], states[:, 2], atol=1e-7)
        np.testing.assert_allclose(cart_motion.zmp[:, axis], zmp_of(states), atol=1e-8)


def test_prediction_matrices_are_the_rolled_out_cart():
    rng = np.random.default_rng(2)
    p_x, p_u = wieber_matrices(40, DT, Z_C)
    for _ in range(5):
        state, jerks = rng.normal(size=3), rng.normal(size=40) * 10.0
        np.testing.assert_allclose(p_x @ state + p_u @ jerks, zmp_of(rolled_out(state, jerks))[1:], atol=1e-12)
    assert np.allclose(p_u, np.tril(p_u))
    a, b, c = cart(DT, Z_C)
    np.testing.assert_allclose(rolled_out([1.0, 2.0, 3.0], [4.0])[1], a @ [1.0, 2.0, 3.0] + b * 4.0)
    assert c @ [1.0, 2.0, 3.0] == pytest.approx(1.0 - Z_C / 9.81 * 3.0)


@pytest.mark.parametrize("window", [50, WINDOW])
def test_eq_18_is_the_least_squares_solution_of_eq_17(preview, window):
    """The whole vector of jerks minimises Q/2 (p - p_ref)^2 + R/2 jerk^2; its first entry is what the gains say."""
    rng = np.random.default_rng(3)
    p_x, p_u = wieber_matrices(window, DT, Z_C)
    state, reference = np.array([0.03, 0.1, -0.2]), np.repeat(rng.normal(size=window // 10) * 0.1, 10)
    stacked = np.vstack([np.sqrt(Q) * p_u, np.sqrt(R) * np.eye(window)])
    wanted = np.concatenate([np.sqrt(Q) * (reference - p_x @ state), np.zeros(window)])
    least_squares = lstsq(stacked, wanted)[0]
    eq_18 = -np.linalg.solve(p_u.T @ p_u + R / Q * np.eye(window), p_u.T @ (p_x @ state - reference))
    np.testing.assert_allclose(eq_18, least_squares, atol=1e-9 * max(1.0, np.abs(least_squares).max()))
    gains = wieber_gains(dataclasses.replace(preview, window=window * DT), DT)
    ours = gains.preview @ reference - gains.state @ state
    assert gains.integral == 0.0
    assert ours == pytest.approx(least_squares[0], abs=1e-9 * max(1.0, np.abs(least_squares).max()))


def test_eq_17_rises_in_every_direction_from_eq_18():
    rng = np.random.default_rng(4)
    p_x, p_u = wieber_matrices(60, DT, Z_C)
    state, reference = np.array([0.0, 0.1, 0.0]), np.linspace(0.0, 0.1, 60)
    best = -np.linalg.solve(p_u.T @ p_u + R / Q * np.eye(60), p_u.T @ (p_x @ state - reference))

    def cost(jerks):
        return Q / 2.0 * np.sum((p_x @ state + p_u @ jerks - reference) ** 2) + R / 2.0 * np.sum(jerks**2)

    for _ in range(20):
        assert cost(best + rng.normal(size=60)) > cost(best)


def test_both_forms_agree_on_the_com_of_the_15_cm_motion(planned, preview):
    reference = planned.sequence.zmp
    kajita, wieber = (track(make(preview, DT), reference, preview, DT) for make in (kajita_gains, wieber_gains))
    difference = np.abs(kajita.position - wieber.position).max()
    assert 1e-4 < difference < 2e-3
    assert 5e-3 < np.abs(kajita.zmp - wieber.zmp).max() < 40e-3


def test_each_form_follows_its_reference(planned, preview):
    reference = planned.sequence.zmp
    for make, rms in ((kajita_gains, 2.5e-3), (wieber_gains, 6e-3)):
        error = track(make(preview, DT), reference, preview, DT).zmp - reference
        assert np.sqrt((error**2).mean(axis=0)).max() < rms


@pytest.mark.parametrize("make", [kajita_gains, wieber_gains])
class TestLinearity:
    """What holds for any linear servo without preference for place or side."""

    reference = np.repeat(np.random.default_rng(5).normal(size=(10, 2)) * 0.1, 80, axis=0)

    def test_a_mirrored_reference_has_the_mirrored_motion(self, preview, make):
        once, mirrored = (track(make(preview, DT), s * self.reference, preview, DT) for s in (1.0, -1.0))
        np.testing.assert_allclose(mirrored.position, -once.position, atol=1e-12)

    def test_a_reference_elsewhere_has_the_same_motion_there(self, preview, make):
        away = np.array([5.0, -3.0])
        here = track(make(preview, DT), self.reference, preview, DT)
        there = track(make(preview, DT), self.reference + away, preview, DT)
        np.testing.assert_allclose(there.position, here.position + away, atol=1e-9)
        np.testing.assert_allclose(there.velocity, here.velocity, atol=1e-9)

    def test_axes_do_not_mix(self, preview, make):
        both = track(make(preview, DT), self.reference, preview, DT).position
        swapped = track(make(preview, DT), self.reference[:, ::-1], preview, DT).position
        np.testing.assert_allclose(swapped[:, ::-1], both, atol=1e-12)

    def test_rest_stays_rest(self, preview, make):
        still = track(make(preview, DT), np.full((500, 2), 0.3), preview, DT)
        np.testing.assert_allclose(still.position, 0.3, atol=1e-12)
        np.testing.assert_allclose(still.velocity, 0.0, atol=1e-12)

    def test_after_a_step_the_com_comes_to_rest_over_the_new_reference(self, preview, make):
        step = np.repeat([[0.0], [0.2]], 1000, axis=0)
        moved = track(make(preview, DT), step, preview, DT)
        assert moved.position[-1, 0] == pytest.approx(0.2, abs=1e-4)
        assert moved.velocity[-1, 0] == pytest.approx(0.0, abs=1e-4)
        assert moved.position[1000, 0] == pytest.approx(0.1, abs=0.03)  # half of the way is before the step: preview
        assert moved.position[600, 0] == pytest.approx(0.0, abs=1e-3)


def test_only_kajitas_form_removes_a_lasting_error(preview):
    """A wrong gain on the state is an unmodelled disturbance: the integral takes it out, Wieber's form has none."""
    step = np.repeat([[0.0], [0.2]], [600, 1800], axis=0)
    ends = {}
    for make in (kajita_gains, wieber_gains):
        gains = make(preview, DT)
        wrong = gains._replace(state=gains.state * [1.001, 1.0, 1.0])
        ends[make] = abs(track(wrong, step, preview, DT).position[-1, 0] - 0.2)
    assert ends[kajita_gains] < 1e-6
    assert ends[wieber_gains] > 1e-5


def test_a_higher_com_leads_by_more(preview):
    step = np.repeat([[0.0], [0.2]], 1000, axis=0)
    low, high = (dataclasses.replace(preview, com_height=h) for h in (0.4, 0.9))
    early = [track(kajita_gains(p, DT), step, p, DT).position[900, 0] for p in (low, high)]
    assert early[1] > 1.5 * early[0] > 0.0
