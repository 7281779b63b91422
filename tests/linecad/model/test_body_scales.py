"""Scale cues between bodies: the most evidence that agrees, exactly, and the scales that follow."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog
from scipy.stats import poisson

import linecad.model.body_scales
from linecad.model.body_scales import BASE_RATE, ENOUGH, LEAST, ScaleCues, evidence_of, find_accepted_cues, join_bodies


def cues_of(*rows, tolerance=0.02):
    """Scale cues from rows of first body, second body, log ratio, seen, expected."""
    table = np.array(rows, float).reshape(-1, 5)
    return ScaleCues(table[:, :2].astype(int), table[:, 2], np.full(len(table), tolerance), table[:, 3], table[:, 4])


def scales_exist(cues, kept, count):
    """Whether linear programming finds log scales that keep all tolerances of the kept cues."""
    if not kept:
        return True
    rows = np.zeros((len(kept), count))
    for row, cue in enumerate(kept):
        first, second = cues.bodies[cue]
        rows[row, second], rows[row, first] = 1, -1
    ratio, tolerance = cues.log_ratio[list(kept)], cues.tolerance[list(kept)]
    found = linprog(
        np.zeros(count), np.r_[rows, -rows], np.r_[ratio + tolerance, tolerance - ratio] + 1e-8, bounds=(None, None)
    )
    return found.status == 0


@st.composite
def some_cues(draw):
    bodies = st.tuples(st.integers(0, 3), st.integers(0, 3)).filter(lambda pair: pair[0] < pair[1])
    ratio = st.sampled_from([0.0, 0.1, 0.11, 0.3])
    rows = draw(st.lists(st.tuples(bodies, ratio, st.integers(1, 6)), min_size=1, max_size=6))
    return cues_of(*[(*pair, ratio, seen, 0.1) for pair, ratio, seen in rows])


@settings(max_examples=25)
@given(some_cues())
def test_no_set_of_cues_that_agree_says_more(cues):
    accepted = find_accepted_cues(cues, 4)
    numbers = range(len(accepted))
    best = max(
        sum(cues.evidence[list(kept)])
        for size in range(len(accepted) + 1)
        for kept in combinations(numbers, size)
        if scales_exist(cues, kept, 4)
    )
    assert scales_exist(cues, tuple(np.flatnonzero(accepted)), 4)
    assert cues.evidence[accepted].sum() == pytest.approx(best)


@given(st.integers(1, 30), st.floats(0, 20))
def test_evidence_is_the_tail_of_poisson(seen, expected):
    assert evidence_of(seen, expected) == pytest.approx(-poisson.logsf(seen - 1, expected + BASE_RATE) / np.log(10))


def test_nothing_seen_is_no_evidence():
    assert evidence_of(0, 2.0) == 0


@given(st.lists(st.floats(-2, 2), min_size=2, max_size=6))
def test_true_scales_come_back(scales):
    pairs = combinations(range(len(scales)), 2)
    joined = join_bodies(cues_of(*[(a, b, scales[b] - scales[a], 6, 0) for a, b in pairs]), len(scales))
    assert (joined.group == 0).all()
    np.testing.assert_allclose(joined.log_scale, np.array(scales) - scales[0], atol=1e-9)


def test_a_chain_carries_the_scale_on():
    joined = join_bodies(cues_of((0, 1, 0.5, 6, 0), (1, 2, 0.25, 6, 0)), 4)
    assert joined.group.tolist() == [0, 0, 0, 3]
    np.testing.assert_allclose(joined.log_scale, [0, 0.5, 0.75, 0], atol=1e-9)


def test_the_weakest_cue_of_a_contradiction_gives_way():
    joined = join_bodies(cues_of((0, 1, 0.0, 6, 0), (1, 2, 0.0, 6, 0), (0, 2, 0.4, 4, 0)), 3)
    assert joined.accepted.tolist() == [True, True, False]
    np.testing.assert_allclose(joined.log_scale, 0, atol=1e-9)


def test_few_coincidences_join_nothing():
    assert evidence_of(2, 0.2) < ENOUGH
    assert join_bodies(cues_of((0, 1, 0.3, 2, 0.2)), 2).group.tolist() == [0, 1]


def test_coincidences_of_a_group_count_together():
    alone = cues_of((0, 2, 0.3, 2, 0.2), (1, 2, 0.3, 2, 0.2))
    assert join_bodies(alone, 3).group.tolist() == [0, 1, 2]
    grouped = cues_of((0, 1, 0.0, 6, 0), (0, 2, 0.3, 2, 0.1), (1, 2, 0.3, 2, 0.1))
    assert join_bodies(grouped, 3).group.tolist() == [0, 0, 0]


def test_cues_that_say_next_to_nothing_do_not_add_up():
    rows = [(a, b, 0.3, 2, 1.5) for a in range(4) for b in range(4, 8)]
    rows += [(a, a + 1, 0.0, 6, 0) for a in (0, 1, 2, 4, 5, 6)]
    assert evidence_of(2, 1.5) < LEAST
    assert join_bodies(cues_of(*rows), 8).group.tolist() == [0] * 4 + [4] * 4


def test_beyond_the_limit_all_of_a_contradiction_is_given_up(monkeypatch):
    monkeypatch.setattr(linecad.model.body_scales, "MOST_BRANCHES", 1)
    cues = cues_of((0, 1, 0.0, 6, 0), (1, 2, 0.0, 6, 0), (0, 2, 0.4, 4, 0), (0, 3, 0.1, 6, 0))
    assert find_accepted_cues(cues, 4).tolist() == [False, False, False, True]


def test_no_cues_leave_every_body_alone():
    joined = join_bodies(cues_of(), 3)
    assert joined.group.tolist() == [0, 1, 2]
    assert joined.log_scale.tolist() == [0, 0, 0]
