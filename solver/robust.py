"""A robust fit of depths: log s_i - log s_j = c_ij for all crossings at once, of which some are fake.

The residuals of the crossings go through the function of Geman and McClure, r^2 / (1 + r^2), so that a crossing far
off its equation costs a constant and pulls no more. Graduated non-convexity finds a good minimum without a start: the
function is first so wide that it is least squares, and narrows step by step (Blake and Zisserman 1987; Yang, Antonante,
Tzoumas and Carlone 2020). Each step is one sparse linear system of one fixed pattern, so a fit takes tenths of a second
where the exact search takes minutes. Nothing is proven.
"""

import time
from collections.abc import Callable

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

from linecad.arrays import Bool, Float, Int
from linecad.errors import SolverError
from linecad.line_graph import LineDepths, LineGraph, Solution
from solver.choice import boundaries
from solver.depths import end_ratios
from solver.options import Progress, SolveOptions

WIDTH = 0.01  # log depth; a crossing this far off pulls no longer, whatever its tolerance: frame and lens are not exact
SLACK = 0.005  # log depth, within which a crossing agrees with a fit whatever its tolerance
NARROWING = 3.0  # of the square of the width, from one step to the next
LAST_STEPS = 4  # at the final width; narrower ones would follow small groups of crossings and measured worse
ANCHOR = 1e-9  # of the crossings of a line; keeps what nothing connects where it is, and the whole


