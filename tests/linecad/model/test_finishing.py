"""Lines merged, stubs left out and ends closed until nothing changes."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.model.clean.sight import Sight
from linecad.model.finishing import finished
from linecad.model.frames import FramedLines
from linecad.scene import Plane, Scene, SolveReport

X, Y, Z = range(3)
DEPTH = 10.0
SILL = (X, (-2, DEPTH, 0), (2, DEPTH, 0))
POST = (Z, (-2, DEPTH, -1), (-2, DEPTH, 1))


@pytest.fixture
def done(lines, crossings, camera, rotation):
    """The scene of rows of detail, each of which really crosses the next, and the same finished."""

    def finish(rows):
        found = replace(lines(rows), role=["detail"] * len(rows))
        scene = Scene(
            photo="wall.jpg", camera=camera, rotation=rotation, lines=found,
            intersections=crossings([(row, row + 1) for row in range(len(rows) - 1)]),
            planes=(Plane(0, Y, DEPTH, tuple(range(len(rows))), ()),),
            solve=SolveReport("SCIP 10.0", "bodies", "optimal", 0, 0, 0), notes=("before",),
        )  # fmt: skip
        framed = FramedLines(found, np.zeros(len(rows), int), ())
        return scene, finished(scene, framed, Sight.of(camera, rotation, None))

    return finish


def test_a_scene_that_nothing_is_to_be_done_about_is_as_it_was(done):
    before, after = done([SILL, POST])
    np.testing.assert_array_equal(after.lines.ends, before.lines.ends)
    assert after.notes == before.notes


def test_a_short_detail_whose_end_can_be_closed_is_no_stub(done):
    _, found = done([SILL, POST, (Z, (0, DEPTH, 0.05), (0, DEPTH, 0.3)), (X, (0, DEPTH, 0.3), (2, DEPTH, 0.3))])
    assert found.lines.id.tolist() == [0, 1, 2, 3]
    assert found.lines.ends[2, 0].tolist() == [0, DEPTH, 0]


def test_stubs_go_and_a_note_counts_them(done):
    _, found = done([SILL, POST, (Z, (0, DEPTH, 0), (0, DEPTH, 0.07)), (Z, (1, DEPTH, 0), (1, DEPTH, 0.07))])
    assert found.lines.id.tolist() == [0, 1]
    assert found.notes == ("before", "2 stubs of detail that end nowhere are left out")


def test_an_end_that_misses_a_line_that_took_another_in_is_closed(done):
    """The end of the bar is near the second piece of the sill, and beyond the end of the first one."""
    bar = (Z, (1, DEPTH, 0.05), (1, DEPTH, 1))
    _, found = done([(X, (-2, DEPTH, 0), (0, DEPTH, 0)), POST, (X, (-0.05, DEPTH, 0), (2, DEPTH, 0)), bar])
    assert len(found.lines) == 3
    ends = found.lines.ends[found.lines.id == 3][0]
    assert ends[:, Z].tolist() == [0, 1]
    assert found.notes == ("before",)
