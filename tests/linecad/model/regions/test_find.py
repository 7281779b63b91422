"""All stages together, from lines and a picture to what every part of it shows."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
import shapely

from linecad.corrections.edits import Region
from linecad.depth.depth_map import DepthMap
from linecad.depth.normals import Normals
from linecad.geometry import project, world_rays
from linecad.model.faces import find_faces
from linecad.model.regions import find
from linecad.model.regions.evidence import NEVER, TURNED_COST
from linecad.model.regions.find import Look, find_regions
from linecad.model.regions.heaven import Heaven
from linecad.model.regions.mapped import MappedDepths
from linecad.model.regions.roofs import Sketch
from linecad.model.regions.surfaces import (
    GroundOfFeet,
    find_surfaces,
    find_walls,
    is_contested,
    level_of_ends,
    likely_grounds,
)
from linecad.scene import Lines, Plane


def surfaces(found):
    return {(surface.kind, surface.axis, surface.offset) for surface in found.labels.surfaces}


def of_axis(found, axis):
    """The region of the one surface of an axis."""
    (number,) = [row for row, surface in enumerate(found.labels.surfaces) if surface.axis == axis]
    return shapely.union_all([region for own, region in found.labels.regions if own == number])


def raster_of(region, shape):
    """The pixels (H, W) whose centres are in a region."""
    v, u = np.indices(shape)
    return shapely.contains_xy(region, u, v)


def test_the_photo_tells_walls_from_ground_and_sky(house_regions):
    assert surfaces(house_regions) == {("wall", 0, 2.0), ("wall", 1, 8.0), ("ground", 2, -2.0)}
    labels = house_regions.labels
    assert (labels.label == labels.sky).any()
    assert sum(region.area for _, region in labels.regions) == pytest.approx(960 * 720)


@pytest.mark.parametrize("axis", [0, 1])
def test_a_wall_is_one_region_with_four_corners(house, house_regions, axis):
    wall = of_axis(house_regions, axis)
    assert len(shapely.get_coordinates(wall)) - 1 == 4
    assert wall.area == pytest.approx((house.truth == axis).sum(), rel=0.01)


def test_a_tree_before_the_house_takes_no_part_of_its_walls(house, house_regions, make_house):
    look = Look(make_house([np.array([(600, 350), (660, 340), (670, 600), (595, 610)], float)]).photo, None, None)
    found = find_regions(house.planes, house.lines, house.camera, house.rotation, look)
    for axis in (0, 1):
        wall = of_axis(house_regions, axis)
        assert of_axis(found, axis).symmetric_difference(wall).area < 0.01 * wall.area


def test_the_feet_of_walls_put_the_ground(house):
    look = Look(house.photo, GroundOfFeet(2.3, 5.0), None)
    assert ("ground", 2, -2.3) in surfaces(find_regions(house.planes, house.lines, house.camera, house.rotation, look))


def misplaced(lines, rows, factor):
    """The lines, with some of them where nothing in the photo tells them apart from themselves, farther or nearer."""
    ends = lines.ends.copy()
    ends[rows] *= factor
    return replace(lines, ends=ends)


def ground_of(house, lines, planes, feet):
    found = find_regions(planes, lines, house.camera, house.rotation, Look(house.photo, feet, None))
    return [-offset for kind, _, offset in surfaces(found) if kind == "ground"]


@pytest.fixture(scope="module")
def astray(house):
    """The lines of the house with a body 2.5 times too far, which ends far below the ground; planes of the rest."""
    windows = np.flatnonzero(house.lines.ends[:, :, 0].max(axis=1) > 2.1)
    return misplaced(house.lines, windows, 2.5), tuple(plane for plane in house.planes if plane.axis == 0)


def grounds_of(house, lines, planes, feet):
    return likely_grounds(find_walls(planes, lines, house.camera), lines, replace(feet, is_open=True))


@pytest.mark.parametrize("log_odds", [1.0, 5.0])
def test_the_photo_tells_feet_from_lines_of_misplaced_bodies_that_contradict_them(house, astray, log_odds):
    """Their walls would show what is floor in the photo."""
    feet = GroundOfFeet(2.0, log_odds)
    assert is_contested(grounds_of(house, *astray, feet))
    assert ground_of(house, *astray, feet) == [2.0]


def test_lines_that_contradict_feet_outweigh_what_labels_gain_by_little(house, astray, monkeypatch):
    """Seen alone, the labels of this photo would have the ground of the feet (above)."""
    monkeypatch.setattr(find, "PER_PHOTO", 1.0)
    assert ground_of(house, *astray, GroundOfFeet(2.0, 1.0)) == [pytest.approx(5.0)]


def test_feet_that_lines_contradict_are_wrong_where_the_photo_fits_the_lines(house):
    feet = GroundOfFeet(0.9, 5.0)
    assert is_contested(grounds_of(house, house.lines, house.planes, feet))
    assert ground_of(house, house.lines, house.planes, feet) == [2.0]


def test_what_a_person_tells_elsewhere_leaves_the_ground(house, astray):
    for top in (545.0, 540.0, 535.0):
        bottom = Region(((0.0, top), (960.0, top), (960.0, 719.0), (0.0, 719.0)), "clutter")
        lines, planes = astray
        look = Look(house.photo, GroundOfFeet(2.0, 1.0), None, faces=(bottom,))
        found = surfaces(find_regions(planes, lines, house.camera, house.rotation, look))
        assert [-offset for kind, _, offset in found if kind == "ground"] == [2.0]


def test_the_ground_is_a_level_of_lines_that_shows_more_of_the_photo(make_house):
    """Feet below the level that the floor's own lines show would make two floors of it."""
    paving = [(1, np.array([[x, 4.5, -2.0], [x, 30.0, -2.0]])) for x in np.linspace(-3, 2, 12)]
    paving += [(0, np.array([[-3.0, y, -2.0], [2.0, y, -2.0]])) for y in np.linspace(4.5, 16, 16)]
    house, feet = make_house(edges_too=paving), GroundOfFeet(2.6, 1.0)
    assert ("level", 2, -2.0) in {(each.kind, each.axis, each.offset) for each in house.surfaces(feet)}
    assert not is_contested(grounds_of(house, house.lines, house.planes, feet))
    assert ground_of(house, house.lines, house.planes, feet) == [2.0]


