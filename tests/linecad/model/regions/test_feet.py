"""Walls that end a little above or below the ground, by labels made by hand; the camera looks down at them."""

import numpy as np
import pytest
import shapely

from linecad.directions import directions_of, partner
from linecad.geometry import project
from linecad.model.regions import partition
from linecad.model.regions.cuts import Borders
from linecad.model.regions.feet import REACH, image_line, on_ground
from linecad.model.regions.filling import Filled
from linecad.model.regions.labels import Labels
from linecad.model.regions.raster import take_raster
from linecad.model.regions.segments import View
from linecad.model.regions.surfaces import Surface

GROUND, TOP = -2.0, 1.6
PITCH = 0.15  # rad, downwards
TURNS = (0.5,)
PHOTO = shapely.box(-0.5, -0.5, 959.5, 719.5)
NO_LINES = np.zeros(0, np.int64)
FRONT, SIDE = (1, 8.0, (2.0, 4.5)), (0, 2.0, (8.0, 16.0))  # axis, offset, from where to where along it
BACK, INNER = (1, 8.0, (-3.0, 2.0)), (0, 2.0, (4.0, 8.0))
TURNED = (4, 8.0, (-1.0, 2.0))
NEAR, FAR = (1, 8.0, (-2.0, 0.0)), (1, 10.0, (-1.0, 3.0))


@pytest.fixture(scope="module")
def view(house):
    cosine, sine = np.cos(PITCH), np.sin(PITCH)
    down = np.array([[1, 0, 0], [0, cosine, -sine], [0, sine, cosine]])
    return View(house.camera, down @ np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), None, TURNS)


@pytest.fixture(scope="module")
def raster(house):
    return take_raster(house.lines, house.camera, house.rotation, None)


def shown(wall, foot, view):
    """The part of the photo, px, in which a wall is down to the height `foot`, or the two heights of a leaning one."""
    axis, offset, span = wall
    vectors = directions_of(TURNS)
    corners = [
        offset * vectors[axis] + place * vectors[int(partner(axis))] + [0, 0, height]
        for place, height in zip((*span, *span[::-1]), (*np.broadcast_to(foot, 2), TOP, TOP), strict=True)
    ]
    outline = project(np.array(corners), view.camera.matrix, view.rotation)
    return shapely.Polygon(outline).intersection(PHOTO)


def regions(walls, feet, view):
    """Each wall (W,) without those before it, then the ground."""
    found, before = [], shapely.Polygon()
    for wall, foot in zip(walls, feet, strict=True):
        region = shown(wall, foot, view)
        found.append(region - before)
        before = before | region
    horizon = float(project(np.array([[0, 1e9, 0.0]]), view.camera.matrix, view.rotation)[0, 1])
    return [*found, shapely.box(-0.5, horizon, 959.5, 719.5) - before]


def labelled(walls, feet, view, raster):
    surfaces = [Surface("wall", axis, offset, NO_LINES, number) for number, (axis, offset, _) in enumerate(walls)]
    surfaces.append(Surface("ground", 2, GROUND, NO_LINES, None))
    areas = regions(walls, feet, view)
    cells = partition.cells_between([shapely.boundary(shape) for shape in (PHOTO, *areas)])
    middle = [cell.point_on_surface() for cell in cells]
    label = np.array([
        next((number for number, area in enumerate(areas) if area.contains(point)), len(surfaces)) for point in middle
    ])  # fmt: skip
    cell = partition.draw(cells, raster.shape, raster.step)
    of_samples = np.zeros((raster.size, len(surfaces) + 2))
    costs = np.zeros((len(cells), len(surfaces) + 2), np.int64)
    borders = Borders(np.zeros((0, 2), np.int64), np.zeros(0, np.int64))
    return Filled(Labels(surfaces, cells, cell, label, of_samples, costs, borders), shapely.Polygon())


def off(found, expected):
    """By how much, px^2, each surface differs from what is expected of it."""
    labels = found.labels
    return [
        shapely.union_all([own for label, own in labels.regions if label == number]).symmetric_difference(area).area
        for number, area in enumerate(expected)
    ]


