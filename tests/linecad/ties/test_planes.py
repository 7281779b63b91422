"""Shared planes: walls that become one plane at a known ratio, and what must not be taken for one."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.ties.planes import (
    INDUCED,
    INDUCED_CONNECTED,
    LEAST_LINES,
    MOST,
    WIDTH,
    SharedPlane,
    find_planes_of_bodies,
    find_shared_planes,
    is_induced,
)

ACROSS, HEIGHTS = np.linspace(-4.0, -1.0, 6), np.linspace(-2.0, 2.5, 5)  # 11 lines of a wall


def walls(build_wall, *places):
    """Walls of one plane each, one above the other so that all are seen."""
    return [build_wall(1, place, ACROSS, HEIGHTS) for place in places]


def shared_of(bodies=(0, 1), log_ratio=0.0):
    return SharedPlane(bodies, log_ratio, 1, 10.0, (0.5, 0.5), (5, 5), 0, 0.0)


@pytest.mark.parametrize("swapped", [False, True])
def test_facades_of_one_row_share_a_plane(build_town, build_row, build_setting, swapped):
    seen = build_town(*build_row(0))
    by = (0.2, -0.5)
    (found,) = find_shared_planes(build_setting(seen, moved=by, body=1 - seen.part if swapped else seen.part))
    assert (found.bodies, found.normal, found.rank) == ((0, 1), 1, 0)
    assert found.log_ratio == pytest.approx(by[1] - by[0])
    assert found.shares == (1.0, 1.0)
    assert found.lines == (24, 24)
    assert found.distance == pytest.approx(2.0 * 3000 / 10, rel=0.01)  # from -1.2 to 0.8 at 10


LOW, HIGH = np.linspace(-2.6, 0.4, 5), np.linspace(0.7, 2.7, 5)


@pytest.mark.parametrize(
    ("across", "overlap"),
    [
        (np.linspace(-4.0, -1.0, 6), 1.0),  # over all of the lower wall
        (np.linspace(-3.0, -2.0, 6), 1.0),  # shorter than it, and within
        (np.linspace(-2.5, 0.5, 6), 0.5),
        (np.linspace(-0.8, 2.2, 6), 0.0),  # beside it
    ],
)
def test_walls_one_above_the_other_overlap(build_town, build_wall, build_setting, across, overlap):
    seen = build_town(build_wall(1, 9.0, ACROSS, LOW), build_wall(1, 9.0, across, HIGH))
    for moved in ((), (0.3, -0.2)):
        (found,) = (shared for shared in find_shared_planes(build_setting(seen, moved=moved)) if shared.normal == 1)
        assert found.overlap == pytest.approx(overlap, abs=0.02)


@pytest.mark.parametrize(("top", "overlap"), [(-0.1, 0.0), (0.1, 1.0)])
@pytest.mark.parametrize("body", [(0, 1), (1, 0)])
def test_a_wall_lower_than_the_camera_may_stand_before_another(
    build_town, build_wall, build_setting, top, overlap, body
):
    seen = build_town(build_wall(1, 9.0, ACROSS, np.linspace(-2.6, top, 5)), build_wall(1, 9.0, ACROSS, HIGH))
    setting = build_setting(seen, body=np.array(body)[seen.part])
    (found,) = (shared for shared in find_shared_planes(setting) if shared.normal == 1)
    assert found.overlap == overlap


@pytest.mark.parametrize("place", [-3.0, 3.0])
def test_walls_to_the_side_overlap_by_how_far_away_their_parts_are(build_town, build_wall, build_setting, place):
    seen = build_town(
        build_wall(0, place, np.linspace(8.0, 12.0, 6), LOW), build_wall(0, place, np.linspace(10.0, 14.0, 6), HIGH)
    )
    (found,) = (shared for shared in find_shared_planes(build_setting(seen)) if shared.normal == 0)
    assert found.overlap == pytest.approx(0.5, abs=0.02)


def test_level_planes_do_not_overlap(build_town, build_setting):
    steps = [[(0, (x, y, -2.0), (x + 2, y, -2.0)) for y in (8.0, 9.0)] + [(1, (x, 8.0, -2.0), (x, 9.0, -2.0))]
             for x in (-2.5, 0.5)]  # fmt: skip
    (found,) = (shared for shared in find_shared_planes(build_setting(build_town(*steps))) if shared.normal == 2)
    assert found.overlap == 0.0


def test_the_ratio_of_walls_at_two_depths_puts_them_into_one_plane(build_town, build_row, build_setting):
    seen = build_town(*build_row(0, at=(9.5, 12.0)))
    (found,) = find_shared_planes(build_setting(seen))
    assert found.log_ratio == pytest.approx(np.log(12 / 9.5))


def test_distances_are_px_at_the_reference_width(build_town, build_row, build_setting):
    setting = build_setting(build_town(*build_row(0)))
    half = replace(setting, sight=replace(setting.sight, width=1920))
    (wide,), (narrow,) = find_shared_planes(setting), find_shared_planes(half)
    assert narrow.distance == pytest.approx(2 * wide.distance)


def test_walls_on_two_sides_of_the_camera_share_nothing(build_town, build_wall, build_setting):
    deep = np.linspace(9.0, 14.0, 6)
    seen = build_town(build_wall(0, -3.0, deep, HEIGHTS), build_wall(0, 3.0, deep, HEIGHTS))
    planes = find_planes_of_bodies(build_setting(seen))
    assert [(plane.normal, plane.side) for own in planes for plane in own if plane.normal == 0] == [(0, -1), (0, 1)]
    assert [shared.normal for shared in find_shared_planes(build_setting(seen)) if shared.normal == 0] == []


def test_walls_of_two_normals_share_nothing(build_town, build_wall, build_setting):
    seen = build_town(build_wall(1, 9.0, ACROSS, HEIGHTS), build_wall(0, 3.0, np.linspace(9.0, 14.0, 6), HEIGHTS))
    assert [shared.normal for shared in find_shared_planes(build_setting(seen)) if shared.normal != 2] == []


def test_a_plane_tells_its_offset_and_share(build_town, build_wall, build_setting):
    parts = [build_wall(1, 10.0, ACROSS, HEIGHTS) + build_wall(1, 8.0, np.array([1.0, 2.0]), np.array([-1.0, 1.0]))]
    large, small = (plane for plane in find_planes_of_bodies(build_setting(build_town(*parts)))[0] if plane.normal == 1)
    assert np.exp(large.log_offset) == pytest.approx(10.0)
    assert np.exp(small.log_offset) == pytest.approx(8.0)
    assert (large.share, small.share) == (11 / 15, 4 / 15)
    assert (large.rank, small.rank) == (0, 1)
    assert (large.lines.tolist(), small.lines.tolist()) == (list(range(11)), [11, 12, 13, 14])


def test_lines_of_one_axis_are_no_plane(build_town, build_wall, build_setting):
    uprights = build_wall(1, 10.0, ACROSS, HEIGHTS)[:6]
    assert find_planes_of_bodies(build_setting(build_town(uprights))) == [[]]


def test_two_lines_that_cross_are_a_plane_and_one_is_none(build_town, build_wall, build_setting):
    upright, *_, course = build_wall(1, 10.0, ACROSS, HEIGHTS)
    assert LEAST_LINES == 2
    (planes,) = find_planes_of_bodies(build_setting(build_town([upright, course])))
    assert [plane.lines.tolist() for plane in planes if plane.normal == 1] == [[0, 1]]


@pytest.mark.parametrize(("off", "lines"), [(1.9, 15), (2.1, 11)])
def test_a_plane_is_thin(build_town, build_wall, build_setting, off, lines):
    beside = build_wall(1, 10.0 * np.exp(off * WIDTH), np.array([1.0, 2.0]), np.array([-1.0, 1.0]))
    (planes,) = find_planes_of_bodies(build_setting(build_town(build_wall(1, 10.0, ACROSS, HEIGHTS) + beside)))
    assert next(len(plane.lines) for plane in planes if plane.normal == 1) == lines


def test_the_main_plane_is_that_of_the_longest_lines_not_of_the_most(build_town, build_wall, build_setting):
    many = build_wall(1, 8.0, np.linspace(1.0, 1.5, 6), np.linspace(0.0, 0.5, 6))
    few = build_wall(1, 10.0, np.array([-4.0, -2.5, -1.0]), np.array([-2.0, 0.3, 2.5]))
    (planes,) = find_planes_of_bodies(build_setting(build_town(many + few)))
    assert [len(plane.lines) for plane in planes if plane.normal == 1] == [6, 12]


def test_a_very_long_line_counts_no_more_than_a_long_one(build_town, build_wall, build_setting):
    two_long = build_wall(1, 8.0, np.array([-4.0, 4.0]), np.array([-3.0, 3.0]))[1:3]  # 2250 and 3000 px
    some = build_wall(1, 10.0, np.linspace(-0.5, 0.5, 3), np.linspace(-0.5, 0.5, 3))  # six of 300 px
    (planes,) = find_planes_of_bodies(build_setting(build_town(two_long + some)))
    assert [len(plane.lines) for plane in planes if plane.normal == 1] == [6, 2]


def test_a_body_has_a_few_planes_of_a_normal(build_town, build_wall, build_setting):
    parts = [
        line
        for place in range(MOST + 2)
        for line in build_wall(1, 7.0 + place, np.array([0.5 * place - 2.0, 0.5 * place - 1.7]), np.array([0.5, 2.5]))
    ]
    (planes,) = find_planes_of_bodies(build_setting(build_town(parts)))
    assert [plane.rank for plane in planes if plane.normal == 1] == list(range(MOST))


def test_planes_of_low_rank_are_not_compared(build_town, build_wall, build_setting):
    across = np.array([0.0, 0.4])
    # Each body has three planes; the uprights of a farther one are shorter in the photo.
    left = [line for place in (8.0, 9.0, 10.0) for line in build_wall(1, place, across - place / 2, HEIGHTS)]
    right = [line for place in (8.0, 9.0, 10.0) for line in build_wall(1, place, across + place / 4, HEIGHTS)]
    ranks = [shared.rank for shared in find_shared_planes(build_setting(build_town(left, right))) if shared.normal == 1]
    assert sorted(ranks) == [0, 1, 1, 2, 2, 2]


@pytest.mark.parametrize(
    ("log_ratio", "connected", "induced"),
    [
        (0.9 * INDUCED, 1.1 * INDUCED_CONNECTED, True),
        (-0.9 * INDUCED, 1.1 * INDUCED_CONNECTED, True),
        (1.1 * INDUCED, 1.1 * INDUCED_CONNECTED, False),
        (-1.1 * INDUCED, 1.1 * INDUCED_CONNECTED, False),
        (0.9 * INDUCED, 0.9 * INDUCED_CONNECTED, False),
    ],
)
def test_a_plane_that_the_fit_made_one_tells_nothing(log_ratio, connected, induced):
    assert is_induced(shared_of(log_ratio=log_ratio), connected) is induced
