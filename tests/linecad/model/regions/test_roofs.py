"""Roofs of made houses in painted photos: where they are, how they slope, and what is none."""

from dataclasses import dataclass, replace

import cv2
import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from linecad.directions import directions_of
from linecad.geometry import central_camera, project
from linecad.model.faces import find_faces, with_roofs
from linecad.model.regions import partition
from linecad.model.regions.bearings import Bearing
from linecad.model.regions.cuts import Borders
from linecad.model.regions.filling import Filled
from linecad.model.regions.heaven import Heaven
from linecad.model.regions.labels import Labels
from linecad.model.regions.profiles import Shown, Wall, about_upright
from linecad.model.regions.raster import take_raster
from linecad.model.regions.roofs import Sketch, find_roofs, notes_on
from linecad.model.regions.segments import View
from linecad.model.regions.slopes import ERROR, SPREAD, USUAL, Edge, Slope, slope_of, slopes_by
from linecad.model.regions.surfaces import Surface
from linecad.scene import Camera, Lines, Plane

WIDTH, HEIGHT = 960, 720
CAMERA = Camera(WIDTH, HEIGHT, central_camera(700.0, WIDTH, HEIGHT), "file")
DISTANCE, EAVE, GROUND, LEFT, RIGHT, RUN = 20.0, 3.0, -2.0, -6.0, 9.0, 5.0  # m
SEEN = 0.1  # rad, of which the camera looks past the house
SKY, TILES, PLASTER, PAVING = (200, 220, 245), (110, 50, 40), (205, 195, 170), (90, 90, 95)
HIP = ERROR["hip"]
NO_LINES = Lines(
    id=np.zeros(0, int), axis=np.zeros(0, int), segment=np.zeros((0, 2, 2)), ends=np.zeros((0, 2, 3)),
    is_boundary=np.zeros(0, bool), component=np.zeros(0, int), confidence=np.zeros(0, "U9"),
)  # fmt: skip


def turned(turn):
    c, s = np.cos(turn), np.sin(turn)
    return np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]) @ [[c, -s, 0], [s, c, 0], [0, 0, 1]]


@dataclass(frozen=True, eq=False)
class Made:
    """A house in a painted photo."""

    rotation: np.ndarray
    corners: np.ndarray  # (4, 3) of the roof: left eave, left ridge, right ridge, right eave
    pixels: np.ndarray  # (4, 2) of these
    photo: np.ndarray
    labels: Labels  # which call the roof a part of the wall
    seed: np.ndarray
    sketch: Sketch

    @property
    def view(self):
        return View(CAMERA, self.rotation, self.photo)

    def found(self, **changes):
        """The roofs, with something changed."""
        made = replace(self, **changes)
        raster = take_raster(NO_LINES, CAMERA, made.rotation, made.photo)
        heaven = Heaven(made.seed, is_sky=bool(made.seed.any()), is_ceiling=False)
        return find_roofs(made.sketch, made.labels, heaven, raster, made.view)


