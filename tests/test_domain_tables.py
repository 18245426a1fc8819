"""report/domain_tables.py: verdicts follow the numbers."""

from __future__ import annotations

import numpy as np
import pytest

from stepover.analysis.double_support import double_support
from stepover.analysis.key_domain import key_domain, key_grid
from stepover.analysis.planar.domains import Domains
from stepover.analysis.planar.feasibility_domain import feasibility_domains
from stepover.report.tables import domains as domain_tables


@pytest.fixture(scope="module")
def domains(robot, obstacle):
    return feasibility_domains(robot, obstacle, points=100)


def upside_down(domains):
    """The same domains with the hip's height turned about, and (6) as large as (7)."""
    masks = {equation: mask[::-1] for equation, mask in domains.masks.items()} | {6: domains.masks[7][::-1]}
    return Domains(domains.x_ads, domains.z_hds, masks)


def column(table, name):
    """Cells of a column by their row's first cell."""
    k = table.header.index(name)
    return {row[0]: row[k] for row in table.rows}


def test_remarks_hold_or_differ_as_the_numbers_say(domains):
    wrong = upside_down(domains)
    verdicts = column(domain_tables.remark_1(domains, domains, domains), "Remark 1")
    assert verdicts == {"(6)": "holds", "(7)": "-", "(8)": "holds", "(22)": "-"}
    assert column(domain_tables.remark_1(wrong, wrong, wrong), "Remark 1")["(6)"] == "differs"
    ends = [domain_tables.remark_2(one, (0.6, 0.5)).rows[-1][1] for one in (domains, wrong)]
    assert ends == ["holds", "differs"]
    read = domain_tables.readings({"right": (domains, domains), "wrong": (wrong, wrong)})
    assert column(read, "Remark 2") == {"right": "holds", "wrong": "differs"}
    assert set(column(read, "left of (7), higher obstacle").values()) == {"1.00"}


def test_an_empty_domain_shows_as_none(domains):
    empty = Domains(domains.x_ads, domains.z_hds, {e: np.zeros_like(m) for e, m in domains.masks.items()})
    assert column(domain_tables.remark_1(empty, domains, domains), "Remark 1")["(6)"] == "differs"
    assert domain_tables.remark_2(empty, (0.6,)).rows[0][1] == "none"
    table = domain_tables.highest(np.array([0.1, 0.2]), {"a": [domains, empty], "b": [empty, empty]},
                                  {"a": domains, "b": empty})  # fmt: skip
    assert column(table, "(7)") == {"a": "10", "b": "none"}
    assert column(table, "(6) and (8), the same X_ads") == {"a": "10", "b": "none"}


def test_conditions_of_the_planned_motion(robot, motion):
    table = domain_tables.conditions(double_support(robot, motion))
    assert list(column(table, "(6) to (8)").values()) == ["does not hold", "holds", "does not hold"]
    assert list(column(table, "(10) to (12)").values()) == ["holds"] * 3


def test_key_postures_and_frontiers(robot, obstacle):
    grid = key_grid(robot, 0.02, 25.0)
    masks = {0.15: key_domain(robot, obstacle, grid), 0.9: np.zeros((len(grid.z_hds), len(grid.x_ads)), bool)}
    rows = domain_tables.key_postures(robot, [grid], [masks]).rows
    assert rows[0][1] == f"{masks[0.15].sum() * 0.0004:.4f}"
    assert rows[1][1:] == ("0.0000", "none")
    heights = {"yaw 0": np.array([0.3, 0.2]), "yaw 25": np.array([0.4, 0.1])}
    table = domain_tables.frontiers(np.array([0.05, 0.10]), heights, (0.05, 0.10))
    assert column(table, "turning allows more") == {"5 cm wide": "holds", "10 cm wide": "differs"}
    assert column(table, "yaw 25") == {"5 cm wide": "40.0", "10 cm wide": "10.0"}
