"""Bundles: all crossings between two bodies that ask for one ratio of their scales. However many, one witness."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import maximum_bipartite_matching

from linecad.arrays import Int
from linecad.ties.setting import Setting, densest_groups

WIDTH = 0.015  # log ratio within which crossings ask for the same
MOST = 5  # bundles of two bodies


@dataclass(frozen=True, eq=False)
class Bundle:
    """What one bundle shows; px at the reference width."""

    bodies: tuple[int, int]  # the smaller number first
    log_ratio: float  # log scale of the first body less that of the second
    edges: Int  # the crossings
    coordinates: frozenset[int]  # in which its lines must agree: of a shared plane's normal this one says nothing new
    log_odds: float  # the sum of those of the crossings
    of_all: float  # the same of all crossings of the two bodies
    matched: int  # crossings of which no two have a line in common, at most
    fewest: int  # lines on the side with fewer
    corners: int  # crossings at which both lines end
    pieces: int  # collinear ones
    gap: float  # px, the smallest
    from_both: bool  # lines of each body end at lines of the other


def find_bundles(setting: Setting) -> list[Bundle]:
    """The bundles of all pairs of bodies, the heaviest of each pair first."""
    graph, body = setting.graph, setting.bodies.body
    of_ends = body[graph.edges]
    told = graph.possible & graph.informative & (of_ends >= 0).all(axis=1) & (of_ends[:, 0] != of_ends[:, 1])
    edges = np.flatnonzero(told)
    # Sides: the line of the body with the smaller number first.
    turned = of_ends[edges, 0] > of_ends[edges, 1]
    lines = np.where(turned[:, None], graph.edges[edges][:, ::-1], graph.edges[edges])
    asked = graph.log_ratio[edges] * np.where(turned, -1.0, 1.0)
    asked = asked - setting.log_depth[lines[:, 0]] + setting.log_depth[lines[:, 1]]
    pair = body[lines[:, 0]] * setting.bodies.count + body[lines[:, 1]]
    found = []
    for number in np.unique(pair).tolist():
        own = np.flatnonzero(pair == number)
        weight = graph.weight[edges[own]]
        for log_ratio, which in densest_groups(asked[own], weight, WIDTH, MOST):
            chosen = own[which]
            found.append(_bundle(setting, edges[chosen], lines[chosen], log_ratio, float(weight.sum())))
    return found


def _bundle(setting: Setting, edges: Int, lines: Int, log_ratio: float, of_all: float) -> Bundle:
    graph = setting.graph
    first, second = setting.bodies.body[lines[0]].tolist()
    to_end = np.stack(
        [np.linalg.norm(graph.segments.ends[side] - graph.crossing[edges][:, None], axis=2).min(axis=1)
         for side in lines.T], axis=1,
    )  # fmt: skip
    is_stem = graph.kind[edges] == "T"
    of_first = is_stem & (to_end[:, 0] < to_end[:, 1])
    return Bundle(
        bodies=(first, second),
        log_ratio=log_ratio,
        edges=edges,
        coordinates=frozenset(graph.coordinate[edges].tolist()),
        log_odds=float(graph.weight[edges].sum()),
        of_all=of_all,
        matched=_matched(lines),
        fewest=min(len(np.unique(side)) for side in lines.T),
        corners=int((graph.kind[edges] == "L").sum()),
        pieces=int((graph.kind[edges] == "collinear").sum()),
        gap=float(graph.gap[edges].max(axis=1).min()) * setting.scale,
        from_both=bool(of_first.any() and (is_stem & ~of_first).any()),
    )


def _matched(lines: Int) -> int:
    """The size of a maximum matching of pairs of lines (M, 2)."""
    (first, row), (second, column) = (np.unique(side, return_inverse=True) for side in lines.T)
    links = csr_matrix((np.ones(len(lines)), (row, column)), (len(first), len(second)))
    return int((maximum_bipartite_matching(links, perm_type="column") >= 0).sum())
