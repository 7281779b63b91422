import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import solver.paper.search
from solver.options import SolveOptions
from solver.solve import solve

HERE = Path(__file__).parents[1]

PRINT_A_SOLUTION = """
import json, sys
sys.path.insert(0, sys.argv[1])
from conftest import line_graph, street_lines
from solver.options import SolveOptions
from solver.solve import solve
found = solve(line_graph(*street_lines(40), tolerance=0.004), SolveOptions(formulation="paper", seed=3))
print(json.dumps([found.status, found.objective, found.nodes, found.connected.tolist(), found.is_boundary.tolist(),
                  found.planar_pairs.tolist(), found.log_depth.tolist()]))
"""


def test_the_same_input_gives_the_same_solution_in_every_process():
    """To the last bit, whatever order Python's sets have."""
    results = []
    for seed in ("1", "2"):
        environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": str(HERE.parents[2])}
        command = [sys.executable, "-c", PRINT_A_SOLUTION, str(HERE)]
        results.append(subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout)
    assert results[0] == results[1]
    assert json.loads(results[0])[0] == "optimal"


def test_crossings_that_hold_by_loose_arithmetic_alone_are_excluded(build_graph, monkeypatch):
    """The model is given rows twice too wide, as if SCIP's tolerance were that coarse; the answer is still exact."""
    lines = [(0, (0, 5, 2), 1, 3), (1, (1, 0, 2), 5, 7), (2, (1, 5.2, 0), -1, 2)]
    graph = build_graph(lines, tolerance=0.01)
    wide = build_graph(lines, tolerance=0.02)
    options = SolveOptions(formulation="paper", without=frozenset({"cycles", "boundary"}))
    assert solve(graph, options).connected.sum() == 2
    assert solve(wide, options).connected.sum() == 3
    build = solver.paper.search.build_model
    excluded = []
    exclude = solver.paper.search.exclude
    monkeypatch.setattr(solver.paper.search, "build_model", lambda _, *others: build(wide, *others))
    monkeypatch.setattr(
        solver.paper.search, "exclude", lambda *args: (excluded.append(args[1].tolist()), exclude(*args))
    )
    assert solve(graph, options).connected.sum() == 2
    assert excluded == [[0, 1, 2]]


def test_the_report_agrees_with_the_answer(street):
    found = solve(street, SolveOptions(formulation="paper"))
    expected = street.weight[found.connected].sum() + 0.5 * len(found.planar_pairs) + 10 * (~found.is_boundary).sum()
    assert found.objective == pytest.approx(expected)
    assert found.gap == pytest.approx((found.bound - found.objective) / found.objective)
    assert found.solver.startswith("SCIP ")
    assert found.formulation == "paper"


def test_connected_edges_hold_within_their_tolerance(street):
    found = solve(street, SolveOptions(formulation="paper"))
    i, j = street.edges.T
    off = np.abs(found.log_depth[i] - found.log_depth[j] - street.log_ratio)
    real = found.connected & street.informative
    assert real.sum() > 20
    assert (off[real] <= street.tolerance[real] + 1e-6).all()
