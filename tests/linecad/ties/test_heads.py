"""Heads of walls: a photo of a street upside down is one below a ceiling, which is as high as the ground was low."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.line_graph import Segments
from linecad.ties import heads
from linecad.ties.feet import FootReader, Reading
from linecad.ties.heads import SPREAD, USUAL, log_height_of_ceiling
from linecad.ties.walls import StripDrawer, find_walls

FOUND = 0.03  # log height


def upside_down(setting):
    """The photo with its last row first: what was below the horizon is above it."""
    sight, segments = setting.sight, setting.graph.segments
    height = len(sight.pixels)
    matrix = sight.matrix.copy()
    matrix[1, 2] = height - 1 - matrix[1, 2]
    turned = np.diag([1.0, -1, 1]) @ sight.rotation @ np.diag([1.0, 1, -1])
    ends = segments.ends * [1, -1] + [0, height - 1]
    flipped = replace(sight, pixels=np.ascontiguousarray(sight.pixels[::-1]), matrix=matrix, rotation=turned)
    graph = replace(setting.graph, segments=Segments(ends, *(segments.__dict__[name] for name in REST)))
    return replace(setting, sight=flipped, graph=graph)


REST = [name for name in Segments.__dataclass_fields__ if name != "ends"]


@pytest.fixture(scope="module")
def lane(brick_lane, build_setting):
    """Two walls below one ceiling, as two bodies moved by so much."""
    seen, _ = brick_lane

    def look(moved=(0.0, 0.0)):
        return upside_down(build_setting(seen, moved, seen.part, pixels=seen.sight.pixels))

    return look


@pytest.fixture(scope="module")
def above(brick_lane):
    """Log height of the ceiling above the camera."""
    return np.log(brick_lane[1])


def test_strips_above_are_those_below_of_the_photo_upside_down(lane, brick_lane, build_setting):
    seen, _ = brick_lane
    usual = build_setting(seen, (0.0, 0.0), seen.part, pixels=seen.sight.pixels)
    flipped = lane()
    for below, over in zip(find_walls(usual), find_walls(flipped), strict=True):
        one, other = StripDrawer(usual).draw(below), StripDrawer(flipped, is_above=True).draw(over)
        assert other.top == pytest.approx(one.top)
        assert np.abs(other.layers - one.layers).mean() < 0.01  # but for the rounding of pixels


@pytest.mark.parametrize("moved", [(0.0, 0.0), (0.7, -0.4)])
def test_a_ceiling_is_found_at_the_scale_that_its_walls_are_put_to(lane, above, moved):
    found = log_height_of_ceiling(lane(moved), -np.array(moved), None)
    assert found == pytest.approx(above, abs=FOUND)


def test_walls_that_do_not_agree_are_weighed_by_how_usual_the_room_is(lane, above):
    # Of two walls with their heads at different heights, the one of a usual room tells.
    for apart, ground in ((0.5, above - USUAL), (0.5, above + 0.5 - USUAL)):
        found = log_height_of_ceiling(lane(), np.array([0.0, apart]), ground)
        assert found == pytest.approx(ground + USUAL, abs=FOUND)


def test_a_hall_is_found_too(lane, above):
    high = above - USUAL - 4 * SPREAD
    assert log_height_of_ceiling(lane(), np.zeros(2), high) == pytest.approx(above, abs=FOUND)


def test_a_faint_head_of_a_usual_room_is_no_reason_against_a_clear_one(lane, above, monkeypatch):
    shares = {0: 0.9, 1: 0.2}

    def read(_, walls):
        return [Reading(((float(above) + (wall.body == 1), shares[wall.body]),), 0.0) for wall in walls]

    monkeypatch.setattr(FootReader, "read", read)
    found = log_height_of_ceiling(lane(), np.zeros(2), above + 1 - USUAL)
    assert found == pytest.approx(above)


@pytest.mark.parametrize(("share", "of_higher", "expected"), [(0.5, 0.5, 0.04), (0.6, 0.1, 0.0)])
def test_what_stands_before_its_wall_shows_its_head_too_low(lane, above, monkeypatch, share, of_higher, expected):
    """Of two heads that nearly agree the higher one is the wall's, unless it is faint."""
    readings = {0: (above, share), 1: (above + 0.04, of_higher)}

    def read(_, walls):
        return [Reading((tuple(map(float, readings[wall.body])),), 0.0) for wall in walls]

    monkeypatch.setattr(FootReader, "read", read)
    assert log_height_of_ceiling(lane(), np.zeros(2), None) == pytest.approx(above + expected)


def test_few_walls_tell_no_ceiling(lane, monkeypatch):
    setting = lane()
    monkeypatch.setattr(heads, "LEAST", 2.1)
    assert log_height_of_ceiling(setting, np.zeros(2), None) is None


def test_without_pixels_no_wall_tells(lane):
    setting = lane()
    unseen = replace(setting, sight=replace(setting.sight, pixels=None))
    assert log_height_of_ceiling(unseen, np.zeros(2), None) is None
