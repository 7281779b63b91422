"""Bundles: the ratio of scales that crossings of two bodies ask for, and what is counted of them."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.line_graph import Segments
from linecad.ties.bodies import RigidBodies
from linecad.ties.bundles import MOST, WIDTH, find_bundles
from linecad.ties.setting import Setting, Sight

LINES = 6  # of each body of `two`
SIGHT = Sight(np.eye(3), np.eye(3), 3840, None)


def two(graph, width=3840):
    """Two bodies of LINES lines each."""
    body = np.repeat([0, 1], LINES)
    return Setting(graph, np.zeros(2 * LINES), RigidBodies(body, 2), None, replace(SIGHT, width=width))


def across(*pairs):
    """Edges from lines of the first body of `two` to lines of the second."""
    return [(first, LINES + second) for first, second in pairs]


@pytest.mark.parametrize("swapped", [False, True])
def test_the_ratio_makes_the_crossings_hold(build_town, build_row, build_setting, swapped):
    seen = build_town(*build_row(3))
    body = 1 - seen.part if swapped else seen.part
    by = (0.3, -0.4)
    moved = build_setting(seen, moved=by, body=body)
    (bundle,) = find_bundles(moved)
    assert bundle.bodies == (0, 1)
    assert bundle.log_ratio == pytest.approx(by[1] - by[0])
    assert (seen.graph.misfit(moved.log_depth)[bundle.edges] > 0.5).all()
    placed = moved.log_depth + np.where(body == 0, bundle.log_ratio, 0.0)
    assert (seen.graph.misfit(placed)[bundle.edges] < 1e-9).all()
    between = seen.part[seen.graph.edges[:, 0]] != seen.part[seen.graph.edges[:, 1]]
    assert sorted(bundle.edges.tolist()) == np.flatnonzero(between).tolist()
    assert bundle.coordinates == {1}


@pytest.mark.parametrize(("body", "log_ratio"), [((0, 1), 0.2 - 0.5 + 0.1), ((1, 0), -0.2 + 0.5 - 0.1)])
def test_a_ratio_has_the_sign_of_the_smaller_body(build_links, body, log_ratio):
    graph = build_links(2, [(0, 1)], log_ratio=np.array([0.2]))
    (bundle,) = find_bundles(Setting(graph, np.array([0.5, 0.1]), RigidBodies(np.array(body), 2), None, SIGHT))
    assert bundle.log_ratio == pytest.approx(log_ratio)


def test_crossings_that_ask_for_different_ratios_are_bundles_of_their_own(build_links):
    edges = across((0, 0), (1, 1), (2, 2), (3, 3), (4, 4))
    ratio = np.array([0.0, 0.5, 1.9 * WIDTH, 0.5, 0.52])
    weight = np.array([4.0, 1.0, 2.0, 1.0, 1.0])
    found = find_bundles(two(build_links(2 * LINES, edges, log_ratio=ratio, weight=weight)))
    assert [bundle.edges.tolist() for bundle in found] == [[0, 2], [1, 3, 4]]
    assert [bundle.log_odds for bundle in found] == [6.0, 3.0]
    assert [bundle.of_all for bundle in found] == [9.0, 9.0]
    assert found[0].log_ratio == pytest.approx(1.9 * WIDTH * 2 / 6)


@pytest.mark.parametrize(("apart", "bundles"), [(1.9, 1), (2.1, 2)])
def test_crossings_of_a_bundle_ask_for_nearly_the_same(build_links, apart, bundles):
    graph = build_links(2 * LINES, across((0, 0), (1, 1)), log_ratio=np.array([0.0, apart * WIDTH]))
    assert len(find_bundles(two(graph))) == bundles


def test_no_two_bodies_have_more_bundles_than_a_few(build_links):
    pairs = [(first, second) for first in range(3) for second in range(3)]
    graph = build_links(2 * LINES, across(*pairs), log_ratio=np.arange(9.0), weight=np.arange(1.0, 10.0))
    found = find_bundles(two(graph))
    assert [bundle.edges.tolist() for bundle in found] == [[8 - place] for place in range(MOST)]


def test_crossings_within_a_body_or_of_no_body_tell_nothing(build_links):
    graph = build_links(4, [(0, 1), (0, 2), (0, 3)])
    setting = Setting(graph, np.zeros(4), RigidBodies(np.array([0, 0, 1, -1]), 2), None, SIGHT)
    assert [bundle.edges.tolist() for bundle in find_bundles(setting)] == [[1]]


@pytest.mark.parametrize("field", ["possible", "informative"])
def test_crossings_that_cannot_tell_are_in_no_bundle(build_links, field):
    graph = build_links(2 * LINES, across((0, 0), (1, 1)), **{field: np.array([True, False])})
    assert [bundle.edges.tolist() for bundle in find_bundles(two(graph))] == [[0]]


def test_bundles_of_all_pairs(build_links):
    graph = build_links(6, [(0, 2), (0, 4), (1, 5), (3, 5)])
    setting = Setting(graph, np.zeros(6), RigidBodies(np.array([2, 2, 0, 0, 1, 1]), 3), None, SIGHT)
    found = find_bundles(setting)
    assert [(bundle.bodies, bundle.edges.tolist()) for bundle in found] == [
        ((0, 1), [3]),
        ((0, 2), [0]),
        ((1, 2), [1, 2]),
    ]


@given(st.sets(st.tuples(st.integers(0, 3), st.integers(0, 3)), min_size=1, max_size=9))
def test_matched_is_the_most_crossings_without_a_common_line(build_links, pairs):
    graph = build_links(2 * LINES, sorted(across(*pairs)))
    (bundle,) = find_bundles(two(graph))
    best = max(
        size
        for size in range(1, 5)
        for chosen in combinations(sorted(pairs), size)
        if all(len(set(side)) == size for side in zip(*chosen, strict=True))
    )
    assert bundle.matched == best
    assert bundle.fewest == min(len(set(side)) for side in zip(*pairs, strict=True))


def test_corners_and_pieces_are_counted(build_links):
    edges = across((0, 0), (1, 1), (2, 2), (3, 3), (4, 4), (5, 5))
    kind, coordinate = np.array(["L", "X", "collinear", "L", "L", "collinear"]), np.array([0, 1, 1, 0, 1, 0])
    (bundle,) = find_bundles(two(build_links(2 * LINES, edges, kind=kind, coordinate=coordinate)))
    assert (bundle.corners, bundle.pieces, bundle.coordinates) == (3, 2, {0, 1})


@pytest.mark.parametrize("width", [3840, 960])
def test_gap_is_the_smallest_of_the_wider_ones_at_the_reference_width(build_links, width):
    gap = np.array([[9.0, 2.0], [1.0, 8.0], [12.0, 0.0]])
    graph = build_links(2 * LINES, across((0, 0), (1, 1), (2, 2)), gap=gap)
    (bundle,) = find_bundles(two(graph, width))
    assert bundle.gap == 8.0 * 3840 / width


# Where two crossings lie of a line from (0, 0) to (100, 0) with one from (50, 10) to (50, 90): at the first end of the
# second, or at the end of the first; the stems are then of the second body, or of the first.
SECOND_ENDS, FIRST_ENDS = [50.0, 9.0], [101.0, 50.0]


@pytest.mark.parametrize(
    ("crossing", "kind", "from_both"),
    [
        ([SECOND_ENDS, FIRST_ENDS], ["T", "T"], True),
        ([SECOND_ENDS, SECOND_ENDS], ["T", "T"], False),
        ([FIRST_ENDS, FIRST_ENDS], ["T", "T"], False),
        ([SECOND_ENDS, FIRST_ENDS], ["T", "X"], False),
        ([SECOND_ENDS, FIRST_ENDS], ["L", "T"], False),
    ],
)
def test_bundles_from_both_have_stems_of_either_body(build_links, crossing, kind, from_both):
    ends = np.concatenate(
        [np.tile([[[0.0, 0], [100, 0]]], (LINES, 1, 1)), np.tile([[[50.0, 10], [50, 90]]], (LINES, 1, 1))]
    )
    graph = build_links(
        2 * LINES,
        across((0, 0), (1, 1)),
        segments=Segments(ends, np.repeat([0, 2], LINES)),
        crossing=np.array(crossing),
        kind=np.array(kind),
    )
    (bundle,) = find_bundles(two(graph))
    assert bundle.from_both is from_both


def test_bodies_that_do_not_cross_have_no_bundle(build_links):
    assert find_bundles(two(build_links(2 * LINES, []))) == []
