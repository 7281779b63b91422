import numpy as np
import pytest

from exporters.drawings.facades import facade_at, facades_of, number_of_plane
from exporters.model import build_model
from linecad.errors import OutputError


def test_facades_are_the_planes_with_walls_the_largest_first(model):
    found = facades_of(model)
    areas = [each.area for each in found]
    assert areas == sorted(areas, reverse=True)
    assert [each.number for each in found] == list(range(len(found)))
    assert found[0].plane == next(face.plane for face in model.faces if face.id == 0)
    assert np.isclose(areas[0], 12 * 8 - 1.6 * 2.6)  # the door is cut out of the outline, the windows are holes


def test_panes_and_reveals_make_no_facade(row):
    (only,) = facades_of(build_model(row))
    assert only.plane == 11
    assert np.allclose(only.normal, [0, -1, 0])
    assert np.allclose(only.right, [1, 0, 0])


def test_a_plane_names_its_facade(model):
    for facade in facades_of(model):
        assert number_of_plane(model, facade.plane) == facade.number


def test_what_is_no_facade_is_told_which_there_are(model, row):
    with pytest.raises(OutputError, match=r"there is no facade 9; the facades are 0 \(plane 10\), 1 "):
        facade_at(model, 9)
    with pytest.raises(OutputError, match=r"there is no plane 99; the facades are 0 "):
        number_of_plane(model, 99)
    ground = next(plane.id for plane in row.planes if plane.axis == 2)
    with pytest.raises(OutputError, match=rf"plane {ground} has no upright wall; the facades are 0 \(plane 11\)"):
        number_of_plane(build_model(row), ground)


def test_a_scene_without_walls_has_no_drawing(no_faces):
    for ask in (facade_at, number_of_plane):
        with pytest.raises(OutputError, match="the scene has no upright face"):
            ask(build_model(no_faces), 0)
