"""The optimum of every small graph, found a second time by trying all sets of real crossings."""

from functools import lru_cache
from itertools import chain, combinations, permutations
from random import Random

import numpy as np
import pytest
from hypothesis import Phase, find, given, settings
from hypothesis import strategies as st

import solver.gain.search
import solver.gain.separation
from linecad.directions import directions_of
from linecad.errors import ContradictionError
from solver.options import BACKENDS, FAMILIES, FORMULATIONS, SolveOptions
from solver.solve import solve
from solver.start import Starter

ALL_WITHOUT = [frozenset(c) for c in chain.from_iterable(combinations(FAMILIES, n) for n in range(4))]
MOST_EDGES = 10  # here, for time; tests/benchmarks/brute_force.py draws up to 12
MOST_COLLINEAR = 3
USUAL = settings.default.max_examples
GRID = 0.37  # keeps every line off the coordinate planes of the camera

# Uneven numbers, so that no sum of logarithms of grid coordinates comes to lie on the border of an interval.
TOLERANCES = [0.0021, 0.0173, 0.0611, 0.3117]
DEPTH_RANGES = [100.0, 3.07, 1.531]


@st.composite
def lines_in_space(draw, turns=()):
    """Three to seven lines on a small grid, so that many of them meet; some moved a little off it."""
    lines = []
    for _ in range(draw(st.integers(3, 7))):
        axis = draw(st.integers(0, 2 + 2 * len(turns)))
        x, y, z = draw(st.integers(-1, 2)), draw(st.integers(4, 6)), draw(st.integers(-1, 1))
        point = np.array([x, y, z]) + GRID + np.array(draw(st.sampled_from(WOBBLES)))
        place = float(directions_of(turns)[axis] @ point)
        low = place - draw(st.sampled_from([0.2, 0.9]))
        lines.append((axis, point, low, place + draw(st.sampled_from([0.4, 1.7]))))
    return lines


WOBBLES = [(0, 0, 0), (0, 0, 0), (0.0031, -0.0043, 0.0017), (-0.011, 0.023, 0.013)]


@st.composite
def problems(draw, most_edges=MOST_EDGES):
    """Arguments for `build_graph` and for SolveOptions."""
    turns = draw(st.sampled_from([(), (), (0.46,), (0.06, -0.3)]))
    lines = draw(lines_in_space(turns))
    pairs = [(i, j) for i in range(len(lines)) for j in range(i + 1, len(lines))]
    crossings = [(i, j) for i, j in pairs if lines[i][0] != lines[j][0]]
    collinear = [(i, j) for i, j in pairs if lines[i][0] == lines[j][0]]
    edges = list(draw(st.permutations(crossings)))[:most_edges]
    if collinear and draw(st.booleans()):
        added = draw(st.lists(st.sampled_from(collinear), min_size=1, max_size=MOST_COLLINEAR, unique=True))
        edges = edges[: most_edges - len(added)] + added
    each = {"min_size": len(edges), "max_size": len(edges)}
    graph = {
        "lines": lines,
        "edges": edges,
        "tolerance": draw(st.lists(st.sampled_from(TOLERANCES), **each)),
        "weight": draw(st.lists(st.sampled_from([0.4, 1.0, 1.0, 2.3]), **each)),
        "informative": draw(st.lists(st.sampled_from([True, True, True, False]), **each)),
        "yaw": draw(st.sampled_from([0.3, -0.2])),
        "turns": turns,
    }
    options = {
        "mu_planarity": draw(st.sampled_from([0.0, 0.5, 3.0])),
        "mu_boundary": draw(st.sampled_from([0.3, 1.0, 10.0])),
        "depth_range": draw(st.sampled_from(DEPTH_RANGES)),
    }
    return graph, options


def remembered(table):
    """Of the last graphs: what follows depends on the graph alone, and all combinations of families ask for it."""

    @lru_cache(maxsize=4)
    def compute(*arguments):
        array = table(*arguments)
        array.flags.writeable = False
        return array

    return compute


@remembered
def all_subsets(n):
    return (np.arange(2**n)[:, None] >> np.arange(n)) & 1 == 1


