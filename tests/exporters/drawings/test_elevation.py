from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exporters.drawings.choice import Choice
from exporters.drawings.elevation import build_elevation
from exporters.drawings.records import DETAILS, FACES, GROUND, OPENINGS, OUTLINES
from exporters.model import build_model
from linecad.directions import directions_of, partner
from linecad.errors import OutputError
from linecad.model.choice import keep_drawn
from linecad.scene import Certainty, Face, Opening, Plane

SIDES = [(1.5, 4.8), (4.8, 4.8), (8.4, 4.8)]  # lower left corners of the three windows of 1.2 x 1.6 m


def elevation(scene, **chosen):
    return build_elevation(build_model(scene, origin="ground"), Choice(**chosen))


def on(drawing, layer):
    return [stroke for stroke in drawing.strokes if stroke.layer.name.removesuffix("_GUESS") == layer.name]


def segments(strokes):
    """The strokes as rounded pairs of ends, in whichever order."""
    return {frozenset(map(tuple, np.round(stroke.points, 6).tolist())) for stroke in strokes}


def sides_of_windows():
    for x, y in SIDES:
        corners = [(x, y), (x + 1.2, y), (x + 1.2, y + 1.6), (x, y + 1.6)]
        yield from (frozenset(side) for side in zip(corners, corners[1:] + corners[:1], strict=True))


def test_openings_are_drawn_where_the_scene_has_them(drawing):
    rounded = {frozenset((round(x, 6), round(y, 6)) for x, y in side) for side in sides_of_windows()}
    assert segments(on(drawing, OPENINGS)) == rounded


def test_lines_of_the_wall_are_drawn_with_their_lengths(drawing, facade):
    """Of lines in the wall's plane and before nothing else, the whole is there."""
    ends = facade.lines.ends + np.array([-6.5, -15.0, 5.2])  # from the corner of the house
    cornice = ends[(np.abs(ends[:, :, 2] - 7.4) < 1e-9).all(axis=1) & (facade.lines.axis == 0)]
    assert len(cornice) == 1
    assert frozenset(map(tuple, np.round(cornice[0][:, [0, 2]], 6).tolist())) in segments(on(drawing, OUTLINES))


def without(scene, *faces):
    return replace(
        scene,
        planes=tuple(
            replace(plane, faces=tuple(each for each in plane.faces if each.id not in faces)) for plane in scene.planes
        ),
    )


def test_what_lies_behind_the_wall_is_seen_through_its_windows_alone(drawing, facade):
    """Lines stand 0.3 m behind the wall, 5 cm behind the panes, from 4.8 to 6.8 m."""
    behind = {frozenset({(x, 4.8), (x, 6.4)}) for x in (2.35, 5.8, 9.4)}
    above = {frozenset({(x, 6.4), (x, 6.8)}) for x in (2.35, 5.8, 9.4)}
    whole = {frozenset({(x, 4.8), (x, 6.8)}) for x in (2.35, 5.8, 9.4)}
    assert not (behind | above | whole) & segments(on(drawing, OUTLINES))
    panes = (0, 5, 10)
    open_windows = segments(on(elevation(without(facade, *panes)), OUTLINES))
    assert behind <= open_windows
    assert not (above | whole) & open_windows


def test_dimensions_are_those_of_wall_and_windows(drawing):
    told = {upright: {} for upright in (False, True)}
    for each in drawing.dimensions:
        told[each.is_upright].setdefault(each.at, []).append(float(drawing.unit.text(each.length)))
    across = [told[False][at] for at in sorted(told[False], reverse=True)]
    up = [told[True][at] for at in sorted(told[True])]
    assert across == [[1.5, 1.2, 2.1, 1.2, 2.4, 1.2, 2.4], [2.1, 3.3, 3.6, 3.0], [12.0]]
    assert up == [[4.8, 1.6, 1.6], [8.0]]


def test_levels_count_from_the_ground(drawing):
    levels = {label.text for label in drawing.labels if label.layer.name == "LEVELS"}
    assert levels == {"±0.00", "+4.80", "+6.40", "+8.00"}
    (ground,) = on(drawing, GROUND)
    assert np.array_equal(ground.points[:, 1], [0, 0])


