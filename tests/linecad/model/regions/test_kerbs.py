"""Streets painted onto a photo by rays: a road, the face of a kerb, a pavement, whose true heights are known."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import example, given, settings
from hypothesis import strategies as st

from linecad.directions import directions_of, partner
from linecad.geometry import world_rays
from linecad.model.regions import partition
from linecad.model.regions.cuts import Borders
from linecad.model.regions.filling import Filled
from linecad.model.regions.kerbs import find_kerbs, on_kerbs
from linecad.model.regions.labels import Labels
from linecad.model.regions.lanes import ROW
from linecad.model.regions.raster import take_raster
from linecad.model.regions.segments import View
from linecad.model.regions.surfaces import Surface
from linecad.scene import Camera, Lines, Plane

CAMERA = Camera(960, 640, np.array([[800.0, 0, 479.5], [0, 800.0, 319.5], [0, 0, 1]]), "file")
PHOTO = shapely.box(-0.5, -0.5, 959.5, 639.5)
NO_LINES = np.zeros(0, np.int64)
NONE = Lines(
    NO_LINES, NO_LINES, np.zeros((0, 2, 2)), np.zeros((0, 2, 3)), np.zeros(0, bool), NO_LINES, np.zeros(0, "U9")
)
ASPHALT, STONE, SLABS, LAWN, SKY = (90, 90, 95), (130, 128, 125), (180, 178, 172), (60, 120, 40), (200, 215, 240)
STEP = 1.5 * ROW  # log height by which a kerb may be off in such a photo


def view_of(photo, pitch=0.1, yaw=0.0, turns=()):
    """A camera that looks along y, turned to the left by `yaw` and down by `pitch`, rad."""
    cosine, sine = np.cos(pitch), np.sin(pitch)
    down = np.array([[1, 0, 0], [0, cosine, -sine], [0, sine, cosine]])
    turned = np.array([[np.cos(yaw), np.sin(yaw), 0], [-np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    level = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    return View(CAMERA, down @ level @ turned, photo, turns)


def painted(view, edges, drop, colours, axis=1):
    """A photo of a street along `axis` whose kerbs stand beside the camera, at signed distances `edges`.

    The pavement is 1 below the camera, the road 1 + drop; `colours` are of road, face and pavement.
    """
    v, u = np.mgrid[0:640, 0:960].astype(float)
    axes = directions_of(view.turns)
    rays = world_rays(np.stack([u, v], axis=2), CAMERA.matrix, view.rotation)
    beside, below = rays @ axes[int(partner(axis))], -rays[..., 2]
    photo = np.empty((640, 960, 3), np.uint8)
    photo[:] = colours[0]
    for edge in edges:
        away = beside * np.sign(edge)
        photo[away * (1 + drop) > below * abs(edge)] = colours[1]
        photo[away > below * abs(edge)] = colours[2]
    photo[below <= 0] = SKY
    grain = np.random.default_rng(3).normal(0, 2, photo.shape)
    return np.clip(photo + grain, 0, 255).astype(np.uint8)


def street(edges, drop=0.08, colours=(ASPHALT, STONE, SLABS), axis=1, **pose):
    """The labels, raster and view of a photo of which all below the horizon is ground."""
    view = view_of(None, **pose)
    view = View(view.camera, view.rotation, painted(view, edges, drop, colours, axis), view.turns)
    raster = take_raster(NONE, CAMERA, view.rotation, view.photo, None, view.turns)
    return labelled(view, raster), raster, view


def labelled(view, raster, kinds=("ground",)):
    surfaces = [Surface(kind, 2, {"ground": -1.0, "ceiling": 2.0}[kind], NO_LINES, None) for kind in kinds]
    below = partition.positive_part(
        np.array(PHOTO.exterior.coords[:-1]),
        -world_rays(np.array(PHOTO.exterior.coords[:-1]), CAMERA.matrix, view.rotation)[:, 2],
    )
    cells = partition.cells_between([shapely.boundary(PHOTO), shapely.boundary(below)])
    label = np.array([0 if below.contains(cell.point_on_surface()) else len(surfaces) for cell in cells])
    cell = partition.draw(cells, raster.shape, raster.step)
    costs = np.zeros((len(cells), len(surfaces) + 2), np.int64)
    borders = Borders(np.zeros((0, 2), np.int64), np.zeros(0, np.int64))
    return Labels(surfaces, cells, cell, label, np.zeros((raster.size, len(surfaces) + 2)), costs, borders)


@settings(max_examples=12, deadline=None)
@example(distance=2.5, side=-1, drop=0.06, pitch=0.0, yaw=-0.01171875)  # its edges are nearest the least step
@given(st.floats(1.2, 3.5), st.sampled_from([-1, 1]), st.floats(0.06, 0.13), st.floats(0.0, 0.2), st.floats(-0.2, 0.2))
def test_a_kerb_is_where_it_is(distance, side, drop, pitch, yaw):
    (found,) = find_kerbs(*street([side * distance], drop, pitch=pitch, yaw=yaw - 0.3 * side))
    assert (found.along, found.side) == (1, side)
    assert found.drop == pytest.approx(np.log1p(drop), abs=STEP)
    assert found.upper == pytest.approx(np.log(distance), abs=STEP)


def test_both_sides_of_a_street_have_one():
    found = find_kerbs(*street([-2.0, 1.5]))
    assert sorted((kerb.along, kerb.side) for kerb in found) == [(1, -1.0), (1, 1.0)]


def test_a_street_of_a_turned_frame_has_one():
    (found,) = find_kerbs(*street([-2.0], axis=4, turns=(0.3,)))
    assert (found.along, found.side) == (4, -1.0)
    assert found.upper == pytest.approx(np.log(2.0), abs=STEP)


@pytest.mark.parametrize(
    ("drop", "colours"),
    [
        (0.08, (ASPHALT, STONE, ASPHALT)),  # a line on the road
        (0.08, (ASPHALT, SLABS, SLABS)),  # one edge: the road's own colour ends there
        (0.08, (LAWN, STONE, SLABS)),  # the stones about a lawn
        (0.03, (ASPHALT, STONE, SLABS)),  # a flush kerb
        (0.25, (ASPHALT, STONE, SLABS)),  # a parapet
    ],
    ids=["mark", "edge", "lawn", "flush", "high"],
)
def test_what_is_no_kerb_is_none(drop, colours):
    assert find_kerbs(*street([-2.0], drop, colours)) == []


def covered(scene, first, last, colour):
    """The scene with another colour in some columns of its photo, below the horizon."""
    labels, raster, view = scene
    photo = view.photo.copy()
    below = np.flatnonzero(np.abs(photo[:, 0].astype(int) - SKY).max(axis=1) > 30)
    photo[below[0] :, first:last] = colour
    return labels, raster, replace(view, photo=photo)


def test_a_faint_kerb_in_a_grainy_photo_is_found():
    labels, raster, view = street([-2.0], colours=(ASPHALT, STONE, (145, 143, 140)))
    grain = np.random.default_rng(5).normal(0, 16, view.photo.shape)
    noisy = replace(view, photo=np.clip(view.photo + grain, 0, 255).astype(np.uint8))
    (found,) = find_kerbs(labels, raster, noisy)
    assert found.drop == pytest.approx(np.log1p(0.08), abs=STEP)
    assert found.upper == pytest.approx(np.log(2.0), abs=STEP)


NEARLY_ASPHALT, NEARLY_SLABS = (97, 97, 102), (171, 169, 163)


@pytest.mark.parametrize(
    "colours",
    [(ASPHALT, NEARLY_ASPHALT, SLABS), (ASPHALT, NEARLY_SLABS, SLABS)],
    ids=["lower", "upper"],
)
@pytest.mark.parametrize("side", [-1, 1])
def test_one_edge_of_a_kerb_may_be_faint(colours, side):
    (found,) = find_kerbs(*street([side * 2.0], colours=colours))
    assert (found.along, found.side) == (1, side)
    assert found.drop == pytest.approx(np.log1p(0.08), abs=STEP)
    assert found.upper == pytest.approx(np.log(2.0), abs=STEP)


@pytest.mark.parametrize(
    ("distance", "drop", "colours"),
    [
        (2.0, 0.08, (SLABS, NEARLY_SLABS, ASPHALT)),  # darker behind: a shadow at the foot of a wall
        (2.0, 0.08, ((20, 20, 22), (27, 27, 29), (235, 235, 230))),  # a railing before what is sunlit
        (9.0, 0.08, (ASPHALT, NEARLY_ASPHALT, SLABS)),  # far away
        (2.0, 0.25, (ASPHALT, NEARLY_ASPHALT, SLABS)),  # too high
        (2.0, 0.08, ((70, 105, 50), (78, 113, 58), (140, 138, 132))),
    ],
    ids=["darker", "railing", "far", "high", "lawn"],
)
def test_what_has_one_faint_edge_may_be_no_kerb(distance, drop, colours):
    assert find_kerbs(*street([-distance], drop, colours, yaw=0.8 if distance > 8 else 0.0)) == []


def test_kerbs_on_both_sides_may_have_a_faint_edge_each():
    found = find_kerbs(*street([-2.0, 1.5], colours=(ASPHALT, NEARLY_ASPHALT, SLABS)))
    assert sorted((kerb.along, kerb.side) for kerb in found) == [(1, -1.0), (1, 1.0)]


@pytest.mark.parametrize("place", [0.9, 0.93, 1.07, 1.1])
@pytest.mark.parametrize("colour", [(105, 105, 110), (120, 120, 125), (170, 170, 175), (78, 78, 83)])
def test_a_line_beside_an_edge_is_no_kerb(place, colour):
    """A line that was painted on a road along its border, or a joint along that of a pavement."""
    labels, raster, view = street([-2.0], colours=(ASPHALT, SLABS, SLABS))
    first, last = (beyond(view, 2.0 * place * at) for at in (0.99, 1.01))
    band, photo = first.difference(last), view.photo.copy()
    v, u = np.mgrid[0:640, 0:960]
    photo[shapely.contains_xy(band, u, v)] = colour
    assert find_kerbs(labels, raster, replace(view, photo=photo)) == []


@pytest.mark.parametrize("hidden", [0, 150, 282])
def test_what_hides_half_of_a_pavement_hides_no_kerb(hidden):
    labels, raster, view = street([-2.0], colours=(ASPHALT, NEARLY_SLABS, SLABS))
    before = shapely.intersection(beyond(view, 2.02), shapely.box(-0.5, -0.5, hidden - 0.5, 639.5))
    cells = [cell for old in labels.cells for cell in (old.difference(before), old.intersection(before)) if cell.area]
    (below,) = (old for old, number in zip(labels.cells, labels.label, strict=True) if number == 0)
    middle = [cell.point_on_surface() for cell in cells]
    label = [
        labels.clutter if before.contains(place) else 0 if below.contains(place) else labels.sky for place in middle
    ]
    cell = partition.draw(cells, raster.shape, raster.step)
    (found,) = find_kerbs(replace(labels, cells=cells, label=np.array(label), cell=cell), raster, view)
    assert found.drop == pytest.approx(np.log1p(0.08), abs=STEP)


def test_a_faint_edge_counts_less_than_a_kerb_with_two_clear_ones():
    """A step of 12 % that is clear on one side of a street, one of 7 % with a faint edge on the other."""
    labels, raster, view = street([-2.0], 0.12)
    other = painted(view, [2.0], 0.07, (ASPHALT, NEARLY_ASPHALT, SLABS))
    rays = world_rays(np.stack(np.meshgrid(np.arange(960.0), np.arange(640.0)), axis=2), CAMERA.matrix, view.rotation)
    photo = np.where((rays[..., 0] > 0)[..., None], other, view.photo)
    (found,) = find_kerbs(labels, raster, replace(view, photo=photo))
    assert (found.side, found.drop) == (-1.0, pytest.approx(np.log1p(0.12), abs=STEP))


def test_what_parts_one_road_for_a_while_is_no_kerb():
    """Three colours, one behind the other, in less than half of the view: elsewhere the road goes on behind them."""
    scene = street([-2.0])
    assert find_kerbs(*covered(scene, 0, 240, ASPHALT)) == []
    assert len(find_kerbs(*covered(scene, 0, 60, ASPHALT))) == 1


def beyond(view, distance):
    """What of the photo shows the ground to the left of the camera, further than a distance."""
    corners = np.array(PHOTO.exterior.coords[:-1])
    rays = world_rays(corners, CAMERA.matrix, view.rotation)
    below = partition.positive_part(corners, -rays[:, 2])
    return below.intersection(partition.positive_part(corners, -rays[:, 0] + distance * rays[:, 2]))


@pytest.mark.parametrize("by_map", [True, False], ids=["a wall of a map", "a wall of lines"])
def test_a_wall_as_narrow_as_a_face_is_the_face_where_a_map_alone_shows_it(by_map):
    labels, raster, view = street([-2.0])
    strip = beyond(view, 2.0 / 1.08).difference(beyond(view, 2.0))
    box = np.array([[-2.0, -40.0, -1.08], [-2.0, 40.0, -1.0]]) if by_map else None
    wall = Surface("wall", 0, -2.0, NO_LINES, None, box)
    cells = partition.cells_between([*shapely.boundary(np.array(labels.cells, object)), shapely.boundary(strip)])
    middle = [cell.point_on_surface() for cell in cells]
    is_sky = [any(labels.cells[own].contains(each) for own in np.flatnonzero(labels.label)) for each in middle]
    label = np.where(is_sky, 2, [int(strip.contains(each)) for each in middle])
    cell = partition.draw(cells, raster.shape, raster.step)
    walled = replace(labels, surfaces=[*labels.surfaces, wall], cells=cells, cell=cell, label=label)
    assert sum(cell.area for cell, own in zip(cells, label, strict=True) if own == 1) == pytest.approx(strip.area)

    (kerb,) = find_kerbs(walled, raster, view)
    assert kerb.upper == pytest.approx(np.log(2.0), abs=STEP)
    found = on_kerbs(Filled(walled, shapely.Polygon()), (), raster, view).labels
    area = dict.fromkeys(("ground", "wall", "kerb"), 0.0)
    for cell, own in zip(found.cells, found.label, strict=True):
        if own < found.sky:
            area[found.surfaces[own].kind] += cell.area
    assert area["kerb" if by_map else "wall"] == pytest.approx(strip.area, rel=0.15)


def test_neither_a_room_nor_a_scene_without_photo_or_ground_has_one():
    labels, raster, view = street([-2.0])
    room = labelled(view, raster, ("ground", "ceiling"))
    assert find_kerbs(room, raster, view) == []
    assert find_kerbs(labels, raster, View(view.camera, view.rotation, None)) == []
    assert find_kerbs(labelled(view, raster, ("ceiling",)), raster, view) == []


@pytest.mark.parametrize("edges", [[-2.0], [-2.0, 1.5]], ids=["one side", "both sides"])
def test_ground_is_split_along_kerbs(edges):
    labels, raster, view = street(edges)
    found = on_kerbs(Filled(labels, shapely.Polygon()), (), raster, view)
    drop = found.drop
    assert drop == pytest.approx(0.08, abs=STEP)
    ground, road, *faces = found.labels.surfaces
    assert (ground.offset, road.kind, road.offset) == (-1.0, "ground", pytest.approx(-(1 + drop)))
    assert sorted(face.offset for face in faces) == pytest.approx(sorted(edges), rel=STEP)
    assert [(face.kind, face.axis) for face in faces] == [("kerb", 0)] * len(edges)
    # Each sample has the surface that the photo was painted with, but for those on a border.
    shown = np.array(["pavement", "road", *["face"] * len(edges), "sky", "clutter"])[found.labels.label]
    v, u = np.divmod(np.arange(raster.size), raster.shape[1])
    at = np.round((np.column_stack([u, v]) + 0.5) * raster.step - 0.5).astype(int)
    colour = view.photo[np.minimum(at[:, 1], 639), np.minimum(at[:, 0], 959)].astype(int)
    names = {"road": ASPHALT, "face": STONE, "pavement": SLABS, "sky": SKY}
    nearest = np.argmin([np.abs(colour - each).sum(axis=1) for each in names.values()], axis=0)
    assert (np.array([*names])[nearest] == shown[found.labels.cell]).mean() > 0.985
    assert shapely.union_all(found.labels.cells).symmetric_difference(PHOTO).area < 1e-3
    assert found.notes[-1].startswith("faces: a kerb puts the road ")


@pytest.mark.parametrize(("height", "taken"), [(-1.09, True), (-1.2, False)])
def test_a_level_plane_of_lines_at_the_road_is_the_road(height, taken):
    labels, raster, view = street([-2.0])
    levels = (Plane(4, 2, height, (7, 8)), Plane(5, 2, 1.09, (9,)), Plane(6, 0, -1.09, (10,)))
    found = on_kerbs(Filled(labels, shapely.Polygon()), levels, raster, view)
    road = found.labels.surfaces[1]
    assert (road.plane, road.offset == height) == ((4, True) if taken else (None, False))
    assert found.drop == pytest.approx(-road.offset - 1)
    # Face and road share the line in which they meet, wherever the road has its height from.
    regions = dict(found.labels.regions)
    border = max(shapely.get_parts(shapely.intersection(regions[1], regions[2])), key=shapely.length)
    inner = shapely.get_coordinates(shapely.line_interpolate_point(border, [0.2, 0.5, 0.8], normalized=True))
    rays, face = world_rays(inner, CAMERA.matrix, view.rotation), found.labels.surfaces[2]
    np.testing.assert_allclose(rays * (face.offset / rays[:, :1]), rays * (road.offset / rays[:, 2:]), atol=1e-3)


def test_ground_without_a_kerb_stays():
    labels, raster, view = street([])
    filled = Filled(labels, shapely.Polygon())
    assert on_kerbs(filled, (), raster, view) is filled
    assert len(filled.notes) == 1
