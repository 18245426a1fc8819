"""model/parameters: defaults are HRP-2's, other robots scale them, and docs/parameters.md lists them all."""

from __future__ import annotations

import dataclasses
import re

import numpy as np
import pytest
from conftest import HRP2

from stepover import Obstacle
from stepover.control.stabilizer import Stabilizer
from stepover.locations import data_folder
from stepover.model.parameters.entry import MODEL, entry_of
from stepover.model.parameters.scaling import HRP2 as SIZE
from stepover.model.parameters.scaling import RULES, scaled
from stepover.model.parameters.slow import SLOW
from stepover.planning.algorithm_1.planner import plan_in_detail
from stepover.planning.algorithm_1.preview_control import kajita_gains
from stepover.robots.loading import FACTS, PARAMETERS
from tools.parameters import page

PUBLISHED = {
    "upper_body.arm_swing_max_deg": (25.0, "P S2"),
    "walk.sample_time": (0.005, "P [13]"),
    "walk.step_length": (0.20, "P II-C"),
    "walk.single_support": (0.78, "P V"),
    "walk.double_support": (0.02, "P V"),
    "walk.single_support_over": (1.5, "P V"),
    "walk.single_support_leg_2": (1.5, "P V"),
    "walk.double_support_over": (0.04, "P V"),
    "walk.standing": (1.6, "D [13]"),
    "feasibility.delta_ds": (0.5, "P III-A"),
    "feasibility.knee_margin_deg": (15.0, "P S2"),
    "feasibility.step_length_max": (0.60, "P S2"),
    "feasibility.waist_yaw_deg": (25.0, "P S2"),
    "stepping_over.rest": (0.05, "P S2"),
    "stepping_over.leg1_rise": (0.40, "P S2"),
    "stepping_over.leg1_top": (0.57, "P S2"),
    "stepping_over.leg1_descent": (0.74, "P S2"),
    "stepping_over.leg1_extra_lift": (0.04, "P S2"),
    "stepping_over.leg1_pitch_deg": (-2.0, "P S2"),
    "stepping_over.landing_points": (10, "P S2"),
    "stepping_over.leg2_rise": (0.20, "P S2"),
    "stepping_over.leg2_descent": (0.60, "P S2"),
    "stepping_over.leg2_pitch_per_height_deg": (120.0, "P S2"),
    "stepping_over.leg2_extra_lift": (0.01, "P S2"),
    "stepping_over.landing_step": (0.20, "P S2"),
    "preview.window": (1.6, "P S1"),
    "preview.zmp_weight": (1.0, "P S1"),
    "preview.jerk_weight": (1e-6, "P S1"),
    "preview.com_height": (0.814, "P S1"),
    "stabilizer.dcm_proportional": (4.0, "P S7"),
    "stabilizer.force_admittance": (1e-4, "P S7"),
    "sole.vertical_stiffness": (40e3, "P S8"),
    "sole.vertical_damping": (600.0, "P S8"),
    "sole.tilt_stiffness": (600.0, "P S8"),
    "sole.tilt_damping": (60.0, "P S8"),
}
"""Published values of HRP-2 and their sources, as read there."""
FIELDS = [(table, field) for table, kind in (FACTS | PARAMETERS).items() for field in dataclasses.fields(kind)]
DEFAULTS = [(table, field) for table, field in FIELDS if field.default is not dataclasses.MISSING]


def ids(value):
    """A test's name."""
    return value.name if isinstance(value, dataclasses.Field) else None


@pytest.mark.parametrize(("table", "field"), FIELDS, ids=ids)
def test_every_value_has_a_reason_a_source_and_a_rule_that_exists(table, field):
    entry = entry_of(field)
    assert len(entry.reason) > 3 or entry.reason in ("Q", "R")
    assert re.fullmatch(r"[PDE]( (S\d|\[13\]|[IVX]+(-[A-Z]\d?)?))*", entry.source)
    assert entry.scale in (None, MODEL, *RULES)
    assert set(entry.below) <= {other.name for name, other in FIELDS if name == table}
    if field.name.endswith("_deg"):
        assert entry.unit.startswith("deg")


