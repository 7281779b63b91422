"""Which crossings are worth a person's word first: those whose answer puts the most lines right.

Lines that no single line parts from each other keep one shape whatever is said about one crossing
(`linecad.decide.blocks`). An answer about a crossing between two such *parts* moves one of them, so it is worth the
length of that one in the photo, as far as its depth is not sure. Once a part is asked about, the next crossing that
would move it is worth half of the one before. Crossings inside a part come last.
"""

from collections.abc import Callable

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


class Order:
    """The crossings in the order of what they tell, kept while neither the lines nor the model change.

    Labels do not change it: who goes from one to the next meets each once.
    """

    def __init__(self) -> None:
        self._of: tuple[object, ...] = ()
        self._order: tuple[int, ...] = ()

    def of(
        self, graph: LineGraph, crossings: tuple[int, ...], scene: Scene | None, real: Callable[[int], bool]
    ) -> tuple[int, ...]:
        """The ids of the `crossings` of a graph in the `scene` of its model, `real` by the model's decisions."""
        of = (graph, scene)
        if len(self._of) != len(of) or any(one is not other for one, other in zip(self._of, of, strict=True)):
            probability = np.zeros(len(graph.segments))
            if scene is not None:
                row = rows_in_scene(graph, scene)
                probability[row >= 0] = sureness(scene)[row[row >= 0]]
            decided = np.array([real(crossing) for crossing in crossings], bool)
            order = by_worth(graph, decided, probability)
            self._of, self._order = of, tuple(crossings[edge] for edge in order.tolist())
        return self._order
