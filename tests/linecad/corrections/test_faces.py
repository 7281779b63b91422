"""What is known about faces outlives edits of the lines that it names."""

import numpy as np
import pytest

from linecad.corrections.edits import Delete, NoWindow, Region, SetFrame, Split, WallAnchor, WallByEdges, Window

CORNERS = ((300.0, 300.0), (350.0, 380.0))


@pytest.fixture(scope="module")
def edges(made):
    """Four lines of one face of the first box: two upright, two along x."""
    front = np.flatnonzero((made.ends[:, :, 1] == 9.0).all(axis=1))
    upright, level = (front[made.axis[front] == axis] for axis in (2, 0))
    return [int(row) for row in (*upright[:2], *level[:2])]


def wall(anchor, edges):
    return WallByEdges(tuple(anchor(row) for row in edges))


def test_they_are_kept_in_their_order(applied, anchor, edges):
    told = (Region(((0.0, 0.0), (9.0, 0.0), (9.0, 9.0)), "sky"), NoWindow((5.0, 5.0)), wall(anchor, edges))
    found = applied(*told)
    assert found.faces == told
    assert found.notes == ()


def test_a_line_that_was_split_is_named_by_its_first_piece(applied, anchor, edges):
    level = edges[2]
    middle = tuple(np.mean(anchor(level).ends, axis=0).tolist())
    window = Window(WallAnchor(1, anchor(level)), CORNERS)
    (now,) = applied(window, Split(anchor(level), middle)).faces
    assert now.wall.line.ends == (anchor(level).ends[0], pytest.approx(middle))


def test_a_window_outlives_the_line_that_named_its_wall(applied, anchor, edges):
    (now,) = applied(Window(WallAnchor(1, anchor(edges[2])), CORNERS), Delete(anchor(edges[2]))).faces
    assert now == Window(WallAnchor(1, None), CORNERS)


def test_a_wall_that_lost_an_edge_is_left_out_and_told(applied, anchor, edges):
    found = applied(wall(anchor, edges), Delete(anchor(edges[0])))
    assert found.faces == ()
    assert found.notes == ("a wall by four edges is left out: one of its edges was taken away",)


def test_four_lines_that_are_no_edges_of_a_wall_are_told(applied, anchor, edges):
    one, two, three, _ = edges
    for lines in ([one, two, three, three], [one, one, two, three]):
        (note,) = applied(wall(anchor, lines)).notes
        assert "two upright edges and two along one level axis" in note


def test_a_line_that_cannot_lie_in_the_wall_names_none(applied, anchor, edges):
    (note,) = applied(Window(WallAnchor(0, anchor(edges[2])), CORNERS)).notes
    assert "does not lie in it" in note


def test_a_window_of_an_earlier_frame_has_the_wall_of_its_level_line(applied, anchor, edges):
    frame = SetFrame(tuple(anchor(row) for row in edges))
    window, upright = (Window(WallAnchor(0, anchor(row)), CORNERS) for row in (edges[2], edges[0]))
    found = applied(window, upright, frame)
    assert [face.wall.normal for face in found.faces] == [1]
    assert "in a frame that was replaced" in found.notes[0]
