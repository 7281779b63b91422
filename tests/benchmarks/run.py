"""Measure the solvers on seeded instances: python tests/benchmarks/run.py --sizes paper --count 10 --limit 60

All columns solve the same graphs with all families in one process, one after another. A run that reaches its limit
counts with the limit. "paper" forbids true corners and bounds depths, so that its objective may be
lower than that of "gain" at the optimum of both.
"""

import argparse
import resource
import statistics
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(Path(__file__).resolve().parent)]

from instances import LADDER, make_instance  # noqa: E402 - this is a script, run from a checkout without installing

from linecad.errors import SolverError  # noqa: E402
from linecad.scene import Solution  # noqa: E402
from solver.problem import SolveOptions, solve  # noqa: E402

COLUMNS = {
    "gain": {"formulation": "gain", "backend": "scip"},
    "gain-highs": {"formulation": "gain", "backend": "highs"},
    "paper": {"formulation": "paper", "backend": "scip"},
    "paper-highs": {"formulation": "paper", "backend": "highs"},
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sizes", nargs="+", default=["paper"], choices=list(LADDER))
    parser.add_argument("--columns", nargs="+", default=["gain", "paper"], choices=list(COLUMNS))
    parser.add_argument("--count", type=int, default=10, help="instances of each size, seeds 0, 1, ...")
    parser.add_argument("--limit", type=float, default=60.0, help="s, of each solve")
    parser.add_argument("--mu-boundary", type=float, nargs="+", default=[1.0, 10.0])
    arguments = parser.parse_args()
    print(
        "| size | seed | lines | crossings | fake | mu_2 | column "
        "| status | objective | gap % | nodes | cuts | s | MB |"
    )
    print("| --- " * 14 + "|")
    seconds: dict[tuple[str, float, str], list[float]] = {}
    proven: dict[tuple[str, float, str], int] = {}
    for size in arguments.sizes:
        for seed in range(arguments.count):
            instance = make_instance(seed, LADDER[size])
            graph = instance.graph
            what = f"{size} | {seed} | {len(graph.segments)} | {len(graph.edges)} | {1 - instance.real.mean():.3f}"
            for mu in arguments.mu_boundary:
                for column in arguments.columns:
                    options = SolveOptions(time_limit_s=arguments.limit, mu_boundary=mu, **COLUMNS[column])
                    try:
                        found = solve(graph, options)
                    except SolverError as error:
                        print(f"| {what} | {mu:g} | {column} | {error} |", flush=True)
                        continue
                    print(f"| {what} | {mu:g} | {column} | {_cells(found)} |", flush=True)
                    key = (size, mu, column)
                    is_proven = found.status == "optimal"
                    seconds.setdefault(key, []).append(found.seconds if is_proven else arguments.limit)
                    proven[key] = proven.get(key, 0) + is_proven
    print("\n| size | mu_2 | column | instances | proven | median s | worst s | median of the others over gain |")
    print("| --- " * 8 + "|")
    for (size, mu, column), times in seconds.items():
        gain = seconds.get((size, mu, "gain"), [])
        ratios = [other / own for other, own in zip(times, gain, strict=False)]
        ratio = f"{statistics.median(ratios):.1f}" if ratios else ""
        print(
            f"| {size} | {mu:g} | {column} | {len(times)} | {proven[size, mu, column]} "
            f"| {statistics.median(times):.2f} | {max(times):.2f} | {ratio} |"
        )


def _cells(found: Solution) -> str:
    megabytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024  # of the process so far
    return (
        f"{found.status} | {found.objective:.1f} | {100 * found.gap:.3f} | {found.nodes} | {found.cuts} "
        f"| {found.seconds:.2f} | {megabytes:.0f}"
    )


if __name__ == "__main__":
    main()
