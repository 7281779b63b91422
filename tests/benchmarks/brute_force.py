"""The optimum of thousands of small graphs by every solver and by trying all sets of crossings.

`python tests/benchmarks/brute_force.py --graphs 2000`: the problems are those of tests/solver/test_brute_force.py with
up to 12 crossings or collinear edges, drawn by hypothesis from --seed, each solved with every family of constraints on
and off. A solve agrees when it is proven optimal and its objective, its bound and the worth of the crossings that it
chose are the best that enumeration finds. Prints what disagrees, and one line for each column; exit code 1 when
anything disagrees. Needs hypothesis and pytest.
"""

import argparse
import sys
import time
from collections import Counter, defaultdict
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import HealthCheck, Phase, given, seed, settings

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "solver"), str(Path(__file__).resolve().parent)]

from run import COLUMNS, GUROBI
from test_brute_force import ALL_WITHOUT, problems, values

from conftest import line_graph
from linecad.line_graph import LineGraph
from solver.options import SolveOptions
from solver.solve import solve

MOST_EDGES = 12
CLOSE = 1e-6  # of the objective
SOLVERS = {name: chosen for name, chosen in COLUMNS.items() if name != GUROBI}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--graphs", type=int, default=2000)
    parser.add_argument("--columns", nargs="+", default=list(SOLVERS), choices=list(SOLVERS))
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    drawn: Counter[int] = Counter()  # graphs by number of edges
    collinear = 0
    wrong: Counter[str] = Counter()
    seconds: defaultdict[str, float] = defaultdict(float)

    def compare(problem: tuple[dict[str, Any], dict[str, Any]]) -> None:
        nonlocal collinear
        graph = line_graph(**problem[0])
        drawn[len(graph.edges)] += 1
        collinear += bool((graph.kind == "collinear").any())
        for without in ALL_WITHOUT:
            for column in arguments.columns:
                began = time.monotonic()
                said = disagreement(graph, replace(SOLVERS[column], without=without, **problem[1]))
                seconds[column] += time.monotonic() - began
                if said:
                    wrong[column] += 1
                    print(f"{column} without {sorted(without)}: {said}\n  {problem}", flush=True)

    draw = settings(
        max_examples=arguments.graphs,
        deadline=None,
        database=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    seed(arguments.seed)(draw(given(problems(MOST_EDGES))(compare)))()
    graphs = drawn.total()
    print(
        f"{graphs} graphs with {min(drawn)} to {max(drawn)} edges ({drawn[MOST_EDGES]} with {MOST_EDGES}), "
        f"{collinear} with collinear edges, {len(ALL_WITHOUT)} combinations of families, seed {arguments.seed}"
    )
    for column in arguments.columns:
        solves = graphs * len(ALL_WITHOUT)
        print(
            f"{column}: {solves} solves, {solves - wrong[column]} agree with enumeration, {wrong[column]} do not; "
            f"{1e3 * seconds[column] / solves:.0f} ms each with the enumeration"
        )
    return 1 if wrong else 0


def disagreement(graph: LineGraph, options: SolveOptions) -> str:
    """In what a solve differs from the best of all sets of edges; empty where it does not."""
    value = values(graph, options)
    solution = solve(graph, options)
    chosen = value[int(solution.connected @ (1 << np.arange(len(graph.edges))))]
    found = {"objective": solution.objective, "bound": solution.bound, "worth of the chosen crossings": chosen}
    off = [f"{what} {number:.6f}" for what, number in found.items() if not abs(number - value.max()) <= CLOSE]
    if solution.status != "optimal":
        off.append(f"status {solution.status}")
    return f"best {value.max():.6f}, {', '.join(off)}" if off else ""


if __name__ == "__main__":
    sys.exit(main())
