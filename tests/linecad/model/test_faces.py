"""Faces on the planes of made scenes: openings are holes, walls end at their top, nothing overlaps in the photo."""

from itertools import combinations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from linecad.depth.normals import Normals
from linecad.geometry import project, rotation_about
from linecad.model.faces import find_faces
from linecad.model.planes import find_planes
from linecad.scene import Camera, Lines

CAMERA = Camera(1200, 900, np.array([[800.0, 0, 599.5], [0, 800, 449.5], [0, 0, 1]]), "file")
AHEAD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
C, S = np.cos(0.4), np.sin(0.4)
TURNED = AHEAD @ [[C, -S, 0], [S, C, 0], [0, 0, 1]]
OVERLAP = 0.5  # px^2


def rectangle(normal, place, u, v):
    """The four edges of a rectangle in the plane of `normal` at `place`, from u[0] to u[1] and from v[0] to v[1]."""
    across = [axis for axis in range(3) if axis != normal]
    edges = []
    for along, other, spans, places in ((0, 1, u, v), (1, 0, v, u)):
        for at in places:
            ends = np.full((2, 3), float(place))
            ends[:, across[along]], ends[:, across[other]] = spans, at
            edges.append((across[along], ends))
    return edges


def edge(axis, start, length):
    ends = np.array([start, start], float)
    ends[1, axis] += length
    return (axis, ends)


def faces_of(edges, rotation=AHEAD, normals=None):
    """Planes with faces of the distinct edges, whose equal coordinates are shared."""
    edges = list({(axis, ends.tobytes()): (axis, ends) for axis, ends in edges}.values())
    axis = np.array([each[0] for each in edges])
    ends = np.array([each[1] for each in edges])
    count = len(axis)
    lines = Lines(
        id=np.arange(count), axis=axis, segment=project(ends, CAMERA.matrix, rotation), ends=ends,
        is_boundary=np.zeros(count, bool), component=np.zeros(count, int), confidence=np.full(count, "proven"),
    )  # fmt: skip
    offset = ends[:, 0].copy()
    own = np.arange(3) == axis[:, None]
    offset[own] = np.nan
    shared = np.full((count, 3), -1)
    for number in range(3):
        rest = ~own[:, number]
        shared[rest, number] = np.unique(offset[rest, number], return_inverse=True)[1] + 1000 * number
    return find_faces(find_planes(offset, shared, lines.id), lines, CAMERA, rotation, normals)


def at(planes, axis, offset):
    """The faces of the plane there."""
    return [face for plane in planes if (plane.axis, plane.offset) == (axis, offset) for face in plane.faces]


def corners(ring):
    return set(map(tuple, ring.tolist()))


def in_photo(face, rotation):
    rings = [project(ring, CAMERA.matrix, rotation) for ring in (face.outline, *face.holes)]
    return shapely.Polygon(rings[0], rings[1:])


WALL = rectangle(1, 10.0, (-4, 4), (-2, 3))
REVEALS = [edge(1, (x, 10, z), 0.5) for x in (-1, 1) for z in (0, 1.5)]
WINDOW = rectangle(1, 10.0, (-1, 1), (0, 1.5)) + rectangle(1, 10.5, (-1, 1), (0, 1.5)) + REVEALS
PANES = [edge(2, (0, 10.5, 0), 1.5), edge(0, (-1, 10.5, 0.75), 2)]


def test_a_wall_is_one_face_with_four_corners():
    (face,) = at(faces_of(WALL), 1, 10)
    assert corners(face.outline) == {(-4, 10, -2), (4, 10, -2), (4, 10, 3), (-4, 10, 3)}
    assert face.holes == ()


def test_lines_within_a_wall_cut_no_hole():
    planes = faces_of(WALL + rectangle(1, 10.0, (-1, 1), (0, 1.5)))
    (face,) = at(planes, 1, 10)
    assert len(face.outline) == 4
    assert face.holes == ()


def test_a_window_set_back_is_a_hole_with_a_face_behind():
    planes = faces_of(WALL + WINDOW + PANES)
    (wall,) = at(planes, 1, 10)
    assert corners(wall.outline) == {(-4, 10, -2), (4, 10, -2), (4, 10, 3), (-4, 10, 3)}
    (hole,) = wall.holes
    assert corners(hole) == {(-1, 10, 0), (1, 10, 0), (1, 10, 1.5), (-1, 10, 1.5)}
    (pane,) = at(planes, 1, 10.5)
    # What the wall leaves to be seen, and nothing that it hides.
    assert in_photo(pane, AHEAD).within(shapely.Polygon(project(hole, CAMERA.matrix, AHEAD)).buffer(1e-6))


