"""Measure the solvers: python tests/benchmarks/run.py --sizes paper --count 10 --limit 60

One table over seeded instances and, with --real, over the line graphs of real photos: every column solves the same
graphs, each solve in a process of its own so that its peak memory can be told, one after another. A run that reaches
its limit counts with the limit. "paper" forbids true corners and bounds depths, so that its objective may be lower
than that of "gain" at the optimum of both. "gurobi" is "paper" under the licence that comes with gurobipy, where that
is installed and the instance fits (size "small").

Castle and South Building: --real DIR. The castle of issue 3: --real DIR --only castle/0012 --extension 75
--longest 800. Growth with size: --sizes small paper 640 2000 5000 --count 2 --mu-boundary 1 --plot growth.png
"""

import argparse
import multiprocessing
import statistics
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(Path(__file__).resolve().parent)]

from gurobi import SkippedError, solve_by_gurobi
from instances import LADDER, make_instance
from plot import Dot, draw_growth
from real_graphs import real_graphs

from linecad.errors import SolverError
from linecad.line_graph import LineGraph
from linecad.options import SHORT_REACH
from solver.options import SolveOptions
from solver.solve import solve

GUROBI = "gurobi"  # the column that none of the backends solves
COLUMNS = {
    "gain": SolveOptions(formulation="gain", backend="scip"),
    "gain-highs": SolveOptions(formulation="gain", backend="highs"),
    "paper": SolveOptions(formulation="paper", backend="scip"),
    "paper-highs": SolveOptions(formulation="paper", backend="highs"),
    GUROBI: SolveOptions(formulation="paper"),
}


@dataclass(frozen=True)
class Measured:
    """One solve of one column."""

    status: str
    objective: float
    gap: float
    nodes: int
    cuts: int
    seconds: float
    megabytes: float  # peak of the process, with Python and the libraries

    def cells(self) -> str:
        return (
            f"{self.status} | {self.objective:.1f} | {100 * self.gap:.3f} | {self.nodes} | {self.cuts} "
            f"| {self.seconds:.2f} | {self.megabytes:.0f}"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", nargs="*", choices=list(LADDER), help="default: paper; none with --real")
    parser.add_argument("--columns", nargs="+", default=["gain", "paper"], choices=list(COLUMNS))
    parser.add_argument("--count", type=int, default=10, help="instances of each size, seeds 0, 1, ...")
    parser.add_argument("--limit", type=float, default=60.0, help="s, of each solve")
    parser.add_argument("--mu-boundary", type=float, nargs="+", default=[1.0, 10.0])
    parser.add_argument("--real", type=Path, metavar="DIR", help="folder with castle/ and south_building/")
    parser.add_argument("--only", default="", help="of the real photos, those with this in their name: castle/0012")
    reach = "px at 3840 px width, of real photos"
    parser.add_argument("--extension", type=float, default=SHORT_REACH.extension, help=reach)
    parser.add_argument("--longest", type=int, help="keep so many of the longest segments of a real photo")
    parser.add_argument("--collinear", action="store_true", help="real photos: with edges between collinear segments")
    parser.add_argument("--plot", type=Path, metavar="FILE.png", help="time and memory over the number of crossings")
    arguments = parser.parse_args()
    print(
        "| size | instance | lines | edges | fake | mu_2 | column "
        "| status | objective | gap % | nodes | cuts | s | MB |"
    )
    print("| --- " * 14 + "|")
    results: dict[tuple[str, float, str], dict[str, Measured]] = {}
    dots = []
    for size, name, graph, fake in _instances(arguments):
        what = f"{size} | {name} | {len(graph.segments)} | {len(graph.edges)} | {fake}"
        for mu in arguments.mu_boundary:
            for column in arguments.columns:
                options = replace(COLUMNS[column], time_limit_s=arguments.limit, mu_boundary=mu)
                try:
                    found = _apart(column, graph, options)
                except (SolverError, SkippedError) as error:
                    print(f"| {what} | {mu:g} | {column} | skipped: {error} |", flush=True)
                    continue
                print(f"| {what} | {mu:g} | {column} | {found.cells()} |", flush=True)
                results.setdefault((size, mu, column), {})[name] = found
                proven = found.status == "optimal"
                dots.append(Dot(column, size, len(graph.edges), found.seconds, found.megabytes, proven))
    _summary(results, arguments.limit)
    if arguments.plot and dots:
        draw_growth(arguments.plot, dots, tuple(LADDER))


def _instances(arguments: argparse.Namespace) -> Iterator[tuple[str, str, LineGraph, str]]:
    """Size or dataset, seed or photo, graph and share of fakes as text (unknown for real photos)."""
    sizes = arguments.sizes if arguments.sizes is not None else [] if arguments.real else ["paper"]
    for size in sizes:
        for seed in range(arguments.count):
            instance = make_instance(seed, LADDER[size])
            yield size, str(seed), instance.graph, f"{1 - instance.real.mean():.3f}"
    if arguments.real:
        chosen = arguments.extension, arguments.longest, arguments.collinear, arguments.only
        for name, graph in real_graphs(arguments.real, *chosen):
            dataset, _, photo = name.partition("/")
            yield dataset, photo, graph, ""


def _apart(column: str, graph: LineGraph, options: SolveOptions) -> Measured:
    """`_measure` in a fresh process."""
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        return pool.submit(_measure, column, graph, options).result()


def _measure(column: str, graph: LineGraph, options: SolveOptions) -> Measured:
    if column == GUROBI:
        status, objective, gap, nodes, seconds = solve_by_gurobi(graph, options)
        cuts = 0
    else:
        found = solve(graph, options)
        status, objective, gap, nodes, seconds = found.status, found.objective, found.gap, found.nodes, found.seconds
        cuts = found.cuts
    return Measured(status, objective, gap, nodes, cuts, seconds, _peak_megabytes())


def _peak_megabytes() -> float:
    """Largest memory of this process since it began, as Linux reports it; getrusage counts the parent's before."""
    status = Path("/proc/self/status").read_text()
    (peak,) = (line for line in status.splitlines() if line.startswith("VmHWM:"))
    return int(peak.split()[1]) / 1024


def _summary(results: dict[tuple[str, float, str], dict[str, Measured]], limit: float) -> None:
    """Medians over the instances that a column solved, and of the ratios over those that gain solved too."""
    print("\n| size | mu_2 | column | instances | proven | median s | worst s | median s over gain's | worst MB |")
    print("| --- " * 9 + "|")
    for (size, mu, column), solved in results.items():
        gain = results.get((size, mu, "gain"), {})
        seconds = {name: _counted(found, limit) for name, found in solved.items()}
        ratios = [seconds[name] / _counted(gain[name], limit) for name in seconds if name in gain]
        print(
            f"| {size} | {mu:g} | {column} | {len(solved)} | {sum(f.status == 'optimal' for f in solved.values())} "
            f"| {statistics.median(seconds.values()):.2f} | {max(seconds.values()):.2f} "
            f"| {f'{statistics.median(ratios):.1f}' if ratios else ''} "
            f"| {max(found.megabytes for found in solved.values()):.0f} |"
        )


def _counted(found: Measured, limit: float) -> float:
    return found.seconds if found.status == "optimal" else limit


if __name__ == "__main__":
    main()
