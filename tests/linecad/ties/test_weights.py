"""What candidates are worth as ties: over chance, enough, by the size of the bodies, and which repeat each other."""

import numpy as np
import pytest

from linecad.ties.candidates import KINDS, SAME_RATIO, Candidate
from linecad.ties.table import AT_ONCE, LOG_ODDS
from linecad.ties.weights import (
    AGAIN,
    BY_CHANCE,
    FULL_SIZE,
    JOINED,
    LEAST_OF_PIECES,
    LEAST_WEIGHT,
    OF_PIECES,
    REPEATED,
    SAME_FOOT,
    TOLERANCE,
    UNCLEAR,
    log_odds_of,
    mean_of_looks,
    weigh_candidates,
    with_feet_once,
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
def test_planes_are_worth_less_since_they_repeat_each_other(kind):
    (weight,) = weigh_candidates([worth(5.0, kind)], LARGE).weight
    assert weight == pytest.approx(5.0 * REPEATED if kind == "plane" else 5.0)


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


def look(*candidates):
    """Of large bodies."""
    chosen = list(candidates)
    return weigh_candidates(chosen, LARGE), chosen


def test_what_both_looks_ask_for_is_one_tie_at_the_ratio_of_the_wholes():
    one, other = worth(6.0, log_ratio=0.10), worth(3.0, log_ratio=0.10 + 0.9 * SAME_RATIO)
    ties, told = mean_of_looks(look(one), look(other))
    assert ties.log_ratio.tolist() == [0.10]
    assert ties.weight.tolist() == pytest.approx([6.0 * (1 - OF_PIECES) + 3.0 * OF_PIECES])
    assert told == [one]


@pytest.mark.parametrize(
    "other",
    [
        worth(3.0, log_ratio=0.1 + 1.1 * SAME_RATIO),
        worth(3.0, log_ratio=0.1, bodies=(0, 2)),
        worth(3.0, "plane", log_ratio=0.1, normal=1),
    ],
    ids=["another ratio", "other bodies", "a kind that repeats itself"],
)
def test_what_one_look_shows_has_its_share_of_the_weight(other):
    one = worth(6.0, log_ratio=0.1)
    (whole, _), (parted, _) = look(one), look(other)
    ties, told = mean_of_looks(look(one), look(other))
    assert told == [one, other]
    assert ties.bodies.tolist() == [list(one.bodies), list(other.bodies)]
    assert ties.weight.tolist() == pytest.approx([whole.weight[0] * (1 - OF_PIECES), parted.weight[0] * OF_PIECES])


def test_a_tie_takes_no_more_than_one_of_the_pieces():
    one = worth(6.0, log_ratio=0.1)
    near, nearer = worth(3.0, log_ratio=0.105), worth(4.0, log_ratio=0.101)
    ties, told = mean_of_looks(look(one), look(nearer, near))
    assert told == [one, near]
    assert ties.weight.tolist() == pytest.approx([6.0 * (1 - OF_PIECES) + 4.0 * OF_PIECES, 3.0 * OF_PIECES])


@pytest.mark.parametrize(("share", "count"), [(0.9, 1), (1.1, 2)])
def test_weak_ties_that_pieces_alone_ask_for_are_left_out(share, count):
    other = worth(3.0, log_ratio=0.3)
    size = FULL_SIZE * share * LEAST_OF_PIECES / (OF_PIECES * 3.0)
    crumbs = weigh_candidates([other], np.array([size, size]))
    assert len(mean_of_looks(look(worth(6.0, log_ratio=0.1)), (crumbs, [other]))[0]) == count


def test_looks_that_agree_weigh_as_one():
    candidates = [worth(6.0, log_ratio=0.1), worth(4.0, "plane", (1, 2), 0.2, 0), worth(3.0, "level", (0, 2), 0.4)]
    ties, told = mean_of_looks(look(*candidates), look(*candidates))
    once, _ = look(*candidates)
    assert told == candidates
    assert ties.weight.tolist() == pytest.approx(once.weight.tolist())
    assert ties.group.tolist() == once.group.tolist()


GROUND = len(LARGE)


def foot(body, height, log_odds=UNCLEAR - 0.5, ground=GROUND):
    """A foot of a body: the camera is so high above the ground, log, at the body's own scale."""
    return worth(log_odds - CHANCE, "ground", (body, ground), -height)


def shares(*candidates, size=LARGE):
    """What each keeps of its weight."""
    ties = weigh_candidates(candidates, size)
    assert len(ties) == len(candidates)
    after = with_feet_once(ties, candidates)
    np.testing.assert_array_equal(after.log_ratio, ties.log_ratio)
    return (after.weight / ties.weight).tolist()


def test_unclear_feet_of_bodies_that_hang_together_hardly_count_more_than_one():
    assert shares(foot(0, 0.0), foot(1, 0.0), worth(4.0)) == pytest.approx([1, AGAIN, 1])
    chain = [worth(4.0), worth(4.0, bodies=(1, 2))]
    assert shares(foot(0, 0.0), foot(2, 0.0), foot(1, 0.0), *chain) == pytest.approx([1, AGAIN, AGAIN, 1, 1])


def test_two_feet_of_one_body_are_rivals():
    assert shares(foot(0, 0.0), foot(0, 0.05)) == [1, 1]
    assert shares(foot(0, 0.0), foot(0, 0.05), foot(1, 0.02), worth(4.0)) == pytest.approx([1, 1, AGAIN, 1])


def test_the_heaviest_of_them_keeps_its_weight():
    assert shares(foot(0, 0.0, UNCLEAR - 0.3), foot(1, 0.0, UNCLEAR - 0.1), worth(4.0)) == pytest.approx([AGAIN, 1, 1])


def test_feet_of_bodies_that_nothing_joins_are_witnesses_apart():
    assert shares(foot(0, 0.0), foot(1, 0.0)) == [1, 1]
    assert shares(foot(0, 0.0), foot(1, 0.0), worth(JOINED - 0.1)) == [1, 1, 1]
    assert shares(foot(0, 0.0), foot(1, 0.0), worth(6.0, "plane", normal=0)) == [1, 1, 1]


def test_clear_feet_are_witnesses_apart():
    clear = UNCLEAR + 0.1
    assert shares(foot(0, 0.0, clear), foot(1, 0.0, clear), worth(4.0)) == [1, 1, 1]


def test_heights_are_the_same_or_not_where_the_bundle_has_the_bodies():
    """The scale of the first body is exp(0.7) times that of the second, at which the camera is so much higher."""
    bundle = worth(4.0, log_ratio=0.7)
    assert shares(foot(0, 0.2), foot(1, 0.9), bundle) == pytest.approx([1, AGAIN, 1])
    assert shares(foot(0, 0.2), foot(1, 0.9 + SAME_FOOT - 0.01), bundle) == pytest.approx([1, AGAIN, 1])
    assert shares(foot(0, 0.2), foot(1, 0.9 + SAME_FOOT + 0.01), bundle) == [1, 1, 1]
    assert shares(foot(0, 0.2), foot(1, 0.2), bundle) == [1, 1, 1]


def test_parts_that_a_lighter_bundle_joins_move_as_wholes():
    """Scales 0, -0.3, -1.0 and -1.4, log, of bodies that two heavy bundles and a lighter one join."""
    bundles = [
        worth(6.0, bodies=(0, 1), log_ratio=0.3),
        worth(6.0, bodies=(2, 3), log_ratio=0.4),
        worth(4.0, bodies=(1, 2), log_ratio=0.7),
    ]
    first = foot(0, 0.0, ground=4)
    for body, height in enumerate((0.3, 1.0, 1.4), 1):
        found = shares(first, foot(body, height, UNCLEAR - 0.6, ground=4), *bundles, size=np.full(4, 50))
        assert found == pytest.approx([1, AGAIN, 1, 1, 1])


def test_the_heaviest_bundle_says_how_bodies_hang_together():
    bundles = worth(4.0), worth(6.0, log_ratio=0.7)
    assert shares(foot(0, 0.2), foot(1, 0.9), *bundles) == pytest.approx([1, AGAIN, 1, 1])
    assert shares(foot(0, 0.2), foot(1, 0.2), *bundles) == [1, 1, 1, 1]


def test_without_ties_nothing_changes():
    assert shares() == []