def test_a_wall_ends_at_its_top_line():
    mast = edge(2, (1, 10, -2), 6.5)
    planes = faces_of([*WALL, mast])
    assert max(face.outline[:, 2].max() for _, face in every(planes)) == 3


def test_a_wall_that_the_photo_cuts_off_reaches_to_its_border():
    top = 5.55  # of the photo, at the depth of the wall
    sides = [edge(2, (x, 10, -2), top + 2) for x in (-4, 4)]
    bars = [edge(0, (-4, 10, z), 8) for z in (-2, 1)]
    (face,) = at(faces_of(sides + bars), 1, 10)
    assert corners(face.outline) == {(-4, 10, -2), (4, 10, -2), (4, 10, top), (-4, 10, top)}
    lower = [edge(2, (x, 10, -2), 5) for x in (-4, 4)]
    (face,) = at(faces_of(lower + bars), 1, 10)
    assert face.outline[:, 2].max() == 1


def test_two_walls_share_the_corners_of_their_edge():
    planes = faces_of(WALL + rectangle(0, 4.0, (6, 10), (-2, 3)))
    (front,), (side,) = at(planes, 1, 10), at(planes, 0, 4)
    assert corners(front.outline) & corners(side.outline) == {(4, 10, -2), (4, 10, 3)}


def test_a_wall_hides_the_wall_behind_only_where_it_stands():
    behind = rectangle(1, 20.0, (-8, 8), (-3, 5))
    planes = faces_of(behind + rectangle(1, 10.0, (0, 2), (-1, 2)))
    (front,), (back,) = at(planes, 1, 10), at(planes, 1, 20)
    assert corners(front.outline) == {(0, 10, -1), (2, 10, -1), (2, 10, 2), (0, 10, 2)}
    (hidden,) = back.holes
    assert project(hidden, CAMERA.matrix, AHEAD) == pytest.approx(
        project(hidden / 2, CAMERA.matrix, AHEAD)
    )  # the hole is the shadow of the front wall
    assert sorted(np.round(hidden / 2, 9).tolist()) == sorted(front.outline.tolist())


def test_no_face_hides_a_line_that_is_seen_behind_it():
    # Two courses of two walls meet in a corner and span a level that would float before the walls.
    walls = rectangle(1, 10.0, (-4, 4), (-2, 3)) + rectangle(0, 4.0, (6, 10), (-2, 3))
    courses = [edge(0, (-4, 10, -1), 8), edge(1, (4, 6, -1), 4)]
    bars = [edge(2, (x, 10, -2), 5) for x in (-3, -2, -1, 0, 1, 2, 3)]
    planes = faces_of(walls + courses + bars)
    assert [plane.axis for plane, _ in every(planes)].count(2) == 0


def facing(rotation, axis, elsewhere=None, shape=None):
    """Normals along a world axis, and along `elsewhere` where the photo shows `shape`."""
    vectors = np.empty((CAMERA.height, CAMERA.width, 3))
    vectors[:] = -rotation[:, axis]
    if shape is not None:
        row, column = np.indices(vectors.shape[:2])
        inside = shapely.contains_xy(shape, column.ravel(), row.ravel()).reshape(row.shape)
        vectors[inside] = elsewhere
    return Normals(vectors)


@pytest.mark.parametrize("rotation", [AHEAD, TURNED], ids=["ahead", "turned"])
def test_a_wall_is_kept_where_normals_say_its_axis(rotation):
    def outlines_of(normals):
        return [face.outline.tolist() for face in at(faces_of(WALL, rotation, normals), 1, 10)]

    without = outlines_of(None)
    assert len(without) == 1
    for degrees, others in ((0, without), (25, without), (35, without)):  # a normal near no axis says nothing
        turned = rotation_about(np.radians(degrees) * rotation[:, 2]) @ rotation[:, 1]
        bent = Normals(np.broadcast_to(turned, (CAMERA.height, CAMERA.width, 3)))
        assert outlines_of(bent) == others
    assert outlines_of(Normals(np.zeros((CAMERA.height, CAMERA.width, 3)))) == without
    assert outlines_of(facing(rotation, 0)) == outlines_of(facing(rotation, 2)) == []