class RobustFit:
    """Fits depths to one graph, as often as asked with other weights."""

    def __init__(self, graph: LineGraph) -> None:
        self.count = len(graph.segments)
        self.used = np.flatnonzero(graph.informative & graph.possible)
        i, j = graph.edges[self.used].T
        self.ratio, self.tolerance = graph.log_ratio[self.used], graph.tolerance[self.used]
        self.weight = graph.weight[self.used]
        order = _elimination_order(self.count, i, j)
        self.place = np.empty(self.count, np.int64)  # of each line in the linear system
        self.place[order] = np.arange(self.count)
        self.i, self.j = self.place[i], self.place[j]
        # Where the four entries of each crossing and the diagonal go in the compressed columns of the matrix.
        every = np.arange(self.count)
        rows, columns = np.r_[self.i, self.j, self.i, self.j, every], np.r_[self.j, self.i, self.i, self.j, every]
        cells, self.cell = np.unique(columns * self.count + rows, return_inverse=True)
        told = graph.depths if graph.depths is not None else LineDepths.none()
        self.told, self.told_place = told, self.place[told.line]
        self.rows = (cells % max(1, self.count)).astype(np.int32)
        self.starts = np.searchsorted(cells // max(1, self.count), np.arange(self.count + 1)).astype(np.int32)

    def depths(self, weight: Float | None = None) -> Float:
        """(N,) log depths, by `weight` (E,) if given else the graph's.

        Groups of lines that no crossing connects have unrelated scales.
        """
        own = self.weight if weight is None else weight[self.used]
        if not (own > 0).any() and not len(self.told.line):
            return np.zeros(self.count)
        width = np.maximum(self.tolerance, WIDTH)
        # One unit of log-odds a depth that is told: what crossings contradict is given up as one crossing would be.
        told = np.ones(len(self.told.line))
        depth = self._step(own / width**2, told / self.told.sigma**2, np.zeros(self.count))
        far = float((self._residual(depth, width) ** 2)[own > 0].max(initial=0.0))
        far = max(far, float((self._told_residual(depth) ** 2)[self.told.may_be_outlier].max(initial=0.0)))
        widening = max(1.0, 2 * far)  # of the squared width, at which the cost is convex where the residuals are
        while widening > 1:
            depth = self._narrowed(depth, own, told, width, widening)
            widening /= NARROWING
        for _ in range(LAST_STEPS):
            depth = self._narrowed(depth, own, told, width, 1.0)
        return depth[self.place]

    def _narrowed(self, depth: Float, weight: Float, told: Float, width: Float, widening: float) -> Float:
        """One step of iteratively reweighted least squares."""
        squared = self._residual(depth, width) ** 2
        squared_told = np.where(self.told.may_be_outlier, self._told_residual(depth) ** 2, 0.0)
        return self._step(
            weight / width**2 * (widening / (widening + squared)) ** 2,
            told / self.told.sigma**2 * (widening / (widening + squared_told)) ** 2,
            depth,
        )

    def _residual(self, depth: Float, width: Float) -> Float:
        residual: Float = (depth[self.i] - depth[self.j] - self.ratio) / width
        return residual

    def _told_residual(self, depth: Float) -> Float:
        residual: Float = (depth[self.told_place] - self.told.log_depth) / self.told.sigma
        return residual

    def _step(self, weight: Float, told: Float, depth: Float) -> Float:
        """The weighted least squares of crossings (E',) and depths that are told (M,), as a step from `depth`."""
        pulled = np.bincount(self.i, weight, self.count) + np.bincount(self.j, weight, self.count)
        anchor = ANCHOR * np.maximum(pulled, ANCHOR * pulled.max(initial=0.0))
        anchor += np.bincount(self.told_place, told, self.count)
        values = np.bincount(self.cell, np.concatenate([-weight, -weight, weight, weight, anchor]), len(self.rows))
        matrix = csc_matrix((values, self.rows, self.starts), (self.count, self.count))
        pull = weight * (self.ratio - depth[self.i] + depth[self.j])
        right = np.bincount(self.i, pull, self.count) - np.bincount(self.j, pull, self.count)
        right += np.bincount(self.told_place, told * (self.told.log_depth - depth[self.told_place]), self.count)
        factors = splu(matrix, permc_spec="NATURAL", options={"SymmetricMode": True}, diag_pivot_thresh=0.0)
        stepped: Float = depth + factors.solve(right)
        return stepped


def solve_robust(graph: LineGraph, options: SolveOptions, on_progress: Callable[[Progress], None] | None) -> Solution:
    """The crossings that agree with a robust fit, as the answer: no search, no proof, so neither bound nor gap.

    The objective counts crossings alone. A search keeps to annotations of crossings; a fit cannot:
    SolverError.
    """
    began = time.monotonic()
    if options.real or options.fake:
        raise SolverError("a robust fit cannot keep to annotations of single crossings; leave out --fast")
    end_ratios(graph)  # ValueError for a graph that breaks the promises of LineGraph
    depth = RobustFit(graph).depths()
    connected = agreeing_with(graph, depth)
    objective = float(graph.weight[connected].sum())
    seconds = time.monotonic() - began
    if on_progress is not None:
        on_progress(Progress(seconds, objective, np.inf, np.inf, 0))
    return Solution(
        status="robust fit",
        solver="graduated non-convexity",
        formulation="gain",
        objective=objective,
        bound=np.inf,
        gap=np.inf,
        seconds=seconds,
        nodes=0,
        connected=connected,
        is_boundary=boundaries(graph, connected),
        planar_pairs=np.zeros((0, 3), np.int64),
        log_depth=depth,
    )


def agreeing_with(graph: LineGraph, depth: Float) -> Bool:
    """(E,) the crossings that fitted depths (N,) put within their tolerance, and those that say nothing about depth.

    At least SLACK: a fit spreads what is left over, where a search keeps each crossing within its tolerance.
    """
    agrees: Bool = graph.misfit(depth) <= np.maximum(graph.tolerance, SLACK)
    return graph.possible & (agrees | ~graph.informative)


def _elimination_order(count: int, i: Int, j: Int) -> Int:
    """The lines in an order that keeps the factors of the system sparse (minimum degree)."""
    if count == 0:
        return np.zeros(0, np.int64)
    links = csc_matrix((np.ones(2 * len(i)), (np.r_[i, j], np.r_[j, i])), (count, count))
    links.data[:] = -1.0
    heavy = csc_matrix((np.full(count, 1.0 + count), (np.arange(count), np.arange(count))), (count, count))
    # The order alone counts, and the factors are found soonest one column at a time. Those of a step are not: it would
    # round them in another way.
    factors = splu(
        (links + heavy).tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        panel_size=1,
        options={"SymmetricMode": True},
        diag_pivot_thresh=0.0,
    )
    return np.argsort(factors.perm_c)
