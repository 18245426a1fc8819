"""robots/reading.py: whatever is wrong in a robot.toml is refused with a line that names it."""

from __future__ import annotations

import dataclasses
import math
import tomllib
import types

import pytest
from conftest import DROP, HRP2

from stepover import InvalidInput, load_robot
from stepover.model.parameters.entry import MODEL, entry_of
from stepover.robots.loading import FACTS, PARAMETERS
from stepover.robots.reading import line_of

FILE = tomllib.loads((HRP2 / "robot.toml").read_text())


def plain(value):
    """A value as TOML has it: lists for tuples, dictionaries for mappings."""
    if isinstance(value, tuple):
        return [plain(item) for item in value]
    return dict(value) if isinstance(value, types.MappingProxyType) else value


def whole():
    """HRP-2's robot.toml with every default written out."""
    tables = FACTS | PARAMETERS
    robot = load_robot("hrp2")
    return {key: FILE[key] for key in FILE if key not in tables} | {
        key: {field.name: plain(getattr(getattr(robot, key), field.name)) for field in dataclasses.fields(kind)}
        for key, kind in tables.items()
    }


TABLE = whole()


def leaves(table, above=()):
    """Every key of robot.toml with its value: (keys, value)."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from leaves(value, (*above, key))
        else:
            yield (*above, key), value


LEAVES = dict(leaves(TABLE))
SECTIONS = [(key,) for key, value in TABLE.items() if isinstance(value, dict)] + [("posture", "angles_deg")]
ANGLES = ("posture", "angles_deg")
NEEDED = [("name",), ("urdf",), ("root",), *((key,) for key in FACTS), ANGLES]
NEEDED += [(key, f.name) for key in FACTS for f in dataclasses.fields(FACTS[key]) if f.default is dataclasses.MISSING
           and entry_of(f).scale != MODEL and (key, f.name) != ANGLES]  # fmt: skip
NUMBERS = [keys for keys, value in LEAVES.items() if isinstance(value, int | float)]
LISTS = [keys for keys, value in LEAVES.items() if isinstance(value, list)]
PAIRS = [("foot", "contact_x"), ("foot", "contact_y"), ("outline", "front"), ("outline", "rear")]
NUMBER_LISTS = [keys for keys in LISTS if not isinstance(LEAVES[keys][0], str)]


def entry(keys):
    """What the field of a key knows; joint angles share one."""
    fields = {field.name: field for field in dataclasses.fields((FACTS | PARAMETERS)[keys[0]])}
    return entry_of(fields[keys[1]])


def dotted(keys):
    """A test's name."""
    return ".".join(keys)


POSITIVE = [keys for keys in NUMBERS if entry(keys).sign == "positive"]
NOT_NEGATIVE = [keys for keys in NUMBERS if entry(keys).sign != "any"]
SHARES = [keys for keys in NUMBERS if entry(keys).unit == "share"]
BOUNDED = [keys for keys in NUMBERS if entry(keys).limit < 1e9]
ORDERED = [(section, field.name, above) for section, kind in (FACTS | PARAMETERS).items()
           for field in dataclasses.fields(kind) for above in entry_of(field).below]  # fmt: skip


@pytest.fixture
def robot_table():
    """What is spoilt here: HRP-2's robot.toml with every default written out."""
    return TABLE


def refusal(path):
    """The line with which a robot.toml is refused."""
    with pytest.raises(InvalidInput) as caught:
        load_robot(path)
    assert "\n" not in str(caught.value)
    assert str(path) in str(caught.value)
    return str(caught.value).removeprefix(f"{path}: ")


def test_unspoilt_copy_loads(spoilt):
    assert load_robot(spoilt({})).name == "hrp2"


@pytest.mark.parametrize("keys", NEEDED, ids=dotted)
def test_a_missing_key_is_named(spoilt, keys):
    message = refusal(spoilt({keys: DROP}))
    assert repr(keys[-1]) in message
    assert "lacks" in message
    assert keys[0] in message


@pytest.mark.parametrize("section", [(), *(keys for keys in SECTIONS if keys[-1] != "angles_deg")], ids=dotted)
def test_an_unknown_key_is_named(spoilt, section):
    assert "unknown key 'stride'" in refusal(spoilt({(*section, "stride"): 0.2}))


@pytest.mark.parametrize("keys", LEAVES, ids=dotted)
@pytest.mark.parametrize("value", [True, {"a": 1.0}], ids=["bool", "table"])
def test_a_wrong_type_is_named(spoilt, keys, value):
    assert keys[-1] in refusal(spoilt({keys: value}))


