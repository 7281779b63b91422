"""What the photo is cut along."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from linecad.geometry import angles_to, vanishing_points, world_rays
from linecad.model.regions.raster import take_raster
from linecad.model.regions.segments import FURTHEST, View, find_meets, find_segments, limit_of_depth
from linecad.model.regions.surfaces import Surface

PLAIN = np.full((720, 960, 3), 128, np.uint8)
NO_LINES = np.zeros(0, np.int64)


def seen(house, photo=None):
    """Surfaces, raster and view of the house, or of another photo with its lines."""
    surfaces = house.surfaces()
    return surfaces, take_raster(house.lines, house.camera, house.rotation, photo), View(
        house.camera, house.rotation, photo
    )  # fmt: skip


def points_on(surface, pixels, house):
    rays = world_rays(pixels, house.camera.matrix, house.rotation)
    return rays * (surface.offset / rays[:, surface.axis])[:, None]


def has(segments, pixels, tolerance=1e-6):
    """Whether one of the segments is the line between two pixels."""
    pixels = np.asarray(pixels, float)
    both = np.stack([segments, segments[:, ::-1]])
    return bool((np.abs(both - pixels).max(axis=(2, 3)) < tolerance).any())


def test_meets_project_exactly_on_both_of_their_surfaces(house):
    surfaces, _, view = seen(house)
    meets = find_meets(house.lines, surfaces, view)
    kinds = []
    for ends, (one, other) in zip(meets.ends, meets.surfaces.tolist(), strict=True):
        points = points_on(surfaces[one], ends, house)
        assert points == pytest.approx(points_on(surfaces[other], ends, house), rel=1e-9)
        kinds.append({(surfaces[number].axis, surfaces[number].offset) for number in (one, other)})
    for pair in ({(0, 2.0), (1, 8.0)}, {(0, 2.0), (2, -2.0)}, {(1, 8.0), (2, -2.0)}):
        assert pair in kinds


def test_a_corner_is_as_high_as_its_walls_and_reaches_the_ground(house):
    surfaces, _, view = seen(house)
    meets = find_meets(house.lines, surfaces, view)
    (corner,) = [
        ends for ends, pair in zip(meets.ends, meets.surfaces.tolist(), strict=True)
        if {surfaces[number].axis for number in pair} == {0, 1}
    ]  # fmt: skip
    high = points_on(surfaces[0], corner, house)[:, 2]
    assert sorted(high.tolist()) == pytest.approx([-2, 1.6])


def test_walls_far_from_each_other_do_not_meet(house):
    def corners(place):
        walls = [Surface("wall", 1, 8.0, own(house, 1, 8.0), 0), Surface("wall", 0, place, own(house, 0, 2.0), 1)]
        return len(find_meets(house.lines, walls, View(house.camera, house.rotation, None)).ends)

    assert corners(2.0) == 1
    assert corners(2.0 - 0.24 * 3.5) == 1  # a quarter of the front's width beside it
    assert corners(2.0 - 0.26 * 3.5) == 0


def own(house, axis, offset):
    """Rows of the lines of the plane there."""
    return np.array([line for plane in house.planes if (plane.axis, plane.offset) == (axis, offset)
                     for line in plane.lines])  # fmt: skip


def test_parallel_walls_and_levels_do_not_meet(house):
    lines = own(house, 1, 8.0)
    parallel = [Surface("wall", 1, 8.0, lines, 0), Surface("wall", 1, 9.0, lines, 1)]
    assert len(find_meets(house.lines, parallel, View(house.camera, house.rotation, None)).ends) == 0
    levels = [Surface("ground", 2, -2.0, NO_LINES, None), Surface("ceiling", 2, 3.0, NO_LINES, None)]
    assert len(find_meets(house.lines, levels, View(house.camera, house.rotation, None)).ends) == 0


def test_a_meet_behind_the_camera_is_cut_off_before_it(house, to_lines):
    # A wall beside the camera that begins behind it.
    edges = [(1, np.array([[3.0, -5, z], [3, 30, z]])) for z in (-2.0, 0.5, 3)]
    lines, _ = to_lines([(1, np.maximum(ends, [[-9, 2, -9]])) for _, ends in edges], house.camera, house.rotation)
    lines = replace(lines, ends=np.array([ends for _, ends in edges]))
    wall = Surface("wall", 0, 3.0, np.arange(3), 0)
    ground = Surface("ground", 2, -2.0, NO_LINES, None)
    (meet,) = find_meets(lines, [wall, ground], View(house.camera, house.rotation, None)).ends
    assert (meet >= -0.5).all()
    assert (meet <= [959.5, 719.5]).all()
    assert points_on(wall, meet, house) == pytest.approx(points_on(ground, meet, house))


def test_lines_of_the_scene_are_cut_along_and_short_ones_are_not(house):
    surfaces, raster, view = seen(house)
    found = find_segments(house.lines, surfaces, raster, view)
    length = np.linalg.norm(house.lines.segment[:, 1] - house.lines.segment[:, 0], axis=1)
    assert (length > 0.02 * 960).any()
    for segment, size in zip(house.lines.segment, length, strict=True):
        assert has(found, segment) == (size >= 0.02 * 960)
    for meet in find_meets(house.lines, surfaces, view).ends:
        assert has(found, meet)


def test_the_ground_ends_on_one_image_line_behind_nearly_all_lines(house):
    surfaces, raster, view = seen(house)
    limit = limit_of_depth(raster)
    assert limit == pytest.approx(FURTHEST * (house.lines.ends @ house.rotation[2]).max(), rel=0.05)
    with_ground = find_segments(house.lines, surfaces, raster, view)
    walls = [surface for surface in surfaces if surface.kind != "ground"]
    without = {segment.tobytes() for segment in find_segments(house.lines, walls, raster, view)}
    meets = {meet.tobytes() for meet in find_meets(house.lines, surfaces, view).ends}
    (end,) = [each for each in with_ground if each.tobytes() not in without | meets]
    ground = next(surface for surface in surfaces if surface.kind == "ground")
    assert points_on(ground, end, house) @ house.rotation[2] == pytest.approx([limit, limit])
    # From border to border; this camera is level.
    assert sorted(end[:, 0].tolist()) == pytest.approx([-0.5, 959.5])


def test_a_scene_without_points_on_lines_has_no_limit(house):
    _, raster, _ = seen(house)
    assert limit_of_depth(replace(raster, line_depth=np.zeros(0))) == np.inf


def test_the_strongest_come_first_by_length_and_contrast(house):
    surfaces, _, view = seen(house)

    def in_order(photo):
        raster = take_raster(house.lines, house.camera, house.rotation, photo)
        found = find_segments(house.lines, surfaces, raster, view)
        return [each for each in found if has(house.lines.segment, each)]

    plain = in_order(PLAIN)
    assert (np.diff([np.linalg.norm(each[1] - each[0]) for each in plain]) <= 1e-9).all()
    number = len(plain) // 2
    start, end = plain[number]
    photo = PLAIN.copy()
    beside = 40 * np.array([start[1] - end[1], end[0] - start[0]]) / np.linalg.norm(end - start)
    cv2.fillPoly(photo, [np.rint([start, end, end + beside, start + beside]).astype(np.int32)], (250, 250, 250))
    assert has(np.array(in_order(photo)[: number // 2]), [start, end])


def edges_at(angle, house):
    """What is cut along an edge of a photo, `angle` degrees off the direction to the vanishing point of x.

    The segments, and the sines of their angles to that direction.
    """
    middle = np.array([480.0, 200.0])
    point = vanishing_points(house.camera.matrix, house.rotation)[0]
    along = (point[:2] / point[2] - middle) / np.linalg.norm(point[:2] / point[2] - middle)
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    along = np.array([[c, -s], [s, c]]) @ along
    across = np.array([-along[1], along[0]])
    corners = [middle + u * along + v * across for u, v in ((-200, 0), (200, 0), (200, 90), (-200, 90))]
    photo = np.full((720, 960, 3), 60, np.uint8)
    cv2.fillPoly(photo, [np.rint(np.array(corners) * 256).astype(np.int32)], (220, 220, 220), cv2.LINE_AA, shift=8)
    surfaces, raster, view = seen(house, photo)
    found = find_segments(house.lines, surfaces, raster, view)
    own = found[(np.abs((found - middle) @ across).max(axis=1) < 8) & ~np.array([has(house.lines.segment, each)
                                                                                for each in found])]  # fmt: skip
    own = own[np.linalg.norm(own[:, 1] - own[:, 0], axis=1) > 300]
    return own, angles_to(own, point[None])[0]


@pytest.mark.parametrize(("angle", "is_turned"), [(1.5, True), (-2.0, True), (8.0, False)])
def test_edges_that_nearly_point_to_a_vanishing_point_are_turned_to_it(house, angle, is_turned):
    found, sines = edges_at(angle, house)
    assert len(found) >= 1
    if is_turned:
        assert sines.max() < 1e-9
    else:
        assert np.degrees(np.arcsin(sines)) == pytest.approx(np.full(len(sines), abs(angle)), abs=0.5)


def test_without_a_photo_there_are_no_edges(house):
    surfaces, raster, view = seen(house)
    found = find_segments(house.lines, surfaces, raster, View(house.camera, house.rotation, house.photo))
    assert len(find_segments(house.lines, surfaces, raster, view)) < len(found)