def test_published_defaults_are_those_of_their_sources():
    ours = {f"{table}.{field.name}": (field.default, entry_of(field).source) for table, field in DEFAULTS}
    assert {name: value for name, value in ours.items() if value[1][0] in "PD"} == PUBLISHED


def test_the_defaults_are_hrp2s_to_the_bit(robot):
    for table, field in DEFAULTS:
        assert getattr(getattr(robot, table), field.name) == field.default, (table, field.name)


def test_hrp2_is_the_robot_that_the_rules_compare_with(robot):
    for name, value in dataclasses.asdict(SIZE).items():
        assert getattr(robot.size, name) == pytest.approx(value, rel=1e-4, abs=1e-12), name
    for table, values in SLOW.items():
        assert scaled(PARAMETERS[table], robot.size, values) == values


@pytest.mark.parametrize(
    ("change", "table", "name", "expected"),
    [
        ({"leg": 2.0 * SIZE.leg}, "walk", "step_length", 0.40),
        ({"leg": 0.5 * SIZE.leg}, "stabilizer", "height_max", 0.0075),
        ({"leg": 1.2146 * SIZE.leg}, "walk", "step_length_max", 0.30),
        ({"toe": 0.5 * SIZE.toe}, "beyond_paper", "zmp_toe", (0.031, 0.040)),
        ({"heel": 0.5 * SIZE.heel}, "beyond_paper", "zmp_heel", 0.031),
        ({"heel": 0.5 * SIZE.heel}, "beyond_paper", "zmp_toe", (0.062, 0.080)),
        ({"mass": 2.0 * SIZE.mass}, "servo", "leg_stiffness", 8000.0),
        ({"mass": 2.0 * SIZE.mass}, "stabilizer", "ankle_admittance", 0.003),
        ({"straight_deg": 9.34}, "checks", "knee_margin_deg", 14.3),
        ({"straight_deg": -20.0}, "checks", "knee_margin_deg", 0.0),
        ({"above_hips": 0.27}, "feasibility", "waist_height_min", 0.77),
        ({"leg": 0.5 * SIZE.leg, "above_hips": 0.1}, "feasibility", "waist_height_min", 0.35),
        ({"leg": 2.0 * SIZE.leg}, "walk", "single_support", 0.78),
        ({"leg": 2.0 * SIZE.leg}, "stepping_over", "leg1_extra_lift", 0.04),
    ],
)
def test_a_default_scales_with_what_its_rule_names(change, table, name, expected):
    assert scaled(PARAMETERS[table], dataclasses.replace(SIZE, **change))[name] == pytest.approx(expected, rel=1e-12)


def test_windows_are_times_so_another_sample_time_gives_the_same_motion(robot):
    """Half the sample time, twice the samples: the preview looks 1.6 s ahead in both."""
    fine = dataclasses.replace(robot, walk=dataclasses.replace(robot.walk, sample_time=0.0025))
    assert len(kajita_gains(robot.preview, 0.0025).preview) == 640
    coarse, twice = (plan_in_detail(who, Obstacle(0.10, 0.05), look_for_nearest=False).motion for who in (robot, fine))
    assert twice.dt == pytest.approx(0.0025)
    np.testing.assert_allclose(twice.com[::2], coarse.com, atol=5e-5)
    assert Stabilizer(fine, twice)._age == 2 * Stabilizer(robot, coarse)._age == 4


def test_the_page_is_up_to_date():
    assert (data_folder().parent / "docs" / "parameters.md").read_text() == page(), "python -m tools.parameters"


def test_sources_on_the_page_are_named_in_the_readme():
    text = (HRP2 / "README.md").read_text()
    for source in {part for _, field in FIELDS for part in re.findall(r"S\d", entry_of(field).source)}:
        assert f"| {source} |" in text