@pytest.mark.parametrize("keys", LEAVES, ids=dotted)
def test_text_for_a_number_and_a_number_for_text_are_named(spoilt, keys):
    value = "text" if isinstance(LEAVES[keys], int | float) else 7
    assert keys[-1] in refusal(spoilt({keys: value}))


@pytest.mark.parametrize("keys", SECTIONS, ids=dotted)
def test_a_number_for_a_table_is_named(spoilt, keys):
    message = refusal(spoilt({keys: 1.0}))
    assert keys[-1] in message
    assert "must be a table" in message


@pytest.mark.parametrize("keys", NUMBERS, ids=dotted)
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 10**400], ids=["nan", "inf", "-inf", "huge"])
def test_not_finite_is_named(spoilt, keys, value):
    message = refusal(spoilt({keys: value}))
    assert keys[-1] in message
    assert "finite" in message


@pytest.mark.parametrize("keys", NOT_NEGATIVE, ids=dotted)
def test_negative_is_named(spoilt, keys):
    message = refusal(spoilt({keys: -1 if isinstance(LEAVES[keys], int) else -0.5}))
    assert keys[-1] in message
    assert "positive" in message


@pytest.mark.parametrize("keys", POSITIVE, ids=dotted)
def test_zero_is_named(spoilt, keys):
    message = refusal(spoilt({keys: 0 if isinstance(LEAVES[keys], int) else 0.0}))
    assert keys[-1] in message
    assert "positive" in message


@pytest.mark.parametrize("keys", [keys for keys in NUMBERS if isinstance(LEAVES[keys], int)], ids=dotted)
def test_a_count_is_whole(spoilt, keys):
    assert "whole" in refusal(spoilt({keys: 2.5}))


@pytest.mark.parametrize("keys", LISTS, ids=dotted)
def test_an_empty_list_is_named(spoilt, keys):
    assert keys[-1] in refusal(spoilt({keys: []}))


@pytest.mark.parametrize("keys", NUMBER_LISTS, ids=dotted)
def test_a_list_that_holds_nan_is_named(spoilt, keys):
    nan = [0.1, math.nan] if isinstance(LEAVES[keys][0], list) else math.nan
    assert keys[-1] in refusal(spoilt({keys: [*LEAVES[keys][:-1], nan]}))


@pytest.mark.parametrize("more", [1, -1], ids=["more", "less"])
@pytest.mark.parametrize("keys", PAIRS, ids=dotted)
def test_a_pair_of_one_or_three_is_named(spoilt, keys, more):
    pair = [0.1, 0.2, 0.3][: 2 + more]
    assert keys[-1] in refusal(spoilt({keys: [pair] if isinstance(LEAVES[keys][0], list) else pair}))


@pytest.mark.parametrize(("section", "low", "high"), ORDERED)
def test_values_out_of_order_are_named(spoilt, section, low, high):
    for value in (TABLE[section][high], 1.001 * TABLE[section][high]):
        message = refusal(spoilt({(section, low): value}))
        assert "must be less than" in message
        assert low in message


def test_what_is_ordered():
    """As many pairs as the rules had before each field kept its own."""
    assert len(ORDERED) == 26
    assert ("walk", "sample_time", "double_support") in ORDERED
    assert ("stepping_over", "rest", "leg2_rise") in ORDERED


@pytest.mark.parametrize("keys", SHARES, ids=dotted)
def test_a_share_of_more_than_all_is_named(spoilt, keys):
    for value in (1.0, 1.5):
        message = refusal(spoilt({keys: value}))
        assert dotted(keys) in message
        assert "must be less than 1" in message


@pytest.mark.parametrize("keys", BOUNDED, ids=dotted)
def test_a_value_in_another_unit_is_named(spoilt, keys):
    value = 1000 * int(entry(keys).limit) if isinstance(LEAVES[keys], int) else 1000.0 * entry(keys).limit
    message = refusal(spoilt({keys: value}))
    assert dotted(keys) in message
    assert "at most" in message


def test_ranges_upside_down_are_named(spoilt):
    for key in ("contact_x", "contact_y"):
        assert key in refusal(spoilt({("foot", key): TABLE["foot"][key][::-1]}))


def test_a_search_that_begins_below_its_end_is_named(spoilt):
    assert "waist_height_min" in refusal(spoilt({("feasibility", "waist_height_min"): 0.7}))


def test_lengths_times_and_weights_may_be_neither_negative_nor_zero():
    positive = {keys[-1] for keys in POSITIVE}
    assert positive >= {"ankle_height", "waist_height", "heel", "toe", "sample_time", "window", "com_height"}
    assert positive >= {"single_support", "double_support", "jerk_weight", "zmp_weight", "step_length", "delta_ds"}


