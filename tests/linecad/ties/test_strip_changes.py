"""What tests/benchmarks/strip_changes.py makes of strips: what a foot is stays one, whatever else changes."""

import numpy as np
import pytest
import strip_changes
from feet_truth import UNSEEN
from hypothesis import given, settings
from hypothesis import strategies as st
from strip_changes import LAYERS, SHIFT, add_hedge, change_ground, changed_example

from linecad.ties.walls import COLUMNS, ROWS

FOOT = 140


def strip_with_foot(foot=FOOT):
    """A light wall with uprights above dark ground, all of it seen."""
    strip = np.zeros((LAYERS, ROWS, COLUMNS), np.float32)
    strip[0, :foot], strip[0, foot:], strip[3] = 1.0, -1.0, 1.0
    strip[4, :foot, ::8] = 1.0
    return strip


@settings(max_examples=60)
@given(st.integers(0, 2**32 - 1), st.one_of(st.just(UNSEEN), st.floats(8.0, ROWS - 8.0)))
def test_a_changed_strip_is_one_that_the_network_reads(seed, row):
    before = strip_with_foot()
    changed, at = changed_example(before, row, np.random.default_rng(seed))
    assert changed.shape == before.shape
    assert np.isfinite(changed).all()
    assert at == UNSEEN or abs(at - row) <= SHIFT + 1e-9
    assert at == UNSEEN or 0 < at < ROWS
    assert not (row == UNSEEN and at != UNSEEN), "a foot that is not seen stays unseen"
    assert not changed[:3][:, changed[3] == 0].any(), "what is not seen has no colour"
    assert (before == strip_with_foot()).all(), "the strip that was given stays"


def test_most_feet_stay_seen_and_some_are_hidden_by_hedges():
    random = np.random.default_rng(0)
    stays = np.mean([changed_example(strip_with_foot(), FOOT, random)[1] != UNSEEN for _ in range(300)])
    assert 0.7 < stays < 0.95


@pytest.mark.parametrize("foot", [30, FOOT, ROWS - 4])
def test_a_hedge_hides_the_lines_and_all_of_a_foot_or_a_part(foot):
    random, hidden = np.random.default_rng(1), []
    for _ in range(60):
        strip = strip_with_foot(foot)
        is_whole = add_hedge(strip, foot, random)
        is_hedge = strip[0] != strip_with_foot(foot)[0]
        assert is_hedge[foot - 1 : foot + 1].all() == is_whole
        assert not strip[4][is_hedge].any()
        hidden.append(is_whole)
    assert 0.5 < np.mean(hidden) < 0.95


def test_ground_is_changed_at_few_feet_and_as_often_elsewhere(monkeypatch):
    """Else a change would tell the network where feet are, as it once did."""
    monkeypatch.setattr(strip_changes, "grain", lambda shape, _: np.zeros((3, *shape)))
    random, at_foot, elsewhere = np.random.default_rng(3), [], []
    for _ in range(600):
        colour = np.zeros((3, ROWS, COLUMNS), np.float32)
        change_ground(colour, FOOT, random)
        steps = np.abs(np.diff(colour, axis=1)).max(axis=(0, 2)) > 0
        at_foot.append(steps[FOOT - 1])
        elsewhere.append(steps[: FOOT - 1].any() or steps[FOOT:].any())
    assert 0.1 < np.mean(at_foot) < 0.3
    assert np.mean(elsewhere) > np.mean(at_foot)
