"""The edges of faces that the photo shows."""

import numpy as np

from linecad.geometry import central_camera, project
from linecad.model.on_faces.edges import edges_of
from linecad.model.on_faces.seen import SeenFaces
from linecad.scene import Camera, Face, Plane

WIDTH, HEIGHT = 1600, 1200
CAMERA = Camera(WIDTH, HEIGHT, central_camera(1200.0, WIDTH, HEIGHT), "file")
AHEAD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])


def box(number, offset, u0, u1, v0, v1):
    ring = [[u0, offset, v0], [u1, offset, v0], [u1, offset, v1], [u0, offset, v1]]
    return Plane(number, 1, offset, (), (Face(number, np.array(ring, float), kind="wall"),))


def found(*planes):
    seen = SeenFaces.of(planes, CAMERA, AHEAD)
    segments, face = edges_of(seen, AHEAD, ())
    return segments, [seen.plane[each].id for each in face.tolist()]


def length_of(ends):
    (pixels,) = project(np.array([ends], float), CAMERA.matrix, AHEAD)
    return float(np.linalg.norm(pixels[1] - pixels[0]))


def test_a_wall_before_the_sky_has_its_four_edges():
    segments, owner = found(box(0, 10.0, -3, 2, -1, 2))
    assert sorted(segments.axis.tolist()) == [0, 0, 2, 2]
    assert owner == [0] * 4
    np.testing.assert_allclose(sorted(segments.length)[-1], length_of([[-3, 10, 2], [2, 10, 2]]), rtol=1e-9)


def test_the_border_of_the_photo_is_no_edge():
    segments, _ = found(box(0, 10.0, -9, 2, -8, 2))
    assert sorted(segments.axis.tolist()) == [0, 2]


def test_where_a_nearer_wall_hides_a_farther_one_the_edge_is_that_of_the_nearer():
    near, far = box(0, 8.0, -3, 0, -2, 2), box(1, 10.0, 0, 4, -2.5, 2.5)
    segments, owner = found(near, far)
    middle = [
        owner[row] for row in range(len(segments)) if np.abs(segments.ends[row, :, 0] - CAMERA.matrix[0, 2]).max() < 1
    ]
    assert middle == [0]


def test_a_corner_belongs_to_both_walls():
    side = np.array([[2, 10, -1], [2, 20, -1], [2, 20, 2], [2, 10, 2]], float)
    corner = Plane(1, 0, 2.0, (), (Face(1, side, kind="wall"),))
    segments, owner = found(box(0, 10.0, -3, 2, -1, 2), corner)
    at = project(np.array([[2.0, 10, 0]]), CAMERA.matrix, AHEAD)[0, 0]
    shared = [owner[row] for row in range(len(segments)) if np.abs(segments.ends[row, :, 0] - at).max() < 1]
    assert sorted(shared) == [0, 1]


def test_slanted_edges_are_no_lines():
    ring = np.array([[-3, 10, -1], [2, 10, -1], [0, 10, 2]], float)
    segments, _ = found(Plane(0, 1, 10.0, (), (Face(0, ring, kind="wall"),)))
    assert segments.axis.tolist() == [0]
