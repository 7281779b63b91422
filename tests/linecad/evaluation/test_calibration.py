"""Probabilities against what came true, on handfuls that can be counted."""

import numpy as np
import pytest

from linecad.evaluation.calibration import SURE, Tenth, find_tenths, score_confidence

STATED = np.array([0.95, 0.9, 0.6, 0.6, 0.2])
TRUE = np.array([True, True, True, False, False])


def test_points_are_counted_in_the_tenth_of_their_probability():
    tenths = find_tenths(STATED, TRUE)
    assert len(tenths) == 10
    assert tenths[9] == Tenth(2, pytest.approx(1.85), 2)
    assert tenths[6] == Tenth(2, pytest.approx(1.2), 1)
    assert tenths[2] == Tenth(1, pytest.approx(0.2), 0)
    assert sum(tenth.points for tenth in tenths) == 5


@pytest.mark.parametrize("bound", range(11))
def test_a_bound_belongs_to_the_upper_tenth_and_1_to_the_last(bound):
    tenths = find_tenths(np.array([bound / 10]), np.array([True]))
    assert [tenth.points for tenth in tenths].index(1) == min(bound, 9)


def test_the_recall_at_each_confidence_is_averaged():
    # 10 surveyed points: recall 0.3 up to 0.6, 0.2 up to 0.9, 0.1 up to 0.95.
    area = score_confidence(STATED, TRUE, 10).recall_area
    assert area == pytest.approx(0.3 * 0.6 + 0.2 * 0.3 + 0.1 * 0.05)
    assert score_confidence(np.ones(3), np.ones(3, bool), 4).recall_area == 0.75


def test_the_area_under_precision_over_recall_takes_equal_probabilities_together():
    # After 0.95: precision 1 at recall 0.1; after 0.9: 1 at 0.2; after both of 0.6: 3 / 4 at 0.3.
    assert score_confidence(STATED, TRUE, 10).precision_area == pytest.approx(0.1 + 0.1 + 0.1 * 3 / 4)
    backwards = score_confidence(1 - STATED, TRUE, 10).precision_area
    assert backwards == pytest.approx(0.1 * 1 / 3 + 0.1 * 2 / 4 + 0.1 * 3 / 5)


def test_the_order_alone_counts_for_the_area_under_precision():
    squeezed = score_confidence(STATED / 10, TRUE, 10)
    assert squeezed.precision_area == pytest.approx(score_confidence(STATED, TRUE, 10).precision_area)
    assert squeezed.recall_area < score_confidence(STATED, TRUE, 10).recall_area


def test_what_is_sure_is_scored_alone():
    score = score_confidence(np.array([SURE, 0.99, 0.89]), np.array([True, False, True]), 10)
    assert (score.sure_recall, score.sure_precision) == (0.1, 0.5)
    assert score_confidence(np.array([0.5]), np.array([True]), 10).sure_precision is None


def test_no_point_with_a_depth_has_no_area():
    score = score_confidence(np.zeros(0), np.zeros(0, bool), 10)
    assert (score.recall_area, score.precision_area, score.sure_recall, score.sure_precision) == (0, 0, 0, None)
