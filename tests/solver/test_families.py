from solver.families import (
    SharedNeighbour,
    find_families,
    find_four_cycles,
    find_parallel_pairs,
    find_three_cycles,
    find_two_sides,
)
from solver.options import FAMILIES

# x0, x1 parallel; y2, y3 and z4, z5 meet them or not according to the edges of each test
LINES = [
    (0, (0, 6, 1), 0.5, 3),
    (0, (0, 6, 2), 0.5, 3),
    (1, (1, 0, 1), 5, 7),
    (1, (2, 0, 1), 5, 7),
    (2, (1, 6, 0), 0.5, 3),
    (2, (2, 6, 0), 0.5, 3),
]


def lines_of(graph, cycle):
    """The lines around a cycle of edges, each edge sharing one with the next."""
    pairs = [set(graph.edges[e].tolist()) for e in cycle]
    return [(pairs[n - 1] & pairs[n]).pop() for n in range(len(pairs))]


def test_three_lines_that_cross_each_other_are_a_three_cycle(build_graph):
    graph = build_graph(LINES, [(0, 2), (0, 4), (2, 4), (1, 2), (1, 5)])
    assert find_three_cycles(graph) == ((0, 2, 1),)


def test_every_four_cycle_of_three_axes_is_found_once_and_in_order(build_graph):
    graph = build_graph(LINES, [(k, m) for k in (0, 1) for m in (2, 3)] + [(m, k) for m in (2, 3) for k in (4, 5)])
    around = [lines_of(graph, cycle) for cycle in find_four_cycles(graph)]
    assert sorted(sorted(lines) for lines in around) == [[0, 2, 3, 4], [0, 2, 3, 5], [1, 2, 3, 4], [1, 2, 3, 5]]
    assert all({lines[0], lines[2]} == {2, 3} or {lines[1], lines[3]} == {2, 3} for lines in around)


def test_a_four_cycle_of_two_axes_is_none(build_graph):
    assert find_four_cycles(build_graph(LINES, [(0, 2), (0, 3), (1, 2), (1, 3)])) == ()


def test_edges_that_say_nothing_of_depth_stand_in_no_cycle(build_graph):
    edges = [(0, 2), (0, 4), (2, 4)]
    graph = build_graph(LINES, edges, informative=[True, False, True])
    assert find_three_cycles(graph) == ()


def test_collinear_edges_stand_in_no_family(build_graph):
    graph = build_graph(LINES, [(0, 1), (0, 2), (1, 2)])
    assert graph.kind[0] == "collinear"
    assert find_three_cycles(graph) == ()
    assert [pair.shared for pair in find_parallel_pairs(graph)] == [(SharedNeighbour(1, 1, 2),)]
    assert find_two_sides(graph) == ()


def test_parallel_lines_without_a_common_neighbour_are_no_pair(build_graph):
    assert len(find_parallel_pairs(build_graph(LINES, [(0, 2), (1, 3)]))) == 0


def test_a_pair_lists_all_its_common_neighbours(build_graph):
    graph = build_graph(LINES, [(0, 2), (0, 4), (1, 2), (1, 4), (1, 5)])
    (pair,) = (pair for pair in find_parallel_pairs(graph) if pair.lines == (0, 1))
    assert pair.axes == (1, 2)
    assert pair.shared == (SharedNeighbour(1, 0, 2), SharedNeighbour(2, 1, 3))


def test_a_common_neighbour_that_cannot_meet_both_makes_no_pair(build_graph, change):
    graph = build_graph(LINES, [(0, 2), (1, 2)])
    assert len(find_parallel_pairs(graph)) == 1
    assert len(find_parallel_pairs(change(graph, possible=[True, False]))) == 0


def test_a_line_with_crossings_of_both_other_axes_has_two_sides(build_graph):
    graph = build_graph(LINES, [(0, 2), (0, 3), (0, 4), (1, 2)])
    (two,) = find_two_sides(graph)
    assert two.line == 0
    assert two.sides == ((0, 1), (2,))


def test_a_family_that_is_off_is_empty(build_graph):
    graph = build_graph(LINES)
    on = find_families(graph, frozenset())
    assert all([on.three_cycles, on.four_cycles, on.pairs, on.two_sides])
    for family, names in zip(FAMILIES, [("three_cycles", "four_cycles"), ("pairs",), ("two_sides",)], strict=True):
        off = find_families(graph, frozenset({family}))
        for name in ("three_cycles", "four_cycles", "pairs", "two_sides"):
            assert list(getattr(off, name)) == ([] if name in names else list(getattr(on, name)))