def test_where_no_ground_is_seen_the_first_one_stays(house, monkeypatch):
    tried, stand_on = [], find._Sight.stand_on

    def counted(sight, ground):
        tried.append(ground.height)
        return stand_on(sight, ground)

    monkeypatch.setattr(find._Sight, "stand_on", counted)
    feet = GroundOfFeet(2.2, 5.0)
    assert ground_of(house, house.lines, house.planes, feet) == [2.2]
    assert tried == [2.2], "it is seen, and nothing contradicts it"
    monkeypatch.setattr(find, "SEEN", 0.9)  # of the photo
    assert ground_of(house, house.lines, house.planes, feet) == [2.2]
    assert tried == [2.2, 2.2, 2.0]


@pytest.mark.parametrize(
    ("feet", "width", "height"),
    [(1.86, 0.02, 2.0), (1.86, 0.05, 1.86), (1.95, 0.02, 1.95), (2.1, 0.02, 2.1)],
    ids=["a kerb higher", "by a coarse map", "hardly higher", "lower"],
)
def test_an_exact_map_shows_the_road_below_a_kerb_that_is_hidden(house, feet, width, height):
    v, u = np.mgrid[:720, :960].astype(float)
    rays = world_rays(np.stack([u, v], axis=2), house.camera.matrix, house.rotation)
    depth = np.zeros((720, 960), np.float32)
    for axis, offset in ((0, 2.0), (1, 8.0), (2, -2.0)):
        own = house.truth == axis
        depth[own] = offset / rays[own][:, axis]
    seen = MappedDepths(DepthMap("map.npz", depth, depth > 0, "z"), "z", 0.0, 1.0, house.camera.matrix, 0.02, width)
    look = Look(house.photo, GroundOfFeet(feet, 12.0), None, mapped=seen)
    found = find_regions(house.planes, house.lines, house.camera, house.rotation, look)
    assert [-offset for kind, _, offset in surfaces(found) if kind == "ground"] == pytest.approx([height], rel=0.01)
    said = [note for note in found.notes if "no kerb is seen" in note]
    assert len(said) == (height != feet)
    assert all(float(note.split("has it, ")[1].split("%")[0]) == pytest.approx(7.5, abs=0.3) for note in said)