def test_the_view_is_to_scale(drawing):
    assert drawing.view.scale == 1000 / 50
    a, b = drawing.view.to_paper(np.array([[0.0, 0.0], [12.0, 8.0]]))
    assert np.allclose(b - a, [240, 160])
    width, height = drawing.view.size
    x, y = drawing.view.corner
    assert 0 < x < x + width < drawing.paper.width
    assert 0 < y < y + height < drawing.paper.height


def test_everything_stands_on_the_paper(drawing):
    for stroke in drawing.sheet:
        assert (stroke.points >= 0).all()
        assert (stroke.points <= [drawing.paper.width, drawing.paper.height]).all()
    for label in drawing.labels:
        assert 0 < label.x < drawing.paper.width
        assert 0 < label.y < drawing.paper.height


def test_without_a_known_length_lengths_are_shares_of_the_width_and_the_sheet_says_so(facade):
    free = elevation(replace(facade, metres_per_unit=None))
    texts = [label.text for label in free.labels]
    assert "Scale: none, as no length is known" in texts
    assert any("shares of the width of the facade" in text for text in texts)
    told = {free.unit.text(each.length) for each in free.dimensions}
    assert {"1.000", "0.100", "0.667"} <= told
    with pytest.raises(OutputError, match="needs a known length"):
        elevation(replace(facade, metres_per_unit=None), drawing_scale="1:50")


def test_what_told_the_scale_and_doubts_about_the_camera_are_noted(facade):
    certainty = Certainty([0.1, 0.1, 0.1], 50.0, None, None, "doubtful", "few lines agree")
    drawing = elevation(replace(facade, scale_source="line 3 is 2 m long", certainty=certainty, notes=("a note",)))
    notes = [label.text for label in drawing.labels if label.text.startswith("- ")]
    assert notes[:2] == ["- scale: line 3 is 2 m long", "- camera doubtful: few lines agree"]
    assert "- a note" in notes


def test_notes_that_have_no_room_are_counted(facade):
    drawing = elevation(replace(facade, notes=tuple(f"note {number}" for number in range(30))))
    notes = [label.text for label in drawing.labels if label.text.startswith("- ")]
    shown = sum(note.startswith("- note ") for note in notes)
    assert notes[-1] == f"- {30 - shown} more notes are in the scene file"


def test_metres_multiply_all_lengths(drawing, facade):
    double = elevation(replace(facade, metres_per_unit=2.0), drawing_scale="1:100")
    for one, other in zip(drawing.dimensions, double.dimensions, strict=True):
        assert np.isclose(2 * one.length, other.length, rtol=1e-12)
        assert np.isclose(one.at, other.at)


def test_guesses_are_dashed_and_counted(told, facade):
    drawing = elevation(replace(facade, lines=told.lines))
    dashed = [stroke for stroke in on(drawing, OUTLINES) if stroke.layer.is_dashed]
    assert 0 < len(dashed) < len(on(drawing, OUTLINES))
    assert any(label.text.startswith("- dashed: ") for label in drawing.labels)


def test_an_opening_that_is_not_seen_is_dashed(facade):
    openings = (replace(facade.openings[0], is_completed=True), *facade.openings[1:])
    drawing = elevation(replace(facade, openings=openings))
    assert [stroke.layer.is_dashed for stroke in on(drawing, OPENINGS)] == 4 * [True] + 8 * [False]
    assert any("1 openings that the photo does not show" in label.text for label in drawing.labels)


def test_lines_have_the_layers_of_their_roles(facade):
    for role, layer in (("outline", OUTLINES), ("detail", DETAILS)):
        drawing = elevation(replace(facade, lines=replace(facade.lines, role=[role] * len(facade.lines))))
        assert on(drawing, layer)
        assert not on(drawing, {OUTLINES: DETAILS, DETAILS: OUTLINES}[layer])


def test_a_line_that_repeats_the_side_of_an_opening_is_drawn_once(facade):
    drawing = elevation(replace(facade, lines=replace(facade.lines, role=["opening"] * len(facade.lines))))
    drawn = [frozenset(map(tuple, np.round(each.points, 6).tolist())) for each in on(drawing, OPENINGS)]
    for side in sides_of_windows():
        assert drawn.count(frozenset((round(x, 6), round(y, 6)) for x, y in side)) == 1


def test_borders_of_faces_are_drawn(drawing):
    assert frozenset({(0.0, 8.0), (12.0, 8.0)}) in segments(on(drawing, FACES))


