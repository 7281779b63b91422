"""Faces that the page names, told by where the photo shows them; distances that it sends."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.corrections.file import corrections_from_json, corrections_to_json
from linecad.editing.faces import face_anchor
from linecad.errors import CorrectionError
from linecad.geometry import project
from linecad.model.known_lengths import measured
from linecad.model.scale import seen_plane
from linecad.scene import Face


@pytest.fixture(scope="module")
def solved(open_page):
    page = open_page()
    page.solve()
    return page


def main_faces(scene):
    """The faces of planes of component 0 with lines."""
    of_plane = scene.components_of_planes
    return [(plane, face) for plane, face in scene.faces if plane.lines and of_plane[plane.id] == 0]


def pixel_of(scene, point):
    return tuple(project(np.asarray(point), scene.camera.matrix, scene.rotation).tolist())


def test_an_anchor_shows_the_plane_of_its_face(solved):
    scene = solved.session.scene()
    for plane, face in main_faces(scene):
        anchor = face_anchor(scene, pixel_of(scene, face.outline[0]), face.id)
        assert seen_plane(scene, anchor.pixel, anchor.axis).id == plane.id


def test_where_the_photo_shows_the_face_at_the_point_the_anchor_is_there(solved):
    scene = solved.session.scene()
    for plane, face in main_faces(scene):
        middle = pixel_of(scene, face.outline.mean(axis=0))
        if (seen := seen_plane(scene, middle, plane.axis)) is not None and seen.id == plane.id:
            assert face_anchor(scene, middle, face.id).pixel == middle
            return
    pytest.fail("no face is seen at its middle")


def test_a_face_that_others_hide_has_no_anchor(solved):
    scene = solved.session.scene()
    plane, face = main_faces(scene)[0]
    hidden = Face(10**6, face.outline * 2)
    behind = replace(plane, id=10**6, offset=2 * plane.offset, faces=(hidden,))
    both = replace(scene, planes=(*scene.planes, behind))
    with pytest.raises(CorrectionError, match="the photo shows nothing of the face"):
        face_anchor(both, pixel_of(scene, face.outline[0]), hidden.id)
    with pytest.raises(CorrectionError, match="there is no face 7777777"):
        face_anchor(scene, (0.0, 0.0), 7777777)


def points_of(scene, state):
    """A corner of a face, a point on a line, and their distance in units."""
    plane, face = main_faces(scene)[0]
    corner = face.outline[0]
    line = next(one for one in state["lines"] if one["component"] == 0 and one["id"] not in plane.lines)
    point = 0.3 * np.array(line["ends"][0]) + 0.7 * np.array(line["ends"][1])
    sent = [
        {"pixel": list(pixel_of(scene, corner)), "face": face.id},
        {"pixel": list(pixel_of(scene, point)), "line": line["id"]},
    ]
    return sent, float(np.linalg.norm(corner - point))


def test_a_distance_sets_the_scale_and_its_file_does_so_again(open_page):
    page = open_page()
    sent, units = points_of(page.session.scene() if page.solve() else None, page.state())
    state = page.edit(op="distance", points=sent, metres=12.5)
    assert state["metres_per_unit"] * units == pytest.approx(12.5, rel=1e-6)
    assert state["solve"]["fresh"]
    said = corrections_from_json(corrections_to_json(page.session.now().corrections))
    again = open_page(corrections=said)
    assert again.solve()["metres_per_unit"] == pytest.approx(state["metres_per_unit"], rel=1e-12)
    assert again.change("undo")["metres_per_unit"] is None


def test_a_distance_between_the_same_points_replaces_the_one_before_and_null_takes_it_back(open_page):
    page = open_page()
    page.solve()
    sent, units = points_of(page.session.scene(), page.state())
    page.edit(op="distance", points=sent, metres=3.0)
    state = page.edit(op="distance", points=sent, metres=6.0)
    assert state["metres_per_unit"] * units == pytest.approx(6.0, rel=1e-6)
    assert page.edit(op="distance", points=sent, metres=None)["metres_per_unit"] is None


def test_a_split_line_keeps_the_point_on_the_nearer_piece_and_deleted_ones_drop_it(open_page):
    page = open_page()
    page.solve()
    sent, _ = points_of(page.session.scene(), page.state())
    page.edit(op="distance", points=sent, metres=3.0)
    line = sent[1]["line"]
    ends = next(np.array(one["segment"]) for one in page.state()["lines"] if one["id"] == line)
    page.edit(op="split", line=line, at=ends.mean(axis=0).tolist())
    corrected = page.session.lines.corrected
    ((_, place, _),) = corrected.distances
    piece = corrected.segments.ends[corrected.ids == place.line][0]
    along = (np.array(place.pixel) - piece[0]) @ (piece[1] - piece[0])
    assert -1e-6 < along / np.sum((piece[1] - piece[0]) ** 2) < 1 + 1e-6
    for piece in corrected.ids[-2:].tolist():
        page.edit(op="delete", line=piece)
    assert page.session.lines.corrected.distances == ()


def test_what_sets_no_scale_is_refused_at_once(solved):
    scene, state = solved.session.scene(), solved.state()
    sent, _ = points_of(scene, state)
    for edit, words in [
        ({"points": [sent[0], sent[0]], "metres": 2}, "two points are one"),
        ({"points": [sent[0]], "metres": 2}, "list of 2"),
        ({"points": sent, "metres": -1}, "a length from"),
        ({"points": [sent[0], {"pixel": [1, 2]}], "metres": 2}, "face is missing"),
    ]:
        assert words in solved.refused(422, "edit", edit={"op": "distance", **edit})


def test_without_a_model_there_is_no_distance(page):
    line = page.state()["lines"][0]
    points = [{"pixel": end, "line": line["id"]} for end in line["segment"]]
    assert "solve first" in page.refused(422, "edit", edit={"op": "distance", "points": points, "metres": 2})


def test_known_distances_bear_on_nothing_but_the_scale(open_page):
    page = open_page()
    page.solve()
    sent, _ = points_of(page.session.scene(), page.state())
    before = page.session.scene()
    page.edit(op="distance", points=sent, metres=3.0)
    after = page.session.scene()
    assert after.lines is before.lines
    assert measured(before, page.session.lines.corrected).metres_per_unit == after.metres_per_unit
