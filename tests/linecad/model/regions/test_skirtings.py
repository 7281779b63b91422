"""Plain walls of which a room shows the skirting alone."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.directions import components, directions_of, partner
from linecad.geometry import central_camera
from linecad.model.regions.skirtings import AT_FLOOR, BEYOND, LEAST_LENGTH, NEAREST, with_skirtings
from linecad.model.regions.surfaces import RELIEF, Surface
from linecad.scene import Camera, Lines

CAMERA = Camera(1000, 800, central_camera(800.0, 1000, 800), "file")
NONE = np.zeros(0, np.int64)
FLOOR, CEILING = Surface("ground", 2, -1.5, NONE, None), Surface("ceiling", 2, 1.2, NONE, None)
LONG = 1.1 * LEAST_LENGTH * CAMERA.width  # px


def level(*lines, turns=(), probability=()):
    """Lines along axes, each (axis, offset along its partner, height, from, to, px)."""
    ends, axes = np.zeros((len(lines), 2, 3)), directions_of(turns)
    segment = np.zeros((len(lines), 2, 2))
    for row, (axis, offset, height, start, stop, length) in enumerate(lines):
        for end, place in enumerate((start, stop)):
            ends[row, end] = place * axes[axis] + offset * axes[int(partner(axis))] + height * axes[2]
        segment[row, 1, 0] = length
    count = len(lines)
    return Lines(
        id=np.arange(count), axis=np.array([line[0] for line in lines], np.int64), segment=segment, ends=ends,
        is_boundary=np.zeros(count, bool), component=np.zeros(count, np.int64),
        confidence=np.full(count, "proven"), probability=probability,
    )  # fmt: skip


def wall(axis, offset):
    return Surface("wall", axis, offset, NONE, 0)


def added(lines, *walls, turns=()):
    """What is added to walls, a floor and a ceiling."""
    before = [*walls, FLOOR, CEILING]
    found = with_skirtings(before, lines, CAMERA, turns)
    assert found[: len(before)] == before
    return found[len(before) :]


@given(st.sampled_from([0, 1]), st.sampled_from([-1.0, 1.0]), st.floats(0.5, 8.0), st.floats(2.0, 9.0))
def test_the_farthest_long_line_on_the_floor_is_the_foot_of_a_wall(along, side, offset, reach):
    of_rug = (along, 0.7 * side * offset, -1.5, 1.0, reach, LONG)
    lines = level((along, side * offset, -1.5, 1.0, reach, LONG), of_rug)
    (found,) = added(lines, wall(1 - along, -20.0 * side))
    assert (found.kind, found.axis, found.plane, len(found.lines)) == ("wall", 1 - along, None, 0)
    assert found.offset == pytest.approx(side * offset)
    # Of what runs towards the camera a photo shows nothing beside it.
    assert found.box[:, along] == pytest.approx([0.0 if reach > offset else 1.0, reach])
    assert found.box[:, 2] == pytest.approx([-1.5, 1.2])


def test_pieces_of_one_skirting_count_together_and_it_is_where_the_longest_is():
    pieces = [(0, 3.0, -1.5, 1.0, 2.0, 0.6 * LONG), (0, 3.0 * (1 + 0.9 * RELIEF), -1.5, 3.0, 4.0, 0.5 * LONG)]
    (found,) = added(level(*pieces), wall(0, 9.0))
    assert found.offset == pytest.approx(3.0)
    assert found.box[:, 0] == pytest.approx([0.0, 4.0])
    assert added(level(pieces[0]), wall(0, 9.0)) == []


@pytest.mark.parametrize(
    "line",
    [
        (0, 3.0, -1.5 * np.exp(1.1 * AT_FLOOR), 1.0, 4.0, LONG),
        (0, 3.0, -1.5 * np.exp(-1.1 * AT_FLOOR), 1.0, 4.0, LONG),
        (0, 3.0, 1.5, 1.0, 4.0, LONG),
        (0, 0.9 * NEAREST * 1.5, -1.5, 1.0, 4.0, LONG),
    ],
    ids=["below the floor", "above it", "at the ceiling", "below the camera"],
)
def test_what_is_no_skirting(line):
    assert added(level(line), wall(0, 9.0)) == []


def test_what_a_line_reaches_behind_is_no_skirting():
    """A rug before a wall whose pictures go on beside it; a picture of which nothing is sure says nothing."""
    rug = (0, 3.0, -1.5, 1.0, 4.0, LONG)
    behind = 3.0 * BEYOND
    for reach, probability, count in ((1.1, 0.9, 0), (0.9, 0.9, 1), (1.1, 0.05, 1)):
        lines = level(rug, (1, 9.0, 0.5, 1.0, reach * behind, 50.0), probability=[0.9, probability])
        assert len(added(lines, wall(0, 9.0))) == count


def test_a_side_with_a_wall_needs_none():
    lines = level((0, 3.0, -1.5, 1.0, 4.0, LONG), (0, -2.0, -1.5, 1.0, 4.0, LONG))
    (found,) = added(lines, wall(1, 1.0), wall(0, -5.0))
    assert found.offset == -2.0


@given(st.sampled_from([0, 1]), st.sampled_from([-1.0, 1.0]), st.floats(3.0, 8.0), st.floats(0.0, 0.9))
def test_a_wall_with_few_lines_goes_on_along_its_skirting(along, side, offset, off):
    """As far as its own lines reach, too, and up to the ceiling."""
    frame = (along, side * offset, 0.5, 1.5, 2.5, 20.0)  # of a door
    lines = level((along, side * offset * np.exp(off * RELIEF), -1.5, -1.0, 2.0, LONG), frame)
    known = Surface("wall", 1 - along, side * offset, np.array([1]), 7)
    before = [wall(along, 20.0), known, wall(1 - along, 0.5 * side * offset), FLOOR, CEILING]
    found = with_skirtings(before, lines, CAMERA, ())
    assert len(found) == len(before)
    assert [one for one, other in zip(found, before, strict=True) if one is not other] == [found[1]]
    assert (found[1].offset, found[1].plane, found[1].lines.tolist()) == (side * offset, 7, [1])
    assert found[1].box[:, along] == pytest.approx([-1.0, 2.5], abs=0.03)
    assert found[1].box[:, 1 - along] == pytest.approx([side * offset] * 2)
    assert found[1].box[:, 2] == pytest.approx([-1.5, 1.2])


def test_one_line_of_a_wall_that_ends_elsewhere_does_not_make_it_longer():
    own = [(0, 3.0, 0.5, 1.0, 2.0, 20.0)] * 60 + [(0, 3.0, 0.5, 1.0, 40.0, 20.0)]
    known = Surface("wall", 1, 3.0, np.arange(1, 62), 7)
    found = with_skirtings([known, FLOOR, CEILING], level((0, 3.0, -1.5, -1.0, 2.0, LONG), *own), CAMERA, ())
    assert found[0].box[:, 0] == pytest.approx([-1.0, 2.0])


def test_the_box_of_a_wall_of_another_frame_holds_for_all_directions():
    turns = (0.5,)
    known = Surface("wall", 4, 2.0, np.array([0]), 7)
    lines = level((3, 2.0, -1.5, 1.0, 4.0, LONG), turns=turns)
    (found, *_) = with_skirtings([known, FLOOR, CEILING], lines, CAMERA, turns)
    assert found.box[:, 4] == pytest.approx([2.0, 2.0])
    along = np.array([found.box[0, 3], found.box[1, 3]])
    axes = directions_of(turns)
    points = np.outer(along, axes[3]) + 2.0 * axes[4]
    assert found.box[:, :2] == pytest.approx(np.sort(components(points, turns)[:, :2], axis=0))


def test_what_a_depth_map_shows_of_a_wall_is_kept_within_a_wider_box():
    of_map = Surface("wall", 1, 3.0, NONE, None, np.array([[5.0, 3.0, -1.0], [7.0, 3.0, 1.0]]))
    found = with_skirtings([of_map, FLOOR, CEILING], level((0, 3.0, -1.5, 1.0, 2.0, LONG)), CAMERA, ())
    assert found[0].box.T.tolist() == [[1.0, 7.0], [3.0, 3.0], [-1.5, 1.2]]


@pytest.mark.parametrize(
    ("skirting", "beyond"),
    [
        ((0, 3.0 * np.exp(1.1 * RELIEF), -1.5, 1.0, 4.0, LONG), None),
        ((0, 3.0, -1.5, 1.0, 4.0, 0.9 * LEAST_LENGTH * CAMERA.width), None),
        ((0, 3.0, -1.3, 1.0, 4.0, LONG), None),
        ((0, 3.0, -1.5, 1.0, 4.0, LONG), (1, 9.0, 0.5, 1.0, 9.0, 50.0)),
    ],
    ids=["elsewhere", "short", "above the floor", "lines behind"],
)
def test_a_wall_without_a_skirting_stays_as_it_is(skirting, beyond):
    before = [wall(1, 3.0), FLOOR, CEILING]
    assert with_skirtings(before, level(*filter(None, (skirting, beyond))), CAMERA, ()) == before


def test_a_turned_frame_has_skirtings_if_it_has_walls():
    turns = (0.3,)
    lines = level((3, 2.0, -1.5, 1.0, 4.0, LONG), turns=turns)
    (found,) = added(lines, wall(3, 9.0), turns=turns)
    assert (found.axis, found.offset) == (int(partner(3)), pytest.approx(2.0))
    assert found.box.shape[1] == components(np.zeros(3), turns).shape[-1]
    assert added(lines, wall(0, 9.0), turns=turns) == []  # a table that stands askew


@pytest.mark.parametrize("level_surface", [FLOOR, CEILING])
def test_without_floor_and_ceiling_nothing_is_a_room(level_surface):
    lines = level((0, 3.0, -1.5, 1.0, 4.0, LONG))
    before = [wall(0, 9.0), level_surface]
    assert with_skirtings(before, lines, CAMERA, ()) == before