def build(degrees=40.0, hips=False, reach=(LEFT, RIGHT), colours=(TILES, PLASTER), top=None, turn=0.0, pitch=0.0):
    """A house whose roof ends in verges or hips, or by the roof's corners `top` (2, 3) at the ridge.

    It is turned by `turn`, rad, from the wall that it is labelled as, about the upright through its middle. The camera
    looks up by `pitch`, rad.
    """
    c, s = np.cos(pitch), np.sin(pitch)
    rotation, rise = np.array([[1, 0, 0], [0, c, s], [0, -s, c]]) @ turned(SEEN), RUN * np.tan(np.radians(degrees))
    inwards = RUN if hips else 0.0
    left, right = reach
    if top is None:
        top = [[left + inwards, DISTANCE + RUN, EAVE + rise], [right - inwards, DISTANCE + RUN, EAVE + rise]]
    corners = np.array([[left, DISTANCE, EAVE], *top, [right, DISTANCE, EAVE]])
    feet = np.array([[right, DISTANCE, GROUND], [left, DISTANCE, GROUND]])
    middle = np.array([(left + right) / 2, DISTANCE, 0.0])
    corners, feet = (middle + (each - middle) @ about_upright(turn).T for each in (corners, feet))
    pixels, feet = project(corners, CAMERA.matrix, rotation), project(feet, CAMERA.matrix, rotation)
    frame = shapely.box(-0.5, -0.5, WIDTH - 0.5, HEIGHT - 0.5)
    roof, wall = shapely.Polygon(pixels), shapely.Polygon([pixels[0], pixels[3], *feet])
    house = shapely.union_all([roof, wall]).intersection(frame)
    horizon = project(np.array([[-3.0, 10, 0], [3.0, 10, 0]]), CAMERA.matrix, rotation)[:, 1].mean()
    below = shapely.box(-0.5, horizon, WIDTH - 0.5, HEIGHT - 0.5).difference(house)
    cells = [house, below, frame.difference(house).difference(below)]
    photo = np.full((HEIGHT, WIDTH, 3), SKY, np.uint8)
    for shape, colour in ((below, PAVING), (wall, colours[1]), (roof, colours[0])):
        for part in partition.polygons_of(shape):
            cv2.fillPoly(photo, [np.rint(shapely.get_coordinates(part.exterior)).astype(np.int32)], colour)
    raster = take_raster(NO_LINES, CAMERA, rotation, photo)
    flat = [part for cell in cells for part in partition.polygons_of(cell)]
    label = np.array([number for number, cell in enumerate(cells) for _ in partition.polygons_of(cell)])
    none = np.zeros(0, np.int64)
    surfaces = [Surface("wall", 1, DISTANCE, none, 0), Surface("ground", 2, GROUND, none, None)]
    costs = np.zeros((len(flat), 4), np.int64)
    borders = Borders(np.zeros((0, 2), np.int64), np.zeros(0, np.int64))
    cell = partition.draw(flat, raster.shape, raster.step)
    labels = Labels(surfaces, flat, cell, label, np.zeros((raster.size, 4)), costs, borders)
    level, ends = pixels[[[0, 3], [1, 2]]], pixels[[[0, 1], [3, 2]]]
    sketch = Sketch(np.concatenate([level, ends]), level[:1], np.array([0]))
    return Made(rotation, corners, pixels, photo, labels, (label == 2)[cell], sketch)


@pytest.fixture(scope="module")
def made():
    return build()


def told(*degrees):
    """The slope that so many ends and what is usual tell together, degrees, where all ends are seen equally well."""
    weight = np.array([SPREAD**-2, *(len(degrees) * [HIP**-2])])
    return weight @ [np.degrees(USUAL), *degrees] / weight.sum()


@pytest.mark.parametrize("hips", [False, True])
@pytest.mark.parametrize("degrees", [35.0, 50.0])
def test_a_roof_has_its_place_and_its_slope(degrees, hips):
    made = build(degrees, hips)
    (roof,) = made.found()
    truth = shapely.Polygon(made.pixels)
    assert roof.polygon.intersection(truth).area > 0.95 * roof.polygon.union(truth).area
    assert roof.is_told
    if hips:
        assert np.degrees(roof.slope) == pytest.approx(told(degrees, degrees), abs=1.0)
    else:  # verges tell it better
        assert np.degrees(roof.slope) == pytest.approx(degrees, abs=1.0)
    assert roof.eave[1:] == pytest.approx([DISTANCE, EAVE], rel=1e-6)


