"""--detail: which lines are written."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.cli import arguments
from linecad.model.choice import DETAILS, keep_drawn
from linecad.model.frames import FramedLines
from linecad.scene import Face, Plane, Scene, SolveReport


@pytest.fixture
def scene(lines, crossings, camera, rotation):
    """A wall with a line of each role."""
    rows = [(0, (-1, 10, z), (1, 10, z)) for z in (0, 1, 2)] + [(2, (0, 10, 0), (0, 10, 2))]
    roles = ["outline", "opening", "detail", "outline"]
    face = Face(0, [(-1, 10, 0), (1, 10, 0), (1, 10, 2)])
    return Scene(
        photo="wall.jpg", camera=camera, rotation=rotation, lines=replace(lines(rows), role=roles),
        intersections=crossings([(0, 3), (1, 3), (2, 3)]), planes=(Plane(0, 1, 10.0, (0, 1, 2, 3), (face,)),),
        solve=SolveReport("SCIP 10.0", "bodies", "optimal", 0, 0, 0), notes=("before",),
    )  # fmt: skip


def test_all_is_the_scene_as_it_is(scene):
    assert keep_drawn(scene, "all") is scene


@pytest.mark.parametrize(
    ("detail", "ids", "said"),
    [
        ("none", [0, 3], "2 of 4 lines are left out: they are openings and detail"),
        ("openings", [0, 1, 3], "1 of 4 lines are left out: they are detail"),
    ],
)
def test_lines_go_with_their_crossings_and_faces_stay(scene, detail, ids, said):
    found = keep_drawn(scene, detail)
    assert found.lines.id.tolist() == ids
    assert found.intersections.lines.tolist() == [[each, 3] for each in ids[:-1]]
    assert [plane.lines for plane in found.planes] == [tuple(ids)]
    assert found.faces[0][1] is scene.faces[0][1]
    assert found.notes == ("before", said)


def test_ends_at_lines_that_are_left_out_go_to_those_beside_them(lines, scene):
    rows = [(0, (-1, 10, 0), (1, 10, 0)), (0, (-1, 10, 0.05), (1, 10, 0.05)), (2, (0, 10, 0.05), (0, 10, 2))]
    rows.append((2, (1, 10, 0), (1, 10, 2)))
    near = replace(lines(rows), role=["outline", "detail", "outline", "outline"])
    found = keep_drawn(replace(scene, lines=near), "none")
    np.testing.assert_array_equal(found.lines.ends[1], [[0, 10, 0], [0, 10, 2]])


def test_a_plane_without_lines_keeps_its_faces(scene):
    bare = replace(scene, lines=replace(scene.lines, role=np.full(4, "detail")))
    found = keep_drawn(bare, "none")
    assert len(found.lines) == 0
    assert len(found.faces) == 1


def test_the_command_line_knows_the_same_words():
    assert arguments.DETAILS == DETAILS


def test_ends_of_several_frames_close_on_what_stays(lines, crossings, camera, rotation):
    """What is written of a street of two frames; the ends of its lines are equal in the world but for rounding."""
    turns = (0.5,)
    rows = [(0, (-1, 10, 0), (1, 10, 0)), (2, (0.95, 10, 0), (0.95, 10, 1)), (2, (1, 10, -1), (1, 10, 1))]
    framed = FramedLines(lines(rows), np.array([1, 1, 1]), turns)
    world = replace(framed.in_world(), role=["outline", "detail", "outline"])
    ends = world.ends.copy()
    ends[0, 1] = ends[1, 0]  # on the detail, near the outline behind it
    scene = Scene(
        photo="street.jpg", camera=camera, rotation=rotation, turns=turns, planes=(),
        lines=replace(world, ends=ends), intersections=crossings([(0, 1), (0, 2)]),
        solve=SolveReport("SCIP 10.0", "bodies", "optimal", 0, 0, 0),
    )  # fmt: skip
    found = keep_drawn(scene, "none")
    assert found.lines.id.tolist() == [0, 2]
    np.testing.assert_allclose(found.lines.ends[0], world.ends[0], atol=1e-12)
