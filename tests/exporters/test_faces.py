from dataclasses import replace

import numpy as np
import pytest

from exporters.faces import signed_area
from exporters.model import build_model


def test_hidden_parts_of_faces_are_in_metres_too(scene):
    plane = next(plane for plane in scene.planes if plane.faces)
    part = plane.faces[0].outline[:3]
    hiding = replace(plane, faces=(replace(plane.faces[0], hidden=(part,)),))
    (face,) = build_model(replace(scene, planes=(hiding,), metres_per_unit=0.25)).faces
    assert len(face.hidden) == 1
    assert face.hidden[0] == pytest.approx(0.25 * part)


def test_faces_look_at_the_camera(model):
    for face in model.faces:
        assert face.normal @ (0 - face.vertices[0]) > 0


def test_outlines_turn_counter_clockwise_as_the_camera_sees_them_and_holes_the_other_way(model):
    for face in model.faces:
        across = [np.cross(ring, np.roll(ring, -1, axis=0)).sum(axis=0) @ face.normal for ring in face.rings]
        assert across[0] > 0
        assert all(value < 0 for value in across[1:])


def test_the_two_axes_of_a_plane_give_its_normal(model):
    for face in model.faces:
        u, v = (np.eye(3)[axis] for axis in face.in_plane)
        np.testing.assert_array_equal(np.cross(u, v), face.normal)


def test_the_area_of_a_ring_far_from_the_origin_is_exact():
    ring = np.array([(0, 0), (1, 0), (1, 1), (0, 1)]) + 1e9
    assert signed_area(ring) == 1.0
    assert signed_area(ring[::-1]) == -1.0


def test_faces_are_labelled_by_kind_and_counted_where_there_are_several(model):
    assert [face.label for face in model.faces] == [
        "wall 1", "wall 2", "other 1", "window 1", "window 2", "window 3", "door", "other 2", "other 3",
    ]  # fmt: skip
    assert [face.kind for face in model.faces] == [face.label.split()[0] for face in model.faces]


def test_the_count_goes_by_id_through_all_planes(scene):
    faces = iter([7, 3, 5, 0, 8, 1, 2, 6, 4])
    planes = [
        replace(plane, faces=tuple(replace(face, id=next(faces), kind="wall") for face in plane.faces))
        for plane in scene.planes
    ]
    labels = {face.id: face.label for face in build_model(replace(scene, planes=tuple(planes))).faces}
    assert labels == {number: f"wall {number + 1}" for number in range(9)}


def test_reveals_say_whose_they_are_and_panes_are_called_like_their_opening(row):
    labels = [face.label for face in build_model(row).faces]
    windows = ["window 1", "window 2", "window 3"]
    assert labels == [label for name in windows for label in (name, *[f"reveal of {name}"] * 4)] + ["wall", "ground"]


def test_faces_of_no_opening_count_with_the_openings_of_their_kind(row):
    planes = [
        replace(plane, faces=tuple(replace(face, opening=None) if face.id == 5 else face for face in plane.faces))
        for plane in row.planes
    ]
    labels = {face.id: face.label for face in build_model(replace(row, planes=tuple(planes))).faces}
    assert [labels[number] for number in (0, 5, 6, 10)] == ["window 1", "window 2", "reveal of window 3", "window 4"]


def test_reveals_look_into_their_opening_wherever_the_camera_is(row):
    for face in build_model(row).faces:
        if face.kind == "reveal":
            opening = row.openings[face.opening]
            middle = [(opening.u0 + opening.u1) / 2, opening.panel, (opening.v0 + opening.v1) / 2]
            assert face.normal @ (middle - face.vertices[0]) > 0
            u, v = (np.eye(3)[axis] for axis in face.in_plane)
            np.testing.assert_array_equal(np.cross(u, v), face.normal)
            assert signed_area(face.rings[0][:, face.in_plane]) > 0
