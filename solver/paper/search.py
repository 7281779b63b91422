"""Formulation "paper": the paper's MILP solved by SCIP, from a good start, with an answer whose depths are exact."""

import threading
import time
from collections.abc import Callable
from dataclasses import replace
from typing import assert_never

import numpy as np
from pyscipopt import Model

from linecad.arrays import Float
from linecad.line_graph import LineGraph, Solution
from solver.annotations import check_annotations, read_annotations
from solver.backends.scip import Outcome, Watch, run, version
from solver.choice import Choice, objective_of, recheck, trivial_bound
from solver.depths import end_ratios, near_log_ratio
from solver.families import find_families
from solver.options import Progress, SolveOptions, relative_gap
from solver.paper.milp import PaperModel, add_start, build_model, exclude, read_choice
from solver.potentials import fit_near_depths
from solver.progress import Reporter, catch_interrupt
from solver.start import Starter


def solve_paper(graph: LineGraph, options: SolveOptions, on_progress: Callable[[Progress], None] | None) -> Solution:
    """Solve the paper's MILP; see `solver.solve.solve` for what is promised."""
    began = time.monotonic()
    name = _solver_name(options)
    with catch_interrupt() as stop:
        ratios = end_ratios(graph)
        families = find_families(graph, options.without)
        real, fake = read_annotations(graph, options)
        check_annotations(graph, families, options, real, ratios)
        start = Starter(graph, families, options, ratios, real, fake).find()
        recheck(graph, families, options, start)
        paper = build_model(graph, families, options, ratios)
        least, most = objective_of(graph, options, start), trivial_bound(graph, families, options)
        reporter = Reporter(began, least, most, on_progress)
        watch = Watch(paper.model, reporter)

        def search() -> Outcome:
            add_start(paper, start, ratios)
            if options.backend == "highs":
                return _search_by_highs(paper.model, options, reporter, stop)
            return run(paper.model, options, watch, stop)

        outcome, choice = _search_exactly(search, paper, graph, options, ratios, start)
        recheck(graph, families, options, choice)
        objective = objective_of(graph, options, choice)
        bound = max(objective, reporter.bound)
        reporter.finish(objective, bound)
    return Solution(
        status=outcome.status,
        solver=name,
        formulation="paper",
        objective=objective,
        bound=bound,
        gap=relative_gap(objective, bound),
        seconds=time.monotonic() - began,
        nodes=reporter.nodes,
        connected=choice.connected,
        is_boundary=choice.is_boundary,
        planar_pairs=choice.planar_pairs,
        log_depth=choice.log_depth,
    )


def _solver_name(options: SolveOptions) -> str:
    match options.backend:
        case "scip":
            return version()
        case "highs":
            from solver.backends import highs

            return highs.version()
        case _:
            assert_never(options.backend)


def _search_by_highs(model: Model, options: SolveOptions, reporter: Reporter, stop: threading.Event) -> Outcome:
    """Solve the same program by HiGHS, from the start that the SCIP model was given."""
    from solver.backends.highs import from_scip, search

    highs, names = from_scip(model, options)
    first = model.getBestSol()
    variables = model.getVars()
    answer = search(highs, options, np.array([model.getSolVal(first, v) for v in variables]), reporter, stop)
    reporter.note(-np.inf, answer.bound, answer.nodes)
    if answer.x is None:
        return Outcome(answer.status, has_solution=False)
    return Outcome(answer.status, has_solution=True, found=dict(zip(names, answer.x.tolist(), strict=True)))


def _search_exactly(
    search: Callable[[], Outcome],
    paper: PaperModel,
    graph: LineGraph,
    options: SolveOptions,
    ratios: Float,
    start: Choice,
) -> tuple[Outcome, Choice]:
    """Search until the crossings that SCIP takes fit depths exactly, not only within the tolerance of its arithmetic.

    A row (4) may be off by SCIP's feasibility tolerance times L. Where a set of crossings holds by that alone, the
    cycle that contradicts itself is excluded and the search runs again. At a limit the start is the answer then.
    """
    step, near_ratio = near_log_ratio(graph, ratios), np.log(ratios.min(axis=1))
    while True:
        outcome = search()
        if not outcome.has_solution:  # a limit came before SCIP had looked at the start
            return outcome, start
        choice = read_choice(paper, graph, options, ratios, outcome.found)
        log_range = float(np.log(options.depth_range))
        fit = fit_near_depths(graph, step, choice.connected, log_range, choice.log_depth + near_ratio)
        if len(fit.contradiction) == 0:
            return outcome, replace(choice, log_depth=fit.near - near_ratio)
        if outcome.status not in ("optimal", "gap limit"):
            return outcome, start
        exclude(paper, fit.contradiction)