def of_frame(scene, turn, axis):
    """A wall of 7 by 3 m with a window of 1 by 2, 9 m before the camera, in a frame turned by `turn`."""
    level = directions_of((turn,))
    normal, along = level[axis], level[int(partner(axis))]

    def ring(u0, u1, v0, v1):
        return np.array(
            [9.0 * normal + u * along + v * np.eye(3)[2] for u, v in ((u0, v0), (u1, v0), (u1, v1), (u0, v1))]
        )

    wall = Face(0, ring(-3.0, 4.0, -1.0, 2.0), (ring(0.5, 1.5, -0.5, 1.5),), "wall")
    pane = Face(1, ring(0.5, 1.5, -0.5, 1.5), (), "window", opening=5)
    plane = Plane(3, axis, 9.0, (), (wall, pane))
    opening = Opening(5, 3, 0.5, 1.5, -0.5, 1.5, "window")
    return replace(scene, planes=(plane,), openings=(opening,), turns=(turn,))


@given(st.floats(0.05, 0.75), st.sampled_from([3, 4]))
def test_a_facade_of_a_turned_frame_has_its_lengths(no_lines, turn, axis):
    drawing = elevation(of_frame(no_lines, turn, axis))
    across = [each.length for each in drawing.dimensions if not each.is_upright]
    gaps = (3.5, 1.0, 2.5) if axis == 4 else (2.5, 1.0, 3.5)  # from left to right: x2 runs so, and y2 the other way
    assert np.allclose(across, [*gaps, 7.0], atol=1e-12)
    sides = [np.linalg.norm(each.points[1] - each.points[0]) for each in on(drawing, OPENINGS)]
    assert np.allclose(sorted(sides), [1, 1, 2, 2], atol=1e-12)


def test_another_facade_is_drawn_from_its_own_front(scene):
    """The side wall of the house: 6 m wide, with its left end at the far corner."""
    side = elevation(scene, facade=1)
    whole = [each.length for each in side.dimensions if not each.is_upright][-1]
    assert np.isclose(whole, 6.0)
    assert "plane" in side.title
    assert side.title.startswith("Elevation of facade 1 ")


def under_roof(scene, before=0.0):
    """The wall of 12 by 8 m under a roof that rises 5 m over 5 m, from 0.5 m left of it to 2 m right of it."""
    pitch = np.radians(45.0)
    outline = np.array([(-0.5, 0, 0), (14, 0, 0), (12, 5, 5), (0, 5, 5)]) + np.array([6.5, 15.0 - before, 8.0 - 5.2])
    tilt = pitch + np.pi / 2
    offset = float(np.array([0, np.cos(tilt), np.sin(tilt)]) @ outline[0])
    roof = Plane(77, 1, offset, (), (Face(55, outline, kind="roof"),), tilt)
    return replace(scene, planes=(*scene.planes, roof))


def test_the_roof_above_its_eave_is_drawn_and_measured(facade):
    drawing = elevation(under_roof(facade))
    around = 0.08 * 12
    assert np.allclose(drawing.view.box, [-0.5 - around, 0.0, 14 + around, 13 + around])
    assert frozenset({(0.0, 13.0), (12.0, 13.0)}) in segments(on(drawing, FACES))
    up = [float(drawing.unit.text(each.length)) for each in drawing.dimensions if each.is_upright]
    assert up == [4.8, 1.6, 1.6, 5.0, 13.0]
    levels = {label.text for label in drawing.labels if label.layer.name == "LEVELS"}
    assert levels == {"±0.00", "+4.80", "+6.40", "+8.00", "+13.00"}
    across = [each.length for each in drawing.dimensions if not each.is_upright]
    assert np.isclose(across[-1], 12.0)  # the width is that of the walls


def test_a_roof_is_drawn_above_a_wall_whose_lines_are_left_out(facade):
    roofed = under_roof(replace(facade, lines=replace(facade.lines, role=["detail"] * len(facade.lines))))
    bare = keep_drawn(roofed, "none")
    assert len(bare.lines) == 0
    assert elevation(bare).view.box == elevation(roofed).view.box
    assert elevation(bare).view.box[3] > 13


def test_a_roof_on_another_plane_changes_nothing(drawing, facade):
    other = elevation(under_roof(facade, before=-0.01), drawing_scale="1:50")
    assert other.view.box == drawing.view.box
    places = [[(each.start, each.end) for each in one.dimensions] for one in (other, drawing)]
    assert places[0] == places[1]
