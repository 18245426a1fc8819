"""model/reading.py: whatever is wrong in a robot.toml is refused with a line that names it."""

from __future__ import annotations

import math
import tomllib
import types
from itertools import chain, pairwise

import pytest
from conftest import DROP, HRP2

from stepover import InvalidInput, load_robot
from stepover.robots import reading

TABLE = tomllib.loads((HRP2 / "robot.toml").read_text())


def leaves(table, above=()):
    """Every key of robot.toml with its value: (keys, value)."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from leaves(value, (*above, key))
        else:
            yield (*above, key), value


LEAVES = dict(leaves(TABLE))
SECTIONS = [(key,) for key, value in TABLE.items() if isinstance(value, dict)] + [("posture", "angles_deg")]
NEEDED = [keys for keys in LEAVES if keys[:2] != ("posture", "angles_deg") and keys[0] != "slow"] + SECTIONS
NUMBERS = [keys for keys, value in LEAVES.items() if isinstance(value, int | float)]
LISTS = [keys for keys, value in LEAVES.items() if isinstance(value, list)]
PAIRS = [("foot", "contact_x"), ("foot", "contact_y"), ("outline", "front"), ("outline", "rear")]
NUMBER_LISTS = [keys for keys in LISTS if not isinstance(LEAVES[keys][0], str)]


def section_of(keys):
    """The key as it is called in reading.SIGNED and ZERO: the angles of the posture share one name."""
    return "angles_deg" if "angles_deg" in keys else keys[-1]


def dotted(keys):
    """A test's name."""
    return ".".join(keys)


POSITIVE = [keys for keys in NUMBERS if section_of(keys) not in reading.SIGNED | reading.ZERO]
NOT_NEGATIVE = [keys for keys in NUMBERS if section_of(keys) not in reading.SIGNED]


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


@pytest.mark.parametrize(
    ("section", "keys"),
    [(section, keys) for section in TABLE for keys in reading.RISING
     if isinstance(TABLE[section], dict) and sum(key in TABLE[section] for key in keys) > 1],
    ids=str,
)  # fmt: skip
def test_values_out_of_order_are_named(spoilt, section, keys):
    keys = [key for key in keys if key in TABLE[section]]
    for low, high in pairwise(keys):
        for value in (TABLE[section][high], 1.001 * TABLE[section][high]):
            message = refusal(spoilt({(section, low): value}))
            assert "must be less than" in message
            assert low in message


@pytest.mark.parametrize("key", sorted(reading.SHARES))
def test_a_share_of_more_than_all_is_named(spoilt, key):
    sections = [section for section, table in TABLE.items() if isinstance(table, dict) and key in table]
    assert sections
    for section in sections:
        assert f"{section}.{key}" in refusal(spoilt({(section, key): 1.5}))


def test_ranges_upside_down_are_named(spoilt):
    for key in ("contact_x", "contact_y"):
        assert key in refusal(spoilt({("foot", key): TABLE["foot"][key][::-1]}))


def test_a_search_that_begins_below_its_end_is_named(spoilt):
    assert "waist_height_min" in refusal(spoilt({("feasibility", "waist_height_min"): 0.7}))


def test_rules_name_keys_that_exist():
    known = {keys[-1] for keys in LEAVES} | {"angles_deg"}
    ruled = reading.SIGNED | reading.ZERO | reading.SHARES | reading.RANGES | set(chain(*reading.RISING))
    assert ruled <= known


def test_lengths_times_and_weights_may_be_neither_negative_nor_zero():
    free = {key for keys in NUMBERS if (key := section_of(keys)) in reading.SIGNED | reading.ZERO}
    assert not free & {"ankle_height", "waist_height", "heel", "toe", "sample_time", "window", "com_height"}
    assert not free & {"single_support", "double_support", "jerk_weight", "zmp_weight", "step_length", "delta_ds"}


ATTRIBUTES = {"urdf": "urdf_path"}


def test_what_is_read_is_what_is_written(robot):
    for keys, value in LEAVES.items():
        read = robot
        for key in keys:
            read = read[key] if isinstance(read, types.MappingProxyType) else getattr(read, ATTRIBUTES.get(key, key))
        assert as_lists(read) == (robot.urdf_path if keys == ("urdf",) else value), dotted(keys)


def as_lists(value):
    """Tuples as lists, as TOML has them."""
    return [as_lists(item) for item in value] if isinstance(value, tuple) else value


@pytest.mark.parametrize("keys", [keys for keys in LISTS if keys[0] != "slow"], ids=dotted)
def test_values_cannot_be_changed(robot, keys):
    assert isinstance(getattr(getattr(robot, keys[0]), keys[1]), tuple)