@given(
    st.floats(25, 60), st.floats(-0.4, 0.4), st.sampled_from(["verge", "hip", "valley"]), st.sampled_from([1.0, -1.0])
)
def test_each_end_tells_its_slope_exactly(made, degrees, turn, end, inwards):
    rotation, along = turned(turn), {"verge": 0.0, "hip": inwards, "valley": -inwards}[end]
    foot = np.array([2.0, DISTANCE, EAVE])
    top = foot + 4.0 * np.array([along, 1.0, np.tan(np.radians(degrees))])
    pixels = project(np.stack([foot, top]), CAMERA.matrix, rotation)
    shown = Shown(take_raster(NO_LINES, CAMERA, rotation, None), View(CAMERA, rotation, None), made.labels, made.seed)
    wall = Wall(1, DISTANCE, np.array([0.0, 1, 0]), (0,), np.zeros((1, 1), bool))
    edge = Edge(*pixels, inwards, Bearing(0.0, 0.0), is_free=True)
    (slope,) = slopes_by(edge, wall, shown, (end,))
    assert np.degrees(slope.angle) == pytest.approx(degrees, abs=1e-6)
    (other,) = slopes_by(replace(edge, is_free=False), wall, shown, (end,))
    assert other.angle == slope.angle
    if end != "verge":
        assert other.error == slope.error
    elif abs(pixels[1, 0] - pixels[0, 0]) > 1:  # a wall that cuts it off may be turned
        assert other.error > slope.error


@pytest.mark.parametrize("turn", [-6.0, 5.0])
def test_a_house_is_turned_from_the_frame_that_it_was_given(turn):
    """By 2 or 3 degrees of slope for each, if the eave did not tell."""
    made = build(50.0, turn=np.radians(turn))
    (roof,) = made.found()
    assert roof.is_told
    assert np.degrees(roof.slope) == pytest.approx(50.0, abs=1.0)
    truth = shapely.Polygon(made.pixels)
    assert roof.polygon.intersection(truth).area > 0.9 * roof.polygon.union(truth).area


@pytest.mark.parametrize(
    ("quarters", "off", "axis"),
    [(0, 0.0, 1), (1, 0.0, 0), (2, 0.0, 1), (3, 0.0, 0), (0, 0.3, 4), (1, 0.3, 3), (2, 0.3, 4)],
)
def test_a_roof_is_the_same_along_every_axis(quarters, off, axis):
    """The world turned about the upright, so that the wall is another axis's, before or behind the middle."""
    made, turns = build(50.0, turn=np.radians(4.0)), (off,) if off else ()
    world = about_upright(quarters * np.pi / 2 + off)
    rotation = made.rotation @ world.T
    normal = world @ [0.0, 1.0, 0.0]
    offset = DISTANCE * float(np.sign(normal @ directions_of(turns)[axis]))
    labels = replace(
        made.labels, surfaces=[replace(made.labels.surfaces[0], axis=axis, offset=offset), made.labels.surfaces[1]]
    )
    raster = take_raster(NO_LINES, CAMERA, rotation, made.photo, None, turns)
    along = {1: 0, 0: 1, 3: 4, 4: 3}[axis]
    sketch = replace(made.sketch, axis=np.array([along]))
    heaven = Heaven(made.seed, is_sky=True, is_ceiling=False)
    (roof,) = find_roofs(sketch, labels, heaven, raster, View(CAMERA, rotation, made.photo, turns))
    (same,) = made.found()
    assert (roof.axis, roof.is_told) == (axis, True)
    assert roof.normal(turns) == pytest.approx(world @ same.normal(()), abs=1e-6)
    assert roof.eave == pytest.approx(world @ same.eave, rel=1e-6)
    assert roof.polygon.symmetric_difference(same.polygon).area < 1e-3 * same.polygon.area


def _before(made, left, right):
    """The labels with something else before the wall, down from the eave, from one place along it to another, m."""
    corners = [[left, DISTANCE, EAVE], [right, DISTANCE, EAVE], [right, DISTANCE, GROUND], [left, DISTANCE, GROUND]]
    hidden = shapely.Polygon(project(np.array(corners), CAMERA.matrix, made.rotation))
    cells = [
        (new, part)
        for number, cell in zip(made.labels.label.tolist(), made.labels.cells, strict=True)
        for new, shape in ((number, cell.difference(hidden)), (3, cell.intersection(hidden)))
        for part in partition.polygons_of(shape, 1.0)
    ]
    raster = take_raster(NO_LINES, CAMERA, made.rotation, made.photo)
    flat = [part for _, part in cells]
    label = np.array([number for number, _ in cells])
    return replace(made.labels, cells=flat, label=label, cell=partition.draw(flat, raster.shape, raster.step))


