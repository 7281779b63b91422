"""Each kind of bad line in a scene where it can be counted by hand. The walls are 10 away: 1 % is 0.1."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.directions import MAIN
from linecad.evaluation.draughting.lines import count_lines, distances


def level(start, end, z, y=10.0):
    return (start, y, z), (end, y, z)


def upright(x, low, high, y=10.0):
    return (x, y, low), (x, y, high)


def counted(drawing, lines, faces=(), components=None, details=()):
    scene, shapes = drawing(lines, faces, components)
    return count_lines(scene, shapes, np.isin(np.arange(len(lines)), details))


def test_a_clean_rectangle_has_nothing_to_strike_out(drawing):
    found = counted(drawing, [level(0, 2, 0), level(0, 2, 1), upright(0, 0, 1), upright(2, 0, 1)])
    assert (found.lines, found.ends) == (4, 8)
    assert (found.too_many, found.parallel_pairs, found.missing, found.in_air) == (0, 0, 0, 0)


def test_a_scene_without_lines_has_no_count(drawing):
    found = counted(drawing, [])
    assert (found.lines, found.too_many, found.missing, found.in_air) == (0, 0, 0, 0)


@pytest.mark.parametrize(
    ("pieces", "too_many"),
    [
        ([(0, 1, 0.0), (1, 2, 0.0), (2.05, 3, 0.0)], 2),  # one line in three pieces, one of the gaps 0.5 %
        ([(0, 1, 0.0), (1.2, 2, 0.0)], 0),  # 2 % apart: two lines
        ([(0, 1, 0.0), (1, 2, 0.008)], 1),  # 0.08 % beside each other: one
        ([(0, 1, 0.0), (1, 2, 0.02)], 0),  # 0.2 %: two
    ],
)
def test_pieces_of_one_line_are_too_many(drawing, pieces, too_many):
    assert counted(drawing, [level(*piece) for piece in pieces]).too_many == too_many


@pytest.mark.parametrize(
    ("second", "pairs"),
    [
        ((0, 2, 0.02), 1),  # 0.2 % beside it
        ((0, 2, 0.03), 0),  # 0.3 %
        ((1.6, 2.6, 0.02), 0),  # less than half of the shorter runs along
        ((1.4, 2.4, 0.02), 1),  # more than half
    ],
)
def test_parallel_lines_that_the_eye_cannot_part_are_pairs(drawing, second, pairs):
    assert counted(drawing, [level(0, 2, 0), level(*second)]).parallel_pairs == pairs


def test_a_detail_may_be_as_near_as_it_likes(drawing):
    lines = [level(0, 2, 0), level(0, 2, 0.02), level(0, 2, 0.04)]
    found = [counted(drawing, lines, details=details) for details in ((), (0,), (1,))]
    assert [each.details for each in found] == [0, 1, 1]
    assert [each.parallel_pairs for each in found] == [2, 1, 0]


def test_lines_of_two_components_have_nothing_to_do_with_each_other(drawing):
    lines = [level(0, 2, 0), level(0, 2, 0.02), level(2, 3, 0)]
    assert counted(drawing, lines, components=[0, 1, 2]).parallel_pairs == 0
    assert counted(drawing, lines, components=[0, 1, 2]).too_many == 0
    assert counted(drawing, [level(0, 2, 0), upright(0, 0.05, 1)], components=[0, 1]).missing == 0


@pytest.mark.parametrize(
    ("low", "missing", "in_air"),
    [
        (0.0, 0, 3),  # on the line; its top and both ends of the other are free
        (0.05, 1, 3),  # 0.5 % above it
        (0.15, 0, 4),  # 1.5 % above it
        (-0.05, 1, 3),  # it crosses the line and sticks out by 0.5 %
    ],
)
def test_an_end_misses_a_line_by_less_than_a_hundredth(drawing, low, missing, in_air):
    found = counted(drawing, [level(-1, 1, 0), upright(0, low, 1)])
    assert (found.missing, found.in_air) == (missing, in_air)


def test_an_end_on_the_outline_of_a_face_is_not_in_the_air(drawing, outline):
    lines = [level(0, 1, 0)]
    assert counted(drawing, lines).in_air == 2
    assert counted(drawing, lines, [(1, 10.0, outline((-1, -1), (1, 1)))]).in_air == 1
    # Inside of a face is no outline, that of a hole is one.
    assert counted(drawing, lines, [(1, 10.0, outline((-1, -1), (3, 1)))]).in_air == 2
    hole = outline((-0.5, -0.2), (0, 0.2))
    assert counted(drawing, lines, [(1, 10.0, outline((-1, -1), (3, 1)), hole)]).in_air == 1


def test_an_end_is_not_in_the_air_where_something_nearer_hides_what_follows(drawing, outline):
    lines = [level(0, 1, 0)]
    for depth, high, in_air in ((5.0, 0.5, 1), (9.95, 1.0, 1), (20.0, 2.0, 2), (5.0, -0.1, 2)):
        half = 0.5 * depth / 5  # the right side of the face is seen where the line ends
        face = (1, depth, outline((-half, -half), (half, high)))
        assert counted(drawing, lines, [face]).in_air == in_air


def test_an_end_where_the_photo_ends_is_not_in_the_air(drawing):
    half = 479.5 / 600 * 10  # of the photo's width, at the wall
    assert counted(drawing, [level(-half, half - 0.5, 0)]).in_air == 1


def test_a_point_is_as_far_from_a_segment_as_from_its_nearest_point():
    segments = np.array([[[0, 0, 0], [2, 0, 0]], [[0, 5, 0], [0, 9, 0]]], float)
    points = np.array([[1, 1, 0], [4, 0, 0], [3, 6, 4]], float)
    assert distances(points, segments) == pytest.approx([1, 2, 5])


def street(rng, count):
    """Lines at random on two walls, many of them near each other and near another's end."""
    lines = []
    for number in range(count):
        x, z = rng.integers(-2, 2, 2) + rng.choice([0.0, 0.02, 0.05], 2)
        y = float(rng.choice([10.0, 11.0]))
        ends = level(x, x + 1, z, y), upright(x, z, z + 1, y), ((x, y, z), (x, y + 1, z))
        lines.append(ends[number % 3])
    return lines


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("angle", [0.1, 0.7])
def test_a_scene_turned_into_another_frame_has_the_same_counts(drawing, turned, seed, angle):
    scene, _ = drawing(street(np.random.default_rng(seed), 60))
    none = np.zeros(len(scene.lines), bool)
    found = count_lines(scene, [], none)
    assert found == count_lines(turned(scene, angle), [], none)
    assert min(found.parallel_pairs, found.too_many, found.missing, found.in_air) > 0


@pytest.mark.parametrize(("gap", "missing"), [(0.0, 0), (0.05, 1), (0.15, 0)])
def test_an_end_misses_a_line_of_another_frame(drawing, gap, missing):
    angle = 0.3
    along = np.array([np.cos(angle), np.sin(angle), 0.0])
    scene, _ = drawing([level(-1, 1, 0), level(0, 1, 0)])
    start = np.array([0.2, 10.0, 0.0])
    # The second runs along x of the second frame, and begins `gap` off the first.
    ends = np.stack([scene.lines.ends[0], [start + gap / np.sin(angle) * along, start + 2 * along]])
    scene = replace(scene, lines=replace(scene.lines, axis=np.array([0, MAIN]), ends=ends), turns=(angle,))
    found = count_lines(scene, [], np.zeros(2, bool))
    assert (found.missing, found.parallel_pairs, found.too_many) == (missing, 0, 0)
