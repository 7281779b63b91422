"""The photo cut into convex cells along lines."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from linecad.model.regions.partition import (
    BESIDE,
    BESIDE_MEET,
    MOST_LINES,
    cells_between,
    cut,
    draw,
    extended,
    polygons_of,
    positive_part,
    without_holes,
)

WIDTH, HEIGHT, STEP = 120, 90, 2.0
FRAME = shapely.box(-0.5, -0.5, WIDTH - 0.5, HEIGHT - 0.5)


def drawn(*segments, meets=0):
    """The lines but the photo's borders, and the rows of the segments that made them."""
    lines, rows = extended(np.array(segments, float).reshape(-1, 2, 2), WIDTH, HEIGHT, STEP, meets)
    assert rows[:4].tolist() == [-1] * 4
    return lines[4:], rows[4:].tolist()


def same_line(found, expected):
    return sorted(np.round(found, 9).tolist()) == sorted(np.array(expected, float).tolist())


def test_a_photo_without_segments_is_one_cell():
    (cell,) = cut(extended(np.zeros((0, 2, 2)), WIDTH, HEIGHT, STEP)[0])
    assert cell.equals(FRAME)


def test_the_strongest_segment_goes_from_border_to_border_and_the_next_ends_on_it():
    (first, second), rows = drawn([[40, 20], [40, 60]], [[60, 30], [80, 30]])
    assert rows == [0, 1]
    assert same_line(first, [[40, -0.5], [40, HEIGHT - 0.5]])
    assert same_line(second, [[40, 30], [WIDTH - 0.5, 30]])
    (_, second), _ = drawn([[40, 20], [40, 60]], [[10, 30], [20, 30]])
    assert same_line(second, [[-0.5, 30], [40, 30]])
    (first, second), _ = drawn([[60, 30], [80, 30]], [[40, 20], [40, 60]])
    assert same_line(first, [[-0.5, 30], [WIDTH - 0.5, 30]])
    # It crosses the stronger one by itself, and so goes on to both borders.
    assert same_line(second, [[40, -0.5], [40, HEIGHT - 0.5]])


def test_a_segment_that_crosses_a_stronger_one_by_little_ends_there():
    (_, second), _ = drawn([[40, 20], [40, 60]], [[40 - 1.9 * STEP, 30], [80, 30]])
    assert same_line(second, [[40, 30], [WIDTH - 0.5, 30]])
    (_, second), _ = drawn([[40, 20], [40, 60]], [[40 - 2.1 * STEP, 30], [80, 30]])
    assert same_line(second, [[-0.5, 30], [WIDTH - 0.5, 30]])


def test_a_weaker_segment_close_beside_a_stronger_one_cuts_nothing():
    stronger = [[40, 10], [40, 80]]
    for off, rows in ((0.9 * BESIDE * STEP, [0]), (1.1 * BESIDE * STEP, [0, 1])):
        assert drawn(stronger, [[40 + off, 20], [40 + off, 60]])[1] == rows
    # Beside it in its direction alone, or across it, it cuts.
    assert drawn(stronger, [[42, 75], [42, 89]])[1] == [0, 1]
    assert drawn(stronger, [[42, 20], [70, 48]])[1] == [0, 1]


def test_segments_keep_more_distance_from_meets_and_meets_are_all_drawn():
    meet = [[40, 10], [40, 80]]
    off = (BESIDE + BESIDE_MEET) / 2 * STEP
    beside = [[40 + off, 20], [40 + off, 60]]
    assert drawn(meet, beside)[1] == [0, 1]
    assert drawn(meet, beside, meets=1)[1] == [0]
    assert drawn(meet, [[41, 20], [41, 60]], meets=2)[1] == [0, 1]


def test_a_segment_outside_the_photo_is_left_out():
    lines, rows = drawn([[WIDTH + 30, 10], [WIDTH + 30, 60]], [[20, 10], [20, 60]])
    assert rows == [1]
    assert len(lines) == 1


