"""The paper's MILP as a SCIP model: variables, one function per family of constraints, the objective.

Ranade and Ramalingam, "Novel Single View Constraints for Manhattan 3D Line Reconstruction", 3DV 2018. Numbers in
brackets are the paper's equations.

| paper                | here                                                          | variable    | equations     |
| -------------------- | ------------------------------------------------------------- | ----------- | ------------- |
| i in V, D_i          | a line of the graph, `graph.axis[i]`                          |             |               |
| (i, j) in E, w_ij    | an edge, `graph.edges[e]`, `graph.weight[e]`                  |             |               |
| alpha                | `graph.coordinate[e]`                                         |             | (4)           |
| d_ia                 | `graph.end_rays[i, a]`, camera depth 1                        |             | (2)           |
| lambda_ia            | `depth[i][a]`, camera depth of an end, a = 0, 1 for the       | lambda_i_a  | (4) (5) (6)   |
|                      | paper's 1, 2                                                  |             |               |
| b_ij                 | `connected[e]`                                                | b_i_j       | (3) to (19)   |
| pi_kl^(e), pi_kl^(f) | `planar[k, l, axis]`                                          | pi_k_l_x    | (12) to (18)  |
| B_i                  | `boundary[i]`                                                 | B_i         | (19) (20)     |
| mu_1, mu_2           | `options.mu_planarity`, `options.mu_boundary`                 |             | (21)          |
| L                    | for each row the smallest valid number, see `add_connectivity`|             | (4)           |
| slack                | `graph.tolerance[e]`, an interval of the ratio of two depths  |             | (4)           |

What the paper leaves open, and how it is settled here:

- lambda has an upper bound (the near end of a line lies at most at `options.depth_range`), without which no L exists.
- An annotation, real or fake, is a bound of b.
- The paper writes "(j, m) in E" above (13); it must read "(l, m)".
- A pi exists only for pairs with a neighbour that both lines can meet; else it would be a reward for nothing.
- An edge whose two lines lie on opposite sides of the camera (`possible` False) has b = 0. One that says nothing about
  depth (`informative` False) has no row (4) and stands in no cycle, but takes part in (15) to (19).
- A collinear edge joins two lines of one axis; it has rows (4) and a place in the objective, and nothing else.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from pyscipopt import Model, Variable, quicksum

from linecad.arrays import Bool, Float, Int
from linecad.directions import axis_name
from linecad.errors import SolverError
from linecad.line_graph import LineGraph
from solver.annotations import read_annotations
from solver.choice import Choice, boundaries, objective_of
from solver.depths import near_log_ratio
from solver.families import Families
from solver.options import SolveOptions

INTEGRALITY_TOLERANCE = 1e-6  # how far a Boolean may be from 0 and 1, and SCIP's objective (relative) from our own


@dataclass(frozen=True, eq=False)
class PaperModel:
    """A SCIP model with its variables by the indices of the line graph."""

    model: Model
    depth: list[tuple[Variable, Variable]]  # per line, lambda of both ends
    near: list[int]  # per line, which of the two is the near end
    connected: list[Variable]  # per edge
    planar: dict[tuple[int, int, int], Variable]  # two lines, ascending, and the other axis of their plane
    boundary: list[Variable]  # per line; empty without the family


def build_model(graph: LineGraph, families: Families, options: SolveOptions, ratios: Float) -> PaperModel:
    """The whole MILP (21); `ratios` as `solver.depths.end_ratios` returns them."""
    paper = _add_variables(graph, families, options, ratios)
    add_connectivity(paper, graph, options, ratios)
    add_manhattan(paper, ratios)
    add_three_cycles(paper, graph, families)
    add_four_cycles(paper, graph, families)
    add_planarity(paper, graph, families)
    add_boundary(paper, graph, families)
    set_objective(paper, graph, options)
    return paper


def _add_variables(graph: LineGraph, families: Families, options: SolveOptions, ratios: Float) -> PaperModel:
    """All variables; (6), lambda_ia >= 1, is the lower bound of the depths."""
    model = Model("linecad")
    model.hideOutput()
    known_real, known_fake = read_annotations(graph, options)
    near = np.argmin(ratios, axis=1).tolist()
    largest = options.depth_range * ratios / ratios.min(axis=1, keepdims=True)
    depth = [
        (
            model.addVar(f"lambda_{i}_0", lb=1.0, ub=upper[0]),
            model.addVar(f"lambda_{i}_1", lb=1.0, ub=upper[1]),
        )
        for i, upper in enumerate(largest.tolist())
    ]
    connected = [
        model.addVar(f"b_{i}_{j}", vtype="B", lb=float(real), ub=float(allowed))
        for (i, j), real, allowed in zip(
            graph.edges.tolist(), known_real.tolist(), (graph.possible & ~known_fake).tolist(), strict=True
        )
    ]
    planar = {
        (*pair.lines, axis): model.addVar(f"pi_{pair.lines[0]}_{pair.lines[1]}_{axis_name(axis)}", vtype="B")
        for pair in families.pairs
        for axis in pair.axes
    }
    lines = range(0 if "boundary" in options.without else len(graph.segments))
    boundary = [model.addVar(f"B_{i}", vtype="B") for i in lines]
    return PaperModel(model, depth, near, connected, planar, boundary)


def add_connectivity(paper: PaperModel, graph: LineGraph, options: SolveOptions, ratios: Float) -> None:
    """(4): two lines that meet agree in the third coordinate, |lambda_ia d_ia,alpha - lambda_jb d_jb,alpha| <= L(1-b).

    By (5) both ends of a line have the same coordinate alpha, so the four rows over a, b in {1, 2} are one and the same
    constraint; it is written for the near ends n_i, n_j. Noise widens the zero to an interval (the paper's slack): the
    ratio of the two coordinates lies within exp(-tolerance) .. exp(+tolerance), which is linear in the depths,

        n_i <= exp(c + tolerance) n_j + L (1 - b),    n_j <= exp(-c + tolerance) n_i + L' (1 - b),

    with c the log ratio of the near ends of lines that meet, and equals |log s_i - log s_j - log_ratio| <= tolerance.
    Near ends lie in 1 .. U, U = depth_range, so the smallest valid L is the largest that the left side can exceed the
    right: L = U - exp(c + tolerance), and L' likewise. Where that is not positive the row always holds and is left out.
    """
    step = near_log_ratio(graph, ratios)
    for e in (graph.possible & graph.informative).nonzero()[0].tolist():
        i, j = graph.edges[e].tolist()
        n_i, n_j = paper.depth[i][paper.near[i]], paper.depth[j][paper.near[j]]
        for upper, lower, c, side in ((n_i, n_j, step[e], "upper"), (n_j, n_i, -step[e], "lower")):
            factor = float(np.exp(c + graph.tolerance[e]))
            big = options.depth_range - factor
            if big > 0:
                row = upper - factor * lower <= big * (1 - paper.connected[e])
                paper.model.addCons(row, f"connect_{i}_{j}_{side}")


def add_manhattan(paper: PaperModel, ratios: Float) -> None:
    """(5): a line runs along its axis, lambda_i1 d_i1,beta = lambda_i2 d_i2,beta for the two other coordinates beta.

    Both rows are the same for a segment that passes through the vanishing point of its axis, and `end_ratios` has
    checked that it does. One is written, with the far end alone on the left; two that differ by rounding alone would
    allow no depth but zero.
    """
    for i, ends in enumerate(paper.depth):
        near = paper.near[i]
        stretch = float(ratios[i, 1 - near] / ratios[i, near])
        paper.model.addCons(ends[1 - near] == stretch * ends[near], f"manhattan_{i}")


def add_three_cycles(paper: PaperModel, graph: LineGraph, families: Families) -> None:
    """(10): of the crossings of an x-, a y- and a z-line at most two are real, b_ij + b_jk + b_ik <= 2.

    This forbids a true corner of three lines as well; it stands here as printed.
    """
    for cycle in families.three_cycles:
        _keep_open(paper, graph, cycle)


def add_four_cycles(paper: PaperModel, graph: LineGraph, families: Families) -> None:
    """(11): of the crossings around an xyzy cycle at most three are real, b_ij + b_jk + b_kl + b_li <= 3."""
    for cycle in families.four_cycles:
        _keep_open(paper, graph, cycle)


def _keep_open(paper: PaperModel, graph: LineGraph, cycle: tuple[int, ...]) -> None:
    lines = "_".join(map(str, np.unique(graph.edges[list(cycle)]).tolist()))
    paper.model.addCons(quicksum(paper.connected[e] for e in cycle) <= len(cycle) - 1, f"cycle_{lines}")


def add_planarity(paper: PaperModel, graph: LineGraph, families: Families) -> None:
    """(12), (15), (16), (17): two parallel lines k, l in a plane along e meet a line m of axis e both or not at all.

    A line m of the other axis f meets at most one of them. For every line m with edges to both.
    """
    for pair in families.pairs:
        k, l = pair.lines  # noqa: E741 - the paper's names
        pi = {axis: paper.planar[k, l, axis] for axis in pair.axes}
        paper.model.addCons(quicksum(pi.values()) <= 1, f"plane_{k}_{l}")
        for shared in pair.shared:
            (m,) = set(graph.edges[shared.first].tolist()) - {k}
            b_km, b_lm = paper.connected[shared.first], paper.connected[shared.second]
            e, f = shared.axis, sum(pair.axes) - shared.axis
            paper.model.addCons(pi[e] + b_km <= 1 + b_lm, f"plane_{k}_{l}_first_{m}")
            paper.model.addCons(pi[e] + b_lm <= 1 + b_km, f"plane_{k}_{l}_second_{m}")
            paper.model.addCons(pi[f] + b_km + b_lm <= 2, f"plane_{k}_{l}_not_both_{m}")


def add_boundary(paper: PaperModel, graph: LineGraph, families: Families) -> None:
    """(19): a line that meets lines m, n of two different axes is a boundary, b_im + b_in <= 1 + B_i."""
    for two in families.two_sides:
        i = two.line
        lower, higher = two.sides
        for first in lower:
            for second in higher:
                (m,), (n,) = (set(graph.edges[e].tolist()) - {i} for e in (first, second))
                row = paper.connected[first] + paper.connected[second] <= 1 + paper.boundary[i]
                paper.model.addCons(row, f"boundary_{i}_{m}_{n}")


def set_objective(paper: PaperModel, graph: LineGraph, options: SolveOptions) -> None:
    """(21): the weighted crossings (3), mu_1 times the planar pairs (18), mu_2 times the lines off a boundary (20)."""
    crossings = quicksum(w * b for w, b in zip(graph.weight.tolist(), paper.connected, strict=True))
    planes = options.mu_planarity * quicksum(paper.planar.values())
    inner = options.boundary_reward * quicksum(1 - boundary for boundary in paper.boundary)
    paper.model.setObjective(crossings + planes + inner, "maximize")


def add_start(paper: PaperModel, choice: Choice, ratios: Float) -> None:
    """Give SCIP a complete feasible solution to start from; it drops it in silence if a constraint is broken."""
    model = paper.model
    start = model.createSol()
    depths = np.exp(choice.log_depth)[:, None] * ratios
    for ends, values in zip(paper.depth, depths.tolist(), strict=True):
        for variable, value in zip(ends, values, strict=True):
            model.setSolVal(start, variable, max(1.0, value))
    for variable, flag in zip(paper.connected, choice.connected.tolist(), strict=True):
        model.setSolVal(start, variable, float(flag))
    for pair in choice.planar_pairs.tolist():
        model.setSolVal(start, paper.planar[tuple(pair)], 1.0)
    for i, variable in enumerate(paper.boundary):
        model.setSolVal(start, variable, float(choice.is_boundary[i]))
    model.addSol(start)


def exclude(paper: PaperModel, edges: Int) -> None:
    """Forbid that all of `edges` are real, after a solve that took them by the tolerance of SCIP's arithmetic."""
    paper.model.freeTransform()
    names = "_".join(map(str, edges.tolist()))
    paper.model.addCons(quicksum(paper.connected[e] for e in edges.tolist()) <= len(edges) - 1, f"exclude_{names}")


def read_choice(
    paper: PaperModel, graph: LineGraph, options: SolveOptions, ratios: Float, found: Mapping[str, float] | None = None
) -> Choice:
    """SCIP's best solution, or what another solver `found` for the variables by name.

    A boundary flag that no crossing asks for is taken back, which only adds to the objective.

    Raises SolverError when a Boolean is not integral or when SCIP counts another objective for the same choice.
    """
    model = paper.model
    best = model.getBestSol() if found is None else None

    def value(variable: Variable) -> float:
        return float(model.getSolVal(best, variable) if found is None else found[variable.name])

    def flags(variables: list[Variable]) -> Bool:
        values = np.array([value(variable) for variable in variables], np.float64)
        off = np.abs(values - np.rint(values))
        if len(off) and off.max() > INTEGRALITY_TOLERANCE:
            name = variables[int(np.argmax(off))].name
            raise SolverError(f"SCIP leaves {name} {off.max():.3g} off an integer; this is a fault of linecad")
        read: Bool = values > 0.5
        return read

    near = np.array([value(ends[near]) for ends, near in zip(paper.depth, paper.near, strict=True)])
    connected = flags(paper.connected)
    planar = flags(list(paper.planar.values()))
    needed = boundaries(graph, connected)
    marked = flags(paper.boundary) if paper.boundary else needed
    planar_pairs = np.array(list(paper.planar), np.int64).reshape(-1, 3)[planar]
    log_depth = np.log(near / ratios.min(axis=1))
    counted = objective_of(graph, options, Choice(connected, marked, planar_pairs, log_depth))
    if found is None:
        told = model.getSolObjVal(best)
    else:
        told = model.getObjoffset() + sum(variable.getObj() * value(variable) for variable in model.getVars())
    if abs(counted - told) > INTEGRALITY_TOLERANCE * max(1.0, abs(told)):
        raise SolverError(f"SCIP counts {told:g} where its answer is worth {counted:g}; this is a fault of linecad")
    return Choice(connected, marked & needed, planar_pairs, log_depth)