@pytest.mark.parametrize("high", [-0.1, 0.1], ids=["buried", "floating"])
@pytest.mark.parametrize(
    "walls",
    [[FRONT], [FRONT, SIDE], [BACK, INNER], [TURNED], [(1, 8.0, (-9.0, 9.0))]],
    ids=["alone", "convex", "concave", "turned", "past both edges of the photo"],
)
def test_feet_come_to_lie_on_the_ground(walls, high, view, raster):
    before = labelled(walls, [GROUND + high] * len(walls), view, raster)
    expected = regions(walls, [GROUND] * len(walls), view)
    assert min(off(before, expected)) > 100
    found = on_ground(before, raster, view)
    assert max(off(found, expected)) < 0.1


@pytest.mark.parametrize("feet", [(0.1, -0.1), (-0.1, 0.1), (-0.1, -0.1)])
def test_a_wall_before_another_has_a_foot_of_its_own(feet, view, raster):
    before = labelled([NEAR, FAR], [GROUND + high for high in feet], view, raster)
    expected = regions([NEAR, FAR], [GROUND, GROUND], view)
    assert max(off(on_ground(before, raster, view), expected)) < 0.1


@pytest.mark.parametrize("high", [-0.1, 0.1])
def test_the_parts_still_cover_the_photo_once(high, view, raster):
    before = labelled([FRONT, SIDE], [GROUND + high, GROUND - high], view, raster)
    labels = on_ground(before, raster, view).labels
    assert shapely.union_all(labels.cells).symmetric_difference(PHOTO).area < 1e-3
    assert sum(region.area for _, region in labels.regions) == pytest.approx(PHOTO.area)
    assert not (labels.label == labels.clutter).any()
    assert np.array_equal(labels.cell, partition.draw(labels.cells, raster.shape, raster.step))


def test_what_ends_further_from_the_meet_stays(view, raster):
    line = image_line(Surface("wall", 1, 8.0, NO_LINES, 0), Surface("ground", 2, GROUND, NO_LINES, None), view)
    reach = REACH * view.camera.width
    for high, moves in ((0.15, True), (0.3, False)):
        border = project(np.array([[0, 8.0, GROUND + high]]), view.camera.matrix, view.rotation)[0]
        assert (abs(border @ line[:2] + line[2]) < reach) == moves
        before = labelled([FRONT], [GROUND + high], view, raster)
        assert (on_ground(before, raster, view) is not before) == moves


@pytest.mark.parametrize("high", [(0.1, 0.4), (0.4, 0.1)])
def test_what_ends_further_from_the_meet_at_one_end_stays_whole(high, view, raster):
    before = labelled([FRONT], [GROUND + np.array(high)], view, raster)
    assert on_ground(before, raster, view) is before


def test_feet_on_the_meet_stay(view, raster):
    before = labelled([FRONT, SIDE], [GROUND, GROUND], view, raster)
    assert max(off(on_ground(before, raster, view), regions([FRONT, SIDE], [GROUND, GROUND], view))) < 1e-3


def test_the_note_counts_the_parts_that_were_labelled(view, raster):
    before = labelled([FRONT], [GROUND + 0.1], view, raster)
    found = on_ground(before, raster, view)
    assert len(found.labels.cells) > len(before.labels.cells)
    assert found.notes == before.notes


@pytest.mark.parametrize("wall", [FRONT, SIDE, TURNED], ids=["y", "x", "turned"])
def test_two_surfaces_meet_in_an_image_line(wall, view):
    axis, offset, span = wall
    vectors = directions_of(TURNS)
    feet = offset * vectors[axis] + np.array(span)[:, None] * vectors[int(partner(axis))] + [0, 0, GROUND]
    line = image_line(Surface("wall", axis, offset, NO_LINES, 0), Surface("ground", 2, GROUND, NO_LINES, None), view)
    assert project(feet, view.camera.matrix, view.rotation) @ line[:2] + line[2] == pytest.approx(0, abs=1e-6)
    assert np.hypot(*line[:2]) == pytest.approx(1)