def test_there_are_at_most_so_many_lines():
    count = MOST_LINES + 10
    far = 30.0 * np.arange(count)
    segments = np.stack([np.column_stack([far, np.zeros(count)]), np.column_stack([far, np.full(count, 50)])], axis=1)
    _, rows = extended(segments, 30 * count, 100, 1.0)
    assert rows[4:].tolist() == list(range(MOST_LINES))


def test_cells_of_any_shapes_have_corners_in_common():
    cells = cells_between([shapely.boundary(FRAME), shapely.LineString([(10, -5), (50, 100)])])
    one, other = ({*map(tuple, shapely.get_coordinates(cell).tolist())} for cell in cells)
    assert len(one & other) == 2
    assert sum(cell.area for cell in cells) == pytest.approx(FRAME.area)


def part_of_px(size):
    return st.integers(-20 * 64, (size + 20) * 64).map(lambda number: number / 64)


places = st.tuples(part_of_px(WIDTH), part_of_px(HEIGHT))
segments = st.lists(st.tuples(places, places).filter(lambda s: np.hypot(*np.subtract(*s)) > 3), max_size=10)


@settings(max_examples=30)
@given(segments)
def test_cells_of_any_segments_are_convex_cover_the_photo_and_have_their_sides_on_the_lines(rows):
    lines, own = extended(np.array(rows, float).reshape(-1, 2, 2), WIDTH, HEIGHT, STEP)
    cells = cut(lines)
    assert sum(cell.area for cell in cells) == pytest.approx(FRAME.area, abs=1e-3)
    assert shapely.union_all(cells).symmetric_difference(FRAME).area < 1e-3
    for cell in cells:
        assert not cell.interiors
        assert cell.convex_hull.area - cell.area < 1e-3
        corners = shapely.get_coordinates(cell.exterior)
        for side in np.stack([corners[:-1], corners[1:]], axis=1):
            points = shapely.points(side)
            assert any((shapely.distance(points, line) < 1e-4).all() for line in shapely.linestrings(lines))
    for line, row in zip(lines[4:], own[4:].tolist(), strict=True):
        along = np.subtract(*rows[row])
        off = np.abs((line - rows[row][0]) @ [-along[1], along[0]]) / np.hypot(*along)
        assert off.max() < 1e-6


@settings(max_examples=20)
@given(segments)
def test_samples_inside_a_cell_are_its_own(rows):
    cells = cut(extended(np.array(rows, float).reshape(-1, 2, 2), WIDTH, HEIGHT, STEP)[0])
    shape = (int(HEIGHT / STEP), int(WIDTH / STEP))
    cell = draw(cells, shape, STEP)
    row, column = np.divmod(np.arange(len(cell)), shape[1])
    middle = shapely.points((column + 0.5) * STEP - 0.5, (row + 0.5) * STEP - 0.5)
    off = shapely.distance(middle, np.array(cells, object)[cell])
    assert off.max() <= 1.5 * STEP
    assert (cell >= 0).all()


@given(st.lists(st.floats(-5, 5), min_size=3, max_size=3))
def test_the_positive_part_of_the_photo_is_what_lies_on_one_side_of_an_image_line(line):
    corners = shapely.get_coordinates(FRAME.exterior)[:-1]
    value = corners / WIDTH @ line[:2] + line[2]
    part = positive_part(corners, value)
    points = np.random.default_rng(1).uniform(0, [WIDTH, HEIGHT], (200, 2)) - 0.5
    at = points / WIDTH @ line[:2] + line[2]
    clear = np.abs(at) > 1e-9
    assert (shapely.contains_xy(part, points)[clear] == (at[clear] > 0)).all()


@given(st.lists(st.tuples(st.integers(1, 17), st.integers(1, 17)), max_size=4))
def test_a_polygon_with_holes_is_polygons_without(places):
    holes = shapely.union_all([shapely.box(x, y, x + 2.5, y + 1.5) for x, y in places])
    (whole,) = polygons_of(shapely.difference(shapely.box(0, 0, 21, 21), holes))
    pieces = without_holes(whole)
    assert not any(piece.interiors for piece in pieces)
    assert sum(piece.area for piece in pieces) == pytest.approx(whole.area)
    assert shapely.union_all(pieces).symmetric_difference(whole).area < 1e-6
