"""Each kind of bad face in a scene where it can be counted by hand. The walls are 10 away: 1 % is 0.1."""

import numpy as np
import pytest

from linecad.evaluation.draughting.faces import count_faces, steps_of
from linecad.evaluation.draughting.shapes import shapes_of

WALL = ((-5, -2), (5, 3))
STAIR = [(0, 0), (10, 0), (10, 5), (9.8, 5), (9.8, 5.2), (9.6, 5.2), (9.6, 5.4), (0, 5.4)]


def counted(drawing, faces, lines=(), of_openings=()):
    scene, shapes = drawing(lines, faces)
    return count_faces(scene, shapes, np.isin(np.arange(len(faces)), of_openings))


def test_one_rectangle_has_nothing_but_to_be_alone(drawing, outline):
    found = counted(drawing, [(1, 10.0, outline(*WALL))])
    assert (found.faces, found.alone) == (1, 1)
    assert (found.too_many, found.steps, found.slivers, found.small, found.holes) == (0, 0, 0, 0, 0)


def test_a_scene_without_faces_has_no_count(drawing):
    found = counted(drawing, [])
    assert (found.faces, found.too_many, found.alone, found.steps, found.small, found.slivers) == (0, 0, 0, 0, 0, 0)


@pytest.mark.parametrize(
    ("offset", "start", "too_many"),
    [
        (10.0, 5.2, 1),  # 2 % beside it
        (10.0, 5.5, 0),  # 5 % beside it
        (10.15, 5.2, 1),  # 1.5 % behind it
        (10.3, 5.2, 0),  # 3 % behind it
    ],
)
def test_pieces_of_one_wall_are_too_many(drawing, outline, offset, start, too_many):
    faces = [(1, 10.0, outline(*WALL)), (1, offset, outline((start, -2), (start + 4, 3)))]
    assert counted(drawing, faces).too_many == too_many


def test_a_piece_in_the_angle_of_another_is_measured_by_its_outline(drawing, outline):
    corner = [(0, 0), (6, 0), (6, 1), (1, 1), (1, 6), (0, 6)]
    assert counted(drawing, [(1, 10.0, corner), (1, 10.0, outline((4, 4), (6, 6)))]).too_many == 0
    assert counted(drawing, [(1, 10.0, corner), (1, 10.0, outline((1.1, 4), (6, 6)))]).too_many == 1


def test_three_pieces_in_a_row_are_two_too_many(drawing, outline):
    faces = [(1, 10.0, outline((x, 0), (x + 1.9, 3))) for x in (0, 2, 4)]
    assert counted(drawing, faces).too_many == 2


def test_faces_that_share_an_edge_are_not_alone(drawing, outline):
    front, side = (1, 10.0, outline((-5, -2), (5, 3))), (0, 5.0, outline((10, -2), (14, 2)))
    apart = (0, 5.1, outline((10, -2), (14, 2)))
    assert counted(drawing, [front, side]).alone == 0
    assert counted(drawing, [front, apart]).alone == 2
    assert counted(drawing, [front, side, apart]).alone == 1
    # They meet in a corner only.
    assert counted(drawing, [front, (0, 5.0, outline((10, 3), (14, 6)))]).alone == 2


def test_every_edge_of_a_stair_is_a_step(drawing):
    _, (shape,) = drawing(faces=[(1, 10.0, STAIR)])
    steps = steps_of(shape)
    assert sorted(np.linalg.norm(step[1] - step[0]) for step in steps) == pytest.approx([0.2] * 4)
    assert {tuple(step[:, 1]) for step in steps} == {(10.0, 10.0)}
    assert counted(drawing, [(1, 10.0, STAIR)]).steps == 4


def test_points_where_nothing_turns_hide_no_step(drawing):
    between = [*STAIR[:3], (9.9, 5.0), *STAIR[3:]]
    assert counted(drawing, [(1, 10.0, between)]).steps == 4


def test_a_step_of_a_tenth_of_the_face_is_none(drawing):
    assert counted(drawing, [(1, 10.0, [(0, 0), (10, 0), (10, 5), (8, 5), (8, 7), (0, 7)])]).steps == 0


def test_a_step_in_a_hole_counts(drawing, outline):
    notch = [(2, 2), (4, 2), (4, 3.8), (3.8, 3.8), (3.8, 4), (2, 4)]
    assert counted(drawing, [(1, 10.0, outline((0, 0), (6, 6)), notch)]).steps == 2