def test_what_a_person_tells_elsewhere_leaves_the_ground_that_a_map_lowered(house):
    v, u = np.mgrid[:720, :960].astype(float)
    rays = world_rays(np.stack([u, v], axis=2), house.camera.matrix, house.rotation)
    ground = house.truth == 2
    depth = np.where(ground, -2.0 / np.where(ground, rays[..., 2], 1.0), 0.0).astype(np.float32)
    seen = MappedDepths(DepthMap("map.npz", depth, depth > 0, "z"), "z", 0.0, 1.0, house.camera.matrix, 0.02, 0.02)
    clutter = Region(((20.0, 640.0), (120.0, 640.0), (120.0, 700.0), (20.0, 700.0)), "clutter")
    for faces in ((), (clutter,)):
        look = Look(house.photo, GroundOfFeet(1.86, 12.0), None, mapped=seen, faces=faces)
        found = surfaces(find_regions(house.planes, house.lines, house.camera, house.rotation, look))
        assert [-offset for kind, _, offset in found if kind == "ground"] == pytest.approx([2.0], rel=0.01)


def test_normals_of_a_depth_map_are_looked_at(house, house_regions):
    vectors = np.empty((720, 960, 3))
    vectors[:] = -house.rotation[:, 0]
    look = Look(house.photo, None, Normals(vectors))
    labels = find_regions(house.planes, house.lines, house.camera, house.rotation, look).labels
    more = labels.of_samples - house_regions.labels.of_samples
    for number, surface in enumerate(labels.surfaces):
        seen = house_regions.labels.of_samples[:, number] < NEVER
        assert more[seen, number] == pytest.approx(0.0 if surface.axis == 0 else TURNED_COST)


def test_a_scene_without_planes_has_no_walls(house):
    found = find_regions((), house.lines, house.camera, house.rotation, Look(house.photo, None, None))
    assert surfaces(found) == {("ground", 2, -2.0)}


def test_a_painted_roof_is_found_and_cut_out_of_the_wall(house, house_regions):
    """Painted over the front of the house; nothing but the sketch tells of its ends."""
    (row,) = (
        number for number, ends in enumerate(house.lines.ends)
        if house.lines.axis[number] == 0 and (ends[:, 1] == 8).all() and ends[0, 2] == house.lines.ends[..., 2].max()
    )  # fmt: skip
    low = house.lines.ends[row]
    corners = np.array([low[0], low[0] + [0, 3, 2.5], low[1] + [0, 3, 2.5], low[1]])
    pixels = project(corners, house.camera.matrix, house.rotation)
    photo = house.photo.copy()
    cv2.fillPoly(photo, [np.rint(pixels).astype(np.int32)], (120, 50, 40))
    ridge = pixels[[1, 2]]
    raw = np.concatenate([house.lines.segment, [ridge, pixels[[0, 1]], pixels[[2, 3]]]])
    whole, axis = np.array([*house.lines.segment, ridge]), np.array([*house.lines.axis, 0])
    look = Look(photo, None, None, Sketch(raw, whole, axis))
    found = find_regions(house.planes, house.lines, house.camera, house.rotation, look)
    (roof,) = found.roofs
    assert (roof.axis, roof.is_told) == (1, True)
    assert np.degrees(roof.slope) == pytest.approx(np.degrees(np.arctan2(2.5, 3)), abs=3)
    planes = find_faces(house.planes, house.lines, found, house.camera, house.rotation)
    rings = [face.outline for plane in planes for face in plane.faces]
    seen = [shapely.Polygon(project(ring, house.camera.matrix, house.rotation)) for ring in rings]
    assert max(area.intersection(roof.polygon).area for area in seen) < 1
    assert house_regions.roofs == ()


def below_a_ceiling(raster):
    return Heaven(np.zeros(raster.size, bool), is_sky=False, is_ceiling=True)


