"""Faces of regions: of a painted house, and of shapes in the photo that are made by hand."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from linecad.geometry import central_camera, project
from linecad.model.faces import FURTHEST, LEAST_AREA, LEAST_HIDDEN, faces_that_go_on, find_faces, without_spikes
from linecad.model.regions import partition
from linecad.model.regions.cuts import Borders
from linecad.model.regions.filling import Filled
from linecad.model.regions.labels import Labels
from linecad.model.regions.surfaces import Surface
from linecad.scene import Camera, Face, Lines, Plane

WIDTH, HEIGHT = 400, 300
CAMERA = Camera(WIDTH, HEIGHT, central_camera(300.0, WIDTH, HEIGHT), "file")
AHEAD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
AREA = WIDTH * HEIGHT
NO_LINES = np.zeros(0, np.int64)
FRAME = shapely.box(-0.5, -0.5, WIDTH - 0.5, HEIGHT - 0.5)
FRONT = Plane(7, 1, 10.0, (3,))
WALL = Surface("wall", 1, 10.0, NO_LINES, 7)
GROUND = Surface("ground", 2, -2.0, NO_LINES, None)


@pytest.fixture(scope="module")
def planes(house, house_regions):
    """The planes of the house with their faces."""
    return find_faces(house.planes, house.lines, house_regions, house.camera, house.rotation)


def lines(*edges):
    """Lines (axis, ends), with ids from 3 on."""
    axis, ends = np.array([each[0] for each in edges], np.int64), np.array([each[1] for each in edges], float)
    ends = ends.reshape(-1, 2, 3)
    return Lines(
        id=3 + np.arange(len(axis)), axis=axis, segment=np.zeros((len(axis), 2, 2)), ends=ends,
        is_boundary=np.zeros(len(axis), bool), component=np.zeros(len(axis), int),
        confidence=np.full(len(axis), "proven"),
    )  # fmt: skip


BACK_EDGE = lines((0, [[-3, 10, 1], [3, 10, 1]]))


def regions(surfaces, shapes, clutter=()):
    """Cells (label, polygon) of the photo as regions, and what hides them."""
    label, cells = [each[0] for each in shapes], [each[1] for each in shapes]
    nothing = np.zeros((0, len(surfaces) + 2))
    borders = Borders(np.zeros((0, 2), np.int64), NO_LINES)
    labels = Labels(list(surfaces), cells, NO_LINES, np.array(label), nothing, nothing.astype(np.int64), borders)
    return Filled(labels, shapely.union_all(list(clutter)))


def faces_of(surfaces, shapes, clutter=(), known=(FRONT,), edges=BACK_EDGE):
    return find_faces(tuple(known), edges, regions(surfaces, shapes, clutter), CAMERA, AHEAD)


def every(planes):
    return [(plane, face) for plane in planes for face in plane.faces]


def corners(*rings):
    return {tuple(corner) for ring in rings for corner in ring.tolist()}


def in_photo(ring, camera=CAMERA, rotation=AHEAD):
    return shapely.Polygon(project(ring, camera.matrix, rotation))


def test_walls_of_the_house_end_at_its_edges_exactly(planes):
    (side,), (front,) = planes[0].faces, planes[1].faces
    assert corners(side.outline) == {(2, 8, -2), (2, 16, -2), (2, 16, 1.6), (2, 8, 1.6)}
    assert corners(front.outline) == {(2, 8, -2), (5.5, 8, -2), (5.5, 8, 1.6), (2, 8, 1.6)}
    assert [face.kind for face in (side, front)] == ["wall", "wall"]
    assert side.holes == front.holes == ()


def test_the_ground_of_the_house_ends_at_the_feet_of_its_walls(planes):
    assert [plane.id for plane in planes] == list(range(len(planes)))
    ground = planes[-1]
    assert (ground.axis, ground.offset, ground.lines) == (2, -2.0, ())
    (face,) = ground.faces
    assert face.kind == "ground"
    assert {(2, 16, -2), (2, 8, -2), (5.5, 8, -2)} < corners(face.outline)


def test_faces_of_the_house_do_not_overlap_in_the_photo(house, planes):
    shapes = [in_photo(face.outline, house.camera, house.rotation) for _, face in every(planes)]
    assert len(shapes) == 3
    for one, other in combinations(shapes, 2):
        assert shapely.intersection(one, other).area < 1e-3


def test_a_region_at_the_border_is_cut_straight_along_it(house, planes):
    (ground,) = planes[-1].faces
    pixels = project(ground.outline, house.camera.matrix, house.rotation)
    on_border = np.isclose(pixels, [-0.5, 719.5], atol=1e-5) | np.isclose(pixels, [959.5, -0.5], atol=1e-5)
    assert on_border.any(axis=1).sum() == 4  # two corners of the photo, and where the far end meets its sides
    assert on_border.all(axis=1).sum() == 2


def test_a_ground_without_lines_is_a_plane_of_its_own():
    found = faces_of([WALL, GROUND], [(0, shapely.box(50, 50, 150, 200)), (1, shapely.box(50, 200, 150, 280))])
    assert [(plane.id, plane.axis, plane.offset, plane.lines) for plane in found] == [(7, 1, 10, (3,)), (8, 2, -2, ())]
    assert [face.kind for _, face in every(found)] == ["wall", "ground"]
    assert [face.id for _, face in every(found)] == [0, 1]


def test_a_ground_that_nothing_shows_is_no_plane():
    assert [plane.id for plane in faces_of([WALL, GROUND], [(0, shapely.box(50, 50, 150, 200))])] == [7]
    assert [(plane.id, plane.faces) for plane in faces_of([WALL], [(1, FRAME)])] == [(7, ())]  # sky alone


def test_kinds_are_those_of_surfaces():
    kinds = {"wall": 1, "level": 2, "ground": 2, "ceiling": 2}
    for kind, axis in kinds.items():
        ((_, face),) = every(faces_of([Surface(kind, axis, 10.0 if axis == 1 else 2.0, NO_LINES, None)],
                                      [(0, shapely.box(50, 50, 150, 100))]))  # fmt: skip
        assert face.kind == ("other" if kind == "level" else kind)


def test_sky_clutter_and_what_is_tiny_have_no_face():
    side = np.sqrt(LEAST_AREA * AREA)
    shapes = [(0, shapely.box(50, 50, 50 + 0.99 * side, 50 + side)), (1, shapely.box(200, 0, 300, 50)),
              (2, shapely.box(0, 200, 100, 290))]  # fmt: skip
    assert every(faces_of([WALL], shapes)) == []
    assert len(every(faces_of([WALL], [(0, shapely.box(50, 50, 50 + 1.01 * side, 50 + side))]))) == 1


def test_corners_where_two_walls_meet_are_the_same_numbers():
    side = Surface("wall", 0, 3.0, NO_LINES, None)
    at = 199.5 + 300 * 3 / 10  # px, where x = 3 meets y = 10
    shapes = [(0, shapely.box(100, 80, at, 220)), (1, shapely.Polygon([(at, 80), (at, 220), (350, 260), (350, 40)]))]
    (_, front), (_, right) = every(faces_of([WALL, side], shapes))
    shared = corners(front.outline) & corners(right.outline)
    assert len(shared) == 2
    assert {corner[:2] for corner in shared} == {(3, 10)}


def test_corners_on_lines_have_their_coordinates():
    edge, other = lines((0, [[-3, 10, 1.1], [3, 10, 1.1]]), (2, [[0.3, 10, 0], [0.3, 10, 1]])), 0.3
    x, y = project(np.array([other, 10, 1.1]), CAMERA.matrix, AHEAD)
    off = 1e-6  # px, as cells are rounded
    ((_, face),) = every(faces_of([WALL], [(0, shapely.box(100, y + off, x + off, 200))], edges=edge))
    assert (0.3, 10, 1.1) in corners(face.outline)
    ((_, face),) = every(faces_of([WALL], [(0, shapely.box(100, y + 1e-3, x, 200))], edges=edge))
    assert (0.3, 10, 1.1) not in corners(face.outline)


def test_a_hole_stays_a_hole():
    hole = shapely.box(120, 120, 140, 150)
    ((_, face),) = every(faces_of([WALL], [(0, shapely.box(50, 50, 200, 200) - hole)]))
    assert len(face.holes) == 1
    assert in_photo(face.holes[0]).symmetric_difference(hole).area < 1e-6
    assert (face.holes[0][:, 1] == 10).all()


def test_what_hides_a_part_of_a_face_is_told():
    tree, leaf = shapely.box(180, 100, 260, 150), shapely.box(60, 60, 61, 60 + 0.9 * LEAST_HIDDEN * AREA)
    ((_, face),) = every(faces_of([WALL], [(0, shapely.box(50, 50, 200, 200))], [tree, leaf]))
    (hidden,) = face.hidden
    assert in_photo(hidden).symmetric_difference(shapely.box(180, 100, 200, 150)).area < 1e-6
    assert (hidden[:, 1] == 10).all()
    assert face.holes == ()
    assert in_photo(face.outline).area == pytest.approx(150 * 150)


def test_a_face_goes_on_where_another_hides_it():
    low = Surface("wall", 1, 5.0, NO_LINES, None)
    shapes = [(0, shapely.box(50, 50, 200, 150)), (1, shapely.box(80, 150, 160, 180))]
    found = regions([WALL, low], shapes)
    found = replace(found, behind={0: shapely.box(80, 150, 160, 170) | shapely.box(300, 160, 320, 165)})
    faces = find_faces((FRONT,), BACK_EDGE, found, CAMERA, AHEAD)
    ((_, face), (_, before)) = every(faces)
    expected = shapely.box(50, 50, 200, 150) | shapely.box(80, 150, 160, 170)  # no face where nothing of it is seen
    assert in_photo(face.outline).symmetric_difference(expected).area < 1e-3
    (hidden,) = face.hidden
    assert in_photo(hidden).symmetric_difference(shapely.box(80, 150, 160, 170)).area < 1e-3
    assert in_photo(before.outline).symmetric_difference(shapes[1][1]).area < 1e-6
    assert before.hidden == ()


@pytest.mark.parametrize("off", [0.0, 1e-6, 2e-6, 1e-5])
def test_corners_that_differ_by_rounding_are_one_where_a_face_goes_on(off):
    found = regions([WALL], [(0, shapely.box(50, 50, 200, 150))])
    found = replace(found, behind={0: shapely.box(50 + off, 150, 200 - off, 170)})
    ((_, face),) = every(find_faces((FRONT,), BACK_EDGE, found, CAMERA, AHEAD))
    assert in_photo(face.outline).symmetric_difference(shapely.box(50, 50, 200, 170)).area < 0.01
    assert len(face.outline) == 4


def test_ground_that_goes_on_unseen_ends_where_all_ground_ends():
    low = Surface("wall", 1, 5.0, NO_LINES, None)
    shapes = [(0, shapely.box(50, 200, 200, 299)), (1, shapely.box(50, 149.8, 200, 200))]
    found = replace(regions([GROUND, low], shapes), behind={0: shapely.box(50, 149.6, 200, 200)})
    ((_, ground), *_) = [pair for pair in every(find_faces((), BACK_EDGE, found, CAMERA, AHEAD)) if pair[0].axis == 2]
    assert ground.outline[:, 1].max() == pytest.approx(FURTHEST * 10)


def test_what_is_too_small_to_be_told_as_hidden_does_not_go_on():
    small = np.sqrt(0.9 * LEAST_HIDDEN * AREA)
    found = regions([WALL], [(0, shapely.box(50, 50, 200, 150))])
    ((_, face),) = every(find_faces((FRONT,), BACK_EDGE, found, CAMERA, AHEAD))
    more = replace(found, behind={0: shapely.box(80, 150, 80 + small, 150 + small)})
    ((_, same),) = every(find_faces((FRONT,), BACK_EDGE, more, CAMERA, AHEAD))
    assert (same.outline == face.outline).all()
    assert same.hidden == ()


def test_faces_go_on_where_their_planes_are_the_same():
    seen, other = (Plane(0, 1, 5.0, ()),), (Plane(0, 1, 5.0, (), (Face(0, np.eye(3)),)),)
    assert faces_that_go_on(seen, other) is other
    assert faces_that_go_on(seen, (Plane(0, 0, 5.0, ()),)) is seen
    assert faces_that_go_on(seen, (*other, Plane(1, 2, 1.0, ()))) is seen


def test_two_faces_are_one_where_what_hides_their_middle_does_not_end_them():
    left, right = shapely.box(50, 50, 100, 150), shapely.box(140, 50, 200, 150)
    found = replace(regions([WALL], [(0, left), (0, right)]), behind={0: shapely.box(100, 60, 140, 150)})
    ((_, face),) = every(find_faces((FRONT,), BACK_EDGE, found, CAMERA, AHEAD))
    assert in_photo(face.outline).area == pytest.approx(left.area + right.area + 40 * 90)


def test_a_region_with_a_hair_is_a_face_without_it():
    # Thinner than what counts as rounding, as strips beside the foot of a wall can be.
    body = shapely.box(90, 170, 130, 200)
    hair = shapely.Polygon([(100, 170), (100, 150), (100 + 1e-6, 150), (100 + 1e-6, 170)])
    region = shapely.union(body, hair)
    assert region.is_valid
    ((_, face),) = every(faces_of([WALL], [(0, region)]))
    assert in_photo(face.outline).symmetric_difference(body).area < 1e-6
    assert shapely.hausdorff_distance(in_photo(face.outline), body) < 1e-6


@pytest.mark.parametrize(
    ("ring", "kept"),
    [
        ("abca", "abc"),
        ("abcbad", ""),
        ("abacde", "acde"),
        ("aab", ""),
        ("bcdab", "bcda"),
        ("abcdc", "abc"),
        ("aaa", ""),
    ],
)
def test_edges_there_and_back_are_left_out(ring, kept):
    places = {letter: np.array([number, number**2, 1.0]) for number, letter in enumerate("abcde")}
    found = without_spikes(np.array([places[letter] for letter in ring]))
    assert len(found) == len(kept)
    assert {tuple(place) for place in found} == {tuple(places[letter]) for letter in kept}


def test_an_edge_that_turns_back_beyond_its_start_is_no_spike_any_more():
    # Up along one side to 5.6, then down the same side to -0.5: a whole wall was lost for it.
    ring = np.array([[-9.5, 9.0, 4.1], [-9.5, 9.0, 5.6], [-9.5, 9.0, -0.5], [0.8, 9.0, -0.5], [0.1, 9.0, 4.1]])
    for start in range(len(ring)):
        for turned in (np.roll(ring, start, axis=0), np.roll(ring[::-1], start, axis=0)):
            found = without_spikes(turned)
            assert len(found) == 4
            assert {tuple(place) for place in found} == {tuple(place) for place in ring[[0, 2, 3, 4]]}


def test_a_surface_ends_before_its_horizon_with_one_straight_cut():
    # A wall on the right whose region reaches to its vanishing point in the middle of the photo, and beyond.
    side = Surface("wall", 0, 3.0, NO_LINES, None)
    edge = lines((1, [[3, 4, 0], [3, 12, 0]]))
    far = 199.5 + 300 * 3 / (FURTHEST * 12)
    for left in (199.5, 150, far - 1):
        shapes = [(0, shapely.box(left, 100, 350, 200))]
        ((_, face),) = every(faces_of([side], shapes, edges=edge))
        assert in_photo(face.outline).symmetric_difference(shapely.box(far, 100, 350, 200)).area < 1e-3
        assert face.outline[:, 1].max() == pytest.approx(FURTHEST * 12)
    ((_, face),) = every(faces_of([side], [(0, shapely.box(far + 1, 100, 350, 200))], edges=edge))
    assert in_photo(face.outline).area == pytest.approx((350 - far - 1) * 100)
    assert every(faces_of([side], [(0, shapely.box(50, 100, 150, 200))], edges=edge)) == []


def test_no_planes_and_no_regions_have_no_faces():
    assert faces_of([], [(0, FRAME)], known=()) == ()


@st.composite
def cut_photos(draw):
    """Cells of a photo along some lines, with a label of two walls and a ground, or sky, or clutter."""
    place = st.tuples(st.integers(0, WIDTH * 8).map(lambda v: v / 8), st.integers(0, HEIGHT * 8).map(lambda v: v / 8))
    ends = st.tuples(place, place).filter(lambda s: np.hypot(*np.subtract(*s)) > 10)
    rows = draw(st.lists(ends, min_size=1, max_size=5))
    border, _ = partition.extended(np.array(rows, float), WIDTH, HEIGHT, 1.0)
    cells = partition.cut(border)
    label = draw(st.lists(st.integers(0, 4), min_size=len(cells), max_size=len(cells)))
    return cells, label


@settings(max_examples=25)
@given(cut_photos())
def test_faces_of_any_cells_lie_in_their_planes_and_in_their_cells(photo):
    cells, label = photo
    surfaces = [WALL, Surface("wall", 0, 30.0, NO_LINES, None), GROUND]
    # A wall on the right and a ground below are seen in a half of the photo.
    halves = [FRAME, shapely.box(210, -0.5, 399.5, 299.5), shapely.box(-0.5, 160, 399.5, 299.5), FRAME, FRAME]
    shown = [(number, cell) for cell, number in zip(cells, label, strict=True) if cell.within(halves[number])]
    far = lines((0, [[-3, 1e6, 1], [3, 1e6, 1]]))
    found = every(faces_of(surfaces, shown, edges=far))
    shapes = []
    for plane, face in found:
        for ring in (face.outline, *face.holes):
            assert (ring[:, plane.axis] == plane.offset).all()
        holes = [in_photo(hole).exterior for hole in face.holes]
        shapes.append(shapely.Polygon(in_photo(face.outline).exterior, holes))
        assert shapes[-1].is_valid
        number = [(surface.axis, surface.offset) for surface in surfaces].index((plane.axis, plane.offset))
        own = shapely.union_all([cell for other, cell in shown if other == number])
        assert shapely.difference(shapes[-1], own).area < 1e-2
    for one, other in combinations(shapes, 2):
        assert shapely.intersection(one, other).area < 1e-2
    large = [(number, region) for number, region in regions(surfaces, shown).labels.regions
             if number < 3 and region.area >= LEAST_AREA * AREA]  # fmt: skip
    assert sum(shape.area for shape in shapes) == pytest.approx(sum(region.area for _, region in large), abs=0.1)
