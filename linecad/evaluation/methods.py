"""The rows of the paper's table 1: which families of constraints each method has, and how it is run on a graph."""

import math
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.evaluation.decisions import Decisions, compare
from linecad.line_graph import Formulation, LineGraph, Solution
from linecad.model.lifting import lift
from linecad.options import SHORT_REACH, Options
from solver.options import FAMILIES, Family, SolveOptions
from solver.solve import solve

BASELINE = "Baseline"
PAPER_ROWS = (BASELINE, "B", "C", "P", "B+C", "B+P", "C+P", "B+C+P")
# Cycles that cannot close are refused by formulation gain itself, so family C cannot be taken from it or added.
GAIN_ROWS = ("none", "B", "P", "B+P")
ROWS: dict[Formulation, tuple[str, ...]] = {"paper": PAPER_ROWS, "gain": GAIN_ROWS}
LETTERS: dict[Family, str] = {"boundary": "B", "cycles": "C", "planarity": "P"}


@dataclass(frozen=True)
class Settings:
    """How a dataset is evaluated; the same settings give the same figures, except where a time limit ends a search."""

    formulations: tuple[Formulation, ...] = ("paper", "gain")  # for table 1
    ablation: bool = True  # solve all rows of table 1, or only the default settings
    reconstruction: Options = field(default_factory=Options)  # of the whole photo; of table 1 the weights and rewards
    pictures: bool = False  # keep what the report shows of each photo
    turned: Path | None = None  # a folder for the turned pictures of each photo

    def options(self, formulation: Formulation, row: str) -> SolveOptions:
        """The solver's options for a row of table 1 that is no baseline."""
        left_out = frozenset(name for name in FAMILIES if LETTERS[name] not in row.split("+"))
        return replace(self.reconstruction.solve, formulation=formulation, without=left_out, fast=False)

    def paper_graph(self) -> Options:
        """The line graph of table 1: the paper's extension, no collinear edges, the largest component."""
        weights = self.reconstruction.weights or "junctions"
        return Options(reach=SHORT_REACH, weights=weights, collinear=False, largest_component=True)


@dataclass(frozen=True)
class Run:
    """One method on one photo."""

    decisions: Decisions
    seconds: float  # s, of the solver
    status: str
    gap: float | None  # None: nothing was proven


def proven_gap(solution: Solution) -> float | None:
    """The gap of a solution; None where nothing was proven, which JSON has no number for."""
    return solution.gap if math.isfinite(solution.gap) else None


def run_method(
    graph: LineGraph, formulation: Formulation, row: str, label: Int, total_length: float, settings: Settings
) -> Run:
    """Solve a graph by one row of table 1 and compare with the labels (E,). Raises SolverError."""
    if row == BASELINE:
        return _run_baseline(graph, label, total_length, settings)
    solution = solve(graph, settings.options(formulation, row))
    chosen: Bool = solution.connected
    residual: Float = lift(graph, chosen, solution.log_depth).residual
    decisions = compare(graph, chosen, residual, label, total_length)
    return Run(decisions, solution.seconds, solution.status, proven_gap(solution))


def _run_baseline(graph: LineGraph, label: Int, total_length: float, settings: Settings) -> Run:
    """The baseline chooses nothing: its tree is the minimum spanning tree of all crossings, in order of slack."""
    from solver.baseline import solve_baseline

    found = solve_baseline(graph, settings.options("paper", BASELINE).seconds)
    decisions = compare(graph, np.ones(len(graph.edges), bool), found.slack, label, total_length)
    return Run(decisions, found.seconds, "optimal", 0.0)
