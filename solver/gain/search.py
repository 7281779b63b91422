"""Formulation "gain": one potential per line in log depth, and only Booleans in the program that is solved.

A line of known axis through a known segment has one unknown, its depth s. Two lines meet in space when
log s_i - log s_j = c_ij within the tolerance of the crossing, so crossings can be real together exactly when every
cycle of them is balanced (`solver.cycles`). That replaces the paper's depths, its big L and its rows (4): the program
holds Booleans alone (`solver.gain.master`), and the rows of unbalanced cycles are added when a point breaks them. It is
combinatorial Benders decomposition (Codato and Fischetti 2006) whose minimal infeasible sets are simple cycles.

Families P and B mean what they mean in the paper. Of the rest two things differ:

- Family C has no counterpart of its own. What is right about it, that an xyzy cycle and an xyz cycle without a common
  corner cannot be real, is connectivity itself here and cannot be switched off; a true corner of three lines, which the
  paper's (10) forbids, is allowed. `without={"cycles"}` leaves out the short cycles that are looked up at the start,
  and nothing else: the optimum is the same.
- `depth_range` has no counterpart: potentials need no bound, since no L depends on them.

The search: a heuristic answer, linear relaxations with all rows that they break, Booleans fixed by their reduced
costs, then branch and cut. At the time limit before the last of these the answer is that of the heuristic, and the
status says so.
"""

import threading
import time
from collections.abc import Callable

import numpy as np

from linecad.arrays import Bool, Float
from linecad.line_graph import LineGraph, Solution, Status
from solver.annotations import check_annotations, read_annotations
from solver.choice import (
    BOUND_ROUNDING,
    Choice,
    boundaries,
    common_measure,
    objective_of,
    planar_pairs,
    recheck,
    round_down,
    trivial_bound,
)
from solver.depths import end_ratios
from solver.families import Families, find_families
from solver.gain.backend import Backend, Relaxed
from solver.gain.master import Program, add_plane_column, build_master, fill
from solver.gain.separation import Separation, is_integral
from solver.options import Progress, SolveOptions, relative_gap
from solver.potentials import fit_near_depths
from solver.progress import Reporter, catch_interrupt
from solver.start import Starter

ROUNDS = 200  # of the relaxation, at most
TAIL = 8  # rounds
LEAST_PROGRESS = 0.02  # of the gap, which the bound must fall by in TAIL rounds for another one
HEURISTIC_EVERY = 5  # rounds
TIE = 1e-3  # weight beside the relaxation's value, where that is the same for two crossings
SAFETY = 1e-6  # relative, by which a bound must be worse than the objective to fix a Boolean or to end the search
RELAXATION_SHARE = 0.7  # of the time, after which the relaxations leave the rest to branch and cut


def solve_gain(
    graph: LineGraph, options: SolveOptions, backend: Backend, on_progress: Callable[[Progress], None] | None
) -> Solution:
    """The best balanced set of crossings; see `solver.solve.solve` for what is promised."""
    began = time.monotonic()
    with catch_interrupt() as stop:
        search = _Search(graph, options, backend, began, on_progress, stop)
        status = search.run()
        recheck(graph, search.families, options, search.best)
        objective = objective_of(graph, options, search.best)
        bound = max(objective, search.reporter.bound)
        if bound - objective <= SAFETY * max(1.0, abs(objective)):
            bound, status = objective, "optimal"
        search.reporter.finish(objective, bound)
    return Solution(
        status=status,
        solver=backend.name,
        formulation="gain",
        objective=objective,
        bound=bound,
        gap=relative_gap(objective, bound),
        seconds=time.monotonic() - began,
        nodes=search.reporter.nodes,
        connected=search.best.connected,
        is_boundary=search.best.is_boundary,
        planar_pairs=search.best.planar_pairs,
        log_depth=search.best.log_depth,
        cuts=search.separation.cuts if search.separation else 0,
    )


