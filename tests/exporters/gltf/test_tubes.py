"""Tubes about lines: closed, turned outwards, of the right size and in the right place."""

import numpy as np
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from exporters.gltf.tubes import build_tubes

RADIUS = 0.25
HEXAGON = 1.5 * np.sqrt(3) * RADIUS**2  # area of the section

coordinate = st.floats(-50, 50)
point = st.tuples(coordinate, coordinate, coordinate)


@given(point, point)
def test_a_tube_is_a_closed_prism_about_its_line(start, end):
    ends = np.array([[start, end]])
    length = np.linalg.norm(ends[0, 1] - ends[0, 0])
    if length < 0.1:
        return
    vertices, triangles, normals = build_tubes(ends, RADIUS)
    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    assert mesh.is_watertight
    np.testing.assert_allclose(mesh.volume, HEXAGON * length, rtol=1e-6)  # negative if it were turned inside out
    np.testing.assert_allclose(mesh.center_mass, ends[0].mean(axis=0), atol=1e-5)
    direction = (ends[0, 1] - ends[0, 0]) / length
    axis = ends[0, 0] + ((vertices - ends[0, 0]) @ direction)[:, None] * direction
    np.testing.assert_allclose(vertices - axis, RADIUS * normals, atol=1e-9)


def test_each_line_has_its_own_vertices_in_its_order():
    ends = np.array([[[0.0, 0, 0], [1, 0, 0]], [[5.0, 5, 5], [5, 7, 5]], [[0, 0, 9.0], [0, 0, 8]]])
    vertices, triangles, normals = build_tubes(ends, RADIUS)
    assert vertices.shape == normals.shape == (36, 3)
    assert triangles.shape == (60, 3)
    np.testing.assert_allclose(vertices.reshape(3, 2, 6, 3).mean(axis=2), ends, atol=1e-12)
    assert [set(part.ravel().tolist()) for part in triangles.reshape(3, 20, 3)] == [
        set(range(12 * line, 12 * line + 12)) for line in range(3)
    ]
