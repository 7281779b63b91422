"""The earlier method: connectivity alone in a least-absolute-deviation program, no Booleans.

Ramalingam and Brand, "Lifting 3D Manhattan Lines from a Single Image", ICCV 2013, as Ranade and Ramalingam (3DV 2018)
state it with their constraints (4) to (6): the Boolean of a crossing becomes a slack s_ij that is paid for,

    min sum w_ij s_ij,    |lambda_ia d_ia,alpha - lambda_jb d_jb,alpha| <= s_ij,    (5),    lambda_ia >= 1.

By (5) both ends of a line have the same coordinate alpha, so a line has one unknown, the depth of its middle.
"""

import time
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import csr_matrix, vstack

from linecad.arrays import Float
from linecad.errors import SolverError
from linecad.line_graph import LineGraph
from solver.check import check_graph
from solver.depths import end_ratios

TIME_LIMIT = 4  # linprog's status when HiGHS ran out of time or met numbers that it could not handle


@dataclass(frozen=True, eq=False)
class Baseline:
    """The depths of N lines and the slacks of E crossings."""

    depth: Float  # (N,) camera depth of each segment's middle; no end is nearer than 1
    slack: Float  # (E,) by how far two lines miss each other in the third coordinate
    objective: float  # weighted sum of the slacks
    seconds: float


def solve_baseline(graph: LineGraph, time_limit_s: float) -> Baseline:
    """The depths of least weighted absolute deviation; SolverError when there are none within the time.

    Crossings whose lines lie on opposite sides of the camera are part of it: the method does not know about them.
    """
    check_graph(graph)
    started = time.perf_counter()
    lines, edges = len(graph.segments), len(graph.edges)
    near = 1.0 / end_ratios(graph).min(axis=1)  # depth of the middle when the near end has depth 1
    rows = np.arange(edges)
    i, j = graph.edges.T
    own, other = graph.components[i, graph.coordinate], graph.components[j, graph.coordinate]
    # s_i d_i - s_j d_j <= slack and the same with the other sign; columns are the depths, then the slacks.
    columns = np.concatenate([i, j, lines + rows])
    minus = -np.ones(edges)
    upper = csr_matrix((np.concatenate([own, -other, minus]), (np.tile(rows, 3), columns)), (edges, lines + edges))
    lower = csr_matrix((np.concatenate([-own, other, minus]), (np.tile(rows, 3), columns)), (edges, lines + edges))
    found = linprog(
        np.concatenate([np.zeros(lines), graph.weight]),
        A_ub=vstack([upper, lower]).tocsr(),
        b_ub=np.zeros(2 * edges),
        bounds=[*((float(least), None) for least in near), *((0.0, None) for _ in range(edges))],
        method="highs",
        options={"time_limit": time_limit_s},
    )
    if found.x is None or not found.success:
        reason = "the time was over" if found.status in (1, TIME_LIMIT) else " ".join(str(found.message).split())
        raise SolverError(f"the baseline's linear program has no solution: {reason}; give it more time")
    depth = np.asarray(found.x[:lines])
    slack = np.abs(depth[i] * own - depth[j] * other)
    return Baseline(depth, slack, float(graph.weight @ slack), time.perf_counter() - started)
