"""Which component a scene is about, and the scene of that one alone."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.errors import GroupError
from linecad.io.scene_document import document_of
from linecad.model.groups import choose_main, keep_main, with_main_first
from linecad.scene import Camera, Face, Intersections, Lines, Opening, Plane, Scene, SolveReport

WIDTH, HEIGHT = 800, 600
ROTATION = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # x right, y away, z up


def wall(x0, x1, y, z0, z1):
    """The corners of a wall that faces the camera."""
    return np.array([[x0, y, z0], [x1, y, z0], [x1, y, z1], [x0, y, z1]], float)


def pixels(points):
    points = np.asarray(points, float) @ ROTATION.T
    return 500 * points[..., :2] / points[..., 2:] + (WIDTH / 2, HEIGHT / 2)


def lines_of(ends, component, probability):
    ends = np.array(ends, float)
    count = len(ends)
    return Lines(
        id=np.arange(count) + 10, axis=np.full(count, 2), segment=pixels(ends), ends=ends,
        is_boundary=np.zeros(count, bool), component=component,
        confidence=np.where(np.array(component) == 0, "supported", "weak"), probability=probability,
    )  # fmt: skip


@pytest.fixture
def scene():
    """A far tower of eight short lines (component 0), a near house of four long ones (component 1), and the ground."""
    tower = [[[20 + x, 90, 10], [20 + x, 90, 14]] for x in range(8)]
    house = [[[x, 10, -1.5], [x, 10, 3]] for x in (-4, -3, -2, 0)]
    lines = lines_of([*tower, *house], [0] * 8 + [1] * 4, np.array([0.9] * 8 + [0.8] * 4))
    ids = lines.id.tolist()
    planes = (
        Plane(0, 1, 90.0, tuple(ids[:8]), (Face(0, wall(20, 27, 90, 10, 14), kind="wall"),)),
        Plane(1, 1, 10.0, tuple(ids[8:]), (Face(1, wall(-4, 0, 10, -1.5, 3), kind="wall"),)),
        Plane(2, 2, -1.5, (), (Face(2, np.array([[-4.0, 5, -1.5], [4, 5, -1.5], [4, 10, -1.5]]), kind="ground"),)),
        Plane(3, 1, 10.2, (), (Face(3, wall(-3, -2, 10.2, 0, 1), kind="window", opening=7),)),
        Plane(4, 0, 5.0, ()),
    )
    crossings = Intersections(
        lines=np.array([[10, 11], [18, 19]]), kind=np.array(["L", "L"]), pixel=np.zeros((2, 2)),
        real=np.array([True, True]), in_tree=np.array([True, True]), weight=np.ones(2),
    )  # fmt: skip
    camera = Camera(WIDTH, HEIGHT, np.array([[500.0, 0, WIDTH / 2], [0, 500, HEIGHT / 2], [0, 0, 1]]), "file")
    opening = Opening(id=7, plane=1, u0=-3.0, u1=-2.0, v0=0.0, v1=1.0, kind="window", recess=0.2, panel=10.2)
    return Scene(
        "a.jpg", camera, ROTATION, lines, crossings, planes, SolveReport("s", "bodies", "optimal", 1.0, 1.0, 0.0),
        metres_per_unit=0.5, scale_source="a length", openings=(opening,),
    )  # fmt: skip


def test_a_far_tower_of_many_short_lines_is_not_what_the_scene_is_about(scene):
    found = with_main_first(scene)
    assert found.lines.component.tolist() == [1] * 8 + [0] * 4
    assert found.lines.confidence.tolist() == ["weak"] * 8 + ["supported"] * 4
    assert with_main_first(found) is found


def test_lines_that_are_hardly_right_weigh_little(scene):
    unsure = replace(scene, lines=replace(scene.lines, probability=np.array([0.9] * 8 + [0.01] * 4)))
    assert with_main_first(unsure) is unsure


def test_without_probabilities_the_program_has_chosen(scene):
    silent = replace(scene, lines=replace(scene.lines, probability=()))
    assert with_main_first(silent) is silent


@pytest.mark.parametrize(
    "place", [pixels([-2.01, 10, 1]), pixels([-2.5, 10, 0.5]), pixels([-1, 10, 1])]
)  # on a line, on a pane, on a wall
def test_a_place_chooses_what_stands_there(scene, place):
    chosen = choose_main(scene, tuple(place.tolist()))
    assert chosen.lines.component.tolist() == [1] * 8 + [0] * 4
    assert chosen.notes[-1].startswith("component 0 is what stands at ")
    assert "it was component 1; probabilities are still those relative to the former one" in chosen.notes[-1]
    assert chosen.metres_per_unit == 0.5


def test_a_place_on_component_0_changes_nothing(scene):
    assert choose_main(scene, tuple(pixels([23.5, 90, 12]).tolist())) is scene


def test_a_length_of_another_group_is_no_length_where_scales_are_guesses(scene):
    silent = replace(scene, lines=replace(scene.lines, probability=()))
    chosen = choose_main(silent, tuple(pixels([-2, 10, 1]).tolist()))
    assert (chosen.metres_per_unit, chosen.scale_source) == (None, "")
    assert chosen.notes[-1].endswith("the known length was of the former one, so the scale is free again")


def test_where_nothing_stands_nothing_can_be_chosen(scene):
    with pytest.raises(GroupError, match=r"no line and no face stands at 5,5 px; choose"):
        choose_main(scene, (5.0, 5.0))


def test_the_main_group_alone(scene):
    kept = keep_main(with_main_first(scene))
    assert kept.lines.id.tolist() == [18, 19, 20, 21]
    assert kept.intersections.lines.tolist() == [[18, 19]]
    assert [plane.id for plane in kept.planes] == [1, 2, 3, 4]
    assert [face.id for _, face in kept.faces] == [1, 2, 3]
    assert [opening.id for opening in kept.openings] == [7]
    assert kept.notes == ("8 of 12 lines are left out: they are not of component 0",)
    assert keep_main(kept) is kept


def test_the_windows_of_other_groups_go_with_their_walls(scene):
    kept = keep_main(scene)
    assert [plane.id for plane in kept.planes] == [0, 2, 4]
    assert [face.id for _, face in kept.faces] == [0, 2]
    assert kept.openings == ()
    document_of(kept)


def test_a_component_in_the_middle_comes_first_and_the_others_keep_their_order(scene):
    lines = replace(scene.lines, component=[0, 0, 1, 1, 2, 2, 3, 3, 2, 2, 2, 2])
    found = with_main_first(replace(scene, lines=lines)).lines.component
    assert found.tolist() == [1, 1, 2, 2, 0, 0, 3, 3, 0, 0, 0, 0]
