"""Which crossings are worth a person's word first: those whose answer puts the most lines right.

Lines that no single line parts from each other keep one shape whatever is said about one crossing
(`linecad.decide.blocks`). An answer about a crossing between two such *parts* moves one of them, so it is worth the
length of that one in the photo, as far as its depth is not sure. Once a part is asked about, the next crossing that
would move it is worth half of the one before. Crossings inside a part come last.
"""

from collections.abc import Mapping
from typing import Protocol

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.decide.blocks import find_blocks
from linecad.editing.in_model import rows_in_scene, sureness
from linecad.line_graph import LineGraph
from linecad.scene import Scene

AGAIN = 0.5  # of the worth of a crossing, when one that moves the same part came before


def by_worth(graph: LineGraph, real: Bool, probability: Float) -> Int:
    """(E,) the crossings of a graph of N lines, the most telling first.

    `real` (E,) is what is decided about each, `probability` (N,) that the depth of a line is right; 0 for lines that
    are not in the model.
    """
    ends = graph.segments.ends
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    part = find_blocks(graph, real).body
    count = int(part.max(initial=-1)) + 1
    weight = np.bincount(part, length * probability, count)
    unsure = np.bincount(part, length * (1 - probability), count)
    one, other = part[graph.edges].T
    moved = np.where(weight[one] < weight[other], one, other)
    in_model = np.maximum(weight[one], weight[other]) > 0  # else both stay outside, whatever is said
    worth = np.where((one != other) & in_model, unsure[moved], 0.0)
    seen = length[graph.edges].min(axis=1)
    doubt = 1 - probability[graph.edges].min(axis=1)
    # Of one part the crossing of the longest lines is asked about first: what it shows is seen best.
    about = np.where(worth > 0, moved, -1)
    within = np.lexsort((-seen, about))
    starts = np.r_[True, np.diff(about[within]) != 0][: len(within)]
    number = np.arange(len(within)) - np.maximum.accumulate(np.where(starts, np.arange(len(within)), 0))
    worth[within] *= AGAIN**number
    order: Int = np.lexsort((-seen, -doubt, -worth))
    return order


class IsReal(Protocol):
    """The decision about a crossing."""

    @property
    def real(self) -> bool:
        """Whether its lines meet."""


class Order:
    """The crossings in the order of what they tell, found once for each model: that takes longer than an edit may.

    Labels do not change it: who goes from one to the next meets each once. Crossings of lines that the model does not
    have come first, since a person has just made them.
    """

    def __init__(self) -> None:
        self._scene: Scene | None = None
        self._of_model: tuple[int, ...] = ()
        self._graph: LineGraph | None = None
        self._now: tuple[int, ...] = ()

    def of(
        self, graph: LineGraph, crossings: tuple[int, ...], scene: Scene | None, decided: Mapping[int, IsReal]
    ) -> tuple[int, ...]:
        """The ids of the `crossings` of a graph in the `scene` of its model, with its decisions by id."""
        is_new = self._graph is None or scene is not self._scene
        if is_new or (scene is None and graph is not self._graph):
            probability = np.zeros(len(graph.segments))
            if scene is not None:
                row = rows_in_scene(graph, scene)
                probability[row >= 0] = sureness(scene)[row[row >= 0]]
            real = np.array([crossing in decided and decided[crossing].real for crossing in crossings], bool)
            order = by_worth(graph, real, probability)
            self._scene, self._of_model = scene, tuple(crossings[edge] for edge in order.tolist())
            self._graph, self._now = graph, self._of_model
        elif graph is not self._graph:
            here, known = frozenset(crossings), frozenset(self._of_model)
            new = (crossing for crossing in crossings if crossing not in known)
            self._graph, self._now = graph, (*new, *(crossing for crossing in self._of_model if crossing in here))
        return self._now
