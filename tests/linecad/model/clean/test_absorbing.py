"""Lines taken into those that they repeat or go on from."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from linecad.model.clean.absorbing import absorbed
from linecad.model.clean.ends import NEAR
from linecad.model.clean.strokes import SAME

X, Z = 0, 2
DEPTH = 10.0
FORWARD = np.array([0.0, 1.0, 0.0])


def level(low, high, z=0.0):
    return X, (low, DEPTH, z), (high, DEPTH, z)


def spans(lines):
    return [tuple(sorted(ends[:, X].round(9).tolist())) for ends in lines.ends]


def after(lines, rows, spare):
    found, left = absorbed(lines(rows), np.array(spare), FORWARD)
    assert found.id.tolist() == left.tolist()
    return found, left


def test_a_line_reaches_as_far_as_what_goes_on_from_it(lines):
    found, left = after(lines, [level(0, 1), level(1.02, 2, 0.3 * SAME * DEPTH)], [False, True])
    assert left.tolist() == [0]
    assert spans(found) == [(0, 2)]
    assert found.ends[0, :, Z].tolist() == [0, 0]
    assert len(found.pieces[0]) == 2


def test_what_stays_is_never_taken_in(lines):
    found, left = after(lines, [level(0, 1), level(0.5, 3)], [False, False])
    assert left.tolist() == [0, 1]
    assert spans(found) == [(0, 1), (0.5, 3)]


@pytest.mark.parametrize("gap", [0.5 * NEAR * DEPTH, 2 * NEAR * DEPTH])
def test_two_spare_lines_are_one_where_they_nearly_touch(lines, gap):
    found, _ = after(lines, [level(0, 1), level(1 + gap, 3)], [True, True])
    assert len(found) == (1 if gap < NEAR * DEPTH else 2)


def test_a_line_that_became_longer_takes_in_what_it_then_touches(lines):
    found, left = after(lines, [level(0, 1), level(2, 2.5), level(1, 2)], [False, True, True])
    assert left.tolist() == [0]
    assert spans(found) == [(0, 2.5)]


def test_what_bridges_two_lines_that_stay_goes_and_these_do_not_touch(lines):
    found, left = after(lines, [level(0, 1), level(2, 3), level(1, 2)], [False, False, True])
    assert left.tolist() == [0, 1]
    assert spans(found) == [(0, 1), (2, 3)]


def test_two_spare_lines_that_bridge_two_that_stay_go_and_these_do_not_touch(lines):
    rows = [level(0, 1), level(2, 3, 0.5 * SAME * DEPTH), level(1, 1.5), level(1.5, 2)]
    found, left = after(lines, rows, [False, False, True, True])
    assert left.tolist() == [0, 1]
    assert spans(found) == [(0, 1), (2, 3)]


def test_lines_of_other_axes_and_places_stay(lines):
    rows = [level(0, 1), level(0, 1, 3 * SAME * DEPTH), (Z, (0.5, DEPTH, -1), (0.5, DEPTH, 1))]
    assert after(lines, rows, [False, True, True])[1].tolist() == [0, 1, 2]


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])  # it only makes records
@given(reaches=st.lists(st.tuples(st.floats(-3, 3), st.floats(0.05, 2)), min_size=1, max_size=7))
def test_spare_lines_of_one_place_cover_what_they_covered_and_stay_apart(lines, reaches):
    rows = [level(low, low + length) for low, length in reaches]
    found, _ = after(lines, rows, [True] * len(rows))
    merged = sorted(spans(found))
    assert all(later[0] - former[1] > 0.99 * NEAR * DEPTH for former, later in pairwise(merged))
    for low, length in reaches:
        assert any(a - 1e-6 <= low and low + length <= b + 1e-6 for a, b in merged)