@pytest.mark.parametrize("right", [2.0, 5.0])
def test_a_roof_is_seen_above_what_hides_most_of_its_wall(right):
    made = build(50.0)
    (roof,) = made.found(labels=_before(made, LEFT, right))
    assert roof.is_told
    assert np.degrees(roof.slope) == pytest.approx(50.0, abs=1.0)


def _with_tower(made, left, right, upright):
    """A house with a tower on its wall, 2 % before it and as high as its ridge, and an upright of that, (2,) heights.

    The tower reaches from one place along the wall to another, m; its upright is its right edge.
    """
    top = float(made.corners[1, 2])
    low = EAVE - 0.6  # below that something else hides it
    corners = [[left, DISTANCE, top], [right, DISTANCE, top], [right, DISTANCE, low], [left, DISTANCE, low]]
    tower = shapely.Polygon(project(np.array(corners), CAMERA.matrix, made.rotation))
    cells = [(0, 0), (1, 1), (2, 3)]  # labels without and with one more surface
    shapes = [(new, part) for old, new in cells
              for cell in np.array(made.labels.cells, object)[made.labels.label == old]
              for part in partition.polygons_of(cell.difference(tower), 1.0)] + [(2, tower)]  # fmt: skip
    flat, label = [part for _, part in shapes], np.array([number for number, _ in shapes])
    photo = made.photo.copy()
    cv2.fillPoly(photo, [np.rint(shapely.get_coordinates(tower.exterior)).astype(np.int32)], PLASTER)
    raster = take_raster(NO_LINES, CAMERA, made.rotation, photo)
    before = Surface("wall", 1, 0.98 * DISTANCE, np.zeros(0, np.int64), 1)
    surfaces = [*made.labels.surfaces, before]
    cell = partition.draw(flat, raster.shape, raster.step)
    labels = replace(made.labels, surfaces=surfaces, cells=flat, label=label, cell=cell)
    edge = project(np.array([[[right, DISTANCE, height] for height in upright]]), CAMERA.matrix, made.rotation)
    sketch = replace(made.sketch, whole=np.concatenate([made.sketch.whole, edge]), axis=np.array([0, 2]))
    return tower, replace(made, photo=photo, labels=labels, seed=(label == 3)[cell], sketch=sketch)


@pytest.mark.parametrize(
    ("upright", "walls"),
    [
        ((GROUND, EAVE + 1.8), (0,)),
        ((EAVE + 1.8, GROUND), (0,)),
        ((GROUND, EAVE + 0.5), (0, 2)),  # not far above the eave
        ((EAVE - 0.5, EAVE + 1.8), (0, 2)),  # nor below
    ],
)
@pytest.mark.parametrize("pitch", [0.0, 10.0])
def test_a_tower_a_little_before_a_wall_goes_on_above_its_eave(upright, walls, pitch):
    tower, made = _with_tower(build(50.0, pitch=np.radians(pitch)), -1.0, 1.0, upright)
    roofs = made.found()
    assert len(roofs) == 2  # on both sides of the tower
    assert {roof.walls for roof in roofs} == {walls}
    for roof in roofs:
        assert shapely.intersection(roof.polygon, tower).area < 0.01 * tower.area


