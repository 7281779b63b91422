from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exporters.drawings.dimensions import (
    APART,
    Measured,
    build_dimensions,
    build_levels,
    chains_across,
    chains_up,
    distinct_spans,
    label_of,
    spread,
    strokes_of,
)
from exporters.drawings.records import Unit, View

METRES = Unit(1.0, 2, " m")
spans = st.lists(
    st.tuples(st.floats(0.5, 15), st.floats(0.3, 3)).map(lambda each: (each[0], each[0] + each[1])), max_size=12
)


def view_of(measured, scale=20.0):
    (x0, x1), (y0, y1) = measured.width, measured.height
    return View((x0 - 1, y0, x1 + 1, y1 + 1), (40.0, 90.0), scale)


@given(spans)
def test_distinct_spans_do_not_overlap_and_leave_out_only_what_overlaps_them(given_spans):
    found = distinct_spans(given_spans)
    assert set(found) <= set(given_spans)
    assert all(a[1] <= b[0] for a, b in pairwise(found))
    for low, high in given_spans:
        assert any(low < other[1] and other[0] < high for other in found)


def test_of_spans_that_overlap_the_more_frequent_one_stays():
    assert distinct_spans([(0.9, 2.0), (1.0, 2.0), (1.0, 2.0), (5.0, 6.0)]) == ((1.0, 2.0), (5.0, 6.0))


@given(spans, spans)
def test_every_dimension_is_a_difference_of_coordinates_and_a_chain_adds_up_to_the_whole(across, up):
    measured = Measured((0.0, 20.0), (0.2, 19.0), distinct_spans(across), distinct_spans(up), 19.0)
    view = view_of(measured)
    made = build_dimensions(chains_across(measured), chains_up(measured), (20.0, 0.2), view)
    known = {
        False: {0.0, 20.0, *(x for span in measured.columns for x in (*span, sum(span) / 2))},
        True: {0.2, 19.0, *(y for span in measured.rows for y in span)},
    }
    for each in made:
        axis = int(each.is_upright)
        assert {each.start[axis], each.end[axis]} <= known[each.is_upright]
        assert each.length == each.end[axis] - each.start[axis] > 0
        assert each.start[1 - axis] == each.end[1 - axis]
    for upright, whole in ((False, 20.0), (True, 18.8)):
        chains = {each.at for each in made if each.is_upright == upright}
        for at in chains:
            own = [each for each in made if (each.is_upright, each.at) == (upright, at)]
            assert np.isclose(sum(each.length for each in own), whole)
            assert all(a.end == b.start for a, b in pairwise(own))
        assert all(abs(a - b) >= APART - 1e-9 for a in chains for b in chains if a != b)


def test_a_facade_with_a_row_of_windows_has_chains_of_openings_of_bays_and_overall():
    measured = Measured((0.0, 12.0), (0.0, 8.0), ((1.0, 2.0), (5.0, 6.0)), ((1.0, 2.5), (4.0, 5.5)), 8.0)
    assert chains_across(measured) == [[0.0, 1.0, 2.0, 5.0, 6.0, 12.0], [0.0, 1.5, 5.5, 12.0], [0.0, 12.0]]
    assert chains_up(measured) == [[0.0, 1.0, 2.5, 4.0, 5.5, 8.0], [0.0, 1.0, 4.0, 8.0], [0.0, 8.0]]
    plain = Measured((0.0, 12.0), (0.0, 8.0), (), (), 8.0)
    assert (chains_across(plain), chains_up(plain)) == ([[0.0, 12.0]], [[0.0, 8.0]])


def test_a_dimension_is_drawn_between_its_places_and_says_its_length():
    measured = Measured((0.0, 3.456), (0.0, 2.0), (), (), 2.0)
    view = view_of(measured)
    across, up = build_dimensions(chains_across(measured), chains_up(measured), (3.456, 0.0), view)
    for each, length in ((across, 3.456), (up, 2.0)):
        line = strokes_of(each, view)[0].points
        assert np.isclose(np.linalg.norm(line[1] - line[0]), length * view.scale)
        label = label_of(each, view, METRES)
        assert label.text == f"{length:.2f}"
        assert label.is_upright == each.is_upright
        assert np.isclose((label.y if each.is_upright else label.x), line.mean(axis=0)[int(each.is_upright)])


def test_texts_wider_than_their_dimension_stand_beyond_it_every_second_one_of_a_row():
    measured = Measured((0.0, 5.0), (0.0, 2.0), ((1.0, 1.2), (1.4, 1.6)), (), 2.0)
    view = view_of(measured)
    made = spread(build_dimensions(chains_across(measured)[:1], [], (5.0, 0.0), view), view, METRES)
    assert [round(each.length, 3) for each in made] == [1.0, 0.2, 0.2, 0.2, 3.4]
    assert [each.is_beyond for each in made] == [False, True, False, True, False]


def test_places_that_paper_cannot_tell_apart_make_no_dimension():
    measured = Measured((0.0, 5.0), (0.0, 2.0), ((0.01, 2.0), (3.0, 4.99)), (), 2.0)
    view = view_of(measured)
    made = build_dimensions(chains_across(measured)[:1], [], (5.0, 0.0), view)
    assert [(each.start[0], each.end[0]) for each in made] == [(0.0, 2.0), (2.0, 3.0), (3.0, 5.0)]


def test_levels_say_their_height_above_zero_at_their_height():
    measured = Measured((0.0, 5.0), (0.5, 9.0), (), ((2.0, 4.0),), 9.0)
    view = View((-1.0, 0.0, 6.0, 10.0), (40.0, 90.0), 20.0)
    strokes, labels = build_levels(measured, view, METRES)
    assert {label.text for label in labels} == {"±0.00", "+0.50", "+2.00", "+4.00", "+9.00"}
    for label in labels:
        height = float(label.text.replace("±", ""))
        assert np.isclose(label.y - 0.3, 90.0 + 20.0 * height)
    assert len(strokes) == 2 * len(labels)


def test_levels_that_would_cover_each_other_are_left_out():
    measured = Measured((0.0, 5.0), (0.0, 9.0), (), ((8.95, 8.99),), 9.0)
    _, labels = build_levels(measured, View((-1.0, 0.0, 6.0, 10.0), (40.0, 90.0), 20.0), METRES)
    assert [label.text for label in labels] == ["+9.00", "±0.00"]


@pytest.mark.parametrize(("length", "text"), [(1.2345, "1.23"), (-0.001, "0.00"), (-2.0, "-2.00"), (0.0, "0.00")])
def test_lengths_are_told_in_centimetres_and_zero_has_no_sign(length, text):
    assert METRES.text(length) == text


def test_without_a_scale_lengths_are_shares():
    assert Unit(12.0, 3, "").text(3.0) == "0.250"
