"""Cue: the kind of a junction, as a table in place of log-odds: the paper's weights w_ij.

The paper took its weights from an earlier work that did not print them. These follow the log-odds that a crossing of
each kind is real in surveyed photos, X = 1 (tests/benchmarks/junction_weights.py; docs/decisions/0016).
"""

import numpy as np

from linecad.arrays import Float
from linecad.graph.cues.cue import Known

WEIGHT = {
    "L": 1.1,
    "T": 0.9,
    "X": 1.0,
    "collinear": 0.5,  # two segments of one image line are evidence too, but not that the line goes on between them
}
CORNER_FACTOR = 0.6  # where a line of the third axis passes through the same point (Y and W junctions)


def junction_weights(known: Known) -> Float:
    """(E,) weight of each edge by its kind."""
    graph = known.graph
    by_kind = np.array([WEIGHT[word] for word in graph.kind.tolist()])
    return by_kind * np.where(graph.corner, CORNER_FACTOR, 1.0)


def equal_weights(known: Known) -> Float:
    """(E,) the same weight for all edges."""
    return np.ones(len(known.graph.edges))
