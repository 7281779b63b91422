"""Polygons with holes as trimmed planes."""

import importlib
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exporters.faces import FlatFace
from exporters.model import build_model
from linecad.errors import OutputError

pytest.importorskip("rhino3dm", reason="the extra `rhino` is not installed")
faces = importlib.import_module("exporters.rhino.faces")

SQUARE = np.array([[0.0, 0], [10, 0], [10, 8], [0, 8]])


@pytest.fixture(scope="module")
def face(scene):
    return build_model(scene).faces[0]


def laid(face, rings, normal, far=0.0):
    """A face with flat rings (V, 2) in a plane of that normal."""
    normal = np.asarray(normal) / np.linalg.norm(normal)
    first = np.cross([0.0, 0.0, 1.0] if abs(normal[2]) < 0.9 else [1.0, 0.0, 0.0], normal)
    first /= np.linalg.norm(first)
    axes = np.stack([first, np.cross(normal, first)])
    steepest = int(np.abs(normal).argmax())
    u, v = (steepest + 1) % 3, (steepest + 2) % 3
    in_plane = (u, v) if normal[steepest] > 0 else (v, u)
    return replace(face, rings=tuple(ring @ axes + far for ring in rings), normal=normal, in_plane=in_plane)


def corners(brep):
    """(M, 3) the points of all edges, each once: an edge with a point on its straight side is a polyline."""
    curves = [brep.Edges[number].ToNurbsCurve().Points for number in range(len(brep.Edges))]
    points = [curve[number] for curve in curves for number in range(len(curve))]
    return np.unique(np.round([[point.X, point.Y, point.Z] for point in points], 7), axis=0)


def check(face: FlatFace) -> None:
    brep = faces.build_brep(face)
    assert brep.IsValid
    assert brep.Faces[0].IsPlanar(1e-6)
    assert [len(brep.Faces), len(brep.Faces[0].Loops)] == [1, len(face.rings)]
    apart = np.linalg.norm(corners(brep)[:, None] - face.vertices[None], axis=2)
    assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) < 1e-6


directions = st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda vector: np.linalg.norm(vector) > 0.1)
far = st.tuples(*[st.floats(-500, 500)] * 3).map(np.array)


@given(directions, far, st.integers(0, 4), st.integers(0, 3), st.integers(0, 3))
def test_every_corner_stays_in_whatever_direction(face, normal, where, windows, first, first_of_holes):
    holes = [np.array([[x, 1.0], [x, 3.5], [x + 1, 3.5], [x + 1, 1.0]]) for x in np.arange(windows) * 2 + 0.5]
    rings = [np.roll(SQUARE, first, axis=0), *(np.roll(hole, first_of_holes, axis=0) for hole in holes)]
    check(laid(face, rings, normal, where))


@pytest.mark.parametrize("first", range(6))
@pytest.mark.parametrize("bend", [0.0, 1e-4, 0.01, 0.1])
def test_a_corner_on_a_nearly_straight_side_stays_wherever_the_ring_begins(face, first, bend):
    ring = np.array([[0.0, 0], [4, bend], [10, 0], [10, 8], [5, 8], [0, 8]])
    hole = np.array([[2.0, 2], [2 + bend, 4], [2, 6], [6, 6], [6, 4], [6, 2]])
    check(laid(face, [np.roll(ring, first, axis=0), np.roll(hole, first, axis=0)], [0.3, -0.9, 0.0]))


def test_a_face_that_is_not_convex(face):
    ring = np.array([[0.0, 0], [3, 0], [3, 2], [4, 2], [4, 0], [9, 0], [9, 5], [6, 5], [6, 7], [0, 7]])
    check(laid(face, [ring], [0.0, -1.0, 0.0]))


def test_a_face_that_is_taken_for_less_is_told(face):
    with pytest.raises(OutputError, match=r"face_0000 is too small or too thin.*correct it in the scene file"):
        faces.build_brep(laid(face, [SQUARE * 1e-12], [0.0, -1.0, 0.0]))


def test_meshes_hold_more_than_32_bits(face):
    far_away = laid(face, [SQUARE / 3], [0.3, -0.9, 0.1], np.array([500.0, 300.0, 10.0]))
    mesh = faces.build_mesh(far_away)
    points = [mesh.Vertices.Point3dAt(number) for number in range(len(mesh.Vertices))]
    assert [[point.X, point.Y, point.Z] for point in points] == far_away.vertices.tolist()
