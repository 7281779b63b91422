"""Formulation "gain" on scenes small enough to know the answer, and what must not depend on how it is searched."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import solver.backends.scip_gain
import solver.gain.search
from linecad.errors import SolverError
from solver.choice import Choice, recheck
from solver.cycles import find_short_cycles
from solver.families import find_families
from solver.options import FAMILIES, FORMULATIONS, SolveOptions
from solver.solve import solve
from solver.start import Starter

HERE = Path(__file__).parents[1]
OFF = frozenset(FAMILIES)

# A staircase of six lines that would close, were its last step not 0.3 m off; no shorter cycle is in it.
RING = [
    (0, (0, 6, 1), 1, 2),
    (1, (2, 0, 1), 6, 7),
    (2, (2, 7, 0), 1, 2),
    (0, (0, 7, 2), 1, 2),
    (1, (1, 0, 2.3), 6, 7),
    (2, (1, 6, 0), 1, 2),
]
AROUND = [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (0, 5)]


def test_a_true_corner_is_accepted_where_the_paper_forbids_it(corner):
    assert solve(corner, SolveOptions(mu_boundary=0.1)).connected.all()
    assert not solve(corner, SolveOptions(formulation="paper", mu_boundary=0.1)).connected.all()


def test_a_corner_that_is_none_is_refused(build_graph):
    graph = build_graph([(0, (0, 5, 2), 1, 3), (1, (1, 0, 2), 5, 7), (2, (1, 5.2, 0), -1, 2)])
    found = solve(graph, SolveOptions(without=OFF))
    assert (found.connected.sum(), found.status, found.bound) == (2, "optimal", 2.0)


def test_a_long_unbalanced_cycle_is_found_on_the_way(build_graph):
    graph = build_graph(RING, AROUND, tolerance=0.005)
    assert find_short_cycles(graph) == []
    found = solve(graph, SolveOptions(without=OFF))
    assert (found.connected.sum(), found.objective, found.status) == (5, 5.0, "optimal")
    assert found.cuts >= 1


def test_a_long_balanced_cycle_stays_whole(build_graph):
    graph = build_graph([*RING[:4], (1, (1, 0, 2), 6, 7), RING[5]], AROUND, tolerance=0.005)
    assert solve(graph, SolveOptions(without=OFF)).connected.all()


def test_the_lightest_crossing_of_a_bad_cycle_goes(build_graph):
    graph = build_graph(RING, AROUND, tolerance=0.005, weight=[3, 3, 1, 3, 3, 3])
    assert solve(graph, SolveOptions(without=OFF)).connected.tolist() == [True, True, False, True, True, True]


def test_the_short_cycles_at_the_start_change_nothing(alley):
    """without={"cycles"} leaves them out; what is true of cycles cannot be switched off."""
    with_cycles = solve(alley, SolveOptions(mu_boundary=1.0))
    without = solve(alley, SolveOptions(mu_boundary=1.0, without=frozenset({"cycles"})))
    assert with_cycles.status == without.status == "optimal"
    assert with_cycles.objective == pytest.approx(without.objective)


def test_the_depth_range_is_no_concern_of_this_formulation(alley):
    narrow, wide = (solve(alley, SolveOptions(mu_boundary=1.0, depth_range=r)) for r in (1.01, 1000.0))
    assert narrow.objective == wide.objective


@pytest.mark.parametrize("off", [(), ("cycles",), ("planarity",), ("boundary",), FAMILIES])
@pytest.mark.parametrize("mu_boundary", [0.4, 10.0])
def test_every_answer_passes_the_re_check(alley, off, mu_boundary):
    options = SolveOptions(without=frozenset(off), mu_boundary=mu_boundary)
    found = solve(alley, options)
    choice = Choice(found.connected, found.is_boundary, found.planar_pairs, found.log_depth)
    recheck(alley, find_families(alley, options.without | {"cycles"}), options, choice)
    assert found.status == "optimal"
    i, j = alley.edges.T
    real = found.connected & alley.informative
    off_by = np.abs(found.log_depth[i] - found.log_depth[j] - alley.log_ratio)[real]
    assert (off_by <= alley.tolerance[real] + 1e-6).all()


def test_it_beats_the_paper_where_only_the_tolerances_bind(alley):
    """With the range of depths wide and the paper's cycle cuts off, both solve one problem."""
    options = {"mu_boundary": 1.0, "depth_range": 1000.0, "without": frozenset({"cycles"})}
    gain = solve(alley, SolveOptions(formulation="gain", **options))
    paper = solve(alley, SolveOptions(formulation="paper", time_limit_s=10.0, **options))
    assert gain.status == "optimal"
    assert paper.objective <= gain.objective + 1e-6 <= paper.bound + 2e-6