@pytest.mark.parametrize(("at", "walls"), [(4.0, (0,)), (6.0, (0, 2))])
def test_a_lamp_before_a_part_of_a_wall_is_no_edge_of_it(at, walls):
    """The wall is in two parts, one 2 % before the other, with one roof; its upright is where they meet, or before."""
    made = build(50.0)
    part = shapely.box(project(np.array([[4.0, DISTANCE, 0.0]]), CAMERA.matrix, made.rotation)[0, 0], 0, WIDTH, HEIGHT)
    cells = [(0, made.labels.cells[0].difference(part)), (2, made.labels.cells[0].intersection(part))]
    others = zip(made.labels.label.tolist(), made.labels.cells, strict=True)
    cells += [(number if number < 2 else 3, cell) for number, cell in others if number > 0]
    raster = take_raster(NO_LINES, CAMERA, made.rotation, made.photo)
    flat, label = [cell for _, cell in cells], np.array([number for number, _ in cells])
    surfaces = [*made.labels.surfaces, Surface("wall", 1, 0.98 * DISTANCE, np.zeros(0, np.int64), 1)]
    cell = partition.draw(flat, raster.shape, raster.step)
    labels = replace(made.labels, surfaces=surfaces, cells=flat, label=label, cell=cell)
    upright = project(np.array([[[at, DISTANCE, GROUND], [at, DISTANCE, EAVE + 4]]]), CAMERA.matrix, made.rotation)
    sketch = replace(made.sketch, whole=np.concatenate([made.sketch.whole, upright]), axis=np.array([0, 2]))
    (roof,) = made.found(labels=labels, sketch=sketch)
    assert roof.walls == walls


def test_what_an_end_is_follows_from_the_other_end():
    left = [Slope(np.radians(30), HIP, "verge"), Slope(np.radians(50), HIP, "hip")]
    right = [Slope(np.radians(31), HIP, "verge"), Slope(np.radians(62), HIP, "hip")]
    assert np.degrees(slope_of(left, right)) == pytest.approx(told(30, 31))
    assert np.degrees(slope_of(left, [])) == pytest.approx(told(50))
    assert slope_of([], []) is None


def test_a_roof_whose_ends_the_photo_does_not_show_has_the_usual_slope_and_says_so():
    made = build(reach=(-40.0, 40.0))
    made = replace(made, sketch=replace(made.sketch, raw=made.sketch.raw[:2]))
    (roof,) = made.found()
    assert not roof.is_told
    assert roof.slope == USUAL
    assert notes_on([roof, roof]) == (
        "faces: 2 roofs are given a usual slope of 45 degrees: the photo shows no end of it that would tell",
    )
    assert notes_on([replace(roof, is_told=True)]) == ()
    reach = roof.polygon.bounds
    assert (reach[0], reach[2]) == pytest.approx((-0.5, WIDTH - 0.5))


def _with_roofs(made, *roofs):
    """The photo with other things than its roof above the wall, by corners (4, 3) m and colours, and level lines alone.

    All are labelled as the wall.
    """
    photo, house = made.photo.copy(), shapely.Polygon([*made.pixels[[0, 3]], *_feet(made)])
    cv2.fillPoly(photo, [np.rint(made.pixels).astype(np.int32)], SKY)
    level = [made.sketch.raw[0]]
    for corners, colour in roofs:
        pixels = project(np.array(corners), CAMERA.matrix, made.rotation)
        cv2.fillPoly(photo, [np.rint(pixels).astype(np.int32)], colour)
        house = shapely.union_all([house, shapely.Polygon(pixels).buffer(1e-3)])
        level.append(pixels[1:3])
    front = np.array([*made.pixels[[0, 3]], *_feet(made)])
    cv2.fillPoly(photo, [np.rint(front).astype(np.int32)], PLASTER)
    frame = shapely.box(-0.5, -0.5, WIDTH - 0.5, HEIGHT - 0.5)
    house = house.intersection(frame)
    below = made.labels.cells[1].difference(house)
    cells = [(number, part) for number, cell in enumerate((house, below, frame.difference(house).difference(below)))
             for part in partition.polygons_of(cell)]  # fmt: skip
    raster = take_raster(NO_LINES, CAMERA, made.rotation, photo)
    label, flat = np.array([number for number, _ in cells]), [part for _, part in cells]
    cell = partition.draw(flat, raster.shape, raster.step)
    labels = replace(made.labels, cells=flat, label=label, cell=cell)
    return replace(
        made, photo=photo, labels=labels, seed=(label == 2)[cell], sketch=replace(made.sketch, raw=np.array(level))
    )


