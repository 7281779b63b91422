"""What a person fixed: annotations of crossings, which every answer keeps to."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from linecad.corrections.annotations import Annotations, annotations_of, rows_of
from linecad.corrections.corrected import CorrectedLines
from linecad.corrections.words import said
from linecad.errors import ContradictionError
from linecad.line_graph import LineGraph, Solution
from solver.options import OnProgress, SolveOptions
from solver.solve import solve

SURE_FACTOR = 2.0  # by which the tolerance of a crossing grows that a person called real
WIDEST_TOLERANCE = float(np.log(100.0))  # of a crossing that a person called real, in log depth


def annotate(graph: LineGraph, corrected: CorrectedLines | None) -> tuple[LineGraph, Annotations]:
    """The annotations of a graph of corrected lines, and the graph that believes them; none without corrections.

    Every crossing that a person called real tells about depth, if little, and its tolerance is wider: a person is not
    wrong because a segment is off by a little more than its noise.
    """
    if corrected is None:
        none = np.zeros(len(graph.edges), bool)
        return graph, Annotations(none, none, (None,) * len(graph.edges), ())
    annotations = annotations_of(graph, corrected)
    taken = annotations.real & graph.possible
    wider = np.minimum(SURE_FACTOR * graph.tolerance, WIDEST_TOLERANCE)
    tolerance = np.where(taken, wider, graph.tolerance)
    return replace(graph, tolerance=tolerance, informative=graph.informative | taken), annotations


def solve_annotated(
    graph: LineGraph,
    options: SolveOptions,
    annotations: Annotations,
    corrected: CorrectedLines | None,
    on_progress: OnProgress,
) -> Solution:
    """The solution that keeps to the annotations; ContradictionError, by places in the photo, where none can."""
    with told_in_the_photo(graph, corrected):
        return solve(graph, with_annotations(options, annotations), on_progress)


def with_annotations(options: SolveOptions, annotations: Annotations) -> SolveOptions:
    """The options that keep to the annotations."""
    real, fake = (tuple(np.flatnonzero(flags).tolist()) for flags in (annotations.real, annotations.fake))
    return replace(options, real=real, fake=fake)


@contextmanager
def told_in_the_photo(graph: LineGraph, corrected: CorrectedLines | None) -> Iterator[None]:
    """Where annotations contradict each other, name them by their places in the photo."""
    try:
        yield
    except ContradictionError as error:
        if corrected is None:
            raise
        raise _in_the_photo(error, graph, corrected) from None


def _in_the_photo(error: ContradictionError, graph: LineGraph, corrected: CorrectedLines) -> ContradictionError:
    """The same contradiction told by places in the photo, with the ids of the lines."""
    ids = corrected.ids[rows_of(graph.segments, corrected)]
    edge = {pair: number for number, pair in enumerate(map(tuple, graph.edges.tolist()))}
    places = [graph.crossing[edge[pair]].round().astype(int).tolist() for pair in error.crossings]
    where = ", ".join(f"({x}, {y})" for x, y in places)
    text = f"the crossings at {where} cannot all be real: no depths fit them; take one of them back"
    facts = [told.fact for told in corrected.facts if told.fact in error.facts]
    if facts:
        what = ", ".join(f'"{said(fact)}"' for fact in facts) + (f" and the crossings at {where}" if where else "")
        text = f"{what} cannot all hold: no places fit them; take one of them back"
    return ContradictionError(
        text,
        tuple(int(ids[line]) for line in error.lines),
        tuple((int(min(ids[i], ids[j])), int(max(ids[i], ids[j]))) for i, j in error.crossings),
        tuple(facts),
    )
