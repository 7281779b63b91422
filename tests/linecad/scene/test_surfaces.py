"""Which plane of a scene counts as its ground."""

from dataclasses import replace

import pytest

from linecad.scene import Face, Plane, ground_of


def level(number, height, kind="ground"):
    """A horizontal plane with one face, of the ground or of something else."""
    return Plane(number, 2, height, (), (Face(number, [[0, 4, height], [1, 4, height], [0, 5, height]], kind=kind),))


def test_the_lowest_plane_with_a_face_of_the_ground_counts():
    planes = [level(0, -1.5), level(1, -1.6), level(2, -3.0, "other"), Plane(3, 2, -4.0, ())]
    assert ground_of(planes) is planes[1]


def test_a_ground_beside_other_faces_of_its_plane_counts():
    floor = level(0, -1.5, "other")
    assert ground_of([replace(floor, faces=(*floor.faces, *level(1, -1.5).faces))]).id == 0


@pytest.mark.parametrize(
    "plane",
    [level(0, 1.5), replace(level(0, -1.5), axis=0), level(0, -1.5, "other"), replace(level(0, -1.5), faces=())],
    ids=["above", "upright", "of something else", "without a face"],
)
def test_other_planes_are_no_ground(plane):
    assert not plane.shows_ground
    assert ground_of([plane]) is None


def test_a_scene_without_planes_has_no_ground():
    assert ground_of([]) is None
