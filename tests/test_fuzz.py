"""Mutated inputs: no traceback, no hang, no hoard. `make fuzz` tries many more."""

from __future__ import annotations

import os

import pytest
from fuzzing import Broken, Fuzz, tried

COUNT = int(os.environ.get("FUZZ", "0"))
"""Inputs of each kind; 0: the few of a quick run."""
QUICK = {"urdf": 120, "robot_toml": 120, "motion": 150, "obstacle": 40}


@pytest.fixture(scope="module")
def fuzz(tmp_path_factory, motion):
    return Fuzz(tmp_path_factory.mktemp("fuzz"), motion)


@pytest.mark.parametrize("kind", QUICK)
def test_every_input_ends_well(fuzz, kind):
    broken, said = {}, set()
    for seed in range(COUNT or QUICK[kind]):
        try:
            said.add(getattr(fuzz, kind)(seed))
        except Broken as error:
            broken[seed] = str(error)
    assert broken == {}
    assert "accepted" in said
    assert len(said) > 5


def test_a_break_is_found_out(tmp_path):
    for attempt in (lambda: 1 / 0, lambda: (tmp_path / "left").touch()):
        with pytest.raises(Broken):
            tried(attempt, tmp_path)