@remembered
def fits_depths(graph, depth_range):
    """Which sets of edges have depths: shortest paths between all lines and the ground, no negative cycle."""
    subsets = all_subsets(len(graph.edges))
    n = len(graph.segments)
    axis = directions_of(graph.turns)[graph.axis]
    flat = np.linalg.norm(np.cross(graph.rays, axis), axis=1)  # of the ray, across the line's axis
    ends = np.linalg.norm(np.cross(graph.end_rays, axis[:, None]), axis=2)
    nearest = np.log((flat[:, None] / ends).min(axis=1))  # log of near end depth over middle depth
    dist = np.full((len(subsets), n + 1, n + 1), np.inf)
    dist[:, :n, n] = nearest  # t_ground - t_i <= nearest, so that the near end is at 1 or more
    dist[:, n, :n] = np.log(depth_range) - nearest
    for e in np.flatnonzero(graph.informative):
        i, j = graph.edges[e]
        c, tolerance = graph.log_ratio[e], graph.tolerance[e]
        dist[:, j, i] = np.where(subsets[:, e], c + tolerance, dist[:, j, i])  # t_i <= t_j + c + tolerance
        dist[:, i, j] = np.where(subsets[:, e], tolerance - c, dist[:, i, j])
    for k in range(n + 1):
        dist = np.minimum(dist, dist[:, :, k, None] + dist[:, None, k, :])
    fits = (np.diagonal(dist, axis1=1, axis2=2) >= -1e-9).all(axis=1)
    return fits & ~(subsets & ~graph.possible).any(axis=1)


def axes_of(frame):
    """The axes of a frame, the first of further ones being number 1."""
    return {0, 1, 2} if frame == 0 else {2 * frame + 1, 2 * frame + 2, 2}


def frames(graph):
    """The frame of each line, of an upright one that in which it has most crossings."""
    found = []
    for line, axis in enumerate(graph.axis.tolist()):
        met = [graph.axis[i + j - line] for i, j in graph.edges.tolist() if line in (i, j)]
        met = [other for other in met if other != 2]
        own = [frame for frame in range(len(graph.turns) + 1) if axis in axes_of(frame)]
        found.append(max(own, key=lambda frame: (sum(other in axes_of(frame) for other in met), -frame)))
    return np.array(found)


def in_one_frame(graph):
    """Which edges families speak about."""
    frame = frames(graph)
    return (frame[graph.edges[:, 0]] == frame[graph.edges[:, 1]]) & (graph.kind != "collinear")


def edge_table(graph, allowed):
    return {tuple(pair): e for e, (i, j) in enumerate(graph.edges.tolist()) if allowed[e] for pair in ((i, j), (j, i))}


@remembered
def keeps_cycles_open(graph):
    """Which sets of edges hold no cycle of 3 or 4 lines of all three axes."""
    subsets = all_subsets(len(graph.edges))
    edge = edge_table(graph, in_one_frame(graph) & graph.informative)
    axis = graph.axis.tolist()
    keeps = np.ones(len(subsets), bool)
    for size in (3, 4):
        for cycle in permutations(range(len(axis)), size):
            sides = list(zip(cycle, (*cycle[1:], cycle[0]), strict=True))
            if len({axis[i] for i in cycle}) == 3 and all(side in edge for side in sides):
                keeps &= ~subsets[:, [edge[side] for side in sides]].all(axis=1)
    return keeps


@remembered
def planar_count(graph):
    """For each set of edges, how many pairs of parallel lines can be given a plane."""
    subsets = all_subsets(len(graph.edges))
    edge = edge_table(graph, in_one_frame(graph))
    frame = frames(graph)
    axis = graph.axis.tolist()
    count = np.zeros(len(subsets), int)
    for k, l in combinations(range(len(axis)), 2):  # noqa: E741
        shared = [m for m in range(len(axis)) if (k, m) in edge and (l, m) in edge]
        if axis[k] != axis[l] or not any(graph.possible[edge[k, m]] and graph.possible[edge[l, m]] for m in shared):
            continue
        planar = np.zeros(len(subsets), bool)
        for plane in axes_of(frame[k]) - {axis[k]}:
            holds = np.ones(len(subsets), bool)
            for m in shared:
                one, other = subsets[:, edge[k, m]], subsets[:, edge[l, m]]
                holds &= (one == other) if axis[m] == plane else ~(one & other)
            planar |= holds
        count += planar
    return count


@remembered
def inner_count(graph):
    """For each set of edges, how many lines meet lines of at most one other axis."""
    subsets = all_subsets(len(graph.edges))
    edge = edge_table(graph, in_one_frame(graph))
    frame = frames(graph)
    axis = graph.axis.tolist()
    count = np.zeros(len(subsets), int)
    for i in range(len(axis)):
        met = [
            subsets[:, [edge[i, m] for m in range(len(axis)) if axis[m] == a and (i, m) in edge]].any(axis=1)
            for a in axes_of(frame[i]) - {axis[i]}
        ]
        count += ~(met[0] & met[1])
    return count


