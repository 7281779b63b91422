"""`solve`: a line graph in, a solution out, by the program and the solver that the options name.

The programs and their solvers are loaded when they are used: SCIP and HiGHS take a tenth of a second and more.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, assert_never

from linecad.line_graph import LineGraph, Solution
from solver.check import check_graph
from solver.options import Progress, SolveOptions

if TYPE_CHECKING:
    from solver.gain.backend import Backend


def solve(graph: LineGraph, options: SolveOptions, on_progress: Callable[[Progress], None] | None = None) -> Solution:
    """The best choice of real crossings, with boundary flags, planar pairs and depths.

    `on_progress` is called in the caller's thread, at most about five times a second and once at the end; what it
    raises stops the solver and comes out of here. Ctrl-C ends the search with the best solution so far and the status
    "interrupted". The same graph, options and seed give the same solution unless a limit of time or memory or a Ctrl-C
    ends the search. Raises SolverError when there is no answer that passes the re-check, ValueError for a graph that
    breaks the promises of LineGraph.
    """
    check_graph(graph)
    if options.fast:
        from solver.robust import solve_robust

        return solve_robust(graph, options, on_progress)
    match options.formulation:
        case "paper":
            from solver.paper.search import solve_paper

            return solve_paper(graph, options, on_progress)
        case "gain":
            from solver.gain.search import solve_gain

            return solve_gain(graph, options, _gain_backend(options), on_progress)
        case _:
            assert_never(options.formulation)


def _gain_backend(options: SolveOptions) -> "Backend":
    match options.backend:
        case "scip":
            from solver.backends.scip_gain import ScipBackend

            return ScipBackend()
        case "highs":
            from solver.backends.highs import HighsBackend

            return HighsBackend()
        case _:
            assert_never(options.backend)
