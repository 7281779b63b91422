"""The log-odds have a weight for each number, in the order of the numbers."""

import numpy as np
import pytest

from linecad.model.openings import evidence, neighbours
from linecad.model.openings.odds import AT_ONCE, FIRST_AT_ONCE, FIRST_LOG_ODDS, LOG_ODDS, first_odds, odds


def test_weights_are_in_the_order_of_what_they_weigh():
    assert tuple(FIRST_LOG_ODDS) == evidence.NAMES
    assert tuple(LOG_ODDS) == (*evidence.NAMES, *neighbours.NAMES)


def test_each_number_counts_by_its_weight():
    both = np.eye(len(LOG_ODDS))
    count = len(evidence.NAMES)
    assert first_odds(np.eye(count)) == pytest.approx(FIRST_AT_ONCE + np.array(list(FIRST_LOG_ODDS.values())))
    assert odds(both[:, :count], both[:, count:]) == pytest.approx(AT_ONCE + np.array(list(LOG_ODDS.values())))
