from dataclasses import replace

import numpy as np
import pytest

from exporters.model import build_model


def shifted(scene, opening, by):
    """The scene with one corner of the first face of an opening moved along x."""

    def change(face):
        if face.opening != opening or face.kind != "window":
            return face
        outline = face.outline.copy()
        outline[0, 0] += by
        return replace(face, outline=outline)

    planes = [replace(plane, faces=tuple(map(change, plane.faces))) for plane in scene.planes]
    return replace(scene, planes=tuple(planes))


def models(scene):
    return [fitting.model for fitting in build_model(scene).fittings]


def test_the_faces_of_an_opening_belong_together(row):
    model = build_model(row)
    assert [fitting.label for fitting in model.fittings] == ["window 1", "window 2", "window 3"]
    assert [fitting.key for fitting in model.fittings] == ["window_1", "window_2", "window_3"]
    assert [[face.id for face in fitting.faces] for fitting in model.fittings] == [
        list(range(first, first + 5)) for first in (0, 5, 10)
    ]
    assert [face.id for face in model.loose_faces] == [15, 16]


def test_equal_openings_are_the_first_of_them_in_another_place(row):
    model = build_model(row)
    assert models(row) == [0, 0, 0]
    assert [[fitting.id for fitting in equal] for equal in model.equal_fittings] == [[0, 1, 2]]
    first, *others = model.fittings
    for other in others:
        for face, local in zip(other.faces, first.local_faces, strict=True):
            np.testing.assert_allclose(local.vertices + other.place, face.vertices, atol=1e-7)
            assert local.offset + other.place[face.axis] == pytest.approx(face.offset)
            np.testing.assert_array_equal(local.normal, face.normal)


def test_openings_within_rounding_are_equal_and_others_are_not(row):
    assert models(shifted(row, 1, 1e-9)) == [0, 0, 0]
    assert models(shifted(row, 1, 1e-5)) == [0, 1, 0]


@pytest.mark.parametrize("change", [{"shape": 5}, {"kind": "door"}])
def test_openings_of_another_shape_or_kind_are_not_equal(row, change):
    openings = (row.openings[0], replace(row.openings[1], **change), row.openings[2])
    assert models(replace(row, openings=openings)) == [0, 1, 0]


def test_an_opening_that_lacks_a_face_is_not_equal(row):
    planes = [replace(plane, faces=tuple(face for face in plane.faces if face.id != 7)) for plane in row.planes]
    assert models(replace(row, planes=tuple(planes))) == [0, 1, 0]


def test_openings_without_faces_are_left_out(row):
    planes = [replace(plane, faces=tuple(face for face in plane.faces if face.opening != 0)) for plane in row.planes]
    assert [fitting.id for fitting in build_model(replace(row, planes=tuple(planes))).fittings] == [1, 2]