def values(graph, options):
    """All sets of edges and what each is worth, minus infinity where it is not allowed."""
    subsets = all_subsets(len(graph.edges))
    value = subsets @ graph.weight
    depth_range = options.depth_range if options.formulation == "paper" else np.inf
    allowed = fits_depths(graph, depth_range)
    if options.formulation == "paper" and "cycles" not in options.without:
        allowed = allowed & keeps_cycles_open(graph)
    if "planarity" not in options.without:
        value = value + options.mu_planarity * planar_count(graph)
    if "boundary" not in options.without:
        value = value + options.boundary_reward * inner_count(graph)
    return np.where(allowed, value, -np.inf)


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("without", ALL_WITHOUT, ids=lambda families: "-".join(sorted(families)) or "none")
@given(problem=problems())
@settings(max_examples=USUAL * 3 // 5)
def test_the_optimum_is_that_of_brute_force(build_graph, formulation, without, problem):
    graph = build_graph(**problem[0])
    options = SolveOptions(formulation=formulation, without=without, **problem[1])
    value = values(graph, options)
    solution = solve(graph, options)
    number = int(solution.connected @ (1 << np.arange(len(graph.edges))))
    assert solution.status == "optimal"
    assert solution.objective == pytest.approx(value.max(), abs=1e-6)
    assert value[number] == pytest.approx(value.max(), abs=1e-6)
    assert solution.bound == pytest.approx(value.max(), abs=1e-6)


@pytest.mark.parametrize("without", ALL_WITHOUT, ids=lambda families: "-".join(sorted(families)) or "none")
@given(problem=problems())
@settings(max_examples=USUAL * 2 // 5)
def test_branch_and_cut_alone_finds_it_too(build_graph, without, problem):
    """Without relaxations, seeds and a good start before it, which decide most graphs of this size."""
    graph = build_graph(**problem[0])
    options = SolveOptions(formulation="gain", without=without, **problem[1])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(solver.gain.search, "ROUNDS", 0)
        patch.setattr(solver.gain.search, "Starter", lambda *model: Starter(*model[:-1], ~model[-2]))
        patch.setattr(solver.gain.separation, "find_short_cycles", lambda _: [])
        solution = solve(graph, options)
    assert solution.status == "optimal"
    assert solution.objective == pytest.approx(values(graph, options).max(), abs=1e-6)


@pytest.mark.parametrize("family", FAMILIES)
def test_the_drawn_problems_put_every_family_to_the_test(build_graph, family):
    """Guards the property above: among the problems are such whose best crossings the family forbids."""
    without = frozenset(FAMILIES)

    def is_decided_by_family(problem):
        graph = build_graph(**problem[0])
        free = values(graph, SolveOptions(formulation="paper", without=without, **problem[1]))
        best = np.argmax(values(graph, SolveOptions(formulation="paper", without=without - {family}, **problem[1])))
        return free[best] < free.max() - 1e-6

    search = settings(max_examples=500, phases=[Phase.generate], database=None)
    find(problems(), is_decided_by_family, settings=search, random=Random(0))


@st.composite
def problems_with_facts(draw):
    """The same with some crossings called real or fake."""
    graph, options = draw(problems(most_edges=8))
    few = draw(st.booleans())  # with nearly all called real, many contradict each other
    words = draw(
        st.lists(st.sampled_from(["", "real", "fake"] if few else ["real"] * 7 + [""]), min_size=8, max_size=8)
    )
    return graph, options, words


def said(words, graph, word):
    return tuple(edge for edge in range(len(graph.edges)) if words[edge] == word)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("formulation", FORMULATIONS)
@given(problem=problems_with_facts())
@settings(max_examples=USUAL * 3 // 5)
def test_with_facts_too_and_a_contradiction_names_a_smallest_set(build_graph, formulation, backend, problem):
    graph = build_graph(**problem[0])
    real = tuple(edge for edge in said(problem[2], graph, "real") if graph.possible[edge])
    fake = said(problem[2], graph, "fake")
    options = SolveOptions(formulation=formulation, backend=backend, real=real, fake=fake, **problem[1])
    value = values(graph, options)
    subsets = all_subsets(len(graph.edges))
    obeys = subsets[:, list(real)].all(axis=1) & ~subsets[:, list(fake)].any(axis=1)
    allowed = np.isfinite(value)
    if (allowed & obeys).any():
        solution = solve(graph, options)
        assert solution.objective == pytest.approx(value[obeys].max(), abs=1e-6)
        assert solution.connected[list(real)].all()
        assert not solution.connected[list(fake)].any()
        return
    with pytest.raises(ContradictionError) as raised:
        solve(graph, options)
    edge = edge_table(graph, np.ones(len(graph.edges), bool))
    named = [edge[pair] for pair in raised.value.crossings]
    assert set(named) <= set(real)
    assert set(raised.value.lines) == {line for pair in raised.value.crossings for line in pair}
    assert not (allowed & subsets[:, named].all(axis=1)).any()
    for left_out in named:
        rest = [e for e in named if e != left_out]
        assert (allowed & subsets[:, rest].all(axis=1)).any()
