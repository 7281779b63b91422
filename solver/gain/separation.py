"""All rows of the master problem that a point breaks: short cycles, long cycles, planes."""

import numpy as np
from scipy.sparse import csr_array

from linecad.arrays import Bool, Float
from linecad.line_graph import LineGraph
from solver.cycles import Cycle, Separator, build_network, find_contradiction, find_short_cycles
from solver.families import Families
from solver.gain.master import ROUNDING, Planes, Program, Row, add_planes, cycle_row, join_planes
from solver.options import SolveOptions

MOST_SEEDS = 500  # rows of each kind that one round may add
MOST_CYCLES = 200
MOST_PLANES = 1000
FEW = 10  # cycles found the cheap way, below which the dear way is tried too
LEAST_VIOLATION = 1e-3  # by which a point must break a seed
MOST_PATH_WORK = 4_000_000  # roots times edges of one round of shortest paths


def is_integral(b: Float) -> bool:
    """Whether all values are 0 or 1 but for rounding."""
    return bool(np.abs(b - np.rint(b)).max(initial=0) < ROUNDING)


class Separation:
    """Knows the rows that a program has, and finds more."""

    def __init__(self, graph: LineGraph, families: Families, options: SolveOptions, barred: Bool) -> None:
        """`barred` (E,) are edges annotated as fake: no cycle through them matters."""
        self.graph = graph
        self.edges = len(graph.edges)
        self.planes = Planes(families, options.mu_planarity)
        self.cycles = Separator(build_network(graph, barred))
        self.seeds = [] if "cycles" in options.without else find_short_cycles(graph)
        sizes = [len(seed) for seed in self.seeds]
        columns = np.array([edge for seed in self.seeds for edge in seed], np.int64)
        rows = np.repeat(np.arange(len(sizes)), np.array(sizes, np.int64))
        self.table = csr_array((np.ones(len(columns)), (rows, columns)), shape=(len(sizes), self.edges))
        self.allowed = np.array(sizes, np.float64) - 1
        self.known: set[Cycle] = set()
        self.cuts = 0
        work = max(1, len(self.cycles.network.edge))
        self.roots = np.arange(0, len(graph.segments), max(1, len(graph.segments) * work // MOST_PATH_WORK))

    def extend(self, program: Program, x: Float) -> int:
        """Add to a relaxed program rows that its optimum x breaks, with the columns that they need; how many.

        Where b is integral the answer is exact, as that of `broken_rows`.
        """
        b = np.clip(x[: self.edges], 0, 1)
        found = self._broken_seeds(b)
        found += self._new(self.cycles.along_forest(b, MOST_CYCLES))
        if is_integral(b):
            found = found or self._contradiction(b)
        elif len(found) < FEW:
            found += self._new(self.cycles.along_paths(b, self.roots, MOST_CYCLES))
        planes = self.planes.broken(x)[:MOST_PLANES]
        program.rows += [cycle_row(cycle) for cycle in found]
        add_planes(program, self.planes, planes)
        self.cuts += len(found) + len(planes)
        return len(found) + len(planes)

    def broken_rows(self, x: Float, exact: bool) -> list[Row]:
        """Rows that x breaks and that the solver does not have; x has a column for every pair (`join_planes`).

        If `exact`, x must be integral: then there is none only if depths fit the crossings and every pair counted as
        planar is planar.
        """
        b = np.clip(x[: self.edges], 0, 1)
        found = self._broken_seeds(b) + self._new(self.cycles.along_forest(b, MOST_CYCLES))
        if exact and not found:
            found = self._contradiction(b)
        broken = self.planes.broken(x, ROUNDING if exact else LEAST_VIOLATION)
        planes = join_planes(self.planes, broken[:MOST_PLANES])
        self.cuts += len(found) + len(planes)
        return [cycle_row(cycle) for cycle in found] + planes

    def breaks(self, x: Float) -> bool:
        """Whether an integral x breaks any row at all."""
        b = np.clip(x[: self.edges], 0, 1)
        return bool(
            self.cycles.along_forest(b, 1)
            or len(find_contradiction(self.graph, b > 0.5))
            or self.planes.broken(x, ROUNDING)
        )

    def _contradiction(self, b: Float) -> list[Cycle]:
        """A cycle that an integral b breaks, if depths do not fit it."""
        contradiction = find_contradiction(self.graph, b > 0.5)
        return self._new([tuple(contradiction.tolist())], repeat=True) if len(contradiction) else []

    def _broken_seeds(self, b: Float) -> list[Cycle]:
        excess = self.table @ b - self.allowed
        broken = np.flatnonzero(excess > LEAST_VIOLATION)
        broken = broken[np.argsort(-excess[broken], kind="stable")]
        return self._new([self.seeds[k] for k in broken[:MOST_SEEDS].tolist()])

    def _new(self, cycles: list[Cycle], repeat: bool = False) -> list[Cycle]:
        """Those that were not found before, unless a repetition is asked for; from now on all of them were."""
        new = [cycle for cycle in cycles if repeat or cycle not in self.known]
        self.known.update(new)
        return new
