"""The optimal control problem: gradients against differences, the QP against scipy, forces against other formulas."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.optimize import minimize

from stepover.model.obstacle import Obstacle
from stepover.model.parameters.optimal import Optimal
from stepover.planning.optimal.base import base_motion
from stepover.planning.optimal.channels import SIDES, Channels, hip_in_waist, of_sole, poses
from stepover.planning.optimal.constraints.group import Local
from stepover.planning.optimal.constraints.own_links import thigh_pairs
from stepover.planning.optimal.constraints.sharing import shared_torques
from stepover.planning.optimal.instants import Probe
from stepover.planning.optimal.problem import GROUPS, problem_of
from stepover.planning.optimal.qp import ElasticQP, solve
from stepover.planning.optimal.search import chain
from stepover.planning.optimal.variables import variables_of

STEP = 1e-6
NAMES = [group.__name__ for group in GROUPS]


@pytest.fixture(scope="module")
def problem(robot):
    parameters, obstacle = Optimal(), Obstacle(0.25, 0.05)
    base = base_motion(robot, obstacle, parameters)
    channels = Channels(robot, np.radians(parameters.knee_deg))
    return problem_of(channels, base, variables_of(base, parameters, True), obstacle, parameters)


@pytest.fixture(scope="module")
def somewhere(problem):
    """The problem off the base motion, and a little to both sides along a direction."""
    draw, sizes = np.random.default_rng(1), problem.variables.sizes
    x, way = 0.1 * sizes * draw.normal(size=len(sizes)), sizes * draw.normal(size=len(sizes))
    return way, problem.at(x), problem.at(x + STEP * way), problem.at(x - STEP * way)


@pytest.mark.parametrize("number", range(len(GROUPS)), ids=NAMES)
def test_gradients_of_constraints(problem, somewhere, number):
    way, here, up, down = somewhere
    group = here.groups[number]
    least = min(-0.4, np.sort(group.values, axis=None)[-20])
    rows, columns = np.nonzero(group.values >= least)
    assert len(rows) >= 20
    gradient = problem.rows(group.gradient(rows, columns), rows, here.seen) @ way
    change = (up.groups[number].values[rows, columns] - down.groups[number].values[rows, columns]) / (2.0 * STEP)
    assert np.abs(change).max() > 1e-3
    assert np.abs(gradient - change).max() < 1e-5 * max(np.abs(change).max(), 1.0)


def test_gradients_of_the_cost(problem, somewhere):
    way, here, up, down = somewhere
    change = (up.residuals - down.residuals) / (2.0 * STEP)
    assert np.abs(here.linear().slopes @ way - change).max() < 1e-5 * np.abs(change).max()


def test_gradient_beyond_reach(problem):
    channels = problem.scene.channels
    far = problem.at(np.zeros(problem.variables.count)).seen.now[::40].copy()
    far[:, 2] += 0.08  # the waist so high that the legs do not reach
    _, distance = channels.reach(far)
    assert (distance > channels.longest).any()
    way = np.random.default_rng(2).normal(size=far.shape)
    by, by_distance = channels.derivatives(far, channels.reach(far).q)
    up, down = (channels.reach(far + sign * STEP * way) for sign in (1, -1))
    assert np.abs(np.einsum("nij,nj->ni", by, way) - (up.q - down.q) / (2.0 * STEP)).max() < 1e-4
    found = np.einsum("nij,nj->ni", by_distance, way)
    assert np.abs(found - (up.distance - down.distance) / (2.0 * STEP)).max() < 1e-6


def test_feet_come_where_the_channels_say(problem, robot):
    seen = problem.at(np.zeros(problem.variables.count)).seen
    waist = poses(seen.now[:, :6])
    for side, distance in zip(SIDES, seen.distance.T, strict=True):
        columns = problem.scene.channels.leg_columns(side)
        leg = robot.leg(side)
        _, place = leg.sole(waist, seen.q[:, columns])
        assert np.abs(place - seen.now[:, of_sole(side)][:, :3]).max() < 1e-9
        ankle, _, centres = leg.joint_frames(waist, seen.q[:, columns])
        assert np.abs(np.linalg.norm(ankle - centres[:, 2], axis=1) - distance).max() < 1e-9
        assert np.abs(hip_in_waist(leg) - [0.0, 0.06 * side, 0.0]).max() < 1e-9


def test_the_same_zmp_as_on_the_manifold(problem, robot):
    """Euler angles and the manifold differ by what 5 ms leave."""
    scene, channels = problem.scene, problem.scene.channels
    q = channels.configurations(channels.reach(scene.base.channels).q, scene.base.upper)
    zmp = robot.body.zmp(q, scene.dt)[scene.samples]
    seen = problem.at(np.zeros(problem.variables.count)).seen
    turn = np.where(scene.bearing[:, None] > 0, *(seen.now[:, of_sole(side)][:, :2] for side in SIDES))
    assert np.abs(seen.zmp + turn - zmp).max() < 5e-4  # the soles do not turn in the base motion


def test_torques_of_a_standing_robot(problem, robot):
    """At rest the torques of the bearing leg are the change of the potential energy with the sole held."""
    scene, channels = problem.scene, problem.scene.channels
    seen = problem.at(np.zeros(problem.variables.count)).seen
    still = type(seen)(scene, np.repeat(seen.steps[1:2], 3, axis=0), seen.front)
    row = int(np.flatnonzero(scene.support != 0)[100])
    side = int(scene.support[row])
    columns = channels.leg_columns(side)

    def energy(q):
        full = channels.configurations(q[None], scene.base.upper[:1])
        placed = robot.body.placements(full)
        ankle = robot.body.index(robot.leg(side).joints[-1])
        turn, place = placed.rotations[0, ankle], placed.positions[0, ankle]
        com = turn.T @ (robot.body.com(placed)[0] - place)  # in the sole, which stays flat
        return robot.body.mass * 9.81 * com[2]

    for column in columns:
        step = np.eye(len(still.q[row]))[column] * 1e-6
        change = (energy(still.q[row] + step) - energy(still.q[row] - step)) / 2e-6
        assert still.wrench.torques[row, column - 6] == pytest.approx(change, abs=1e-3)


def test_shares_of_double_support_end_in_single_support(problem):
    """The moment that the ZMP is inside the bearing sole, that foot takes all."""
    scene = problem.scene
    seen = problem.at(np.zeros(problem.variables.count)).seen
    probe = Probe(scene, scene.samples, seen.q, seen.v, seen.a)
    inside = np.flatnonzero((scene.support == 0) & (np.abs(seen.zmp[:, 0]) < 0.05) & (np.abs(seen.zmp[:, 1]) < 0.03))
    assert len(inside)
    assert np.abs(shared_torques(probe)[inside] - seen.wrench.torques[inside]).max() < 1e-9


def test_own_pairs_take_trunk_and_thighs(robot):
    pairs = {(one.link, other.link) for one, other in thigh_pairs(robot)}
    assert {("BODY", "LLEG_LINK2"), ("BODY", "RLEG_LINK2"), ("CHEST_LINK1", "LLEG_LINK2")} <= pairs
    assert all("ARM" not in one and "LEG" not in one for one, _ in pairs)


@pytest.mark.parametrize("seed", range(3))
def test_the_quadratic_program_against_scipy(seed):
    draw, n, m = np.random.default_rng(seed), 6, 9
    root, jacobian, values = draw.normal(size=(n, n)), draw.normal(size=(m, n)), draw.normal(size=m)
    hessian, gradient, sizes, penalty = root @ root.T + np.eye(n), draw.normal(size=n), np.full(n, 0.8), 3.0
    given = ElasticQP(sp.csc_matrix(hessian), gradient, sp.csr_matrix(jacobian), values, sizes, penalty)

    def merit(y):
        return 0.5 * y[:n] @ hessian @ y[:n] + gradient @ y[:n] + penalty * y[n:].sum() + 5e-4 * y[n:] @ y[n:]

    kept = {"type": "ineq", "fun": lambda y: y[n:] - jacobian @ y[:n] - values}
    bounds = [(-0.8, 0.8)] * n + [(0.0, None)] * m
    start = np.concatenate([np.zeros(n), np.maximum(values, 0.0)])
    other = minimize(merit, start, bounds=bounds, constraints=[kept], method="SLSQP", options={"ftol": 1e-12})
    found = solve(given)
    slack = np.maximum(jacobian @ found + values, 0.0)
    assert merit(np.concatenate([found, slack])) == pytest.approx(other.fun, abs=2e-3)
    assert np.abs(found - other.x[:n]).max() < 0.02


def test_a_chain_grows_by_no_more_than_its_steps():
    stages = chain(Obstacle(0.51, 0.20), Optimal())
    sizes = np.array([[stage.height, stage.width] for stage in stages])
    assert sizes[0].tolist() == [0.40, 0.05]
    assert sizes[-1].tolist() == [0.51, 0.20]
    assert (np.diff(sizes, axis=0).max(axis=0) < [0.0501, 0.0701]).all()
    assert len(chain(Obstacle(0.10, 0.04), Optimal())) == 1


def test_rows_of_nothing(problem):
    seen = problem.at(np.zeros(problem.variables.count)).seen
    none = Local(channels=np.zeros((0, problem.scene.channels.count)))
    assert problem.rows(none, np.zeros(0, dtype=int), seen).shape == (0, problem.variables.count)
