from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exporters.faces import signed_area
from exporters.model import build_model
from exporters.triangulation import triangulate
from linecad.errors import OutputError
from linecad.scene import Face, Plane

SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4)]


def flat_face(scene_of, rings, axis=1, offset=5.0):
    """The face as the exporters see it, from rings in the two other coordinates."""
    others = [other for other in range(3) if other != axis]
    solid = []
    for ring in rings:
        points = np.full((len(ring), 3), offset)
        points[:, others] = ring
        solid.append(points)
    plane = Plane(id=0, axis=axis, offset=offset, lines=(), faces=(Face(0, solid[0], tuple(solid[1:])),))
    return build_model(scene_of(plane)).faces[0]


@pytest.fixture(scope="module")
def scene_of(no_lines):
    return lambda plane: replace(no_lines, planes=(plane,))


@st.composite
def skylines(draw):
    """A row of houses with vertices in the middle of straight edges, and windows with one each."""
    heights = draw(st.lists(st.floats(1, 4), min_size=1, max_size=6))
    outline = [(0.0, 0.0)]
    for x in range(len(heights)):
        outline += [(x + share, 0.0) for share in sorted(draw(st.sets(st.sampled_from([0.25, 0.5, 0.9]))))]
    outline.append((float(len(heights)), 0.0))
    for x in range(len(heights) - 1, -1, -1):
        outline += [(x + 1.0, heights[x]), (x + 0.5, heights[x]), (float(x), heights[x])]
    outline = [point for number, point in enumerate(outline) if point != outline[number - 1]]
    windows = draw(st.lists(st.booleans(), min_size=len(heights), max_size=len(heights)))
    holes = [
        [(x + 0.2, 0.2), (x + 0.8, 0.2), (x + 0.8, 0.5), (x + 0.8, 0.8), (x + 0.2, 0.8)]
        for x, window in enumerate(windows)
        if window
    ]
    return [outline, *holes]


@st.composite
def stars(draw):
    """A star with any outline about a round hole, turned by any angle."""
    count = draw(st.integers(5, 24))
    radii = np.array(draw(st.lists(st.floats(1, 3), min_size=count, max_size=count)))
    angles = 2 * np.pi * np.arange(count) / count + draw(st.floats(0, 6))
    outline = radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    round_angles = np.linspace(0, 2 * np.pi, draw(st.integers(3, 12)), endpoint=False)
    hole = 0.5 * np.stack([np.cos(round_angles), np.sin(round_angles)], axis=1)
    return [outline, hole][: draw(st.integers(1, 2))]


faces = st.tuples(
    st.one_of(skylines(), stars()), st.integers(0, 2), st.sampled_from([-7.5, -0.1, 0.3, 40.0]), st.booleans()
)


@given(faces)
def test_the_triangles_are_the_polygon(scene_of, drawn):
    rings, axis, offset, reverse = drawn
    rings = [np.asarray(ring)[::-1] if reverse else np.asarray(ring) for ring in rings]
    face = flat_face(scene_of, rings, axis, offset)
    triangles = triangulate(face)

    count, holes = sum(map(len, rings)), len(rings) - 1
    assert len(triangles) == count + 2 * holes - 2
    assert sorted(set(triangles.ravel().tolist())) == list(range(count))

    corners = face.vertices[triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (across @ face.normal > 0).all()
    assert (across[:, axis] * offset < 0).all()  # towards the camera at the origin

    area = abs(signed_area(rings[0])) - sum(abs(signed_area(ring)) for ring in rings[1:])
    assert (across @ face.normal).sum() / 2 == pytest.approx(area, rel=1e-9)

    edges = Counter(frozenset((int(t[i]), int(t[i - 1]))) for t in triangles for i in range(3))
    assert sum(times == 1 for times in edges.values()) == count  # the rings
    assert set(edges.values()) <= {1, 2}  # all others lie between two triangles


def test_the_order_does_not_depend_on_where_a_ring_starts(scene_of):
    hole = [(1, 1), (2, 1), (2, 2), (1, 2)]
    face = flat_face(scene_of, [SQUARE, hole])
    turned = flat_face(scene_of, [SQUARE[2:] + SQUARE[:2], hole[1:] + hole[:1]])

    def corners(face):
        return {frozenset(map(tuple, face.vertices[triangle].tolist())) for triangle in triangulate(face)}

    assert corners(face) == corners(turned)


def test_a_hole_that_touches_the_outline_saves_two_triangles(scene_of):
    face = flat_face(scene_of, [SQUARE, [(0, 0), (1, 2), (2, 1)]])
    triangles = triangulate(face)
    assert len(triangles) == 7 + 2 - 2 - 2
    corners = face.vertices[triangles]
    doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) @ face.normal
    assert doubled.sum() / 2 == pytest.approx(16 - 1.5)


@pytest.mark.parametrize(
    ("rings", "words"),
    [
        ([[(0, 0), (4, 4), (4, 0), (0, 4)]], "self-intersection"),
        ([SQUARE, [(5, 5), (6, 5), (6, 6)]], "hole lies outside"),
        ([SQUARE, [(1, 1), (3, 1), (3, 3)], [(2, 1.5), (3.5, 1.5), (3.5, 2)]], "self-intersection"),
    ],
)
def test_rings_that_bound_no_area_are_named(scene_of, rings, words):
    face = flat_face(scene_of, rings)
    with pytest.raises(OutputError, match=f"face_0000 is not a polygon with holes.*{words}.*correct it"):
        triangulate(face)
