"""What goes on behind low walls, by labels made by hand of walls in space; the camera looks down a little."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from linecad.directions import directions_of, partner
from linecad.geometry import central_camera, project
from linecad.model.regions import partition
from linecad.model.regions.cuts import Borders
from linecad.model.regions.labels import Labels
from linecad.model.regions.lower import WITHIN, parts_behind
from linecad.model.regions.segments import View
from linecad.model.regions.surfaces import Surface
from linecad.scene import Camera

WIDTH, HEIGHT = 960, 720
GROUND = -2.0
PITCH = 0.15  # rad, downwards
TURNS = (0.5,)
PHOTO = shapely.box(-0.5, -0.5, WIDTH - 0.5, HEIGHT - 0.5)
NOTHING = np.zeros(0, np.int64)
SLIVER = 0.01  # px^2
LOW, BACK = (1, 6.0, (-3.0, 3.0), -0.8), (1, 9.0, (-9.0, 9.0), 3.0)  # axis, offset, from where to where, top
CAMERA = Camera(WIDTH, HEIGHT, central_camera(700.0, WIDTH, HEIGHT), "file")


def view(pitch=PITCH):
    cosine, sine = np.cos(pitch), np.sin(pitch)
    down = np.array([[1, 0, 0], [0, cosine, -sine], [0, sine, cosine]])
    return View(CAMERA, down @ np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), None, TURNS)


def seen(wall, sight, foot=GROUND):
    """The part of the photo, px, in which a wall is down to a foot, were nothing before it."""
    axis, offset, span, top = wall
    vectors = directions_of(TURNS)
    corners = [
        offset * vectors[axis] + along * vectors[int(partner(axis))] + [0, 0, height]
        for along, height in zip((*span, *span[::-1]), (foot, foot, top, top), strict=True)
    ]
    return shapely.Polygon(project(np.array(corners), CAMERA.matrix, sight.rotation)).intersection(PHOTO)


def below_horizon(sight):
    horizon = float(project(np.array([[0, 1e9, 0.0]]), CAMERA.matrix, sight.rotation)[0, 1])
    return shapely.box(-0.5, horizon, WIDTH - 0.5, HEIGHT - 0.5)


def labels(walls, sight, feet=None, other=(), ground=None):
    """Walls, the nearest first, then the ground and what is `other`, clutter; the rest is sky."""
    surfaces = [Surface("wall", axis, offset, NOTHING, row) for row, (axis, offset, *_) in enumerate(walls)]
    surfaces.append(Surface("ground", 2, GROUND, NOTHING, None))
    areas = [seen(wall, sight, foot) for wall, foot in zip(walls, feet or [GROUND] * len(walls), strict=True)]
    areas = [*other, *areas, below_horizon(sight) if ground is None else ground, PHOTO]
    numbers = [*[len(surfaces) + 1] * len(other), *range(len(surfaces)), len(surfaces)]
    cells = partition.cells_between([shapely.boundary(area) for area in areas])
    middle = [cell.point_on_surface() for cell in cells]
    label = np.array([next(n for n, area in zip(numbers, areas, strict=True) if area.contains(at)) for at in middle])
    nothing = np.zeros((0, len(surfaces) + 2))
    borders = Borders(np.zeros((0, 2), np.int64), NOTHING)
    return Labels(surfaces, cells, NOTHING, label, nothing, nothing.astype(np.int64), borders)


def alike(found, expected):
    return found.symmetric_difference(expected).area < SLIVER


@pytest.mark.parametrize("pitch", [PITCH, -PITCH, 0.0], ids=["down", "up", "level"])
@pytest.mark.parametrize("low", [LOW, (1, 6.0, (-20.0, 20.0), -0.8), (4, 6.0, (-1.0, 2.0), -1.0)])
def test_a_wall_behind_a_low_one_goes_down_to_its_foot_and_the_ground_goes_on_before_it(low, pitch):
    sight = view(pitch)
    found = parts_behind(labels([low, BACK], sight), sight)
    hides = seen(low, sight)
    assert set(found) == {1, 2}
    assert alike(found[1], hides & seen(BACK, sight))
    assert alike(found[2], hides - seen(BACK, sight))


@given(
    low=st.floats(3.0, 8.0), high=st.floats(8.5, 30.0), top=st.floats(-1.8, -0.1),
    pitch=st.floats(-0.3, 0.3), left=st.floats(-4.0, -0.5), right=st.floats(0.5, 4.0),
)  # fmt: skip
@settings(max_examples=60, deadline=None)
def test_what_is_hidden_is_behind_the_low_wall_and_nowhere_else(low, high, top, pitch, left, right):
    sight = view(pitch)
    before, back = (1, low, (left, right), top), (1, high, (-99.0, 99.0), 9.0)
    shown = labels([before, back], sight)
    found = parts_behind(shown, sight)
    shape = seen(before, sight) if (shown.label == 2).any() else shapely.Polygon()  # it may hide all the ground
    assume(shape.is_empty or shape.bounds[3] - shape.bounds[1] > 3 * WITHIN)
    assert alike(shapely.union_all([*found.values(), shapely.Polygon()]), shape)
    assert alike(found.get(1, shapely.Polygon()), shape & seen(back, sight))


def test_a_wall_that_a_person_told_ends_at_its_edges():
    sight = view()
    shown = labels([LOW, BACK], sight)
    found = parts_behind(shown, sight, [shown.surfaces[1]])
    assert set(found) == {2}
    assert alike(found[2], seen(LOW, sight) - seen(BACK, sight))
    assert set(parts_behind(shown, sight, [shown.surfaces[0]])) == {1, 2}


@pytest.mark.parametrize("roll", [0.1, np.pi / 2])
def test_uprights_may_lean_in_the_photo(roll):
    sight = view()
    cosine, sine = np.cos(roll), np.sin(roll)
    sight = replace(sight, rotation=np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]]) @ sight.rotation)
    far = project(
        np.array([[-1e6, 1e6, 0], [1e6, 1e6, 0], [1e4, 1.0, -1e4], [-1e4, 1.0, -1e4]]), CAMERA.matrix, sight.rotation
    )
    shown = labels([LOW, BACK], sight, ground=shapely.Polygon(far).convex_hull & PHOTO)
    found = parts_behind(shown, sight)
    assert alike(found[1], seen(LOW, sight) & seen(BACK, sight))


def test_a_wall_goes_down_to_the_ground_that_it_is_seen_on():
    sight = view()
    road = shapely.box(-0.5, 485, WIDTH - 0.5, HEIGHT - 0.5)
    shown = labels([LOW, BACK], sight, other=[road])
    sky, clutter = 3, 4
    label = np.where(shown.label == clutter, 3, np.where(shown.label == sky, 4, shown.label))
    shown = replace(shown, surfaces=[*shown.surfaces, Surface("ground", 2, 1.2 * GROUND, NOTHING, None)], label=label)
    found = parts_behind(shown, sight)
    assert set(found) == {1, 2}
    assert alike(found[1], seen(LOW, sight) & seen(BACK, sight))


def test_ground_that_is_seen_over_a_wall_goes_on_behind_it():
    sight = view()
    found = parts_behind(labels([LOW], sight), sight)
    assert set(found) == {1}
    assert alike(found[1], seen(LOW, sight))


def test_a_wall_higher_than_the_camera_hides_what_nobody_knows():
    sight = view()
    assert parts_behind(labels([(1, 6.0, (-3.0, 3.0), 0.5), BACK], sight), sight) == {}


def test_a_wall_that_stands_on_a_low_one_does_not_go_on_behind_it():
    sight = view()
    upper = (1, 6.0 * 1.02, (-3.1, 3.1), 3.0)
    assert parts_behind(labels([LOW, upper], sight, [GROUND, LOW[3] - 0.2]), sight) == {}


def test_what_is_seen_of_what_a_thing_hides_goes_on_only_there():
    sight = view()
    short = (1, 9.0, (-1.0, 1.0), 3.0)
    found = parts_behind(labels([LOW, short], sight), sight)
    assert alike(found[1], seen(LOW, sight) & seen(short, sight))
    assert alike(found[1] | found[2], seen(LOW, sight))  # the ground is seen on both sides of it


def test_a_wall_goes_on_behind_two_low_ones_and_clutter():
    sight = view()
    nearer = (1, 4.0, (-3.0, 3.0), -1.2)
    thing = seen((1, 5.0, (-0.5, 0.5), -1.0), sight) - seen(nearer, sight)
    found = parts_behind(labels([nearer, LOW, BACK], sight, other=[thing]), sight)
    assert alike(found[2], (seen(nearer, sight) | seen(LOW, sight) | thing) & seen(BACK, sight))
    assert found[3].contains(thing.buffer(-1) - seen(BACK, sight))


def test_nothing_goes_on_before_what_is_seen():
    sight = view()
    stray = (1, 30.0, (-40.0, 40.0), -1.2)  # labelled where the back wall's foot would be
    walls = labels([LOW, BACK, stray], sight)
    hole = shapely.box(400, 370, 560, 400)
    assert seen(LOW, sight).contains(hole)
    cells = partition.cells_between([shapely.boundary(shape) for shape in (*walls.cells, hole)])
    label = np.array([
        2 if hole.contains(at) else walls.label[next(n for n, cell in enumerate(walls.cells) if cell.contains(at))]
        for at in (cell.point_on_surface() for cell in cells)
    ])  # fmt: skip
    found = parts_behind(
        Labels(walls.surfaces, cells, NOTHING, label, walls.of_samples, walls.costs, walls.borders), sight
    )
    assert found[1].intersection(hole).area < SLIVER


def test_a_scene_without_ground_has_nothing_that_goes_on():
    sight = view()
    with_ground = labels([LOW, BACK], sight)
    sky = np.where(with_ground.label == 2, 3, with_ground.label)
    without = Labels(
        with_ground.surfaces, with_ground.cells, NOTHING, sky, with_ground.of_samples, with_ground.costs,
        with_ground.borders,
    )  # fmt: skip
    assert parts_behind(without, sight) == {}
