from dataclasses import replace

import numpy as np
import pytest

from exporters.model import FREE_UNIT, KNOWN_UNIT, ON_GROUND, SHORTEST_LINE, build_model
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


@pytest.mark.parametrize("metres", [1.0, 0.25])
def test_on_the_ground_everything_is_as_much_higher_as_the_camera_is_above_it(grounded, metres):
    scaled = replace(grounded, metres_per_unit=metres)
    low, high = build_model(scaled), build_model(scaled, origin="ground")
    height = -min(plane.offset for plane in scaled.planes if plane.axis == 2) * metres
    assert low.eye.tolist() == [0, 0, 0]
    assert high.eye.tolist() == [0, 0, height]
    np.testing.assert_allclose(high.points, low.points + high.eye)
    (ground,) = (face for face in high.faces if face.kind == "ground")
    assert (ground.vertices[:, 2] == 0).all()
    offsets = [after.offset - before.offset for before, after in zip(low.planes, high.planes, strict=True)]
    assert offsets == pytest.approx([height * (plane.axis == "z") for plane in low.planes])
    assert (low.unit_note, high.unit_note) == (KNOWN_UNIT, f"{KNOWN_UNIT}; {ON_GROUND}")


def test_the_lowest_of_several_grounds_counts(grounded):
    plane = next(plane for plane in grounded.planes if plane.faces[0].kind == "ground")
    lower = replace(plane.faces[0], id=99, outline=plane.faces[0].outline - [0, 0, 0.5], holes=())
    other = replace(plane, id=99, offset=plane.offset - 0.5, faces=(lower,))
    model = build_model(replace(grounded, planes=(*grounded.planes, other)), origin="ground")
    assert model.eye[2] == pytest.approx(0.5 - plane.offset)


@pytest.mark.parametrize("change", [{"metres_per_unit": None}, {"planes": ()}])
def test_without_a_scale_or_a_ground_the_origin_stays_at_the_camera(grounded, change):
    changed = replace(grounded, **change)
    model, plain = build_model(changed, origin="ground"), build_model(changed)
    assert model.eye.tolist() == [0, 0, 0]
    assert model.points.tobytes() == plain.points.tobytes()
    assert model.unit_note == plain.unit_note
