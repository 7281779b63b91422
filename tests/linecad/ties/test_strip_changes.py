"""What tests/benchmarks/strip_changes.py makes of strips: what a foot is stays one, whatever else changes."""

import numpy as np
import pytest
import strip_changes
from feet_truth import UNSEEN
from hypothesis import given, settings
from hypothesis import strategies as st
from strip_changes import (
    LAYERS,
    SHIFT,
    add_bands,
    add_hedge,
    add_things,
    as_if_small,
    change_a_little,
    changed_example,
    repeated,
)

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
        change_a_little(colour, FOOT, random)
        steps = np.abs(np.diff(colour, axis=1)).max(axis=(0, 2)) > 0
        at_foot.append(steps[FOOT - 1])
        elsewhere.append(steps[: FOOT - 1].any() or steps[FOOT:].any())
    assert 0.1 < np.mean(at_foot) < 0.3
    assert np.mean(elsewhere) > np.mean(at_foot)


@pytest.mark.parametrize("seed", range(20))
def test_bands_are_elsewhere_than_the_foot(seed):
    """Where nothing but bands change a plain strip, rows beside the foot stay alike."""
    colour = np.zeros((3, ROWS, COLUMNS), np.float32)
    random = np.random.default_rng(seed)
    while not colour.any():
        add_bands(colour, FOOT, random)
    above, below = colour[0, FOOT - 2], colour[0, FOOT + 2]
    grained = np.ptp(above) > 0
    assert grained or above == pytest.approx(below)


def test_a_longer_wall_has_its_foot_where_it_was_and_keeps_its_lines():
    found = repeated(strip_with_foot(), 3)
    assert found.shape == strip_with_foot().shape
    assert (found[0, FOOT - 1] == 1).all()
    assert (found[0, FOOT] == -1).all()
    assert found[4, 0].sum() > strip_with_foot()[4, 0].sum()


@pytest.mark.parametrize(("rows", "columns"), [(1, 1), (2, 1), (7, 5), (5, 3)])
def test_fewer_pixels_blur_a_foot_and_do_not_move_it(rows, columns):
    colour = as_if_small(strip_with_foot()[:3], rows, columns)
    assert colour.shape == (3, ROWS, COLUMNS)
    crossing = (colour[0].mean(axis=1) > 0).sum()
    assert abs(crossing - FOOT) <= rows / 2
    assert colour[0, 20] == pytest.approx(np.ones(COLUMNS))
    if (rows, columns) == (1, 1):
        assert colour == pytest.approx(strip_with_foot()[:3])


def test_things_leave_a_part_of_the_foot():
    random = np.random.default_rng(2)
    shown = []
    for _ in range(60):
        strip = strip_with_foot()
        add_things(strip, FOOT, random)
        shown.append((strip[0, FOOT] == -1).mean())
    assert min(shown) > 0.05
    assert max(shown) < 1
