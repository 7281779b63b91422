"""All counts together on one drawing with every kind of defect, counted by hand; and the tables of two drawings."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.evaluation.drawing import score_drawing
from linecad.evaluation.drawing_tables import MEAN, drawings
from linecad.evaluation.drawing_truth import TrueCounts
from linecad.evaluation.references import Points, Reference
from linecad.scene import Face

LINES = [
    ((-4, 10, -1.5), (1, 10, -1.5)),  # the foot of the wall, in two pieces ...
    ((1, 10, -1.5), (4, 10, -1.5)),
    ((-4, 10, -1.48), (4, 10, -1.48)),  # ... and once more, 0.2 % above it: a pair with either piece
    ((-4, 10, -1.5), (-4, 10, 3)),
    ((4, 10, -1.45), (4, 10, 3)),  # misses the line above the foot by 0.3 %
    ((-2, 10, 0), (-2, 10, 1)),  # in the air with both ends
]


@pytest.fixture(scope="module")
def scene(drawing, outline):
    wall = [(-4, -1.5), (4, -1.5), (4, 2.8), (3.8, 2.8), (3.8, 3), (-4, 3)]  # with a notch of two steps
    found, _ = drawing(
        LINES,
        [
            (2, -1.5, outline((-9, 3), (9, 10))),
            (1, 10.0, wall, outline((0, 0), (1, 1)), outline((2, 0), (3, 1))),
            (1, 10.3, outline((0, 0), (1, 1))),  # in the first hole
            (1, 10.0, outline((4.2, -1.5), (8, 3))),  # a piece of the wall
        ],
    )
    return found


def test_every_defect_is_counted_as_by_hand(scene):
    found = score_drawing(scene, Reference(), None)
    lines, faces, ground = found.lines, found.faces, found.ground
    assert (lines.lines, lines.too_many, lines.parallel_pairs) == (6, 1, 2)
    # The second upright line misses the line above the foot, and that and the foot end short of it.
    assert (lines.ends, lines.missing) == (12, 3)
    # The short line, and the top of the second upright one, where the notch is.
    assert lines.in_air == 3
    # The piece of the wall stands on the ground, so only the face in the hole is alone.
    assert (faces.too_many, faces.alone) == (1, 1)
    assert (faces.faces, faces.steps, faces.holes, faces.recesses, faces.slivers) == (4, 2, 2, 1, 0)
    assert (ground.faces, ground.walls, ground.walls_on_ground) == (1, 2, 2)
    assert faces.small == 0
    assert found.known_covered is None
    assert found.truth is None


def test_windows_of_a_scene_are_told_by_their_kind(scene):
    wall, pane = scene.planes[1], scene.planes[2]
    window = replace(pane, offset=10.1, faces=(Face(2, pane.faces[0].outline - [0, 0.2, 0], kind="window"),))
    plain = replace(window, faces=(replace(window.faces[0], kind="other"),))
    found = [
        score_drawing(replace(scene, planes=(wall, each)), Reference(), None).faces.too_many for each in (window, plain)
    ]
    assert found == [0, 1]


def test_the_share_of_the_photo_is_counted_on_a_grid(drawing, outline):
    quarter = 479.5 / 600 * 10, 319.5 / 600 * 10  # the corner of the photo, on the wall
    scene, _ = drawing(faces=[(1, 10.0, outline((0, 0), quarter))])
    assert score_drawing(scene, Reference(), None).photo_covered == pytest.approx(0.25, abs=0.01)


def test_elsewhere_a_survey_tells_what_should_be_covered(scene):
    pixels = [[479.5, 350.0], [100.0, 10.0]]  # on the wall; in the sky
    found = score_drawing(scene, Reference(dense=Points(np.array(pixels), np.array([10.0, 10.0]))), 1.0)
    assert found.known_covered == 0.5
    assert found.truth is None


def test_tables_have_a_row_for_each_photo_and_the_means(scene):
    one = score_drawing(scene, Reference(), None)
    two = replace(one, lines=replace(one.lines, too_many=4, in_air=5), photo_covered=1.0)
    faces, lines = drawings({"a": one, "b": two})
    assert [row.name for row in lines.rows] == ["a", "b", MEAN]
    column = [column.name for column in lines.columns].index("too many")
    assert [row.cells[column].value for row in lines.rows] == [1, 4, 2.5]
    assert lines.rows[1].cells[-1].value == pytest.approx(5 / 12)
    assert faces.rows[1].cells[0].value == 1
    assert faces.rows[0].cells[1] is None  # no truth tells what should be covered


def test_truth_has_a_table_where_there_is_any(scene):
    plain = score_drawing(scene, Reference(), None)
    made = replace(plain, truth=TrueCounts(100, 80, 60, 30, 20, 5, 0.04, 0.9), windows=0.7, all_windows=0.6)
    unseen = replace(plain, truth=TrueCounts(100, 80, 80, 80, 0, 0, None, None))
    table = drawings({"plain": plain, "made": made, "unseen": unseen})[-1]
    assert [row.name for row in table.rows] == ["made", "unseen", MEAN]
    assert [cell.value for cell in table.rows[0].cells] == [0.6, 0.3, 0.25, 0.9, 1, 1, 0.7, 0.6]
    assert table.rows[1].cells[2:] == (None,) * 6
    assert table.rows[2].cells[0].value == pytest.approx(0.7)
