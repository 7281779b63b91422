"""Lines in the axes of their frames, and back in the world."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.directions import components, directions_of, frame_axes
from linecad.geometry import project
from linecad.model.clean.sight import Sight
from linecad.model.frames import FramedLines, framed_lines, in_frame, in_frames, planes_in, with_repeats
from linecad.scene import Face, Lines, Plane

TURNS = (0.4, -0.2)
VECTORS = directions_of(TURNS)
AXIS = np.array([0, 2, 3, 2, 4, 5])
HOME = np.array([0, 0, 1, 1, 1, 2])


def lines() -> Lines:
    start = np.random.default_rng(1).normal(size=(len(AXIS), 3)) + np.array([0.0, 9.0, 0.0])
    count = len(AXIS)
    return Lines(
        id=np.arange(count),
        axis=AXIS,
        segment=np.zeros((count, 2, 2)),
        ends=np.stack([start, start + 2 * VECTORS[AXIS]], axis=1),
        is_boundary=np.zeros(count, bool),
        component=np.zeros(count, int),
        confidence=np.full(count, "supported"),
    )


def framed() -> FramedLines:
    offset = np.full((len(AXIS), len(VECTORS)), np.nan)
    return in_frames(lines(), offset, HOME, TURNS)


def test_every_line_runs_along_an_axis_of_its_frame():
    found = framed()
    assert found.lines.axis.tolist() == [0, 2, 0, 2, 1, 0]
    along = found.lines.ends[:, 1] - found.lines.ends[:, 0]
    np.testing.assert_allclose(along, 2 * np.eye(3)[found.lines.axis], atol=1e-14)
    assert found.axis.tolist() == AXIS.tolist()


def test_lines_come_back_to_the_world():
    found = framed().in_world()
    np.testing.assert_allclose(found.ends, lines().ends, atol=1e-14)
    assert found.axis.tolist() == AXIS.tolist()


def test_components_that_lines_share_are_taken_to_the_last_bit():
    offset = np.full((len(AXIS), len(VECTORS)), np.nan)
    told = components(lines().ends[:, 0], TURNS)
    offset[2, 4], offset[2, 2] = told[2, 4] + 1e-5, told[2, 2]
    found = in_frames(lines(), offset, HOME, TURNS)
    assert (found.lines.ends[2, :, 1] == offset[2, 4]).all()
    assert found.lines.ends[2, 0, 0] == pytest.approx(told[2, 3])


def test_a_change_reaches_each_frame_apart_and_keeps_the_order():
    seen = []

    def change(part: Lines, frame: int) -> Lines:
        seen.append((frame, part.id.tolist()))
        return part

    assert framed().each(change).lines.id.tolist() == list(range(len(AXIS)))
    assert seen == [(0, [0, 1]), (1, [2, 3, 4]), (2, [5])]


def test_a_frame_has_its_planes_and_the_level_ones_in_its_axes():
    corners = np.array([[0.0, 5, 0], [1, 5, 0], [1, 5, 1]]) @ VECTORS[[3, 4, 2]]
    planes = (
        Plane(0, 1, 4.0, ()),
        Plane(1, 4, 5.0, (), (Face(0, corners),)),
        Plane(2, 2, -1.5, ()),
        Plane(3, 5, 2.0, ()),
    )
    found = planes_in(planes, 1, TURNS)
    assert [(plane.id, plane.axis) for plane in found] == [(1, 1), (2, 2)]
    np.testing.assert_allclose(found[0].faces[0].outline, [[0, 5, 0], [1, 5, 0], [1, 5, 1]], atol=1e-14)
    assert [plane.id for plane in planes_in(planes, 0, TURNS)] == [0, 2]


@pytest.mark.parametrize(
    ("frame", "ids", "axis"), [(0, [0, 1, 3], [0, 2, 2]), (1, [1, 2, 3, 4], [2, 0, 2, 1]), (2, [1, 3, 5], [2, 2, 0])]
)
def test_lines_along_a_frame_are_its_own_to_the_last_bit_and_all_uprights(frame, ids, axis):
    found = framed().along(frame)
    assert found.id.tolist() == ids
    assert found.axis.tolist() == axis
    own = framed().lines.ends
    np.testing.assert_array_equal(found.ends[HOME[ids] == frame], own[ids][HOME[ids] == frame])
    np.testing.assert_allclose(found.ends, lines().ends[ids] @ VECTORS[frame_axes(frame)].T, atol=1e-14)


def test_without_further_frames_all_lines_are_the_worlds():
    own = lines()
    assert FramedLines(own, HOME, ()).along(0) is own


def test_points_of_the_main_frame_are_those_of_the_world():
    points = lines().ends
    assert in_frame(points, 0, TURNS) is points


def test_lines_of_a_scene_are_in_their_frames_and_what_is_equal_there_is_so_to_the_last_bit(crossings):
    offset = np.full((len(AXIS), len(VECTORS)), np.nan)
    own = lines()
    told = components(own.ends[:, 0], TURNS)
    offset[:4] = told[0] + np.zeros((4, 1))  # the first four stand in one place, in each of their frames
    offset[np.arange(len(AXIS)), AXIS] = np.nan
    world = in_frames(own, offset, HOME, TURNS).in_world()
    pairs = [(0, 1), (2, 3), (2, 4), (4, 5)]
    found = framed_lines(world, crossings(pairs), TURNS)
    assert found.frame.tolist() == HOME.tolist()
    np.testing.assert_allclose(found.in_world().ends, world.ends, atol=1e-13)
    assert found.lines.ends[2, 0, 1] == found.lines.ends[3, 0, 1]
    assert found.lines.axis.tolist() == [0, 2, 0, 2, 1, 0]
    only = framed_lines(replace(own, axis=np.minimum(AXIS, 2)), crossings(pairs), ())
    assert not only.frame.any()


def test_an_edge_reaches_as_far_as_its_pieces_of_another_frame_in_the_photo(camera, rotation):
    turns = (0.1,)
    along = directions_of(turns)[3]
    level = np.array([1.0, 10, 0])  # on the horizon, where the photo shows one line
    piece, edge = np.stack([level, level + 2 * along]), np.array([[-3.0, 10, 0], [2, 10, 0]])
    far = np.array([[-3.0, 10, 0], [9, 10, 0]])
    for ends, low, high in ((edge, -3, None), (edge[::-1], -3, None), (far, -3, 9)):
        seen = project(np.stack([ends, piece]), camera.matrix, rotation)
        two = Lines(
            id=np.arange(2), axis=np.array([0, 3]), segment=seen, ends=np.stack([ends, piece]),
            is_boundary=np.zeros(2, bool), component=np.zeros(2, int), confidence=np.full(2, "weak"),
        )  # fmt: skip
        found = with_repeats(
            in_frames(two, np.full((2, 5), np.nan), np.array([0, 1]), turns), np.array([0, 0]),
            Sight.of(camera, rotation, None),
        )  # fmt: skip
        tip = piece[1] * (10 / piece[1, 1])  # where its ray meets the wall of the edge
        np.testing.assert_allclose(np.sort(found.ends[0, :, 0]), [low, high or tip[0]], atol=1e-6)
        np.testing.assert_array_equal(found.ends[0, :, 1:], ends[:, 1:])
        assert (found.ends[0, 0, 0] < found.ends[0, 1, 0]) == (ends[0, 0] < ends[1, 0])
        assert len(found.pieces[0]) == 2
