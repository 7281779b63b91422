"""Parallel projection and hidden lines, against points that are asked one by one."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from exporters.drawings.projection import Projection, shown_faces, visible_parts
from exporters.faces import FlatFace

UP = np.array([0.0, 0.0, 1.0])
BOX = (-6.0, -6.0, 6.0, 6.0)
numbers = st.floats(-5, 5)
angles = st.floats(-np.pi, np.pi)


def facing(turn, origin=(0.0, 0.0, 0.0)):
    normal = np.array([np.sin(turn), -np.cos(turn), 0.0])
    return Projection(np.cross(UP, normal), UP, normal, np.array(origin))


def rectangle(x, y, width, height, depth, slope=0.0):
    """A face of the view from before y = 0, at `depth` before it, leaning by `slope` along x."""
    corners = [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]
    ring = np.array([(a, -(depth + slope * (a - x)), b) for a, b in corners])
    normal = np.array([-slope, -1.0, 0.0]) / np.hypot(slope, 1.0)
    return FlatFace(
        id=0, kind="wall", thing="wall", plane=0, axis=1, tilt=0.0, direction=-normal, offset=float(-normal @ ring[0]),
        normal=normal, in_plane=(0, 2), rings=(ring,), hidden=(), component=0, opening=None,
    )  # fmt: skip


@given(angles, st.tuples(numbers, numbers, numbers), st.tuples(numbers, numbers, numbers))
def test_the_projection_keeps_lengths_and_leads_back(turn, origin, point):
    projection = facing(turn, origin)
    flat = projection(np.array(point))
    assert np.allclose(projection.to_space(flat), point, atol=1e-12)
    assert np.isclose(np.linalg.norm(flat), np.linalg.norm(np.subtract(point, origin)), atol=1e-12)
    assert np.isclose(flat[1], point[2] - origin[2], atol=1e-12)
    assert np.isclose(flat[2], projection.toward @ np.subtract(point, origin), atol=1e-12)


faces = st.builds(
    rectangle, numbers, numbers, st.floats(0.5, 4), st.floats(0.5, 4), st.floats(-3, 3), st.sampled_from([0.0, 0.7])
)
lines = st.tuples(numbers, numbers, st.floats(-4, 4), numbers, numbers, st.floats(-4, 4))


@given(st.lists(faces, max_size=5), lines)
def test_what_of_a_line_is_drawn_is_what_no_face_stands_before(given_faces, numbers_of_line):
    projection = facing(0.0)
    line = np.array(numbers_of_line).reshape(2, 3)
    shown = shown_faces(given_faces, projection, section=3.5)
    parts = visible_parts(line[None], shown, BOX, 3.5, 0.01)
    along = line[1] - line[0]
    if np.hypot(*along[:2]) < 1e-3:
        return
    length = float(along[:2] @ along[:2])
    drawn = [tuple(((part[:, :2] - line[0, :2]) @ along[:2] / length).tolist()) for _, part in parts]
    for at in np.linspace(0.003, 0.997, 61):
        point = line[0] + at * along
        near = []  # signed by how much the answer is clear
        for each in shown:
            (x0, y0), (x1, y1) = each.rings[0][:, :2].min(axis=0), each.rings[0][:, :2].max(axis=0)
            inside = min(point[0] - x0, x1 - point[0], point[1] - y0, y1 - point[1])
            near.append(min(inside, float(each.heights(point[:2])) - point[2] - 0.01))
        within = min(point[0] + 6, 6 - point[0], point[1] + 6, 6 - point[1], 3.5 - point[2])
        clear = min([within, *(-value for value in near)])
        if abs(clear) > 1e-6:  # else it is on a border
            assert any(a <= at <= b for a, b in drawn) == (clear > 0)


def test_a_line_that_hardly_rises_is_drawn_whole():
    """The change of its height is so small that a number divided by it is none."""
    for rise in (2e-313, -2e-313):
        ((_, part),) = visible_parts(np.array([[[0.0, 0.0, 0.0], [0.0, 1.0, rise]]]), [], BOX, 3.5, 0.01)
        assert np.array_equal(part[:, :2], [[0, 0], [0, 1]])


def test_a_face_whose_corner_is_hardly_off_the_axis_hides_no_more_than_another():
    for corner in (2.2250738585e-313, 1e-309, 0.0):
        shown = shown_faces([rectangle(-1.0, corner, 2.0, 1.0, 2.5625, slope=0.7)], facing(0.0), 3.5)
        ((_, part),) = visible_parts(np.array([[[0.0, 1.0, 0.0], [0.0, -0.125, 0.0]]]), shown, BOX, 3.5, 0.01)
        assert np.allclose(part[:, :2], [[0, 0], [0, -0.125]], atol=1e-12)


def test_a_face_that_is_seen_from_its_edge_hides_nothing():
    face = rectangle(0, 0, 1, 1, 1)
    assert shown_faces([face], facing(np.pi / 2), 10.0) == []
    assert len(shown_faces([face], facing(0.0), 10.0)) == 1


def test_a_face_beyond_the_section_is_cut_there():
    leaning = rectangle(0.0, 0.0, 4.0, 1.0, 0.0, slope=1.0)
    (cut,) = shown_faces([leaning], facing(0.0), section=1.5)
    assert np.isclose(cut.rings[0][:, 0].max(), 1.5)
    assert np.isclose(cut.rings[0][:, 2].max(), 1.5)
    assert shown_faces([rectangle(0, 0, 1, 1, 2.0)], facing(0.0), section=1.5) == []


def test_a_line_on_a_face_or_little_behind_it_is_drawn_whole():
    shown = shown_faces([rectangle(-2, -2, 4, 4, 0.0)], facing(0.0), 10.0)
    for behind in (0.0, 0.009):
        line = np.array([[[-1.0, 0.0, -behind], [1.0, 0.0, -behind]]])
        ((row, part),) = visible_parts(line, shown, BOX, 10.0, 0.01)
        assert row == 0
        assert np.array_equal(part, line[0])
    assert visible_parts(np.array([[[-1.0, 0.0, -0.02], [1.0, 0.0, -0.02]]]), shown, BOX, 10.0, 0.01) == []
