"""One ground, pieces of it, and walls that end on it, above it or below the photo. Walls are 10 away: 1 % is 0.1."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.evaluation.draughting.ground import GroundCounts, count_ground
from linecad.evaluation.draughting.shapes import NO_FACE, nearest_faces
from linecad.evaluation.references import pixel_grid

GROUND = (2, -1.5, [(-9, 3), (9, 3), (9, 10), (-9, 10)])


def counted(drawing, faces):
    scene, shapes = drawing(faces=faces)
    face, _ = nearest_faces(scene, pixel_grid(scene.camera.width, scene.camera.height, 96), scene.faces)
    return count_ground(scene, shapes, np.bincount(face[face != NO_FACE], minlength=len(shapes)))


@pytest.mark.parametrize(("foot", "on"), [(-1.5, 1), (-1.45, 1), (-1.3, 0), (-1.7, 0)])
def test_a_wall_ends_on_the_ground_within_a_hundredth(drawing, outline, foot, on):
    found = counted(drawing, [GROUND, (1, 10.0, outline((-4, foot), (4, 3)))])
    assert (found.faces, found.walls, found.walls_on_ground) == (1, 1, on)


def test_a_wall_beside_the_ground_does_not_end_on_it(drawing, outline):
    found = counted(drawing, [GROUND, (1, 10.5, outline((-4, -1.5), (4, 3)))])
    assert (found.walls, found.walls_on_ground) == (1, 0)


def test_a_wall_that_runs_out_of_the_photo_has_no_foot(drawing, outline):
    assert counted(drawing, [GROUND, (1, 10.0, outline((-4, -6), (4, 3)))]).walls == 0


def test_a_wall_whose_foot_something_hides_is_not_asked_for_it(drawing, outline):
    wall, before = (1, 10.0, outline((-1, -1), (1, 3))), (1, 6.0, outline((-3, -1.5), (3, 0.5)))
    assert counted(drawing, [GROUND, wall]).walls == 1
    found = counted(drawing, [GROUND, wall, before])
    assert (found.walls, found.walls_on_ground) == (1, 1)  # the one before it


def test_ground_in_pieces_is_counted_by_its_level(drawing, outline):
    pieces = [(2, -1.5, outline((x, 3), (x + 2, 10))) for x in (-4, -2, 0)]
    sill, ceiling = (2, -0.5, outline((0, 8), (2, 8.2))), (2, 1.5, outline((-9, 3), (9, 10)))
    assert counted(drawing, [*pieces, sill, ceiling]).faces == 3
    assert counted(drawing, [ceiling]).faces == 0


def test_a_small_wall_need_not_end_on_the_ground(drawing, outline):
    faces = [GROUND, (1, 10.0, outline((-4, -1.5), (4, 3))), (1, 9.9, outline((0, 0), (1, 1)))]
    assert counted(drawing, faces).walls == 1


def test_a_wall_on_the_pavement_beside_a_road_stands_on_the_ground(drawing, outline):
    road = (2, -1.6, [(-9, 3), (9, 3), (9, 8), (-9, 8)])
    pavement, wall = (2, -1.4, outline((-9, 8), (9, 10))), (1, 10.0, outline((-4, -1.4), (4, 3)))
    scene, shapes = drawing(faces=[road, pavement, wall])
    seen = np.array([900, 100, 500])
    assert count_ground(scene, shapes, seen) == GroundCounts(1, 1, 0)  # a level of its own, nothing says what
    shapes = [replace(each, face=replace(each.face, kind="wall" if each.is_upright else "ground")) for each in shapes]
    assert count_ground(scene, shapes, seen) == GroundCounts(1, 1, 1)
