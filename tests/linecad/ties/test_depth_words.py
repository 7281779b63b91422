"""What several walls of a body say together of where a map has it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.ties.depth_samples import WallVotes
from linecad.ties.depth_words import MOST_VOTES, WITHIN, words_of, worth_within

WIDTH = 0.02


def votes(*walls):
    """Of walls, each (its body, what it asks for, its weight)."""
    body, asked, weight = np.array(walls, float).reshape(-1, 3).T
    return WallVotes(body.astype(int), asked, weight)


def word(*asked, width=WIDTH):
    """Of one body, by walls of one size."""
    words = words_of(votes(*((0, each, 100.0) for each in asked)), width, 1)
    return words.log_scale[0], words.worth[0]


def test_one_wall_is_worth_what_the_interval_of_a_cauchy_draw_is():
    asked, worth = word(0.3)
    assert asked == pytest.approx(0.3, abs=1e-9)
    assert worth == pytest.approx(worth_within(2 / np.pi * np.arctan(WITHIN), WIDTH), abs=0.05)


def test_two_walls_that_agree_are_worth_more_than_one():
    assert word(0.3, 0.305)[1] > word(0.3)[1] + 1.0


def test_more_walls_than_two_add_little():
    """Networks err on neighbouring walls alike."""
    assert word(*[0.3] * 8)[1] == pytest.approx(word(0.3, 0.3)[1], abs=0.01)


def test_walls_that_disagree_are_worth_less_than_one():
    assert word(0.0, 0.3)[1] < word(0.0)[1] - 0.5


def test_the_body_stands_where_most_walls_have_it_not_in_their_middle():
    assert word(0.1, 0.11, 0.105, 0.5)[0] == pytest.approx(0.105, abs=WIDTH / 4)


def test_a_small_wall_says_little_against_a_large_one():
    words = words_of(votes((0, 0.3, 200.0), (0, 0.9, 8.0)), WIDTH, 1)
    assert words.log_scale[0] == pytest.approx(0.3, abs=1e-3)
    assert words.worth[0] > word(0.3)[1] - 0.2


def test_a_narrow_map_is_worth_more():
    assert word(0.3, width=0.01)[1] > word(0.3, width=0.04)[1]


def test_a_body_without_a_wall_has_no_word():
    words = words_of(votes((1, 0.3, 9.0)), WIDTH, 3)
    assert np.isnan(words.log_scale).tolist() == [True, False, True]
    assert (words.worth > 0).tolist() == [False, True, False]
    assert words_of(votes(), WIDTH, 2).worth.tolist() == [0.0, 0.0]


@given(
    st.lists(st.tuples(st.floats(-1, 1), st.floats(1, 300)), min_size=1, max_size=6),
    st.floats(-0.5, 0.5),
    st.sampled_from([0.01, 0.02, 0.05]),
)
def test_what_moves_all_walls_moves_what_they_say_and_no_more(walls, moved, width):
    before = words_of(votes(*((0, asked, weight) for asked, weight in walls)), width, 1)
    after = words_of(votes(*((0, asked + moved, weight) for asked, weight in walls)), width, 1)
    asked, weight = np.array(walls).T
    counts = weight / weight.max() * min(1.0, MOST_VOTES * weight.max() / weight.sum())

    def likelihood(words, moved=0.0):
        return -(counts * np.log1p(((words.log_scale[0] - moved - asked) / width) ** 2)).sum()

    assert min(asked) - width <= before.log_scale[0] <= max(asked) + width
    assert np.isfinite(before.worth[0])
    assert likelihood(after, moved) == pytest.approx(likelihood(before), abs=1e-6)