def test_a_part_of_a_wall_that_faces_elsewhere_is_cut_out():
    window = rectangle(1, 10.0, (-1, 1), (0, 1.5))
    ring = np.array([[-1, 10, 0], [1, 10, 0], [1, 10, 1.5], [-1, 10, 1.5]], float)
    shape = shapely.Polygon(project(ring, CAMERA.matrix, AHEAD))
    (wall,) = at(faces_of(WALL + window, AHEAD, facing(AHEAD, 1, AHEAD[:, 2], shape)), 1, 10)
    (hole,) = wall.holes
    assert corners(hole) == set(map(tuple, ring.tolist()))
    assert corners(wall.outline) == {(-4, 10, -2), (4, 10, -2), (4, 10, 3), (-4, 10, 3)}


def test_a_wall_in_front_yields_to_the_one_that_faces_as_its_pixels():
    front, side = WALL, rectangle(0, 4.0, (6, 10), (-2, 3))
    both = faces_of(front + side)
    assert at(both, 1, 10)
    assert at(both, 0, 4)
    alone = faces_of(front + side, AHEAD, facing(AHEAD, 0))
    assert at(alone, 1, 10) == []
    assert at(alone, 0, 4)


def test_ids_of_faces_are_unique_and_planes_keep_what_they_have():
    planes = faces_of(WALL + WINDOW + PANES)
    ids = [face.id for _, face in every(planes)]
    assert sorted(ids) == list(range(len(ids)))
    assert [plane.id for plane in planes] == list(range(len(planes)))
    assert [len(plane.lines) for plane in planes] == sorted((len(plane.lines) for plane in planes), reverse=True)


def test_no_planes_no_faces():
    assert faces_of([edge(0, (-1, 10, 0), 2)]) == ()


def every(planes):
    return [(plane, face) for plane in planes for face in plane.faces]


places = st.integers(-5, 5)
boxes = st.lists(
    st.tuples(st.integers(-5, 4), st.integers(1, 4), st.integers(8, 14), st.integers(1, 3), st.integers(-3, 1),
              st.integers(1, 4)),
    min_size=1, max_size=4,
)  # fmt: skip


def box(left, wide, near, deep, low, high):
    """The edges of a box that stands before the camera, and a window set back in its front."""
    x, y, z = (left + 0.3, left + 0.3 + wide), (near, near + deep), (low - 0.2, low - 0.2 + high)
    u = (x[0] + 0.25 * wide, x[1] - 0.25 * wide)
    v = (z[0] + 0.25 * high, z[1] - 0.25 * high)
    edges = [each for place in y for each in rectangle(1, place, x, z)]
    edges += [edge(1, (a, near, b), deep) for a in x for b in z]
    edges += rectangle(1, near, u, v) + rectangle(1, near + 0.4, u, v)
    return edges + [edge(1, (a, near, b), 0.4) for a in u for b in v]


@settings(max_examples=15)
@given(boxes, st.sampled_from([AHEAD, TURNED]))
def test_faces_of_any_boxes_lie_in_their_planes_and_do_not_overlap(rows, rotation):
    edges = [each for row in rows for each in box(*row)]
    if min((ends @ rotation.T)[:, 2].min() for _, ends in edges) < 1:
        return
    planes = faces_of(edges, rotation)
    coordinates = [{float(c) for _, ends in edges for c in ends[:, axis]} for axis in range(3)]
    found = every(planes)
    for plane, face in found:
        for ring in (face.outline, *face.holes):
            assert (ring[:, plane.axis] == plane.offset).all()
            assert (ring.min(axis=0) >= [min(c) - 1e-9 for c in coordinates]).all()
            assert (ring.max(axis=0) <= [max(c) + 1e-9 for c in coordinates]).all()
        flat = [axis for axis in range(3) if axis != plane.axis]
        outline = shapely.Polygon(face.outline[:, flat])
        assert shapely.Polygon(face.outline[:, flat], [hole[:, flat] for hole in face.holes]).is_valid
        assert all(shapely.Polygon(hole[:, flat]).within(outline.buffer(1e-9)) for hole in face.holes)
    shapes = [in_photo(face, rotation) for _, face in found]
    for first, second in combinations(shapes, 2):
        assert shapely.intersection(first, second).area < OVERLAP
