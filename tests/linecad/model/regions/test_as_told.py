"""Regions of the painted house as a person told them: they hold to the last cell, in labels and in faces."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from linecad.corrections.edits import Region
from linecad.geometry import project
from linecad.model.faces import find_faces
from linecad.model.regions.find import Look, find_regions
from linecad.model.regions.surfaces import GroundOfFeet

ARRAYS = (
    "id", "axis", "segment", "ends", "is_boundary", "component", "confidence", "role", "by_face", "by_depth_map",
)  # fmt: skip
SHAPES = [
    ((100.0, 40.0), (260.0, 60.0), (250.0, 200.0), (90.0, 180.0)),  # in the sky, over a corner of the roof's edge
    ((430.0, 250.0), (560.0, 260.0), (500.0, 420.0)),  # on the walls
    ((300.0, 600.0), (700.0, 580.0), (720.0, 719.0), (280.0, 719.0), (400.0, 660.0)),  # on the ground
]


def regions_of(house, *edits):
    look = Look(house.photo, None, None, faces=edits)
    return find_regions(house.planes, house.lines, house.camera, house.rotation, look)


def shown(regions, word):
    labels = regions.labels
    number = {"sky": labels.sky, "clutter": labels.clutter}
    number |= {surface.kind: row for row, surface in enumerate(labels.surfaces) if surface.kind == "ground"}
    return shapely.union_all([region for own, region in labels.regions if own == number[word]])


# Ground is told below the horizon only (test_telling.py).
@pytest.mark.parametrize(
    ("shape", "word"), [(SHAPES[0], "sky"), *((shape, word) for shape in SHAPES[1:] for word in ("ground", "sky"))]
)
def test_an_area_shows_what_was_told_and_the_rest_what_it_did(house, house_regions, word, shape):
    found = regions_of(house, Region(shape, word))
    area = shapely.Polygon(shape)
    assert shown(found, word).intersection(area).area == pytest.approx(area.area, rel=1e-6)
    before, after = house_regions.labels, found.labels
    away = shapely.difference(shapely.box(-0.5, -0.5, 959.5, 719.5), area.buffer(40))
    for row, surface in enumerate(before.surfaces):
        looks = [(each.axis, each.offset) for each in after.surfaces]
        now = looks.index((surface.axis, surface.offset))
        one, other = (
            shapely.union_all([region for own, region in labels.regions if own == number])
            for labels, number in ((before, row), (after, now))
        )
        assert one.symmetric_difference(other).intersection(away).area < 0.002 * away.area


def test_nothing_hides_told_ground_and_told_clutter_hides_what_is_behind_it(house):
    area = shapely.Polygon(SHAPES[2])
    hidden = regions_of(house, Region(SHAPES[2], "clutter"))
    assert hidden.clutter.intersection(area).area == pytest.approx(area.area)
    assert shown(hidden, "ground").intersection(area).area > 0.9 * area.area
    both = regions_of(house, Region(SHAPES[2], "clutter"), Region(SHAPES[2], "ground"))
    assert both.clutter.intersection(area).area < 1e-6


def test_no_face_is_where_the_sky_was_told(house):
    edit = Region(SHAPES[1], "sky")
    planes = find_faces(house.planes, house.lines, regions_of(house, edit), house.camera, house.rotation)
    area = shapely.Polygon(SHAPES[1])
    for face in (face for plane in planes for face in plane.faces):
        rings = [project(ring, house.camera.matrix, house.rotation) for ring in (face.outline, *face.holes)]
        seen = shapely.Polygon(rings[0], rings[1:]).buffer(0)
        assert seen.intersection(area).area < 1e-3


def test_told_ground_is_a_face_where_none_was_found(house):
    """No line ends below the horizon, so that no ground is found, though the feet of walls tell its height."""
    above = np.flatnonzero(house.lines.ends[:, :, 2].min(axis=1) > 0)
    kept = set(house.lines.id[above].tolist())
    lines = replace(house.lines, **{name: getattr(house.lines, name)[above] for name in ARRAYS}, pieces=())
    planes = tuple(replace(plane, lines=tuple(n for n in plane.lines if n in kept)) for plane in house.planes)
    planes = tuple(plane for plane in planes if plane.axis != 2)
    look = Look(house.photo, GroundOfFeet(2.0, 5.0), None)
    for edits in ((), (Region(SHAPES[2], "ground"),)):
        regions = find_regions(planes, lines, house.camera, house.rotation, replace(look, faces=edits))
        faces = [
            face
            for plane in find_faces(planes, lines, regions, house.camera, house.rotation)
            for face in plane.faces
            if face.kind == "ground"
        ]
        if not edits:
            assert faces == []
            continue
        assert {height for face in faces for height in face.outline[:, 2].tolist()} == {-2.0}
        seen = shapely.union_all(
            [shapely.Polygon(project(face.outline, house.camera.matrix, house.rotation)) for face in faces]
        )
        assert seen.buffer(1e-3).covers(shapely.Polygon(SHAPES[2]))