def _feet(made):
    feet = made.corners[[3, 0]] * [1.0, 1, 0] + [0, 0, GROUND]
    return project(feet, CAMERA.matrix, made.rotation)


def _sloped(left, right, height, run=4.0):
    """Corners (4, 3) of a roof between two places along the wall, that rises by so much."""
    return [[left, DISTANCE, EAVE], [left, DISTANCE + run, EAVE + height], [right, DISTANCE + run, EAVE + height],
            [right, DISTANCE, EAVE]]  # fmt: skip


def _upright(left, right, height):
    return [[left, DISTANCE, EAVE], [left, DISTANCE, EAVE + height], [right, DISTANCE, EAVE + height],
            [right, DISTANCE, EAVE]]  # fmt: skip


def test_houses_of_a_row_have_a_roof_each():
    made = build(reach=(-9.0, 11.0))
    low, high = _sloped(-9.0, 1.0, 3.0), _sloped(1.0, 11.0, 4.5)
    row = _with_roofs(made, (low, TILES), (high, TILES))
    ends = [project(np.array(each), CAMERA.matrix, made.rotation) for each in (low[:2], high[:1:-1])]
    row = replace(row, sketch=replace(row.sketch, raw=np.concatenate([row.sketch.raw, ends])))
    roofs = sorted(row.found(), key=lambda roof: roof.polygon.centroid.x)
    assert [roof.is_told for roof in roofs] == [True, True]
    slopes = np.degrees([roof.slope for roof in roofs])
    assert slopes == pytest.approx(np.degrees(np.arctan([3 / 4, 4.5 / 4])), abs=1.5)


@pytest.mark.parametrize(("width", "count"), [(9.0, 0), (14.0, 1)])
def test_a_small_part_of_a_wall_is_no_roof_unless_an_end_tells(width, count):
    """What is above the rest of the wall is higher than the photo."""
    made = build(reach=(-9.0, 11.0))
    tiles, rest = _sloped(-9.0, -9.0 + width, 4.0), _upright(-9.0 + width, 11.0, 30.0)
    above = _with_roofs(made, (rest, PLASTER), (tiles, TILES))
    assert len(above.found()) == count
    assert len(above.found(labels=_before(above, width - 8.8, width - 7.8))) == count  # a post before the wall


OTHER_TILES = (150, 120, 110)


@pytest.mark.parametrize(("share", "colour", "count"), [(0.9, TILES, 0), (0.5, TILES, 1), (0.9, OTHER_TILES, 1)])
def test_where_the_same_goes_on_nearly_as_high_beside_it_is_no_roof_unless_an_end_tells(share, colour, count):
    made = build(reach=(-9.0, 11.0))
    tiles, rest = _sloped(-9.0, 4.0, 4.0), _upright(4.0, 11.0, share * 4.0 * DISTANCE / (DISTANCE + 4.0))
    assert len(_with_roofs(made, (rest, colour), (tiles, TILES)).found()) == count
    made = build(reach=(-11.0, 9.0))  # and to the left
    tiles, rest = _sloped(-4.0, 9.0, 4.0), _upright(-11.0, -4.0, share * 4.0 * DISTANCE / (DISTANCE + 4.0))
    assert len(_with_roofs(made, (rest, colour), (tiles, TILES)).found()) == count


def test_what_has_the_colour_of_the_wall_is_wall():
    assert build(colours=(PLASTER, PLASTER)).found() == ()


def test_what_has_the_colour_of_the_sky_is_a_cloud():
    assert build(colours=(SKY, PLASTER)).found() == ()


@pytest.mark.parametrize("reach", [(-9.0, -3.0), (2.0, 9.0)])
def test_a_storey_of_another_colour_is_no_roof(reach):
    """It ends upright before the sky, where a roof beside the camera would lean away from the end of its wall."""
    top = [[reach[0], DISTANCE, EAVE + 2.5], [reach[1], DISTANCE, EAVE + 2.5]]
    assert build(reach=reach, top=top).found() == ()


