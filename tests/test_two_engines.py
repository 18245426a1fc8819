"""studies/engines, studies/breaking_points.py and their tables: what is varied, what agrees, where it breaks."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from stepover.model.parameters.physics import Simulation
from stepover.report.tables import engines as tables
from stepover.simulation.disturbances import Disturbances
from stepover.studies import breaking_points as breaking
from stepover.studies.engines import convergence, samples


@pytest.fixture(scope="module")
def settings():
    """The stored study of the settings."""
    return convergence.read_table()


@pytest.fixture(scope="module")
def both():
    """The stored samples."""
    return samples.read_table()


def test_each_setting_is_a_parameter_and_its_default_is_among_the_values():
    for engine_settings in convergence.SETTINGS.values():
        for name, values in engine_settings:
            assert getattr(Simulation(), name) in values


def test_the_stored_settings_are_whole_and_move_nothing_that_is_judged(settings):
    assert len(settings) == len(convergence.points())
    assert all(row.crossed for row in settings)
    ideal = [row for row in settings if row.equipment == convergence.IDEAL]
    assert np.ptp([row.clearance for row in ideal]) < 3e-4
    fine = [row for row in ideal if row.setting == "time_step" and row.engine == "mujoco"]
    assert np.ptp([row.zmp_rms_x for row in fine]) < 2e-4
    table = tables.convergence_table(settings, convergence.SERVOS)
    assert len(table.rows) == len(settings) / 2


def test_more_rounds_and_stiffer_contacts_lower_the_zmp_s_error(settings):
    rounds = convergence.varied(settings, "pybullet", "solver_iterations", convergence.IDEAL)
    contacts = convergence.varied(settings, "mujoco", "contact_time", convergence.IDEAL)
    assert np.diff([row.zmp_rms_x for row in rounds]).max() < 0.0
    assert np.diff([row.zmp_rms_x for row in contacts]).min() > 0.0


def test_the_stored_samples_are_those_of_today_and_both_engines_agree(both):
    pairs = samples.pairs(both)
    assert [(one.study, one.name) for one, _ in pairs] == [(case.study, case.name) for case in samples.cases()]
    assert [(one.engine, other.engine) for one, other in pairs] == [samples.BOTH] * len(pairs)
    assert all(map(samples.agree, pairs))
    assert {one.crossed for one, _ in pairs} == {True, False}
    assert "**no**" not in str(tables.samples_table(both))


def test_what_depends_on_the_engine_is_said(both):
    rows = [
        dataclasses.replace(row, crossed=False) if (row.name, row.engine) == ("25 x 5 cm", "mujoco") else row
        for row in both
    ]
    before, after = ({line[0]: line[1:] for line in tables.statements_table(some).rows} for some in (both, rows))
    assert before["25 cm crosses, ideal motors"] == ("true", "true", "")
    assert after["25 cm crosses, ideal motors"] == ("true", "false", "**yes**")
    assert after["15 cm crosses, ideal motors"] == ("true", "true", "")


@pytest.mark.parametrize("kind", breaking.KINDS)
def test_disturbances_grow_and_simulate_knows_them(kind, motion):
    sizes = [breaking.Point(kind, draw).size for draw in range(breaking.DRAWS)]
    growing = breaking.KINDS[kind].end - breaking.KINDS[kind].begin
    assert (np.sign(np.diff(sizes)) == np.sign(growing)).all()
    for draw in (0, breaking.DRAWS - 1):
        perturb = breaking.Point(kind, draw).perturb(motion)
        assert Disturbances.read(perturb, motion) != Disturbances()
        assert perturb == breaking.Point(kind, draw).perturb(motion)


def outcomes(kind, crossed):
    """Rows of one disturbance."""
    points = [breaking.Point(kind, draw) for draw in range(len(crossed))]
    return [
        breaking.Outcome("hrp2", "0", "mujoco", kind, point.draw, point.size, json.dumps({}), one, 0.01, "", "", "")
        for point, one in zip(points, crossed, strict=True)
    ]


def test_where_it_breaks():
    sharp = outcomes("push", [True] * 10 + [False] * 10)
    assert breaking.borne(sharp, 0.5) == pytest.approx(200.0, abs=5.0)
    assert 150.0 < breaking.borne(sharp, 0.95) < 195.0
    soft = outcomes("push", [True] * 8 + [False, True, True, False] + [False] * 8)
    assert breaking.borne(soft, 0.5) == pytest.approx(200.0, abs=10.0)
    assert breaking.borne(soft, 0.95) < breaking.borne(sharp, 0.95)
    falling = outcomes("friction", [True] * 10 + [False] * 10)
    assert breaking.borne(falling, 0.5) == pytest.approx(0.325, abs=0.01)
    assert breaking.borne(falling, 0.95) > 0.33, "less friction is harder"
    assert np.isnan(breaking.borne(outcomes("push", [True] * 20), 0.5))