@pytest.mark.parametrize("off", [(), ("planarity",), ("boundary",), ("planarity", "boundary")])
@pytest.mark.parametrize(
    ("lines", "seed"),
    [(30, 1), (30, 3), *(pytest.param(*street, marks=pytest.mark.thorough) for street in [(45, 3), (60, 2), (60, 3)])],
)
def test_on_streets_it_proves_what_the_paper_proves_with_metric_cycles_alone(street_graph, lines, seed, off):
    """With the range of depths wide and the paper's cycle cuts off, both solve one problem."""
    graph = street_graph(seed, lines)
    options = {"mu_boundary": 1.0, "depth_range": 1000.0, "without": frozenset({"cycles", *off})}
    gain, paper = (solve(graph, SolveOptions(formulation=formulation, **options)) for formulation in FORMULATIONS)
    assert gain.status == paper.status == "optimal"
    assert gain.objective == pytest.approx(paper.objective, abs=1e-6)


def search_by_scip_alone(monkeypatch):
    """Take away what usually decides small graphs before branch and cut: relaxations, seeds, and the good start."""
    monkeypatch.setattr(solver.gain.search, "ROUNDS", 0)
    monkeypatch.setattr(solver.gain.separation, "find_short_cycles", lambda _: [])
    monkeypatch.setattr(solver.gain.search, "Starter", lambda *model: Starter(*model[:-1], ~model[-2]))


@pytest.mark.parametrize("mu_boundary", [0.4, 1.0])
def test_branch_and_cut_needs_no_help(alley, monkeypatch, mu_boundary):
    options = SolveOptions(mu_boundary=mu_boundary)
    expected = solve(alley, options)
    search_by_scip_alone(monkeypatch)
    alone = solve(alley, options)
    assert alone.status == "optimal"
    assert alone.objective == pytest.approx(expected.objective)


def test_scip_is_kept_from_concluding_from_the_rows_that_it_sees(build_graph, monkeypatch):
    """Two like rings, one of them off: before its cycle is a row, symmetry would call their crossings the same."""
    beside = [
        (axis, np.add(point, (3, 0, 0)), low + 3 * (axis == 0), high + 3 * (axis == 0))
        for axis, point, low, high in RING
    ]
    beside[4] = (1, (4, 0, 2), 6, 7)
    edges = [*AROUND, *((i + 6, j + 6) for i, j in AROUND)]
    search_by_scip_alone(monkeypatch)
    set_ = {}
    build = solver.backends.scip_gain.run

    def note(model, *others):
        set_.update({name: model.getParam(name) for name in solver.backends.scip_gain.BLIND})
        return build(model, *others)

    monkeypatch.setattr(solver.backends.scip_gain, "run", note)
    found = solve(build_graph(RING + beside, edges, tolerance=0.005), SolveOptions(without=OFF))
    assert (found.status, found.objective) == ("optimal", 11.0)
    assert found.connected[6:].all()
    assert set_ == {"misc/usesymmetry": 0, "misc/allowstrongdualreds": False, "misc/allowweakdualreds": False}


def test_a_solution_that_no_depths_fit_is_never_returned(alley, monkeypatch):
    """Were separation to miss a cycle, the answer is an error of ours, not a wrong model."""
    monkeypatch.setattr(solver.gain.separation.Separation, "breaks", lambda *_: False)
    monkeypatch.setattr(solver.gain.separation.Separation, "broken_rows", lambda *_: [])
    search_by_scip_alone(monkeypatch)
    with pytest.raises(AssertionError, match="had not tested"):
        solve(alley, SolveOptions(without=OFF))


def test_what_fails_while_scip_asks_for_rows_comes_out(alley, monkeypatch):
    class SeparationError(Exception):
        pass

    def fail(*_):
        raise SeparationError

    search_by_scip_alone(monkeypatch)
    monkeypatch.setattr(solver.gain.separation.Separation, "broken_rows", fail)
    with pytest.raises(SeparationError):
        solve(alley, SolveOptions(without=OFF))


