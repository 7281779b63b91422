"""Plain walls of which a room shows the skirting alone."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.directions import components, directions_of, partner
from linecad.geometry import central_camera
from linecad.model.regions.skirtings import AT_FLOOR, LEAST_LENGTH, with_skirtings
from linecad.model.regions.surfaces import RELIEF, Surface
from linecad.scene import Camera, Lines

CAMERA = Camera(1000, 800, central_camera(800.0, 1000, 800), "file")
NONE = np.zeros(0, np.int64)
FLOOR, CEILING = Surface("ground", 2, -1.5, NONE, None), Surface("ceiling", 2, 1.2, NONE, None)
LONG = 1.1 * LEAST_LENGTH * CAMERA.width  # px


def level(*lines, turns=()):
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
        is_boundary=np.zeros(count, bool), component=np.zeros(count, np.int64), confidence=np.full(count, "proven"),
    )  # fmt: skip


def walls(lines, *others, turns=()):
    """What is added."""
    before = [*others, FLOOR, CEILING]
    found = with_skirtings(before, lines, CAMERA, turns)
    assert found[: len(before)] == before
    return found[len(before) :]


@given(st.sampled_from([0, 1]), st.sampled_from([-1.0, 1.0]), st.floats(0.5, 8.0), st.floats(2.0, 5.0))
def test_the_farthest_long_line_on_the_floor_is_the_foot_of_a_wall(along, side, offset, reach):
    of_rug = (along, 0.7 * side * offset, -1.5, 1.0, reach, LONG)
    (wall,) = walls(level((along, side * offset, -1.5, 1.0, reach, LONG), of_rug))
    assert (wall.kind, wall.axis, wall.plane, len(wall.lines)) == ("wall", 1 - along, None, 0)
    assert wall.offset == pytest.approx(side * offset)
    assert wall.box[:, along] == pytest.approx([0.0, reach])  # from beside the camera on
    assert wall.box[:, 2] == pytest.approx([-1.5, 1.2])


def test_pieces_of_one_skirting_count_together():
    pieces = [(0, 3.0, -1.5, 1.0, 2.0, 0.6 * LONG), (0, 3.0 * (1 + 0.9 * RELIEF), -1.5, 3.0, 4.0, 0.6 * LONG)]
    (wall,) = walls(level(*pieces))
    assert wall.box[:, 0] == pytest.approx([0.0, 4.0])
    assert walls(level(pieces[0])) == []


@pytest.mark.parametrize("height", [-1.5 * np.exp(1.1 * AT_FLOOR), -1.5 * np.exp(-1.1 * AT_FLOOR), 1.5])
def test_what_is_not_on_the_floor_is_no_skirting(height):
    assert walls(level((0, 3.0, height, 1.0, 4.0, LONG))) == []


def test_a_side_with_a_wall_needs_none():
    lines = level((0, 3.0, -1.5, 1.0, 4.0, LONG), (0, -2.0, -1.5, 1.0, 4.0, LONG))
    (wall,) = walls(lines, Surface("wall", 1, 1.0, NONE, 0), Surface("wall", 0, -5.0, NONE, 1))
    assert wall.offset == -2.0


def test_walls_of_a_turned_frame_have_skirtings_too():
    turns = (0.3,)
    (wall,) = walls(level((3, 2.0, -1.5, 1.0, 4.0, LONG), turns=turns), turns=turns)
    assert (wall.axis, wall.offset) == (int(partner(3)), pytest.approx(2.0))
    assert wall.box.shape[1] == components(np.zeros(3), turns).shape[-1]


def test_without_a_floor_nothing_is_known_of_skirtings():
    lines = level((0, 3.0, -1.5, 1.0, 4.0, LONG))
    assert with_skirtings([CEILING], lines, CAMERA, ()) == [CEILING]
