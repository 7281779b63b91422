"""Planes of lines that lie in them exactly."""

import numpy as np
import pytest

from linecad.graph.connectivity import components
from linecad.model.lifting import lift
from linecad.model.planes import MIN_LINES, find_planes


def in_one_plane(axis, place, pairs):
    """Lines in the plane of normal `axis`: each a start in its two coordinates and a length along the first or second.

    Returns what `find_planes` takes: offsets, numbers of shared coordinates, ids.
    """
    across = [other for other in range(3) if other != axis]
    ends = np.full((len(pairs), 2, 3), float(place))
    shared = np.full((len(pairs), 3), -1)
    offset = np.full((len(pairs), 3), np.nan)
    for i, (u, v, length, along) in enumerate(pairs):
        ends[i, :, across] = np.array([[u, u], [v, v]])
        ends[i, 1, across[along]] += length
        shared[i, axis], offset[i, axis] = 0, place
        shared[i, across[1 - along]] = i + 1
        offset[i, across[1 - along]] = ends[i, 0, across[1 - along]]
    return offset, shared, 100 + np.arange(len(pairs))


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_lines_that_share_an_offset_are_a_plane(axis):
    offset, shared, ids = in_one_plane(axis, 2.5, [(0, 0, 4, 0), (0, 3, 4, 0), (0, 0, 3, 1), (4, 0, 3, 1)])
    (plane,) = find_planes(offset, shared, ids)
    assert (plane.id, plane.axis, plane.offset, plane.lines) == (0, axis, 2.5, (100, 101, 102, 103))
    assert plane.faces == ()


def test_the_pieces_of_one_line_are_no_plane():
    assert find_planes(*in_one_plane(1, 5.0, [(0, 0, 1, 0), (2, 0, 1, 0), (4, 0, 1, 0)])) == ()


def test_few_lines_are_no_plane():
    pairs = [(0, 0, 4, 0), (0, 0, 3, 1), (4, 0, 3, 1)]
    assert len(find_planes(*in_one_plane(1, 5.0, pairs[:MIN_LINES]))) == 1
    assert find_planes(*in_one_plane(1, 5.0, pairs[: MIN_LINES - 1])) == ()


def test_no_lines_no_planes():
    assert find_planes(np.zeros((0, 3)), np.zeros((0, 3), int), np.zeros(0, int)) == ()


def test_the_true_planes_of_the_made_scene_are_found(made):
    graph = made.graph()
    chosen = made.truly_real(graph)
    log_depth = np.log([made.depth_at(i, ends.mean(axis=0)) for i, ends in enumerate(made.pixels)])
    lifted = lift(graph, chosen, np.array(log_depth))
    planes = find_planes(lifted.offset, lifted.shared, np.arange(len(made.axis)))
    # Every set of three or more lines of one box that share a coordinate other than their own axis.
    expected = set()
    for part in components(graph):
        for axis in range(3):
            own = part[made.axis[part] != axis]
            places = made.ends[own, 0, axis]
            for place in np.unique(places):
                members = own[places == place]
                if len(members) >= MIN_LINES:
                    expected.add((axis, round(float(place), 6), tuple(members.tolist())))
    found = {(plane.axis, round(plane.offset, 6), tuple(sorted(plane.lines))) for plane in planes}
    assert found == expected
    assert {(1, 9.0), (0, -2.2), (1, 7.0), (0, 2.6)} <= {row[:2] for row in found}
    counts = [len(plane.lines) for plane in planes]
    assert counts == sorted(counts, reverse=True)
    assert [plane.id for plane in planes] == list(range(len(planes)))