def test_a_limit_before_the_search_leaves_the_heuristic_answer(alley):
    found = solve(alley, SolveOptions(time_limit_s=1e-6))
    assert found.status == "heuristic"
    assert found.connected.sum() > 10
    assert found.bound > found.objective


def test_a_node_limit_states_the_gap(alley, monkeypatch):
    search_by_scip_alone(monkeypatch)
    found = solve(alley, SolveOptions(node_limit=1, without=OFF))
    assert found.status in ("node limit", "optimal")
    assert found.gap == pytest.approx((found.bound - found.objective) / found.objective)


PRINT_A_SOLUTION = """
import json, sys
sys.path.insert(0, sys.argv[1])
from conftest import line_graph, street_lines
from solver.options import SolveOptions
from solver.solve import solve
found = solve(line_graph(*street_lines(36), tolerance=0.004), SolveOptions(mu_boundary=0.4))
print(json.dumps([found.status, found.objective, found.nodes, found.cuts, found.connected.tolist(),
                  found.is_boundary.tolist(), found.planar_pairs.tolist(), found.log_depth.tolist()]))
"""


def test_the_same_input_gives_the_same_solution_in_every_process():
    results = []
    for seed in ("1", "2"):
        environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": str(HERE.parents[2])}
        command = [sys.executable, "-c", PRINT_A_SOLUTION, str(HERE)]
        results.append(subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout)
    assert results[0] == results[1]
    assert json.loads(results[0])[0] == "optimal"


INTERRUPTED_SOLVE = """
import json, sys
sys.path.insert(0, sys.argv[1])
from conftest import line_graph, street_lines
from solver.options import SolveOptions
from solver.solve import solve
graph = line_graph(*street_lines(60), tolerance=0.004)  # a hard one: minutes
def told(progress):
    if progress.seconds > 0.5:
        print("searching", file=sys.stderr, flush=True)
found = solve(graph, SolveOptions(time_limit_s=100.0, without=frozenset({"planarity", "boundary"})), told)
print(json.dumps([found.status, int(found.connected.sum()), found.bound > found.objective, found.seconds]))
"""


@pytest.mark.skipif(os.name == "nt", reason="a real SIGINT can be sent to a child on POSIX alone")
def test_ctrl_c_keeps_the_best_solution_and_prints_nothing():
    environment = {**os.environ, "PYTHONPATH": str(HERE.parents[2])}
    command = [sys.executable, "-c", INTERRUPTED_SOLVE, str(HERE)]
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as child:
        assert child.stderr.readline() == "searching\n"
        child.send_signal(signal.SIGINT)
        out, err = child.communicate(timeout=150)
    assert child.returncode == 0, err
    assert set(err.splitlines()) <= {"searching"}
    (line,) = out.splitlines()
    status, crossings, is_open, seconds = json.loads(line)
    assert status == "interrupted"
    assert crossings > 20
    assert is_open
    assert seconds < 90