@pytest.fixture
def silent(house):
    """What a depth map says that knows nothing."""
    nothing = np.zeros(house.photo.shape[:2], np.float32)
    return MappedDepths(DepthMap("map.npz", nothing, nothing > 0, "z"), "z", 0.0, 1.0, house.camera.matrix, 0.02)


def test_a_plain_wall_of_a_room_stands_on_its_skirting(house, silent, monkeypatch):
    """Of the side nothing is left but its foot, before a wall that ends the room."""
    foot = ((2.0, 8.0, -2.0), (2.0, 16.0, -2.0))
    corners = [(-3.0, 16.0, -2.0), (2.0, 16.0, -2.0), (2.0, 16.0, 1.5), (-3.0, 16.0, 1.5)]
    ends = np.array([foot, *zip(corners, [*corners[1:], corners[0]], strict=True)])
    lines = Lines(
        id=np.arange(5), axis=np.array([1, 0, 2, 0, 2]), segment=project(ends, house.camera.matrix, house.rotation),
        ends=ends, is_boundary=np.zeros(5, bool), component=np.zeros(5, int), confidence=np.full(5, "proven"),
    )  # fmt: skip
    planes = (Plane(0, 1, 16.0, (1, 2, 3, 4)),)

    def wall(mapped=None):
        look = Look(house.photo, None, None, mapped=mapped)
        found = find_regions(planes, lines, house.camera, house.rotation, look)
        return of_axis(found, 0) if 0 in {surface.axis for surface in found.labels.surfaces} else None

    assert wall() is None  # below the sky
    monkeypatch.setattr(find, "look_up", below_a_ceiling)
    side = house.truth == 0
    for mapped in (None, silent):  # a map need not show it
        shown = raster_of(wall(mapped), side.shape)
        assert shown[side].mean() > 0.9


def test_heads_put_the_ceiling_above_the_ends_of_lines_where_no_map_shows_it(house, silent, monkeypatch):
    asked = []

    def with_ceiling(walls, ground, ceiling):
        asked.append(ceiling)
        return find_surfaces(walls, ground, ceiling)

    monkeypatch.setattr(find, "look_up", below_a_ceiling)
    monkeypatch.setattr(find, "find_surfaces", with_ceiling)
    ends = level_of_ends(house.lines, above=True)
    for told, mapped in ((None, None), (ends / 2, None), (2 * ends, None), (2 * ends, silent)):
        look = Look(house.photo, None, None, mapped=mapped, height_of_ceiling=lambda told=told: told)
        find_regions(house.planes, house.lines, house.camera, house.rotation, look)
    assert asked == [ends, ends, 2 * ends, ends]


@pytest.mark.parametrize(("is_seen", "is_mapped"), [(True, False), (False, False), (True, True)])
def test_a_blank_wall_outdoors_stands_on_its_foot(is_seen, is_mapped, house, house_regions, silent):
    """Where a line along it is seen, and no map shows it; its place was sky and clutter."""
    corners = np.array([[-3.0, 10.0, -2.0], [0.5, 10.0, -2.0], [0.5, 10.0, 2.5], [-3.0, 10.0, 2.5]])
    shape = project(corners, house.camera.matrix, house.rotation)
    photo = house.photo.copy()
    cv2.fillPoly(photo, [np.rint(shape).astype(np.int32)], (150, 70, 55))
    whole = shape[None, :2] if is_seen else np.zeros((0, 2, 2))
    sketch = Sketch(whole, whole, np.zeros(len(whole), np.int64))
    look = Look(photo, None, None, sketch, mapped=silent if is_mapped else None)
    found = find_regions(house.planes, house.lines, house.camera, house.rotation, look)
    more = {(kind, axis, round(offset, 6)) for kind, axis, offset in surfaces(found) - surfaces(house_regions)}
    assert more == ({("wall", 1, 10.0)} if is_seen else set())
    middle = shapely.Point(shape.mean(axis=0))
    (shown,) = [own for own, region in found.labels.regions if region.contains(middle)]
    assert (shown < found.labels.sky) == is_seen