class _Search:
    """The state of one solve: the best choice so far, the proven bound, the program."""

    def __init__(
        self,
        graph: LineGraph,
        options: SolveOptions,
        backend: Backend,
        began: float,
        on_progress: Callable[[Progress], None] | None,
        stop: threading.Event,
    ) -> None:
        self.graph, self.options, self.backend, self.stop = graph, options, backend, stop
        self.end = began + options.seconds
        ratios = end_ratios(graph)
        self.families: Families = find_families(graph, options.without | {"cycles"})
        self.real, self.fake = read_annotations(graph, options)
        check_annotations(graph, self.families, options, self.real, ratios)
        self.starter = Starter(graph, self.families, options, ratios, self.real, self.fake)
        self.best: Choice = self.starter.find()
        self.value = objective_of(graph, options, self.best)
        self.measure = common_measure(graph, options)
        bound = trivial_bound(graph, self.families, options)
        self.reporter = Reporter(began, self.value, bound, on_progress)
        self.separation: Separation | None = None

    def run(self) -> Status:
        """Search; returns how it ended. The best choice and the bound are kept in the object."""
        ended = self._ended()
        if ended:
            return ended
        self.separation = separation = Separation(self.graph, self.families, self.options, self.fake)
        program = build_master(
            self.graph,
            self.families,
            self.options,
            lower=self.real.astype(np.float64),
            upper=(self.graph.possible & ~self.fake).astype(np.float64),
        )
        last = self._relax(program, separation)
        ended = self._ended()
        if ended:
            return ended
        if last is not None:
            self._fix(program, last)
        for number in range(len(separation.planes.pairs)):
            add_plane_column(program, separation.planes, number)
        start = fill(program, self.best.connected, separation.planes, self.families, self.best.planar_pairs)
        found = self.backend.solve_integer(program, separation, self.options, start, self.reporter, self.stop)
        if found.x is not None:
            self._take(found.x[: program.integers] > 0.5)
        return found.status

    def _relax(self, program: Program, separation: Separation) -> Relaxed | None:
        """Solve relaxations and add the rows that they break until there are none or they are no longer worth it."""
        relaxation = self.backend.relaxation(program)
        until = time.monotonic() + RELAXATION_SHARE * (self.end - time.monotonic())
        values: list[float] = []
        last = None
        for turn in range(ROUNDS):
            seconds = until - time.monotonic()
            solved = relaxation.solve(seconds) if seconds > 0 and not self.stop.is_set() else None
            if solved is None:
                return last
            last = solved
            values.append(solved.value)
            self.reporter.note(self.value, round_down(solved.value, self.measure), 0)
            rows = separation.extend(program, solved.x)
            if not rows and is_integral(solved.x[: program.integers]):
                self._take(solved.x[: program.integers] > 0.5)
            elif not rows or turn % HEURISTIC_EVERY == 1:
                self._round(solved.x)
            self.reporter.report()
            gap = solved.value - self.value
            is_stuck = len(values) > TAIL and values[-1 - TAIL] - values[-1] < LEAST_PROGRESS * gap
            if not rows or is_stuck or self._ended():
                return last
        return last

    def _round(self, x: Float) -> None:
        """Let the values of a relaxation say in which order the heuristic believes the crossings."""
        evidence = np.clip(x[: len(self.graph.edges)], 0, 1) + TIE * self.graph.weight / self.graph.weight.max(
            initial=1
        )
        rounded = self.starter.round(evidence, self.end)
        if rounded is not None:
            self._offer(rounded)

    def _fix(self, program: Program, last: Relaxed) -> None:
        """Fix Booleans whose reduced cost says that the other value cannot be better than what is known.

        Only at the value of the best known choice, which so stays a solution of what is left.
        """
        least_step = (1 - BOUND_ROUNDING) * self.measure  # by which anything better is better
        allowed = last.value - self.value - least_step + SAFETY * max(1.0, abs(self.value))
        b = last.x[: program.integers]
        decided = np.abs(last.reduced[: program.integers]) > allowed
        known = self.best.connected
        for edge in np.flatnonzero(decided & known & (b > 1 - SAFETY)).tolist():
            program.lower[edge] = program.upper[edge]
        for edge in np.flatnonzero(decided & ~known & (b < SAFETY)).tolist():
            program.upper[edge] = program.lower[edge]

    def _take(self, connected: Bool) -> None:
        """Offer a solver's crossings with depths of our own; they are dropped if no depths fit them."""
        step, near = self.starter.step, self.starter.to_middle
        fit = fit_near_depths(self.graph, step, connected, np.inf, self.best.log_depth + near)
        assert len(fit.contradiction) == 0, "a solver returned crossings that separation had not tested"
        flags, planes = boundaries(self.graph, connected), planar_pairs(self.families, connected)
        self._offer(Choice(connected, flags, planes, fit.near - near))

    def _offer(self, choice: Choice) -> None:
        value = objective_of(self.graph, self.options, choice)
        if value > self.value:
            self.best, self.value = choice, value
            self.reporter.note(value, np.inf, 0)

    def _ended(self) -> Status | None:
        """Whether the search is over before branch and cut."""
        gap = relative_gap(self.value, self.reporter.bound)
        if gap <= SAFETY:
            return "optimal"
        if self.options.gap and gap <= self.options.gap:
            return "gap limit"
        if self.stop.is_set():
            return "interrupted"
        if time.monotonic() >= self.end:
            return "heuristic"
        return None
