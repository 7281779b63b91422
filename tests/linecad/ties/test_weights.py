"""What candidates are worth as ties: over chance, enough, by the size of the bodies, and which repeat each other."""

import numpy as np
import pytest

from linecad.ties.candidates import KINDS, Candidate
from linecad.ties.table import AT_ONCE, LOG_ODDS
from linecad.ties.weights import (
    BY_CHANCE,
    FULL_SIZE,
    LEAST_WEIGHT,
    REPEATED,
    TOLERANCE,
    log_odds_of,
    weigh_candidates,
)

LARGE = np.array([40, 50, 60])
CHANCE = np.log(BY_CHANCE / (1 - BY_CHANCE))  # log-odds


def worth(gain, kind="bundle", bodies=(0, 1), log_ratio=0.0, normal=-1):
    """A candidate whose log-odds are so much more than those of chance, by one of its features."""
    name = max(LOG_ODDS[kind], key=lambda one: abs(LOG_ODDS[kind][one]))
    value = (gain + CHANCE - AT_ONCE[kind]) / LOG_ODDS[kind][name]
    return Candidate(kind, bodies, log_ratio, normal, {name: value})


@pytest.mark.parametrize("kind", KINDS)
def test_log_odds_are_the_sum_over_the_features(kind):
    (one, by), (other, by_other), *_ = LOG_ODDS[kind].items()
    candidate = Candidate(kind, (0, 1), 0.0, -1, {one: 2.0, other: -3.0})
    assert log_odds_of(candidate) == pytest.approx(AT_ONCE[kind] + 2 * by - 3 * by_other)


def test_a_tie_is_worth_what_it_adds_over_chance():
    ties = weigh_candidates([worth(3.5, log_ratio=-0.4, bodies=(1, 2))], LARGE)
    assert ties.weight.tolist() == pytest.approx([3.5])
    assert (ties.bodies.tolist(), ties.log_ratio.tolist()) == ([[1, 2]], [-0.4])
    assert ties.tolerance.tolist() == [TOLERANCE]


def test_weak_candidates_are_no_ties():
    ties = weigh_candidates([worth(LEAST_WEIGHT - 0.01), worth(LEAST_WEIGHT + 0.01, log_ratio=0.2)], LARGE)
    assert ties.log_ratio.tolist() == [0.2]


@pytest.mark.parametrize("kind", KINDS)
def test_planes_and_levels_are_worth_less_since_they_repeat_each_other(kind):
    (weight,) = weigh_candidates([worth(5.0, kind)], LARGE).weight
    assert weight == pytest.approx(5.0 * REPEATED if kind in ("plane", "level") else 5.0)


@pytest.mark.parametrize(("lines", "share"), [(6, 6 / FULL_SIZE), (15, 0.5), (30, 1.0), (300, 1.0)])
def test_small_bodies_move_little(lines, share):
    assert FULL_SIZE == 30
    for size in ((lines, 400), (400, lines)):
        assert weigh_candidates([worth(5.0)], np.array(size)).weight.tolist() == pytest.approx([5.0 * share])


@pytest.mark.parametrize(("lines", "share"), [(15, 0.5), (30, 1.0)])
def test_a_tie_to_the_ground_counts_by_the_size_of_its_body(lines, share):
    """The ground has no lines, and is no crumb."""
    ties = weigh_candidates([worth(5.0, bodies=(0, 1))], np.array([lines]))
    assert ties.weight.tolist() == pytest.approx([5.0 * share])
    assert ties.bodies.tolist() == [[0, 1]]


def test_a_weak_tie_of_small_bodies_stays_one():
    assert len(weigh_candidates([worth(LEAST_WEIGHT + 0.1)], np.array([4, 4]))) == 1


def test_groups_are_those_of_one_kind_and_normal():
    wanted = [("bundle", -1), ("plane", 0), ("plane", 1), ("level", -1), ("plane", 0), ("plane", 2), ("bundle", -1)]
    group = weigh_candidates([worth(5.0, kind, normal=normal) for kind, normal in wanted], LARGE).group.tolist()
    assert group[0] == group[6] == -1
    assert group[1] == group[4]
    others = [group[place] for place in (1, 2, 3, 5)]
    assert len(set(others)) == 4
    assert min(others) >= 0


def test_no_candidates_are_no_ties():
    for candidates in ([], [worth(0.0)]):
        ties = weigh_candidates(candidates, LARGE)
        assert len(ties) == 0
        assert ties.value(np.zeros(3)) == 0
