"""Sides of buildings that begin at ends of walls, by boxes before a wall, told by rays."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from linecad.directions import directions_of, partner
from linecad.geometry import central_camera, project
from linecad.model.regions.corners import (
    APART,
    MOST_GAP,
    NARROW,
    NEVER,
    UNBELIEVED,
    Known,
    find_ends,
    find_sides,
    with_sides,
)  # fmt: skip
from linecad.model.regions.raster import take_raster
from linecad.model.regions.surfaces import Surface
from linecad.scene import Camera, Lines

CAMERA = Camera(480, 360, central_camera(300.0, 480, 360), "file")
AHEAD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
TURNS = (0.4,)
GROUND, TOP = -1.5, 2.5
FRONT, BACK, GROUND_ROW, CLUTTER = 0, 1, 2, 4


def photo_of(walls, turns=(), components=(0, 0), heights=(GROUND, TOP)):
    """Walls (axis, offset, from, to) as surfaces, each with level lines at all heights, and the ground; a raster."""
    vectors = directions_of(turns)
    ends, axes = [], []
    for axis, offset, low, high in walls:
        along = int(partner(axis))
        for height in heights:
            ends.append([offset * vectors[axis] + at * vectors[along] + [0, 0, height] for at in (low, high)])
            axes.append(along)
    ends = np.array(ends)
    segment = project(ends.reshape(-1, 3), CAMERA.matrix, AHEAD).reshape(-1, 2, 2)
    count = len(ends)
    lines = Lines(
        id=np.arange(count), axis=np.array(axes), segment=segment, ends=ends, is_boundary=np.zeros(count, bool),
        component=np.repeat(components, len(heights)), confidence=np.full(count, "proven"),
    )  # fmt: skip
    surfaces = [
        Surface("wall", axis, offset, len(heights) * k + np.arange(len(heights)), k)
        for k, (axis, offset, *_) in enumerate(walls)
    ]
    surfaces.append(Surface("ground", 2, GROUND, np.zeros(0, np.int64), None))
    return surfaces, lines, take_raster(lines, CAMERA, AHEAD, None, turns=turns)


def known_of(walls, turns=(), components=(0, 0), heights=(GROUND, TOP)):
    """What is known where the nearest of some walls, the ground or else the sky is shown."""
    surfaces, lines, raster = photo_of(walls, turns, components, heights)
    nearest, shown = np.full(raster.size, np.inf), np.full(raster.size, len(walls) + 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        level = np.where(raster.rays[:, 2] < 0, GROUND / raster.rays[:, 2], np.inf)
        shown[np.isfinite(level)], nearest = len(walls), np.minimum(nearest, level)
        for row, (axis, offset, low, high) in enumerate(walls):
            depth = offset / raster.rays[:, axis]
            at = raster.rays[:, int(partner(axis))] * depth
            hit = (depth > 0) & (depth < nearest) & (at >= low) & (at <= high) & (raster.rays[:, 2] * depth < TOP)
            shown[hit], nearest[hit] = row, depth[hit]
    return Known(shown, surfaces, lines, raster)


def sides_of(known):
    return find_sides(find_ends(known), known)


@settings(deadline=None, max_examples=40)
@given(st.floats(4, 7), st.floats(-3, 1.5), st.floats(1.5, 3), st.floats(1.4, 3))
def test_a_side_begins_at_each_end_that_the_camera_sees_from_beside(near, left, width, behind):
    ends = np.array([left, left + width])
    facing = ends * [1, -1] / near  # 0 where a side is seen from its edge
    assume((np.abs(facing - 0.05) > 0.05).all() and (np.abs(np.abs(ends) / near - 0.8) > 0.1).all())
    expected = ends[(facing > 0) & (np.abs(ends) / near < 0.8)]  # the photo reaches so far to either side
    sides = sides_of(known_of([(1, near, left, left + width), (1, near * behind, -40, 40)]))
    assert [side.surface.axis for side in sides] == [0] * len(expected)
    assert sorted(side.surface.offset for side in sides) == pytest.approx(expected.tolist(), abs=0.01 * near)


def test_a_side_goes_back_to_the_wall_behind_and_hides_it():
    known = known_of([(1, 5.0, 1.0, 3.0), (1, 9.0, -40, 40)])
    (side,) = sides_of(known)
    raster = known.raster
    at = side.surface.offset / raster.rays[:, 0]
    true = (at > 5) & (at < 9) & (raster.rays[:, 2] * at > GROUND) & (known.shown == BACK)
    assert (side.hides != true).mean() < 0.02 * true.mean() + 0.002
    assert (side.cost[side.hides] < 1).all()
    assert (side.cost[raster.rays[:, 0] <= 0] == NEVER).all()
    assert (side.wall, side.behind) == (FRONT, BACK)
    assert side.surface.box[:, 1].tolist() == [5.0, 9.0]


@pytest.mark.parametrize(("axis", "share", "count"), [(1, 0.3, 0), (1, 0.05, 1), (0, 0.3, 1), (None, 0.3, 1)])
def test_where_windows_of_another_wall_are_seen_is_no_side(axis, share, count):
    known = known_of([(1, 5.0, 1.0, 3.0), (1, 9.0, -40, 40)])
    (side,) = sides_of(known)
    hidden = np.flatnonzero(side.hides)
    opened = known.raster.opened.copy()
    if axis is not None:
        opened[hidden[: round(share * len(hidden))]] = axis
    assert len(sides_of(replace(known, raster=replace(known.raster, opened=opened)))) == count


def test_a_side_ends_where_lines_of_its_wall_end_though_the_border_is_elsewhere():
    known = known_of([(1, 5.0, 1.0, 3.0), (1, 9.0, -40, 40)])
    end = min(find_ends(known), key=lambda end: end.place)
    assert end.place == pytest.approx(1.0, abs=0.03)
    (side,) = find_sides([replace(end, place=1.3)], known)
    assert side.surface.offset == pytest.approx(1.0, abs=0.03)


def test_a_wall_behind_at_nearly_the_depth_of_a_side_is_that_side():
    for place, count in ((1.0 * (2 * APART - 1), 1), (1.0 * (1 + APART) / 2, 0)):
        known = known_of([(1, 5.0, 1.0, 3.0), (0, place, 5.0, 40)])
        assert len(sides_of(known)) == count


def test_walls_that_meet_have_no_side_there():
    assert sides_of(known_of([(1, 5.0, 1.0, 3.0), (0, 1.0, 5.0, 40)])) == []


def test_what_ends_below_the_eye_has_no_side():
    known = known_of([(1, 5.0, 1.0, 3.0), (1, 9.0, -40, 40)])
    level = known.raster.rays[:, 2] * 5 / known.raster.rays[:, 1]
    shown = np.where((known.shown == FRONT) & (level > -0.3), BACK, known.shown)
    assert sides_of(Known(shown, known.surfaces, known.lines, known.raster)) == []


def test_a_wall_whose_lines_go_on_does_not_end():
    known = known_of([(1, 5.0, -3.0, 3.0), (1, 9.0, -40, 40)])
    at = known.raster.rays[:, 0] * 5 / known.raster.rays[:, 1]
    shown = np.where((known.shown == FRONT) & (at < 1), BACK, known.shown)  # half of it is hidden by nothing
    assert sides_of(Known(shown, known.surfaces, known.lines, known.raster)) == []


def step_of(taken_for, back=5.6, mirrored=False):
    """Two parallel walls with a side between them at 1.0 that is taken for something; and the samples of that side.

    Mirrored, all is on the left of the camera.
    """
    walls = [(1, 5.0, 1.0, 3.0), (1, back, -40, 1.0), (0, 1.0, 5.0, back)]
    if mirrored:
        walls = [(1, 5.0, -3.0, -1.0), (1, back, -1.0, 40), (0, -1.0, 5.0, back)]
    known = known_of(walls, components=(0, 0, 0), heights=(GROUND, 0.0, 0.7, 1.4, TOP))
    strip = known.shown == 2
    shown = np.where(strip, taken_for, known.shown - (known.shown > 2))
    return replace(known, shown=shown, surfaces=[*known.surfaces[:2], *known.surfaces[3:]]), strip


@settings(deadline=None, max_examples=20)
@given(st.sampled_from([FRONT, BACK, CLUTTER]), st.floats(5.4, 5.0 * NARROW - 0.05), st.booleans())
def test_the_side_of_a_step_is_found_whatever_it_is_taken_for(taken_for, back, mirrored):
    known, strip = step_of(taken_for, back, mirrored)
    (side,) = sides_of(known.without_gaps())
    assert side.is_step
    assert side.surface.offset == pytest.approx(-1.0 if mirrored else 1.0, abs=0.03)
    assert (side.hides & strip).sum() > 0.6 * strip.sum()  # a strip of 5 samples, found to a sample
    assert side.hides.sum() < 1.6 * strip.sum()
    costs = np.full((known.raster.size, len(known.surfaces) + 2), 0.1)
    dearer = with_sides(costs, [side], known)[side.hides][:, [FRONT, BACK, -1]] > 0.1
    assert dearer.all()


def test_the_side_of_a_step_goes_down_as_far_as_the_photo_where_no_ground_is_known():
    known, _ = step_of(BACK)
    (side,) = sides_of(known)
    below = known.raster.rays[:, 2] < -0.5 * known.raster.rays[:, 1]  # in the ground, before the nearer wall
    assert below.any()
    assert (side.cost[below] == NEVER).all()
    groundless = replace(known, surfaces=known.surfaces[:2], shown=np.where(known.shown > 1, CLUTTER - 1, known.shown))
    (side,) = sides_of(groundless)
    assert (side.cost[below] < 1).any()


@pytest.mark.parametrize(("back", "count"), [(5.6, 1), (9.0, 0)])
def test_a_few_lines_may_go_on_beyond_a_step_and_not_before_a_wall_far_behind(back, count):
    known = known_of([(1, 5.0, 0.69, 3.0), (1, back, -40, 40)])
    at = known.raster.rays[:, 0] * 5 / known.raster.rays[:, 1]
    shown = np.where((known.shown == FRONT) & (at < 1.0), BACK, known.shown)  # 7 % of its lines lie in what it hides
    ends = find_ends(replace(known, shown=shown))
    assert len([end for end in ends if end.inwards > 0]) == count


def test_an_end_straight_before_the_camera_shows_no_side():
    assert sides_of(known_of([(1, 5.0, 0.05, 3.0), (1, 5.5, -40, 0.05)])) == []


def test_one_end_before_a_wall_a_little_behind_and_one_far_behind_is_a_step():
    known = known_of([(1, 5.0, 1.0, 3.0), (1, 5.6, -40, 1.0), (1, 9.0, -40, 40)], components=(0, 0, 0))
    beside = known.raster.rays[:, 0] < 1.0 / 5.0 * known.raster.rays[:, 1]
    upper = known.raster.rays[:, 2] > 0.15 * known.raster.rays[:, 1]
    wall = np.where(upper, 2, BACK)
    known = replace(known, shown=np.where(beside & np.isin(known.shown, [BACK, 2]), wall, known.shown))
    assert {end.other for end in find_ends(known) if end.inwards > 0} == {BACK, 2}
    step = [side for side in sides_of(known) if side.surface.offset < 2]
    assert [side.is_step for side in step] == [True]


def test_clutter_between_walls_is_no_end_of_one_before_gaps_are_closed():
    known, _ = step_of(CLUTTER)
    assert sides_of(known) == []


def test_a_tree_between_walls_is_no_side():
    known, strip = step_of(BACK)
    column = np.arange(known.raster.size) % known.raster.shape[1]
    most = int(1.5 * MOST_GAP * known.raster.shape[1])
    tree = (known.shown == BACK) & (column <= column[strip].max()) & (column > column[strip].max() - most)
    hidden = replace(known, shown=np.where(tree, CLUTTER, known.shown))
    assert sides_of(hidden.without_gaps()) == []


def test_one_end_before_two_walls_is_one_side():
    known = known_of([(1, 5.0, 1.0, 3.0), (1, 7.0, -40, 40), (1, 7.2, -40, 40)], components=(0, 0, 0))
    upper = known.raster.rays[:, 2] > 0.15 * known.raster.rays[:, 1]
    known = replace(known, shown=np.where((known.shown == 1) & upper, 2, known.shown))
    assert {(end.wall, end.other) for end in find_ends(known)} == {(0, 1), (0, 2)}
    (side,) = sides_of(known)
    assert np.isin(known.shown[side.hides], [1, 2]).all()
    assert set(known.shown[side.hides].tolist()) == {1, 2}


def test_sides_of_turned_walls_are_in_their_frame():
    known = known_of([(4, 5.0, 1.0, 3.0), (4, 9.0, -40, 40)], TURNS)
    (side,) = sides_of(known)
    assert side.surface.axis == 3
    assert side.surface.offset == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize(("components", "least"), [((0, 0), 0.0), ((0, 1), UNBELIEVED)])
def test_a_wall_behind_a_side_costs_more_most_where_it_is_placed_by_itself(components, least):
    known = known_of([(1, 5.0, 1.0, 3.0), (0, 2.5, 5.0, 40)], components=components)
    (side,) = sides_of(known)
    costs = np.full((known.raster.size, 5), 0.1)
    found = with_sides(costs, [side], known)
    assert found.shape == (known.raster.size, 6)
    assert (found[:, 3] == side.cost).all()
    assert (found[side.hides, BACK] > 0.1).all()
    assert (found[side.hides, BACK] >= least).mean() > 0.95
    assert (found[~side.hides, BACK] == 0.1).all()
    assert (found[:, [FRONT, GROUND_ROW, -2, -1]] == 0.1).all()
    assert (costs == 0.1).all()
