"""report/strategies.py: what two strategies come to, and durations over epsilon."""

from __future__ import annotations

import numpy as np
import pytest

from stepover.analysis.strategies import compared, moments, paper_marks, spans, strategy
from stepover.planning.measures import measure
from stepover.planning.quasi_static.planner import quasi_static_in_detail


@pytest.fixture(scope="module")
def slow(robot, obstacle):
    """The quasi-static motion at 10 mm."""
    return quasi_static_in_detail(robot, obstacle, 0.01, look_for_nearest=False)


def test_numbers_of_both_strategies(robot, slow, motion):
    ours, theirs = strategy(robot, slow.motion), strategy(robot, motion)
    for one, of in ((ours, slow.motion), (theirs, motion)):
        found = measure(robot, of)
        assert one.whole == pytest.approx(found.duration)
        assert one.over == pytest.approx(found.step_over_duration)
    np.testing.assert_allclose([ours.double_support, theirs.double_support], [slow.durations[2], 0.04])
    assert ours.apart < 0.012 < 0.1 < theirs.apart
    assert ours.com_margin > 0.025
    assert theirs.com_margin < 0.0 < theirs.zmp_margin


def test_the_comparison_holds_the_ratio_of_durations(robot, slow, motion):
    rows = {row[0]: row[1:] for row in compared(strategy(robot, slow.motion), strategy(robot, motion))}
    paper, ours, _, theirs, ratio = rows["double support over the obstacle [s]"]
    assert (paper, theirs) == ("15", pytest.approx(0.04))
    assert ratio == pytest.approx(ours / theirs)


def test_spans_are_sums_of_segments_and_fall_with_the_root(slow):
    errors = np.array([1.0, 4.0, 9.0, 16.0, 25.0]) * 1e-3
    found = spans(errors, np.array([1e-3, 4e-3]))
    np.testing.assert_allclose(list(found.values()), [[15.0, 7.5], [9.0, 4.5], [3.0, 1.5]])
    assert spans(slow.zmp_errors, np.array([0.01]))["whole motion"].item() == pytest.approx(
        slow.motion.time[-1], abs=5 * 0.005
    )


def test_the_paper_lies_on_the_curves(slow):
    curves = ("whole motion", "leg 1 lifts off to leg 2 lands", "double support", "whole motion")
    for (epsilon, duration), name in zip(paper_marks(slow.zmp_errors).values(), curves, strict=True):
        assert spans(slow.zmp_errors, np.array([epsilon]))[name].item() == pytest.approx(duration)


def test_moments_are_in_their_phases(slow, motion):
    for one in (slow.motion, motion):
        at = moments(one)
        assert (np.diff(at) > 0.0).all()
        samples = np.round(at / one.dt).astype(int)
        assert one.phase[samples].tolist() == [1, 1, 2, 3, 3, 0]
