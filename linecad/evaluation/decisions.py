"""What was decided about crossings against what is true of them: the paper's spanning tree, precision, recall."""

from dataclasses import dataclass

from linecad.arrays import Bool, Float, Int
from linecad.evaluation.labels import FAKE, REAL
from linecad.graph.connectivity import components, spanning_tree
from linecad.line_graph import LineGraph


@dataclass(frozen=True)
class Decisions:
    """Counts over the crossings of one photo; undecided crossings are in none of them."""

    tree_real: int  # the paper's n_a: crossings of the minimum spanning tree that are real
    tree_fake: int  # n_a + this is N_a
    chosen_real: int  # called real, and are
    chosen_fake: int  # called real, and are fake
    missed_real: int  # called fake, and are real
    tied_length: float  # px of segments in the largest tree
    total_length: float  # px of all labelled segments of the photo

    @property
    def tree_share(self) -> float | None:
        """n_a / N_a; None for a tree without a decided crossing."""
        count = self.tree_real + self.tree_fake
        return self.tree_real / count if count else None


def compare(
    graph: LineGraph, chosen: Bool, residual: Float, label: Int, total_length: float, telling: Bool | None = None
) -> Decisions:
    """Count the `chosen` crossings (E,) by their `label` (E,); the tree is Kruskal's in order of `residual` (E,).

    With `telling` (E,) only those are in the tree, as in a scene, where crossings that tell no depth are not.
    """
    tree = spanning_tree(graph, chosen if telling is None else chosen & telling, residual)
    largest = components(graph, tree)[:1]
    return Decisions(
        tree_real=int((tree & (label == REAL)).sum()),
        tree_fake=int((tree & (label == FAKE)).sum()),
        chosen_real=int((chosen & (label == REAL)).sum()),
        chosen_fake=int((chosen & (label == FAKE)).sum()),
        missed_real=int((~chosen & (label == REAL)).sum()),
        tied_length=float(sum(graph.segments.length[part].sum() for part in largest if len(part) > 1)),
        total_length=total_length,
    )


@dataclass(frozen=True)
class GraphStatistics:
    """One photo's share in the paper's table 2."""

    lines: int
    crossings: int
    real: int
    fake: int
    undecided: int


def count(graph: LineGraph, label: Int) -> GraphStatistics:
    """The lines and crossings of a graph, the latter also by label (E,)."""
    real, fake = int((label == REAL).sum()), int((label == FAKE).sum())
    return GraphStatistics(len(graph.segments), len(graph.edges), real, fake, len(graph.edges) - real - fake)
