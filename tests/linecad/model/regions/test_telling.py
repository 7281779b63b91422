"""The walls and the ground that a person's words ask for, in the scene of the painted house."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from linecad.corrections.edits import Anchor, Region, WallByEdges
from linecad.directions import UP
from linecad.model.regions import find
from linecad.model.regions.find import Look, find_regions
from linecad.model.regions.segments import View
from linecad.model.regions.surfaces import GroundOfFeet, Surface, weights_of
from linecad.model.regions.telling import IN_THE_SKY, ground_height, tell, wall_by_edges

EVERYWHERE = shapely.box(-0.5, -0.5, 959.5, 719.5)


def anchor(house, row):
    (a, b), (c, d) = house.lines.segment[row].tolist()
    return Anchor(((a, b), (c, d)), int(house.lines.axis[row]))


def front_edges(house):
    """Rows of two upright and two level lines of the front, at y = 8, those that are furthest apart."""
    front = np.flatnonzero((house.lines.ends[:, :, 1] == 8).all(axis=1))
    upright, level = (front[house.lines.axis[front] == axis] for axis in (UP, 0))
    by_u, by_v = np.argsort(house.lines.ends[upright, 0, 0]), np.argsort(house.lines.ends[level, 0, UP])
    return [int(row) for row in (*upright[by_u[[0, -1]]], *level[by_v[[0, -1]]])]


def by_edges(house, lines=None, planes=None, surfaces=None):
    view = View(house.camera, house.rotation, house.photo)
    edit = WallByEdges(tuple(anchor(house, row) for row in front_edges(house)))
    planes = house.planes if planes is None else planes
    return wall_by_edges(edit, planes, lines or house.lines, surfaces or house.surfaces(), view)


def test_a_wall_has_the_coordinates_of_its_edges_to_the_last_digit(house):
    left, right, low, high = front_edges(house)
    found = by_edges(house)
    ends = house.lines.ends
    assert (found.surface.kind, found.surface.axis, found.surface.offset, found.apart) == ("wall", 1, 8.0, 0.0)
    assert set(found.corners[:, 0].tolist()) == {ends[left, 0, 0], ends[right, 0, 0]}
    assert set(found.corners[:, 2].tolist()) == {ends[low, 0, 2], ends[high, 0, 2]}


def test_a_told_wall_does_not_go_on_unseen(house, monkeypatch):
    asked = []

    def parts_behind(*given):
        asked.append(given)
        return {}

    monkeypatch.setattr(find, "parts_behind", parts_behind)
    edit = WallByEdges(tuple(anchor(house, row) for row in front_edges(house)))
    for faces in ((), (edit,)):
        look = Look(house.photo, None, None, faces=faces)
        find_regions(house.planes, house.lines, house.camera, house.rotation, look)
    (_, _, nothing), (labels, _, (wall,)) = asked
    assert nothing == []
    assert wall.offset == 8.0
    assert any(surface is wall for surface in labels.surfaces)


def test_a_wall_keeps_its_plane_beside_one_without_lines(house):
    bare = [Surface("wall", 1, 8.02, np.zeros(0, np.int64), None)]
    (plane,) = [plane for plane in house.planes if plane.axis == 1 and plane.offset == 8.0]
    found = by_edges(house, surfaces=bare).surface
    assert (found.plane, found.offset) == (plane.id, 8.0)
    alone = by_edges(house, planes=(), surfaces=bare).surface
    assert (alone.plane, alone.offset) == (None, 8.02)


def test_an_edge_at_another_depth_bounds_the_wall_where_the_photo_shows_it(house):
    left, *_ = front_edges(house)
    ends = house.lines.ends.copy()
    ends[left] *= 1.3
    found = by_edges(house, replace(house.lines, ends=ends))
    assert found.surface.offset == 8.0
    assert np.abs(np.sort(found.corners, axis=0) - np.sort(by_edges(house).corners, axis=0)).max() < 1e-9
    assert found.apart == pytest.approx(np.log(1.3))


def test_one_edge_in_the_model_is_enough_and_none_is_told(house):
    rows = front_edges(house)
    alone = np.setdiff1d(np.arange(len(house.lines)), rows[:3])
    found = by_edges(house, subset(house.lines, alone))
    assert np.abs(np.sort(found.corners, axis=0) - np.sort(by_edges(house).corners, axis=0)).max() < 1e-9
    without = np.setdiff1d(np.arange(len(house.lines)), rows)
    assert "none of its edges is in the model" in by_edges(house, subset(house.lines, without))


def subset(lines, rows):
    arrays = ["id", "axis", "segment", "ends", "is_boundary", "component", "confidence", "role", "by_face"]
    changed = {name: getattr(lines, name)[rows] for name in [*arrays, "by_depth_map"]}
    probability = lines.probability[rows] if len(lines.probability) else lines.probability
    return replace(lines, **changed, probability=probability, pieces=())


def test_told_ground_has_the_height_of_level_lines_on_it_else_of_feet_else_of_the_lowest_end(house):
    feet = GroundOfFeet(2.3, 5.0)
    level = (house.lines.axis != UP) & (house.lines.ends[:, 0, UP] < 0)
    heights, weight = -house.lines.ends[level, 0, UP], weights_of(house.lines)[level]
    found = ground_height(EVERYWHERE, house.lines, feet)
    assert found in heights
    assert max(weight[heights < found].sum(), weight[heights > found].sum()) <= weight.sum() / 2
    nowhere = shapely.box(0, 0, 1, 1)
    assert ground_height(nowhere, house.lines, feet) == 2.3
    assert ground_height(nowhere, house.lines, None) == -house.lines.ends[:, :, UP].min()


def test_ground_above_the_horizon_is_left_out_with_a_note(house):
    view = View(house.camera, house.rotation, house.photo)
    edit = Region(((10.0, 5.0), (200.0, 5.0), (200.0, 60.0)), "ground")
    told, _ = tell([edit], house.planes, house.lines, house.surfaces(), view, None)
    assert told.areas == ()
    assert told.notes == (IN_THE_SKY,)


def test_told_ground_becomes_a_surface_where_none_was_found(house):
    view = View(house.camera, house.rotation, house.photo)
    walls = [surface for surface in house.surfaces() if surface.kind != "ground"]
    edit = Region(((10.0, 650.0), (200.0, 650.0), (200.0, 710.0)), "ground")
    told, surfaces = tell([edit], house.planes, house.lines, walls, view, GroundOfFeet(2.0, 5.0))
    assert [(each.kind, each.offset) for each in surfaces if each.kind == "ground"] == [("ground", -2.0)]
    assert told.notes == ()
    above = replace(house.lines, ends=np.abs(house.lines.ends))
    told, surfaces = tell([edit], (), above, [], view, None)
    assert surfaces == []
    assert "nothing tells how low it is" in told.notes[0]