@pytest.mark.parametrize("formulation", ["gain", "paper"])
class TestFacts:
    def test_a_crossing_called_fake_is_in_no_answer(self, build_graph, formulation):
        graph = build_graph(RING, AROUND, tolerance=0.005)
        found = solve(graph, SolveOptions(formulation=formulation, without=OFF, fake=(2,)))
        assert found.connected.tolist() == [True, True, False, True, True, True]

    def test_a_crossing_called_real_is_in_every_answer(self, build_graph, formulation):
        graph = build_graph(RING, AROUND, tolerance=0.005, weight=[3, 3, 1, 3, 3, 3])
        found = solve(graph, SolveOptions(formulation=formulation, without=OFF, real=(2,)))
        assert found.connected[2]
        assert (found.connected.sum(), found.objective) == (5, 13.0)

    def test_a_contradiction_is_named_by_its_lines(self, build_graph, formulation):
        graph = build_graph(RING, AROUND, tolerance=0.005)
        with pytest.raises(SolverError, match=r"lines 0, [15], .*, 0 cannot all be real; take one back"):
            solve(graph, SolveOptions(formulation=formulation, without=OFF, real=tuple(range(6))))

    def test_the_shortest_contradiction_is_named(self, build_graph, formulation):
        corner = [(0, (0, 6, 1), 1, 2), (1, (1, 0, 1), 6, 7), (2, (1, 6.4, 0), 1, 2)]
        edges = [*AROUND, *((i + 6, j + 6) for i, j in [(0, 1), (1, 2), (0, 2)])]
        graph = build_graph(RING + corner, edges, tolerance=0.005)
        with pytest.raises(SolverError, match=r"lines 6, [78], [78], 6 cannot"):
            solve(graph, SolveOptions(formulation=formulation, without=OFF, real=tuple(range(9))))

    @pytest.mark.parametrize(
        ("facts", "message"),
        [
            ({"real": (9,)}, "crossing 9 is called real, but the graph has 3"),
            ({"real": (1,), "fake": (1,)}, "lines 0 and 2 is called both"),
        ],
    )
    def test_a_fact_that_cannot_be_is_named(self, corner, formulation, facts, message):
        with pytest.raises(SolverError, match=message):
            solve(corner, SolveOptions(formulation=formulation, **facts))

    def test_lines_on_two_sides_of_the_camera_cannot_be_called_real(self, corner, change, formulation):
        graph = change(corner, possible=[True, True, False])
        with pytest.raises(SolverError, match="lines 1 and 2 is called real, but"):
            solve(graph, SolveOptions(formulation=formulation, real=(2,)))


@pytest.mark.parametrize("formulation", ["gain", pytest.param("paper", marks=pytest.mark.thorough)])
def test_a_crossing_called_real_is_so_even_where_it_costs_more_than_it_brings(alley, formulation):
    options = {"formulation": formulation, "mu_boundary": 0.4}
    free = solve(alley, SolveOptions(**options))
    worth = []
    for edge in np.flatnonzero(~free.connected & alley.possible)[:2].tolist():
        found = solve(alley, SolveOptions(**options, real=(edge,)))
        assert found.connected[edge]
        assert found.status == "optimal"
        worth.append(found.objective)
    assert max(worth) <= free.objective
    assert min(worth) < free.objective


@pytest.mark.parametrize("formulation", ["gain", "paper"])
def test_a_collinear_edge_ties_two_lines_of_one_axis(build_graph, formulation):
    """Two pieces of one line; the z-line at the second one gives way to it within the tolerance or is not met."""
    lines = [(0, (0, 6, 1), 0, 1), (0, (0, 6, 1), 2, 3), (2, (0.5, 6, 0), 0.5, 2), (2, (2.5, 7, 0), 0.5, 2)]
    graph = build_graph(lines, [(0, 1), (0, 2), (1, 3)], tolerance=0.005)
    assert graph.kind[0] == "collinear"
    found = solve(graph, SolveOptions(formulation=formulation, without=OFF))
    assert found.connected.all()
    depths = np.exp(found.log_depth)[:2, None] * graph.rays[:2]
    assert depths[0, 1:] == pytest.approx(depths[1, 1:], rel=0.006)


@pytest.mark.parametrize("formulation", ["gain", "paper"])
def test_a_collinear_edge_takes_part_in_cycles_and_in_nothing_else(build_graph, formulation):
    """The rectangle that two pieces close is off by 0.4 m: the collinear edge, the lightest, goes."""
    lines = [(0, (0, 6, 1), 0, 1), (0, (0, 6.4, 1), 2, 3), (2, (0.5, 6, 0), 0.5, 2), (2, (2.5, 6.4, 0), 0.5, 2)]
    lines += [(0, (0, 6, 1.8), 0, 1), (1, (0.7, 0, 1.8), 6, 6.4), (0, (0, 6.4, 1.8), 0.5, 3)]
    edges = [(0, 1), (0, 2), (2, 4), (4, 5), (5, 6), (3, 6), (1, 3)]
    graph = build_graph(lines, edges, tolerance=0.005, weight=[0.5, 1, 1, 1, 1, 1, 1])
    found = solve(graph, SolveOptions(formulation=formulation, without=OFF))
    assert found.connected.tolist() == [False] + [True] * 6
    tied = solve(graph, SolveOptions(formulation=formulation, mu_boundary=0.1, real=(0,)))
    assert tied.connected[0]
    assert not tied.is_boundary[[0, 1]].any()  # line 0 meets a z-line; its own continuation is no second plane