def test_without_sky_there_is_no_roof(made):
    assert made.found(seed=np.zeros_like(made.seed)) == ()


def test_a_roof_without_a_level_line_below_it_is_not_found(made):
    assert made.found(sketch=Sketch(made.sketch.raw[1:], np.zeros((0, 2, 2)), np.zeros(0, np.int64))) == ()


def test_tiles_taller_than_the_wall_below_them_are_none():
    """A strip of shop windows is no wall that carries all the storeys above it."""
    made = build()
    low = made.pixels[[0, 3]] + [0.0, 60.0]
    sketch = replace(made.sketch, raw=np.array([low, *made.sketch.raw[1:]]), whole=low[None])
    photo = made.photo.copy()
    strip = np.array([*made.pixels[[0, 3]], *low[::-1]])
    cv2.fillPoly(photo, [np.rint(strip).astype(np.int32)], TILES)
    assert made.found(sketch=sketch, photo=photo, labels=_shortened(made, low)) == ()


def _shortened(made, low):
    """The labels with the wall cut off a little below a line (2, 2)."""
    (house, *others), down = made.labels.cells, np.array([0.0, 1.0])
    below = shapely.Polygon(np.concatenate([low + 20 * down, low[::-1] + 900 * down]))
    cells = [*partition.polygons_of(house.difference(below)), *others, *partition.polygons_of(house & below)]
    label = np.array([0, *made.labels.label[1:], 1])
    raster = take_raster(NO_LINES, CAMERA, made.rotation, made.photo)
    return replace(made.labels, cells=cells, label=label, cell=partition.draw(cells, raster.shape, raster.step))


def test_the_wall_ends_at_the_eave_and_the_roof_begins_there(made):
    wall = Plane(3, 1, DISTANCE, ())
    lines = replace(NO_LINES, id=np.array([0]), axis=np.array([0]), segment=made.sketch.whole,
                    ends=made.corners[[[0, 3]]], is_boundary=np.zeros(1, bool), component=np.zeros(1, int),
                    confidence=np.full(1, "supported"))  # fmt: skip
    labels = replace(made.labels, surfaces=[replace(made.labels.surfaces[0], plane=3), made.labels.surfaces[1]])
    filled = Filled(labels, shapely.Polygon(), made.found())
    planes = with_roofs(
        find_faces((wall,), lines, filled, CAMERA, made.rotation), filled.roofs, CAMERA, made.rotation, ()
    )
    roof = planes[-1]
    assert (roof.id, roof.axis, roof.lines) == (max(plane.id for plane in planes), 1, ())
    (face,) = roof.faces
    assert face.kind == "roof"
    assert roof.along_normal(face.outline, ()) == pytest.approx(np.full(len(face.outline), roof.offset))
    (front,) = planes[0].faces
    assert front.outline[:, 2].max() == pytest.approx(EAVE, rel=1e-3)
    low = face.outline[np.argsort(face.outline[:, 2])[:2]]
    assert np.abs(front.outline[:, None] - low).max(axis=2).min(axis=0) == pytest.approx(np.zeros(2), abs=1e-6)


def test_the_normal_of_a_plane_of_a_further_frame_is_turned_from_its_axis():
    plane = Plane(0, 4, -2.0, (), tilt=0.7)
    level = directions_of((0.2,))[4]
    assert plane.normal((0.2,)) == pytest.approx(np.cos(0.7) * level + np.sin(0.7) * np.array([0, 0, 1]))


@pytest.mark.parametrize(("axis", "tilt"), [(2, 0.5), (0, -0.1), (0, 3.2)])
def test_a_plane_with_another_tilt_is_refused(axis, tilt):
    with pytest.raises(ValueError, match="expected"):
        Plane(0, axis, 1.0, (), tilt=tilt)
