"""Edits about faces as the page sends them: lassos that cross themselves, windows of walls of the model, walls."""

import numpy as np
import pytest
import shapely

from linecad.corrections.edits import NoWindow, Region, WallByEdges, Window


def project(state, points):
    seen = np.array(points) @ (np.array(state["K"]) @ np.array(state["R_cam_from_world"])).T
    return seen[:, :2] / seen[:, 2:]


def edit(page, **edit):
    return page.post("edit", base_version=page.version, edit=edit)


def edits(page):
    return page.session.now().corrections.edits


@pytest.fixture
def solved(page):
    """A page whose photo is solved, and its state."""
    page.state()
    page.post("solve", base_version=page.version)
    page.solving.answer()
    return page, page.state()


def wall_of(state):
    """The wall that the photo shows most of, and its outline, px."""
    faces = [(plane, face) for plane in state["planes"] for face in plane["faces"] if plane["axis"] != "z"]
    shapes = [shapely.Polygon(project(state, face["outline"])).buffer(0) for _, face in faces]
    best = int(np.argmax([shape.area for shape in shapes]))
    return faces[best][0], shapes[best]


def test_a_lasso_that_crosses_itself_means_the_largest_part_that_it_goes_around(page):
    page.state()
    answer = edit(page, op="region", polygon=[[0, 0], [300, 200], [300, 0], [90, 60], [60, 120]], **{"is": "sky"})
    assert answer.status_code == 200
    (found,) = edits(page)
    assert isinstance(found, Region)
    assert shapely.Polygon(found.polygon).is_valid
    assert answer.json()["areas"] == [{"is": "sky", "polygon": [list(corner) for corner in found.polygon]}]


def test_ground_above_the_horizon_is_refused(page):
    """It did nothing, and nobody was told."""
    horizon = page.state()["photo"]["height"] / 2  # the made camera looks nearly level
    above = [[100, 0], [400, 0], [400, horizon - 250]]
    answer = edit(page, op="region", polygon=above, **{"is": "ground"})
    assert answer.status_code == 422
    assert "above the horizon" in answer.json()["error"]
    assert edits(page) == ()
    assert edit(page, op="region", polygon=above, **{"is": "sky"}).status_code == 200
    page.state()
    reaching_down = [*above[:2], [400, horizon + 250]]
    assert edit(page, op="region", polygon=reaching_down, **{"is": "ground"}).status_code == 200


def test_a_window_names_its_wall_by_a_level_line_in_it_and_is_a_hole_after_the_solve(solved):
    page, state = solved
    plane, shape = wall_of(state)
    middle = np.array(shape.representative_point().coords[0])
    corners = [(middle - 12).tolist(), (middle + 12).tolist()]
    assert edit(page, op="window", plane=plane["id"], corners=corners).status_code == 200
    (found,) = edits(page)
    assert isinstance(found, Window)
    looks = {line["id"]: line for line in state["lines"]}
    own = [looks[number] for number in plane["lines"] if looks[number]["axis"] != "z"]
    assert found.wall.line.ends in [tuple(map(tuple, line["segment"])) for line in own]
    page.solving.answer()  # nobody had to ask for it
    after = page.state()
    (mark,) = after["areas"]  # drawn in the photo, after a reload too
    assert mark["is"] == "window"
    assert np.abs(np.array(mark["polygon"])[:, None] - corners).sum(axis=2).min(axis=0).max() < 1e-6
    panes = [face for each in after["planes"] for face in each["faces"] if face["kind"] == "window"]
    seen = [project(after, face["outline"]) for face in panes]
    assert min(np.abs(ring - corners[0]).sum(axis=1).min() for ring in seen) < 1e-6
    edit(page, op="no-window", at=middle.tolist())
    assert edits(page)[-1] == NoWindow(tuple(middle.tolist()))


def test_a_wall_is_named_by_its_lines(solved):
    page, state = solved
    plane, _ = wall_of(state)
    lines = [line for line in state["lines"] if line["id"] in plane["lines"]]
    upright, level = ([line for line in lines if (line["axis"] == "z") == is_up][:2] for is_up in (True, False))
    four = [line["id"] for line in (*upright, *level)]
    assert edit(page, op="wall", lines=four).status_code == 200
    assert isinstance(edits(page)[0], WallByEdges)
    (mark,) = page.state()["areas"]
    assert mark["is"] == "wall"
    for number in four:  # each side lies along an edge
        segment = next(np.array(line["segment"]) for line in lines if line["id"] == number)
        across = np.array([[0, -1], [1, 0]]) @ (segment[1] - segment[0]) / np.linalg.norm(segment[1] - segment[0])
        off = np.abs((np.array(mark["polygon"]) - segment[0]) @ across)
        assert np.sort(off)[:2].max() < 1e-6
    answer = edit(page, op="wall", lines=four[:2] * 2)
    assert answer.status_code == 409 or "two upright edges" in answer.json()["error"]


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"op": "region", "polygon": [[0, 0], [9, 9], [18, 18]], "is": "sky"}, "goes around nothing"),
        ({"op": "region", "polygon": [[0, 0], [9, 9]], "is": "sky"}, "a list of 3 to 1000 points"),
        ({"op": "window", "plane": 1, "corners": [[0, 0], [9, 9]]}, "there is no model yet"),
        ({"op": "wall", "lines": [1, 2, 3]}, "a list of 4"),
        ({"op": "wall", "lines": [1, 2, 3, 10**6]}, "there is no line 1000000 any more"),
    ],
)
def test_what_means_nothing_is_refused_and_changes_nothing(page, wrong, message):
    page.state()
    answer = edit(page, **wrong)
    assert answer.status_code >= 400
    assert message in answer.json()["error"]
    assert edits(page) == ()


def test_a_plane_that_is_no_wall_is_refused(solved):
    page, _ = solved
    answer = edit(page, op="window", plane=10**6, corners=[[0, 0], [9, 9]])
    assert "no wall of the model is there" in answer.json()["error"]
