"""Lines that are one become one, ends meet, and nothing is bent, lost or torn apart."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linecad.arrays import rows_of
from linecad.geometry import project
from linecad.graph.connectivity import group_numbers
from linecad.model.clean.clean import FARTHEST, clean_lines
from linecad.model.clean.sight import Sight
from linecad.scene import Intersections, Lines

X, Y, Z = range(3)
FOCAL = 2500.0
MATRIX = np.array([[FOCAL, 0, 1499.5], [0, FOCAL, 999.5], [0, 0, 1]])
AHEAD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
SIGHT = Sight(MATRIX, AHEAD, None)
NONE = Intersections([], [], [], [], [], [])
DEPTH = 10.0


def reaches(lines):
    """Where each line starts and ends along its axis."""
    return np.sort(lines.ends[np.arange(len(lines))[:, None], np.arange(2), lines.axis[:, None]], axis=1)


def cleaned(lines, rows, crossings=NONE, **more):
    return clean_lines(lines(rows, **more), crossings, SIGHT)


# --- one line ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("gap", "count"), [(-1.0, 1), (0.0, 1), (0.09, 1), (0.12, 2)])
def test_pieces_are_one_line_where_the_gap_is_small(lines, gap, count):
    found = cleaned(lines, [(X, (-2, DEPTH, 1), (0, DEPTH, 1)), (X, (gap, DEPTH, 1), (2, DEPTH, 1))])
    assert len(found.lines) == count
    assert found.lines.ends[:, :, X].min() == -2
    assert found.lines.ends[:, :, X].max() == 2


@pytest.mark.parametrize(("apart", "count"), [(0.009, 1), (0.012, 2)])
def test_near_duplicates_are_one_line_between_them(lines, apart, count):
    found = cleaned(lines, [(X, (-2, DEPTH, 1), (0, DEPTH, 1)), (X, (-1.5, DEPTH, 1 + apart), (0.5, DEPTH, 1 + apart))])
    assert len(found.lines) == count
    if count == 1:
        assert 1 < found.lines.ends[0, 0, Z] == found.lines.ends[0, 1, Z] < 1 + apart
        assert found.moved == pytest.approx(apart / 2 / DEPTH, rel=0.01)


@pytest.mark.parametrize(("is_shown", "said", "count"), [(True, False, 1), (False, False, 2), (True, True, 2)])
def test_pieces_are_one_line_where_the_photo_shows_the_edge_between(lines, crossings, photo, is_shown, said, count):
    rows = [(X, (-3, DEPTH, 1), (-1, DEPTH, 1)), (X, (0.5, DEPTH, 1), (3, DEPTH, 1))]
    grey = photo([(X, (-3, DEPTH, 1), (3, DEPTH, 1))] if is_shown else rows)
    two = crossings([(0, 1)], kind="collinear", real=False, reason="annotated") if said else NONE
    assert len(clean_lines(lines(rows), two, Sight(MATRIX, AHEAD, grey)).lines) == count


def test_lines_of_different_components_stay_two(lines):
    rows = [(X, (-2, DEPTH, 1), (0, DEPTH, 1)), (X, (-2, DEPTH, 1), (0, DEPTH, 1))]
    assert len(cleaned(lines, rows, component=[0, 1]).lines) == 2


def test_lines_that_a_person_said_are_two_stay_two(lines, crossings):
    rows = [(X, (-2, DEPTH, 1), (0, DEPTH, 1)), (X, (0.05, DEPTH, 1), (2, DEPTH, 1))]
    said = crossings([(0, 1)], kind="collinear", real=False, reason="annotated")
    assert len(cleaned(lines, rows, said).lines) == 2
    weighed = crossings([(0, 1)], kind="collinear", real=False, reason="not chosen")
    assert len(cleaned(lines, rows, weighed).lines) == 1


def test_a_step_that_a_line_shows_is_no_noise(lines):
    treads = [(X, (-2, DEPTH, 1), (0, DEPTH, 1)), (X, (-2, DEPTH, 1.009), (0, DEPTH, 1.009))]
    riser = (Z, (-1, DEPTH, 1), (-1, DEPTH, 1.009))
    found = cleaned(lines, [*treads, riser])
    assert len(found.lines) == 3
    assert found.moved == 0


def test_planes_move_as_a_whole(lines):
    """Two heads of one height but for noise: what ends at them or lies in their plane goes with them."""
    rows = [
        (X, (-2, DEPTH, 1), (0, DEPTH, 1)),
        (X, (-2, DEPTH, 1.004), (0, DEPTH, 1.004)),
        (Z, (-1, DEPTH, -1), (-1, DEPTH, 1.004)),
        (Y, (-1.5, 8, 1.004), (-1.5, DEPTH, 1.004)),
    ]
    found = cleaned(lines, rows)
    height = found.lines.ends[found.row[0], 0, Z]
    assert found.row[0] == found.row[1]
    assert 1 < height < 1.004
    assert found.lines.ends[found.row[2], :, Z].max() == height
    assert (found.lines.ends[found.row[3], :, Z] == height).all()


def test_a_line_has_the_segment_of_its_longest_piece_as_far_as_all_reach(lines):
    rows = [(X, (-2, DEPTH, 1), (-1, DEPTH, 1)), (X, (2, DEPTH, 1), (-0.95, DEPTH, 1))]
    before = lines(rows)
    found = clean_lines(before, NONE, SIGHT).lines
    np.testing.assert_allclose(found.segment, project(np.array([[[2, DEPTH, 1], [-2, DEPTH, 1]]]), MATRIX, AHEAD))
    assert found.ends[0].tolist() == [[2, DEPTH, 1], [-2, DEPTH, 1]]  # in the order of the segment
    np.testing.assert_array_equal(found.pieces[0], before.segment)


def test_a_line_that_is_alone_keeps_its_segment_and_has_no_pieces(lines):
    before = lines([(X, (-2, DEPTH, 1), (-1, DEPTH, 1))])
    found = clean_lines(before, NONE, SIGHT).lines
    np.testing.assert_array_equal(found.segment, before.segment)
    assert [len(each) for each in found.pieces] == [0]


# --- crossings -----------------------------------------------------------------------------------------------------


def test_crossings_go_with_their_lines(lines):
    rows = [
        (X, (-2, DEPTH, 1), (-1, DEPTH, 1)),
        (X, (-0.95, DEPTH, 1), (0, DEPTH, 1)),
        (Z, (-1.5, DEPTH, 0), (-1.5, DEPTH, 1)),
    ]
    crossings = Intersections(
        lines=[(0, 1), (0, 2), (1, 2)], kind=["collinear", "T", "X"], pixel=np.zeros((3, 2)), real=[True, False, True],
        in_tree=[True, False, True], weight=[1, 2, 3], reason=["chosen", "loose", "chosen"],
    )  # fmt: skip
    found = cleaned(lines, rows, crossings).intersections
    assert found.lines.tolist() == [[0, 1]]
    assert (found.kind[0], bool(found.real[0]), found.weight[0], found.reason[0]) == ("X", True, 3, "chosen")
    assert found.in_tree[0]


def test_the_tree_stays_a_tree(lines):
    """Two pieces of one line that the tree joined by a way round: their common line needs one edge less."""
    rows = [
        (X, (-2, DEPTH, 1), (-1, DEPTH, 1)),
        (X, (-0.95, DEPTH, 1), (0, DEPTH, 1)),
        (Z, (-1.5, DEPTH, 0), (-1.5, DEPTH, 1)),
        (Z, (-0.5, DEPTH, 0), (-0.5, DEPTH, 1)),
        (X, (-2, DEPTH, 0), (0, DEPTH, 0)),
    ]
    pairs = [(0, 2), (1, 3), (2, 4), (3, 4)]
    crossings = Intersections(pairs, ["T"] * 4, np.zeros((4, 2)), [True] * 4, [True] * 4, np.ones(4))
    found = cleaned(lines, rows, crossings)
    tree = found.intersections.lines[found.intersections.in_tree]
    assert len(found.intersections) == 4
    assert len(tree) == len(found.lines) - 1 == 3
    assert len(set(group_numbers(4, tree).tolist())) == 1


# --- words ---------------------------------------------------------------------------------------------------------


def test_the_note_says_what_moved_and_how_far(lines):
    rows = [
        (X, (-2, DEPTH, 1), (0, DEPTH, 1)),
        (X, (-2, DEPTH, 1.008), (0, DEPTH, 1.008)),
        (Z, (-1, DEPTH, -1), (-1, DEPTH, 0.95)),
    ]
    found = cleaned(lines, rows)
    assert found.note(np.ones(len(found.lines), bool), found.lines, found.lines) == (
        "1 lines that continue or repeat others were joined to them; planes that were nearly one became one, which "
        "moved lines by up to 0.04% of their depth; ends were moved along their lines to where "
        "these stop, 0 of 4 by more than 1%, at most by 0.5%"
    )


def test_what_a_line_takes_in_is_no_end_that_was_moved(lines):
    rows = [(X, (-2, DEPTH, 1), (0, DEPTH, 1)), (Z, (-1, DEPTH, -1), (-1, DEPTH, 0.95))]
    found = cleaned(lines, rows)
    longer = replace(found.lines, ends=found.lines.ends + np.array([[-1.0, 0, 0], [0, 0, 0]]))
    both = np.ones(2, bool)
    assert found.note(both, longer, longer) == found.note(both, found.lines, found.lines)
    said = found.note(both, found.lines, longer)
    assert said.endswith(f"1 of 4 by more than 1%, at most by {1 / DEPTH:.1%}")
    assert found.note(np.array([False, True]), rows_of(longer, np.array([1])), rows_of(longer, np.array([1]))) != said


def test_where_nothing_happens_nothing_is_said(lines):
    found = cleaned(lines, [(X, (-2, DEPTH, 1), (0, DEPTH, 1))])
    assert found.note(np.ones(len(found.lines), bool), found.lines, found.lines) == ""
    assert clean_lines(lines([]), NONE, SIGHT).note(np.zeros(0, bool), lines([]), lines([])) == ""


# --- properties ----------------------------------------------------------------------------------------------------

places = st.integers(-3, 3)
noises = st.floats(-1e-4, 1e-4)  # of the depth; far below what tells lines apart


@st.composite
def buildings(draw):
    """Lines of a grid of planes 1 apart, in pieces, some twice and a little off, some short of their corners.

    Coordinates of one place are one number or, as after bad luck in the solver, two.
    """
    twin = {place: place + DEPTH * draw(noises) for place in range(-3, 16)}
    rows = []
    for _ in range(draw(st.integers(2, 25))):
        axis = draw(st.integers(0, 2))
        start = np.array([draw(places), draw(st.integers(9, 14)), draw(places) + 0.5], float)
        for other in range(3):
            if other != axis and draw(st.booleans()):
                start[other] = twin[int(np.floor(start[other]))] + start[other] % 1
        end = start.copy()
        end[axis] += draw(st.integers(1, 3)) * draw(st.sampled_from([1, -1])) if axis != Y else draw(st.integers(1, 3))
        start[axis] += draw(st.floats(-0.04, 0.04))
        rows.append((axis, start, end))
    axis, ends = np.array([row[0] for row in rows]), np.array([row[1:] for row in rows])
    count = len(rows)
    lines = Lines(
        id=np.arange(count) * 3 + 1, axis=axis, segment=project(ends, MATRIX, AHEAD), ends=ends,
        is_boundary=np.arange(count) % 2 == 0, component=np.zeros(count, int), confidence=np.full(count, "supported"),
        probability=np.linspace(0, 1, count),
    )  # fmt: skip
    pairs = [(i, j) for i in range(count) for j in range(i) if meets(lines, i, j)]
    chosen = [pair for pair in pairs if draw(st.booleans())]
    tree = np.zeros(len(chosen), bool)
    return lines, Intersections(
        np.array([(lines.id[i], lines.id[j]) for i, j in chosen]).reshape(-1, 2), ["T"] * len(chosen),
        np.zeros((len(chosen), 2)), np.ones(len(chosen), bool), tree, np.ones(len(chosen)),
    )  # fmt: skip


def meets(lines, i, j):
    """Whether two lines of different axes have their third coordinate in common to the last digit."""
    if lines.axis[i] == lines.axis[j]:
        return False
    third = 3 - lines.axis[i] - lines.axis[j]
    return lines.ends[i, 0, third] == lines.ends[j, 0, third]


@settings(max_examples=settings.default.max_examples * 3 // 2)
@given(buildings())
def test_every_line_stays_parallel_to_its_axis_and_goes_forward(building):
    lines, crossings = building
    found = clean_lines(lines, crossings, SIGHT)
    across = np.arange(3) != found.lines.axis[:, None]
    np.testing.assert_array_equal(found.lines.ends[:, 0][across], found.lines.ends[:, 1][across])
    np.testing.assert_array_equal(found.lines.axis[found.row], lines.axis)
    assert (np.diff(reaches(found.lines)) > 0).all()
    # The numbers of the offsets are equal where the offsets are.
    for normal in range(3):
        own = across[:, normal]
        values, numbers = found.lines.ends[own, 0, normal], found.shared[own, normal]
        assert len(set(values.tolist())) == len(set(numbers.tolist())) == len({*zip(values, numbers, strict=True)})


@settings(max_examples=settings.default.max_examples * 3 // 2)
@given(buildings())
def test_real_crossings_still_meet_to_the_last_digit(building):
    lines, crossings = building
    found = clean_lines(lines, crossings, SIGHT)
    place = {number: row for row, number in enumerate(lines.id.tolist())}
    for one, other in crossings.lines.tolist():
        i, j = found.row[place[one]], found.row[place[other]]
        assert meets(found.lines, i, j)
        assert sorted([i, j]) in np.sort(found.intersections.lines, axis=1).tolist()
    assert found.intersections.real.all()


@settings(max_examples=settings.default.max_examples * 3 // 2)
@given(buildings())
def test_no_line_leaves_its_segment(building):
    """By more than twice FARTHEST in the image, across; nothing of a line goes but the last percent at its ends."""
    lines, crossings = building
    found = clean_lines(lines, crossings, SIGHT)
    assert found.moved <= np.sqrt(2) * FARTHEST
    image = project(found.lines.ends, MATRIX, AHEAD)[found.row]
    along = image[:, 1] - image[:, 0]
    length = np.linalg.norm(along, axis=1)
    for end in range(2):
        off = lines.segment[:, end] - image[:, 0]
        seen = length > 1  # a line that points at the camera has no direction in the image
        beside = np.abs(along[:, 0] * off[:, 1] - along[:, 1] * off[:, 0])[seen] / length[seen]
        assert (beside <= 2 * FARTHEST * FOCAL).all()
    before, after = reaches(lines), reaches(found.lines)[found.row]
    lost = np.maximum(after[:, 0] - before[:, 0], before[:, 1] - after[:, 1])
    assert (lost <= 0.5 * np.diff(before)[:, 0]).all()
    assert (lost <= 0.03 * lines.ends[..., Y].max(axis=1)).all()


@settings(max_examples=settings.default.max_examples * 3 // 2)
@given(buildings())
def test_what_is_clean_stays_as_it_is(building):
    once = clean_lines(*building, SIGHT)
    twice = clean_lines(once.lines, once.intersections, SIGHT)
    np.testing.assert_array_equal(twice.lines.ends, once.lines.ends)
    np.testing.assert_array_equal(twice.intersections.lines, once.intersections.lines)
    assert twice.moved == 0
