"""Fig. 4: the diagram says what the planner's text says, in the order of its calls, and changes with it."""

import importlib
import inspect

import pytest

from stepover.analysis.block_diagram import INPUT, NAMES, OUTPUT, diagram
from stepover.planning.algorithm_1 import planner
from stepover.report import figures
from stepover.report.figures.blocks import SYMBOLS

SOURCE = inspect.getsource(planner)


def changed(old, new):
    """The diagram of the planner with another line."""
    assert SOURCE.count(old) == 1, old
    return diagram(SOURCE.replace(old, new))


def names(found):
    return [block.name for block in found.blocks]


def test_the_planner_as_it_is():
    found = diagram()
    assert names(found) == ["FU", "FTG", "CWTG1", "UBMG", "IK", "CWTG2", "FTA"]
    assert found.blocks[1].functions == ("step_sequence", "feet_trajectories")
    back = {("CWTG2", "IK"), ("FTA", "IK"), ("FTA", "CWTG2")}
    order = [INPUT, *names(found), OUTPUT]
    assert {pair for pair in found.flows if order.index(pair[0]) > order.index(pair[1])} == back
    assert found.flows["FTG", "CWTG1"] == ("sequence",)
    assert found.flows["UBMG", "IK"] == ("q", "waist_shift")
    assert found.flows["IK", "CWTG2"] == ("q",)
    assert ("FU", "FTA") not in found.flows


@pytest.mark.parametrize(
    "pair",
    [("FU", "FTG"), ("FU", "CWTG1"), ("FTG", "CWTG1"), ("FTG", "IK"), ("CWTG1", "IK"), ("CWTG1", "UBMG"),
     ("FTG", "CWTG2"), ("IK", "CWTG2"), ("FTG", "FTA"), ("CWTG2", "FTA"), (INPUT, "FU"), (INPUT, "FTG")],
)  # fmt: skip
def test_what_the_printed_algorithm_hands_on_is_handed_on(pair):
    assert pair in diagram().flows


def test_all_that_flows_has_a_symbol():
    assert {(maker, name) for (maker, _), flow in diagram().flows.items() for name in flow} <= set(SYMBOLS)


def test_a_step_that_is_left_out_is_gone():
    found = changed("upper = upper_body(robot, sequence, ftg, first, options.arms)", "upper = first")
    assert names(found) == ["FU", "FTG", "CWTG1", "IK", "CWTG2", "FTA"]
    assert not [pair for pair in found.flows if "UBMG" in pair]
    assert changed("keys = key_configurations(mover, obstacle)  # 1: FU", "keys = []").blocks[0].name == "FTG"


def test_another_order_shows():
    lines = [line for line in SOURCE.splitlines(keepends=True) if "# 3: CWTG1" in line or "# 5: UBMG" in line]
    found = diagram(SOURCE.replace("".join(lines), "".join(reversed(lines))))
    assert names(found) == ["FU", "FTG", "UBMG", "CWTG1", "IK", "CWTG2", "FTA"]


def test_a_loop_that_is_no_longer_one_hands_nothing_back():
    found = changed("for _ in range(robot.preview.filter_passes_max):", "if True:")
    order = [INPUT, *names(found), OUTPUT]
    assert ("FTA", "CWTG2") not in found.flows
    assert ("CWTG2", "FTA") in found.flows
    assert {a for a, b in found.flows if order.index(a) > order.index(b)} <= {"CWTG2", "FTA"}, "the last IK alone"


def test_another_argument_is_another_arrow():
    found = changed(
        "filtered_waist(robot, poses.waist, sequence.zmp, zmp)", "filtered_waist(robot, poses.waist, zmp, zmp)"
    )
    assert ("FTG", "CWTG2") not in found.flows
    found = changed("filter_pass(crossing, WaistAndFeet(waist, feet)", "filter_pass(crossing, WaistAndFeet(key, feet)")
    assert ("FU", "CWTG2") in found.flows
    assert ("CWTG1", "CWTG2") not in found.flows


def test_each_number_is_that_of_the_comment_and_each_name_that_of_the_module():
    for block in diagram().blocks:
        functions = [getattr(planner, name) for name in block.functions]
        modules = [importlib.import_module(function.__module__).__doc__ for function in functions]
        assert f"# {block.step}: {block.name}" in SOURCE
        assert block.name == "IK" or any(doc.startswith(f"{block.name}, the ") for doc in modules)
    assert {block.step for block in diagram().blocks} == set(NAMES)


def test_what_has_no_symbol_is_drawn_under_its_name(tmp_path):
    found = changed("first = com_and_waist(robot, sequence, key,", "first = com_and_waist(robot, sequence.steps, key,")
    figure = figures.block_diagram(found)
    assert "steps" in {text.get_text() for text in figure.axes[0].texts}
    content = [figures.save(figures.block_diagram(found), tmp_path, name) and (tmp_path / f"{name}.png").read_bytes()
               for name in "ab"]  # fmt: skip
    assert content[0] == content[1]