def test_an_order_that_a_default_breaks_names_both_and_the_line(tmp_path):
    path = own(tmp_path, "[walk]", "step_length_min = 0.26")
    line = path.read_text().splitlines().index("step_length_min = 0.26") + 1
    assert refusal(path) == (
        f"line {line}: walk.step_length_min = 0.26 must be less than walk.step_length_max = 0.25 (the default)"
    )
    path = own(tmp_path, "[walk]", "# a comment", "step_length_max = 0.05")
    line = path.read_text().splitlines().index("step_length_max = 0.05") + 1
    assert refusal(path).startswith(f"line {line}: walk.step_length_min = 0.1 (the default) must be less than")


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (["[walk]", "step_lenght = 0.2"], "walk has an unknown key 'step_lenght': did you mean 'step_length'? known"),
        (["[wlak]"], "has an unknown key 'wlak': did you mean 'walk'? known are"),
        (["[walk]", "step_length = 200"], "walk.step_length = 200 must be 10 m at most"),
        (["[adaptor]", "look_every = 5"], "adaptor.look_every = 5 must be 0.2 s at most"),
        (["[walk]", "sample_time = 1e-9"], "walk.sample_time = 1e-09 must be 0.0002 s at least"),
        (["slow = 1"], "slow must be true or false: its values are defaults of the library"),
        (["[slow.walk]", "single_support_over = 2.0"], "slow must be true or false"),
        (["[sole]", "mass = '0.3'"], "sole.mass = '0.3' must be a finite number"),
    ],
)
def test_the_line_that_is_wrong_is_named(tmp_path, lines, message):
    text = own(tmp_path, *lines).read_text().splitlines()
    where = f"line {text.index(lines[-1]) + 1}: " if lines[0] != "[slow.walk]" else ""
    assert refusal(tmp_path / "robot.toml").startswith(f"{where}{message}")


@pytest.mark.parametrize("value", [0.72, 0.9, 1.2])
def test_a_centre_of_mass_that_the_model_does_not_have_is_refused(tmp_path, value):
    path = own(tmp_path, com_height=value)
    assert f"preview.com_height = {value} is far from 0.8105 m, which follows from the URDF" in refusal(path)


def test_a_centre_of_mass_near_to_the_models_is_taken_and_without_one_the_models(tmp_path):
    assert load_robot(own(tmp_path, com_height=0.83)).preview.com_height == 0.83
    assert load_robot(own(tmp_path, com_height=None)).preview.com_height == 0.8105


def own(folder, *lines, com_height=0.814):
    """HRP-2's robot.toml as it is written, with other lines: those of a table of its own at the end."""
    text = (HRP2 / "robot.toml").read_text().replace('"hrp2.urdf"', f'"{HRP2}/hrp2.urdf"')
    table = text[text.index("[preview]") : text.index("[sole]")]
    text = text.replace(table, "" if com_height is None else f"[preview]\ncom_height = {com_height}\n\n")
    if "[sole]" in lines:
        text = text[: text.index("[sole]")]
    extra = "\n".join(lines) + "\n"
    path = folder / "robot.toml"
    path.write_text(text + extra if extra.startswith("[") else extra + text)
    return path


def test_lines_of_tables_and_keys():
    text = (
        '# [walk]\nname = "x"\n[outline]\nfront = [[1, 2],\n  [3, 4]]\nrear = [[1, 2]] # rear = 1\n["walk"]\n"lift" = 1'
    )
    found = {key: line_of(text, key) for key in ("name", "outline", "outline.rear", "walk", "walk.lift", "walk.rear")}
    assert found == {"name": 2, "outline": 3, "outline.rear": 6, "walk": 7, "walk.lift": 8, "walk.rear": None}


ATTRIBUTES = {"urdf": "urdf_path"}


def test_what_is_read_is_what_is_written(spoilt):
    floats = [keys for keys in LEAVES if keys[0] in PARAMETERS and isinstance(LEAVES[keys], float)]
    changed = {keys: 0.999 * LEAVES[keys] for keys in floats}
    robot = load_robot(spoilt(changed))
    for keys, value in (LEAVES | changed).items():
        read = robot
        for key in keys:
            read = read[key] if isinstance(read, types.MappingProxyType) else getattr(read, ATTRIBUTES.get(key, key))
        assert plain(read) == (robot.urdf_path if keys == ("urdf",) else value), dotted(keys)


@pytest.mark.parametrize("keys", LISTS, ids=dotted)
def test_values_cannot_be_changed(robot, keys):
    assert isinstance(getattr(getattr(robot, keys[0]), keys[1]), tuple)
