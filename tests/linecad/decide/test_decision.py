"""The final decision: one reason for every crossing, and what follows from the real ones alone."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.corrections.annotations import Annotations
from linecad.decide.annotations import annotate
from linecad.decide.bodies import agreeing
from linecad.decide.decision import decide
from linecad.decide.stability import find_stable_bodies, resample
from linecad.line_graph import LineGraph, Segments, Solution
from linecad.options import Options
from linecad.scene import REASONS
from solver.choice import boundaries, planar_pairs
from solver.families import find_families

GRID = 12  # lines of each direction of a wall
ALL, LOOSE, STABLE = Options(joins="all"), Options(joins="biconnected"), Options(joins="stable")


def walls(between=(), lone=0):
    """Two walls, each a grid of level and upright lines, `lone` pairs of lines that cross, and crossings `between`."""
    axis = np.concatenate([np.tile(np.repeat([0, 2], GRID), 2), np.tile([0, 2], lone)]).astype(int)
    level, upright = np.arange(GRID), np.arange(GRID, 2 * GRID)
    own = [(int(i), int(j)) for i in level for j in upright]
    second = [(i + 2 * GRID, j + 2 * GRID) for i, j in own]
    pairs = [(4 * GRID + 2 * k, 4 * GRID + 2 * k + 1) for k in range(lone)]
    edges = np.array([*own, *second, *pairs, *between])
    yes = np.ones(len(edges), bool)
    return LineGraph(
        segments=Segments(np.tile([[0.0, 0.0], [90.0, 0.0]], (len(axis), 1, 1)), axis),
        rays=np.ones((len(axis), 3)),
        end_rays=np.ones((len(axis), 2, 3)),
        edges=edges,
        crossing=np.zeros((len(edges), 2)),
        gap=np.zeros((len(edges), 2)),
        kind=np.where(np.arange(len(edges)) < 2 * len(own), "L", "T"),  # lines end where their own wall ends
        corner=~yes,
        weight=np.ones(len(edges)),
        coordinate=3 - axis[edges].sum(axis=1),
        log_ratio=np.zeros(len(edges)),
        tolerance=np.full(len(edges), 0.005),
        possible=yes,
        informative=yes,
    )


def solution_of(graph, connected=None):
    connected = np.ones(len(graph.edges), bool) if connected is None else connected
    return Solution(
        status="optimal", solver="by hand", formulation="gain", objective=0.0, bound=0.0, gap=0.0, seconds=0.0,
        nodes=0, connected=connected, is_boundary=boundaries(graph, connected),
        planar_pairs=planar_pairs(find_families(graph, frozenset()), connected),
        log_depth=np.zeros(len(graph.segments)),
    )  # fmt: skip


def decided(graph, options=ALL, connected=None, annotations=None, inconsistency=None):
    annotations = annotate(graph, None)[1] if annotations is None else annotations
    return decide(graph, solution_of(graph, connected), options, inconsistency, annotations)


def annotations_of(graph, real=(), fake=()):
    flags = np.zeros((2, len(graph.edges)), bool)
    flags[0, list(real)], flags[1, list(fake)] = True, True
    return Annotations(*flags, (None,) * len(graph.edges), ())


def crossing(graph, pair):
    (edge,) = np.flatnonzero((graph.edges == pair).all(axis=1)).tolist()
    return edge


ONE_BAR = [(0, 3 * GRID + k) for k in range(GRID)]  # a course of the first wall meets all uprights of the second


def test_what_the_program_chose_is_real_and_what_it_left_out_is_not():
    graph = walls()
    connected = np.arange(len(graph.edges)) != 5
    found = decided(graph, connected=connected)
    assert found.reason[5] == "not chosen"
    assert set(np.delete(found.reason, 5)) == {"chosen"}
    assert (found.real == connected).all()


def test_every_crossing_has_one_reason_and_only_two_of_them_are_real():
    graph = walls(ONE_BAR, lone=1)
    found = decided(graph, LOOSE, np.arange(len(graph.edges)) % 7 != 0, annotations_of(graph, real=[3], fake=[7]))
    assert set(found.reason) <= set(REASONS)
    assert set(found.reason[found.real]) <= {"chosen", "annotated"}
    assert "chosen" not in set(found.reason[~found.real])


def test_lines_that_cannot_meet_before_the_camera():
    graph = walls()
    possible = np.arange(len(graph.edges)) != 2
    graph = replace(graph, possible=possible, informative=possible)
    assert decided(graph, connected=possible).reason[2] == "impossible"


def test_a_crossing_at_the_horizon_joins_no_two_groups():
    graph = walls([(0, 3 * GRID)])
    last = len(graph.edges) - 1
    graph = replace(graph, informative=np.arange(len(graph.edges)) != last)
    found = decided(graph)
    assert found.reason[last] == "uninformative"
    assert not found.real[last]


def test_a_crossing_at_the_horizon_within_a_group_may_be_real():
    graph = walls()
    graph = replace(graph, informative=np.arange(len(graph.edges)) != 0)
    assert decided(graph).reason[0] == "chosen"


def test_bodies_that_one_line_ties_are_not_joined():
    graph = walls(ONE_BAR)
    found = decided(graph, LOOSE)
    joins = np.arange(len(graph.edges)) >= 2 * GRID**2
    assert set(found.reason[joins]) == {"loose"}
    assert found.real[~joins].all()
    assert any(f"{GRID} crossings join bodies" in note for note in found.notes)


def test_bodies_that_two_lines_tie_are_joined():
    graph = walls(ONE_BAR + [(1, 3 * GRID + k) for k in range(GRID)])
    assert decided(graph, LOOSE).real.all()


def test_a_join_that_falls_with_a_few_lines_is_unstable():
    # Every other crossing between the walls asks for another relative depth: which of them wins depends on the lines.
    graph = walls([(i, 3 * GRID + j) for i in range(9) for j in range(6)])
    first, second = graph.edges.T
    between = second - first > 2 * GRID
    between[: 2 * GRID**2] = False
    ratio = np.where(between & (first % 2 == 1), 0.2, 0.0)
    graph = replace(graph, log_ratio=ratio)
    found = decided(graph, STABLE, ratio == 0, inconsistency=0.5)
    assert set(found.reason[between & (ratio == 0)]) == {"unstable"}
    assert found.real[~between].all()
    assert any("often contradict each other" in note for note in found.notes)


def test_stable_joins_need_the_inconsistency_of_the_photo():
    with pytest.raises(ValueError, match="inconsistency"):
        decided(walls(), STABLE)


def test_a_group_of_few_lines_is_too_small():
    graph = walls(lone=1)
    found = decided(graph)
    assert found.reason[crossing(graph, [4 * GRID, 4 * GRID + 1])] == "small group"
    assert (found.reason == "small group").sum() == 1


def test_annotations_come_before_everything_else():
    graph = walls(ONE_BAR, lone=1)
    join, lone, other = crossing(graph, ONE_BAR[0]), crossing(graph, [4 * GRID, 4 * GRID + 1]), 4
    found = decided(graph, LOOSE, np.arange(len(graph.edges)) != other, annotations_of(graph, [join, lone], [other]))
    assert found.reason[[join, lone, other]].tolist() == ["annotated"] * 3
    assert found.real[[join, lone, other]].tolist() == [True, True, False]
    assert found.real[[crossing(graph, pair) for pair in ONE_BAR]].all()  # the two walls are one body now


def test_boundaries_and_planar_pairs_are_those_of_the_real_crossings():
    # The bar of the first wall runs along x; a refused join to lines along y is all that makes it a boundary.
    graph = walls(ONE_BAR)
    axis = np.where(np.arange(4 * GRID) // GRID == 3, 1, graph.axis)
    coordinate = 3 - axis[graph.edges].sum(axis=1)
    graph = replace(graph, segments=Segments(graph.segments.ends, axis), coordinate=coordinate)
    solution = solution_of(graph)
    found = decided(graph, LOOSE)
    assert solution.is_boundary[0]
    assert not found.is_boundary[0]
    assert (found.is_boundary == boundaries(graph, found.real)).all()
    expected = planar_pairs(find_families(graph, frozenset()), found.real)
    assert np.array_equal(found.planar_pairs, expected)
    assert not np.array_equal(expected, solution.planar_pairs)


def test_a_line_with_a_refused_crossing_is_not_firm():
    graph = walls(ONE_BAR)
    found = decided(graph, LOOSE)
    refused = np.unique(graph.edges[2 * GRID**2 :])
    assert not found.is_firm[refused].any()
    assert np.delete(found.is_firm, refused).all()


def test_a_line_on_a_single_crossing_is_not_firm():
    graph = walls()
    only = (graph.edges == 0).any(axis=1) & (graph.edges != [0, GRID]).any(axis=1)
    found = decided(graph, connected=~only)
    assert not found.is_firm[0]
    assert found.is_firm[1:].all()


def contradicting(graph):
    """The same with every other crossing between the walls at another relative depth, and the mask of the rest."""
    first = graph.edges[:, 0]
    between = np.arange(len(graph.edges)) >= 2 * GRID**2
    ratio = np.where(between & (first % 2 == 1), 0.2, 0.0)
    return replace(graph, log_ratio=ratio), between & (ratio == 0)


MANY_BARS = [(i, 3 * GRID + j) for i in range(9) for j in range(6)]


def test_an_annotated_join_makes_unstable_bodies_one():
    graph, joins = contradicting(walls(MANY_BARS))
    free = decided(graph, STABLE, graph.log_ratio == 0, inconsistency=0.5)
    assert set(free.reason[joins]) == {"unstable"}
    one = int(np.flatnonzero(joins)[0])
    fixed = decided(graph, STABLE, graph.log_ratio == 0, annotations_of(graph, real=[one]), inconsistency=0.5)
    assert fixed.reason[one] == "annotated"
    assert fixed.real[joins].all()


def test_in_an_inconsistent_photo_stable_bodies_that_one_line_joins_are_loose():
    graph = walls(ONE_BAR)
    found = decided(graph, STABLE, inconsistency=0.5)
    joins = np.arange(len(graph.edges)) >= 2 * GRID**2
    assert set(found.reason[joins]) <= {"loose", "unstable"}
    assert "loose" in set(found.reason[joins])
    assert any("that fewer than two lines join" in note for note in found.notes)


def test_in_a_consistent_photo_a_rigid_line_that_is_not_firm_is_not_as_sure_as_the_solution():
    graph, _ = contradicting(walls(MANY_BARS))
    fits = resample(graph, STABLE.solve.seed)
    solution = solution_of(graph, graph.log_ratio == 0)
    stable = find_stable_bodies(
        graph, agreeing(graph, solution.connected, solution.log_depth), solution.log_depth, fits, False
    )
    found = decided(graph, STABLE, graph.log_ratio == 0, inconsistency=0.0)
    assert (stable.bodies.rigid & ~stable.firm).any()
    assert not found.is_firm[stable.bodies.rigid & ~stable.firm].any()


def test_what_is_left_out_for_the_largest_group_is_of_another_group():
    graph = walls()
    found = decided(graph)
    first = np.arange(len(graph.segments)) < 2 * GRID
    kept = found.within(first, graph)
    inside = first[graph.edges].all(axis=1)
    assert set(kept.reason[inside]) == {"chosen"}
    assert set(kept.reason[~inside]) == {"other group"}
    assert (kept.real == inside).all()
    assert not kept.is_boundary[~first].any()


def test_a_refusal_that_parts_a_group_leaves_no_crossing_at_the_horizon_between_its_pieces():
    graph = walls([*ONE_BAR, (1, 3 * GRID)])
    last = len(graph.edges) - 1
    graph = replace(graph, informative=np.arange(len(graph.edges)) != last)
    found = decided(graph, LOOSE)
    assert not found.real[last]
    assert found.reason[last] in ("loose", "uninformative")
