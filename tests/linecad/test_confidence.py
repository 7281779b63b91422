"""Lines that are not sure enough are left out, with all that hangs on them, and a note counts them."""

from dataclasses import replace

import numpy as np
import pytest

from exporters.model import ON_GROUND, ON_THE_GROUND, build_model
from linecad.confidence import keep_probable
from linecad.errors import ConfidenceError
from linecad.io.scene_file import read_scene, write_scene
from linecad.scene import Camera, Face, Intersections, Lines, Opening, Plane, Scene, SolveReport, ground_of

RING = np.array([[0, 4, 0], [1, 4, 0], [0, 4, 1]])


def plane(number, *lines):
    return Plane(number, 1, 4.0 + number, lines, (Face(number, RING + np.array([0, number, 0])),))


@pytest.fixture
def scene():
    return Scene(
        photo="room.jpg",
        camera=Camera(640, 480, [[500, 0, 320], [0, 500, 240], [0, 0, 1]], "file"),
        rotation=[[1, 0, 0], [0, 0, -1], [0, 1, 0]],
        lines=Lines(
            id=[9, 4, 7, 2],
            axis=[0, 2, 0, 2],
            segment=np.arange(16.0).reshape(4, 2, 2),
            ends=np.arange(24.0).reshape(4, 2, 3),
            is_boundary=[True, False, True, False],
            component=[0, 0, 1, 2],
            confidence=["proven", "supported", "weak", "weak"],
            probability=[0.97, 0.9, 0.6, 0.2],
        ),
        intersections=Intersections(
            lines=[[9, 4], [4, 7], [2, 7]],
            kind=["L", "T", "X"],
            pixel=[[1, 2], [3, 4], [5, 6]],
            real=[True, False, True],
            in_tree=[True, False, False],
            weight=[1, 2, 3],
            reason=["chosen", "loose", "annotated"],
        ),
        planes=(plane(0, 9, 4), plane(1, 4, 7, 2), plane(2, 7, 2), plane(3, 2)),
        solve=SolveReport("SCIP", "gain", "optimal", 1, 1, 0),
        notes=("one",),
    )


def test_lines_below_go_and_the_others_stay_as_they_are(scene):
    kept = keep_probable(scene, 0.6).lines
    for name in ("id", "axis", "segment", "ends", "is_boundary", "component", "confidence", "probability"):
        np.testing.assert_array_equal(getattr(kept, name), getattr(scene.lines, name)[:3])


def test_a_crossing_stays_where_both_of_its_lines_do(scene):
    kept = keep_probable(scene, 0.6).intersections
    for name in ("lines", "kind", "pixel", "real", "in_tree", "weight", "reason"):
        np.testing.assert_array_equal(getattr(kept, name), getattr(scene.intersections, name)[:2])
    assert keep_probable(scene, 0.95).intersections.lines.shape == (0, 2)


def test_a_plane_stays_with_all_its_faces_where_one_of_its_lines_does(scene):
    kept = keep_probable(scene, 0.9)
    assert [(each.id, each.lines) for each in kept.planes] == [(0, (9, 4)), (1, (4,))]
    assert [face.id for _, face in kept.faces] == [0, 1]


def test_a_ground_without_lines_stays(scene):
    ground = Plane(7, 2, -2.0, (), (Face(9, [[0, 0, -2], [1, 0, -2], [0, 1, -2]], kind="ground"),))
    kept = keep_probable(replace(scene, planes=(*scene.planes, ground)), 0.9)
    assert [each.id for each in kept.planes] == [0, 1, 7]
    assert "2 of 5 planes" in kept.notes[-1]


def test_a_ground_stays_whose_lines_go(scene):
    """Its heights were told from the camera then, no longer from the ground."""
    ground = Plane(7, 2, -2.0, (2,), (Face(9, [[0, 0, -2], [1, 0, -2], [0, 1, -2]], kind="ground"),))
    scene = replace(scene, planes=(*scene.planes, ground), metres_per_unit=1.0, scale_source="known length")
    for least in (0.1, 0.9):
        kept = keep_probable(scene, least)
        assert ground_of(kept.planes).offset == -2.0
        assert ON_GROUND in build_model(kept, origin=ON_THE_GROUND).unit_note


def test_a_note_counts_what_was_left_out(scene):
    assert keep_probable(scene, 0.9).notes == (
        "one",
        "2 of 4 lines and 2 of 4 planes are left out: the probability that their depth is right is below 0.9",
    )
    without_planes = keep_probable(replace(scene, planes=()), 0.25).notes[-1]
    assert without_planes.startswith("1 of 4 lines are left out: ")


@pytest.mark.parametrize("least", [0.0, 0.2])
def test_where_all_are_sure_enough_the_scene_comes_back_as_it_is(scene, least):
    assert keep_probable(scene, least) is scene


def test_a_scene_that_does_not_tell_is_refused(scene):
    silent = replace(scene, lines=replace(scene.lines, probability=()))
    with pytest.raises(ConfidenceError, match=r"does not tell how likely .*; leave out --confidence, or convert"):
        keep_probable(silent, 0.0)


def test_where_nothing_would_be_left_the_highest_is_named(scene):
    with pytest.raises(ConfidenceError, match=r"probability of 0.98 or more, the highest is 0.97; choose a smaller"):
        keep_probable(scene, 0.98)


def test_what_is_left_is_a_scene_file(scene, tmp_path):
    write_scene(keep_probable(scene, 0.9), tmp_path / "a.json")
    assert read_scene(tmp_path / "a.json").lines.probability.tolist() == [0.97, 0.9]


def test_pieces_and_roles_go_with_their_lines(scene):
    pieces = tuple(np.full((number, 2, 2), float(number)) for number in range(4))
    role = ["outline", "opening", "detail", "outline"]
    lines = replace(scene.lines, probability=[0.9, 0.1, 0.8, 0.2], pieces=pieces, role=role)
    found = keep_probable(replace(scene, lines=lines), 0.5).lines
    assert found.role.tolist() == ["outline", "detail"]
    assert [each.tolist() for each in found.pieces] == [pieces[row].tolist() for row in (0, 2)]


def test_openings_go_with_the_planes_of_their_walls(scene):
    windows = tuple(Opening(wall, wall, 0.0, 1.0, 0.0, 1.0, "window") for wall in (0, 3))
    left = keep_probable(replace(scene, openings=windows), 0.5)
    assert [each.plane for each in left.openings] == [0]


def test_panes_and_reveals_stay_and_go_with_their_openings(scene):
    recess = {"recess": 0.5, "panel": 7.0}
    windows = (
        Opening(0, 0, 0.1, 0.2, 0.1, 0.2, "window", **recess),  # its pane lies in the plane of line 2
        Opening(1, 3, 0.1, 0.2, 0.1, 0.2, "window"),
    )

    def part(number, offset, opening, kind):
        return Face(number, RING + np.array([0, offset - 4, 0]), kind=kind, opening=opening)

    planes = (
        scene.planes[0],
        replace(scene.planes[3], faces=(*scene.planes[3].faces, part(10, 7, 0, "window"), part(11, 7, 1, "window"))),
        Plane(8, 1, 9.0, (), (part(12, 9, 0, "reveal"), part(13, 9, 1, "reveal"))),
        Plane(9, 1, 9.5, (), (part(14, 9.5, 1, "reveal"),)),
    )
    kept = keep_probable(replace(scene, planes=planes, openings=windows), 0.5)
    assert [each.id for each in kept.openings] == [0]
    assert {plane.id: [face.id for face in plane.faces] for plane in kept.planes} == {0: [0], 3: [10], 8: [12]}
