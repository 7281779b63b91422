import time

import numpy as np
import pytest

from solver.choice import Choice, boundaries, objective_of, recheck
from solver.depths import end_ratios
from solver.families import find_families
from solver.options import FAMILIES, SolveOptions
from solver.paper.milp import add_start, build_model
from solver.start import Starter


def start_of(graph, options):
    none = np.zeros(len(graph.edges), bool)
    return Starter(graph, find_families(graph, options.without), options, end_ratios(graph), none, none).find()


@pytest.mark.parametrize("mu_boundary", [0.3, 1.0, 10.0])
@pytest.mark.parametrize("off", [(), ("cycles",), ("planarity",), ("boundary",), FAMILIES])
def test_the_start_passes_the_re_check_and_beats_the_empty_choice(street, off, mu_boundary):
    options = SolveOptions(formulation="paper", without=frozenset(off), mu_boundary=mu_boundary)
    start = start_of(street, options)
    recheck(street, find_families(street, options.without), options, start)
    none = np.zeros(len(street.edges), bool)
    empty = Choice(none, boundaries(street, none), np.zeros((0, 3), int), start.log_depth)
    assert objective_of(street, options, start) > objective_of(street, options, empty)


@pytest.mark.parametrize("depth_range", [100.0, 1.7])
def test_scip_finds_the_start_feasible(street, depth_range):
    options = SolveOptions(formulation="paper", depth_range=depth_range)
    ratios, families = end_ratios(street), find_families(street, options.without)
    start = start_of(street, options)
    paper = build_model(street, families, options, ratios)
    add_start(paper, start, ratios)
    paper.model.setParam("limits/solutions", 1)
    paper.model.setPresolve(0)
    paper.model.optimize()
    assert paper.model.getObjVal() == pytest.approx(objective_of(street, options, start))


def test_a_consistent_scene_is_taken_whole(build_graph):
    """A grid of x- and z-lines in one facade: all crossings are real, every pair is planar, no line a boundary."""
    lines = [(0, (0, 6, z), 0, 3) for z in (1, 2, 3)] + [(2, (x, 6, 0), 0.5, 3.5) for x in (0.5, 1.5, 2.5)]
    graph = build_graph(lines)
    start = start_of(graph, SolveOptions(formulation="paper"))
    assert start.connected.all()
    assert len(start.planar_pairs) == 6
    assert not start.is_boundary.any()


def test_the_majority_of_its_edges_places_a_line(build_graph):
    """Line 0 crosses four lines of a facade, all real, and line 5 behind it, a heavier edge and a wrong one."""
    lines = [(0, (0, 6, 1), 0, 4), *[(2, (x, 6, 0), 0.5, 2) for x in (0.5, 1.5, 2.5, 3.5)], (2, (4, 8, 0), 0.5, 2)]
    lines += [(0, (0, 6, 1.5), 0, 4), (1, (4, 0, 0.7), 6, 8), (0, (0, 6, 0.7), 0, 4)]
    edges = [(0, k) for k in (1, 2, 3, 4, 5)] + [(k, 6) for k in (1, 2, 3, 4)] + [(5, 7), (7, 8), (1, 8)]
    weight = [1, 1, 1, 1, 2.5, *[3] * 7]
    start = start_of(
        build_graph(lines, edges, weight=weight), SolveOptions(formulation="paper", without=frozenset(FAMILIES))
    )
    assert start.connected.tolist() == [True] * 4 + [False] + [True] * 7


def test_rounding_gives_up_when_its_time_is_over(street):
    options = SolveOptions()
    none = np.zeros(len(street.edges), bool)
    families = find_families(street, frozenset({"cycles"}))
    starter = Starter(street, families, options, end_ratios(street), none, none)
    value = np.ones(len(street.edges))
    assert starter.round(value, time.monotonic() - 1) is None
    rounded = starter.round(value, np.inf)
    assert rounded is not None
    recheck(street, families, options, rounded)
