"""Grids and lists of obstacles: what is written is what is swept."""

import pytest

from stepover.errors import InvalidInput
from stepover.studies import obstacle_list
from stepover.studies.obstacle_list import axis, grid, read_list


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("0.05:0.25:0.05", [0.05, 0.1, 0.15, 0.2, 0.25]),
        ("0.05:0.24:0.05", [0.05, 0.1, 0.15, 0.2]),
        ("0.1:0.3:0.1", [0.1, 0.2, 0.3]),
        ("0.15:0.15:0.01", [0.15]),
        ("0.15", [0.15]),
        ("0.2, 0.1", [0.2, 0.1]),
    ],
)
def test_an_axis_has_both_ends(text, values):
    assert axis(text, "--heights") == values


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("high", "first:last:step"),
        ("", "first:last:step"),
        ("0.1:0.2", "first:last:step"),
        ("0.1:0.2:0.1:0.1", "first:last:step"),
        ("0.1:nan:0.1", "first:last:step"),
        ("0.1:inf:0.1", "first:last:step"),
        ("0.1,", "first:last:step"),
        ("0.1:0.2:0.1,0.3", "mixes"),
        ("0.1:0.2:0", "must rise"),
        ("0.1:0.2:-0.1", "must rise"),
        ("0.2:0.1:0.1", "must rise"),
        ("0.1:0.2:1e-12", "larger"),
        ("0.1:0.2:1e-320", "larger"),
    ],
)
def test_what_is_no_axis(text, words):
    with pytest.raises(InvalidInput, match=words) as error:
        axis(text, "--heights")
    assert "--heights" in str(error.value)


def test_a_grid_goes_by_height(monkeypatch):
    assert grid([0.1, 0.2], [0.02, 0.05]) == [(0.1, 0.02), (0.1, 0.05), (0.2, 0.02), (0.2, 0.05)]
    with pytest.raises(InvalidInput, match=r"0\.1 m high and 0\.02 m wide is given 2 times"):
        grid([0.1, 0.1], [0.02])
    monkeypatch.setattr(obstacle_list, "MOST", 3)
    with pytest.raises(InvalidInput, match="4 obstacles; at most 3"):
        grid([0.1, 0.2], [0.02, 0.05])


def test_a_list_keeps_its_order_and_other_columns_do_not_matter(tmp_path):
    (tmp_path / "list.csv").write_text("\ufeffwidth,name,height\n0.05,box,0.2\n0.02,kerb,0.1\n", encoding="utf-8")
    assert read_list(tmp_path / "list.csv") == [(0.2, 0.05), (0.1, 0.02)]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "columns height and width"),
        (b"0.1,0.05\n", "columns height and width"),
        (b"height,depth\n0.1,0.05\n", "columns height and width"),
        (b"height,width\n", "names no obstacle"),
        (b"height,width\n0.1,wide\n", "line 2.*'wide'"),
        (b"height,width\n0.1,0.05\n0.1\n", "line 3.*None"),
        (b"height,width\n0.1,0.05\n0.1,0.05\n", "given 2 times"),
        (b"height,width\n\xff\xfe,1\n", "not a table"),
    ],
)
def test_what_is_no_list(tmp_path, content, words):
    (tmp_path / "list.csv").write_bytes(content)
    with pytest.raises(InvalidInput, match=words):
        read_list(tmp_path / "list.csv")


def test_a_missing_list(tmp_path):
    with pytest.raises(InvalidInput, match="No such file"):
        read_list(tmp_path / "none.csv")