def test_a_step_that_a_line_draws_has_one(drawing):
    step = ((9.8, 10.0, 5.0), (9.8, 10.0, 5.3))
    other = ((9.7, 10.0, 5.0), (9.7, 10.0, 5.3))  # 1 % beside it
    assert counted(drawing, [(1, 10.0, STAIR)]).steps_without_line == 4
    assert counted(drawing, [(1, 10.0, STAIR)], [step]).steps_without_line == 3
    assert counted(drawing, [(1, 10.0, STAIR)], [other]).steps_without_line == 4


@pytest.mark.parametrize(
    ("line", "without"),
    [
        (((9.6, 10.0, 5.2), (9.8, 10.0, 5.2)), 3),  # level
        (((9.8, 10.0, 5.0), (9.8, 10.0, 5.2)), 3),  # upright
        (((9.6, 10.0, 5.3), (9.8, 10.0, 5.3)), 4),  # 1 % above it
    ],
)
def test_a_step_in_another_frame_that_a_line_draws_has_one(drawing, turned, line, without):
    scene = turned(drawing([line], [(1, 10.0, STAIR)])[0], 0.4)
    assert count_faces(scene, shapes_of(scene), np.zeros(1, bool)).steps_without_line == without


def test_slivers_and_small_faces(drawing, outline):
    wall = (1, 10.0, outline((0, 0), (10, 5)))
    strip, patch, crumb = outline((0, 6), (10, 6.3)), outline((20, 0), (20.6, 0.6)), outline((20, 9), (20.1, 9.1))
    assert counted(drawing, [wall, (1, 10.0, strip)]).slivers == 1
    assert counted(drawing, [wall, (1, 10.0, strip)]).small == 0
    assert counted(drawing, [wall, (1, 10.0, patch)]).small == 1
    assert counted(drawing, [wall, (1, 10.0, patch)]).slivers == 0
    assert counted(drawing, [wall, (1, 10.0, crumb)]).slivers == 1


def test_ground_to_the_horizon_makes_no_wall_small(drawing, outline):
    faces = [(2, -1.5, outline((-200, 1), (200, 400))), (1, 10.0, outline((0, 0), (10, 5)))]
    assert counted(drawing, faces).small == 0


@pytest.mark.parametrize(("behind", "recesses"), [(None, 0), (10.3, 1), (12.0, 0), (9.7, 0)])
def test_a_hole_with_a_parallel_face_a_little_behind_is_a_recess(drawing, outline, behind, recesses):
    faces = [(1, 10.0, outline((-5, -2), (5, 3)), outline((0, 0), (1, 1.5)))]
    if behind is not None:
        faces.append((1, behind, outline((-0.1, -0.1), (1.1, 1.6))))
    found = counted(drawing, faces)
    assert (found.holes, found.recesses) == (1, recesses)


def test_a_pane_is_neither_a_piece_of_its_wall_nor_small(drawing, outline):
    faces = [(1, 10.0, outline((-5, -2), (5, 3)), outline((0, 0), (0.5, 0.8))), (1, 10.1, outline((0, 0), (0.5, 0.8)))]
    plain, told = counted(drawing, faces), counted(drawing, faces, of_openings=[1])
    assert (plain.of_openings, plain.too_many, plain.small) == (0, 1, 1)
    assert (told.of_openings, told.too_many, told.small) == (1, 0, 0)
    assert told.recesses == 1
    strip = [faces[0], (0, 0.0, outline((10, 0), (10.01, 0.8)))]
    assert counted(drawing, strip).slivers == 1
    assert counted(drawing, strip, of_openings=[1]).slivers == 0


def test_a_door_is_no_step_of_its_wall(drawing, outline):
    notched = [(-5, -2), (0, -2), (0, -1.8), (0.1, -1.8), (0.1, -2), (5, -2), (5, 3), (-5, 3)]
    faces = [(1, 10.0, notched), (1, 10.0, outline((0, -2), (0.1, -1.8)))]
    assert counted(drawing, faces).steps == 2
    assert counted(drawing, faces, of_openings=[1]).steps == 0


def test_a_wall_with_a_window_alone_is_alone(drawing, outline):
    faces = [(1, 10.0, outline(*WALL)), (1, 10.0, outline((-5, -2), (0, 0)))]
    assert counted(drawing, faces).alone == 0
    assert counted(drawing, faces, of_openings=[1]).alone == 1


def test_a_flush_pane_is_in_no_recess(drawing, outline):
    hole = outline((0, 0), (1, 1))
    assert counted(drawing, [(1, 10.0, outline(*WALL), hole), (1, 10.0, hole)], of_openings=[1]).recesses == 0
    assert counted(drawing, [(1, 10.0, outline(*WALL), hole), (1, 10.1, hole)], of_openings=[1]).recesses == 1
