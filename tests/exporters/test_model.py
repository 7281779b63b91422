from dataclasses import replace

import numpy as np
import pytest

from exporters.faces import signed_area
from exporters.model import FREE_UNIT, KNOWN_UNIT, SHORTEST_LINE, build_model
from linecad.scene import ROLES

BANDS = {"sure": 0.99, "likely": 0.7, "guess": 0.2}  # the probabilities that the scene has


def test_every_line_stands_in_the_group_of_its_axis_and_kind(scene, model):
    found = {number: group for group in model.groups for number in group.ids.tolist()}
    assert len(found) == len(scene.lines)
    for place, number in enumerate(scene.lines.id.tolist()):
        assert found[number].axis == scene.lines.axis[place]
        assert found[number].is_boundary == scene.lines.is_boundary[place]


def test_groups_are_named_by_axis_and_kind(model):
    assert [group.name for group in model.groups] == [
        f"lines_{axis}_{kind}" for axis in "xyz" for kind in ("boundary", "nonboundary")
    ]


def test_ids_ascend_in_each_group_with_their_ends(model, line_ends):
    for group in model.groups:
        assert (np.diff(group.ids) > 0).all()
        np.testing.assert_array_equal(group.ends, [line_ends[number] for number in group.ids.tolist()])


def test_a_group_without_lines_is_left_out(one_line):
    assert len(build_model(one_line).groups) == 1


@pytest.mark.parametrize(("length", "kept"), [(0.0, 0), (0.9 * SHORTEST_LINE, 0), (2 * SHORTEST_LINE, 1)])
def test_lines_without_length_are_dropped(one_line, length, kept):
    ends = np.array([[[0.0, 1.0, 0.0], [length, 1.0, 0.0]]])
    model = build_model(replace(one_line, lines=replace(one_line.lines, ends=ends)))
    assert sum(len(group.ids) for group in model.groups) == kept


def test_a_known_scale_gives_metres(scene, model):
    scaled = build_model(replace(scene, metres_per_unit=0.25))
    assert scaled.unit_note == KNOWN_UNIT
    np.testing.assert_allclose(scaled.points, 0.25 * model.points)
    assert [face.offset for face in scaled.faces] == [0.25 * face.offset for face in model.faces]


def test_an_unknown_scale_gives_one_metre_a_unit_and_says_so(free_unit, model):
    free = build_model(free_unit)
    assert free.unit_note == FREE_UNIT
    np.testing.assert_array_equal(free.points, model.points)


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


@pytest.mark.parametrize(
    ("photo", "name"),
    [("folder/a b.jpg", "a b.jpg"), ("a\nb.jpg", "a b.jpg"), ("\udcff.jpg", "?.jpg"), ("家.jpg", "家.jpg")],
)
def test_the_name_of_the_photo_is_one_line_of_text(scene, photo, name):
    assert build_model(replace(scene, photo=photo)).photo == name


def test_by_band_lines_stand_in_the_group_of_their_probability(told):
    model = build_model(told, by_band=True)
    probability = dict(zip(told.lines.id.tolist(), told.lines.probability.tolist(), strict=True))
    assert sum(len(group.ids) for group in model.groups) == len(told.lines)
    for group in model.groups:
        assert group.name.endswith(f"boundary_{group.band}")
        assert {probability[number] for number in group.ids.tolist()} == {BANDS[group.band]}
        assert group.probability.tolist() == [BANDS[group.band]] * len(group.ids)
    names = [group.name for group in model.groups]
    assert names[:3] == ["lines_x_boundary_sure", "lines_x_boundary_likely", "lines_x_boundary_guess"]
    assert len(set(names)) == len(names) > 12


def test_bands_are_left_alone_where_nobody_asks_or_the_scene_does_not_tell(told, scene, model):
    names = [group.name for group in model.groups]
    assert [group.name for group in build_model(told).groups] == names
    assert [group.name for group in build_model(scene, by_band=True).groups] == names


@pytest.fixture
def drawn(scene):
    """The scene with lines of all roles."""
    return replace(scene, lines=replace(scene.lines, role=np.resize(ROLES, len(scene.lines))))


def test_lines_stand_in_the_group_of_their_role(drawn):
    model = build_model(drawn, by_role=True)
    role = dict(zip(drawn.lines.id.tolist(), drawn.lines.role.tolist(), strict=True))
    assert sorted(number for group in model.groups for number in group.ids.tolist()) == sorted(role)
    for group in model.groups:
        assert {role[number] for number in group.ids.tolist()} == {group.role}
        assert group.roles.tolist() == [group.role] * len(group.ids)
        assert group.name.endswith("boundary" if group.role == "outline" else f"boundary_{group.role}")
    names = [group.name for group in model.groups]
    assert names[:3] == ["lines_x_boundary", "lines_x_boundary_opening", "lines_x_boundary_detail"]
    assert len(set(names)) == len(names)


def test_roles_and_bands_go_together(drawn, told):
    both = replace(drawn, lines=replace(drawn.lines, probability=told.lines.probability))
    names = {group.name for group in build_model(both, by_band=True, by_role=True).groups}
    assert {"lines_x_boundary_sure", "lines_x_boundary_detail_guess", "lines_x_boundary_opening_likely"} <= names


def test_groups_have_their_plain_names_where_nobody_asks_for_roles_and_tell_them(drawn, model):
    plain = build_model(drawn)
    role = dict(zip(drawn.lines.id.tolist(), drawn.lines.role.tolist(), strict=True))
    assert all(group.roles.tolist() == [role[number] for number in group.ids.tolist()] for group in plain.groups)
    assert [group.name for group in plain.groups] == [group.name for group in model.groups]
    assert [group.ids.tolist() for group in plain.groups] == [group.ids.tolist() for group in model.groups]


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
