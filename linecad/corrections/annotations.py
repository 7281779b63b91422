"""What corrections mean for a line graph: which of its crossings a person called real, fake or unsure."""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Int
from linecad.corrections.corrected import CorrectedLines, ToldFact
from linecad.corrections.edits import Label
from linecad.line_graph import LineGraph, Segments


@dataclass(frozen=True, eq=False)
class Annotations:
    """What a person noted about the E crossings of a line graph."""

    real: Bool  # (E,)
    fake: Bool  # (E,)
    label: tuple[Label | None, ...]  # E
    notes: tuple[str, ...]  # what names no crossing of this graph


def annotations_of(graph: LineGraph, corrected: CorrectedLines) -> Annotations:
    """What the labels say about the crossings of a line graph of these lines.

    Pieces that a split parted are two lines, so their collinear crossing is fake.
    """
    ids = corrected.ids[rows_of(graph.segments, corrected)]
    # By the ids of the two lines, the smaller first.
    edge = {(min(pair), max(pair)): number for number, pair in enumerate(ids[graph.edges].tolist())}
    real, fake = np.zeros(len(graph.edges), bool), np.zeros(len(graph.edges), bool)
    label: list[Label | None] = [None] * len(graph.edges)
    notes = []
    for one, other in corrected.parted:
        number = edge.get((min(one, other), max(one, other)))
        if number is not None:
            fake[number] = graph.kind[number] == "collinear"
    for pair, (pixel, word) in corrected.labels.items():
        number = edge.get(pair)
        if number is not None:
            label[number] = word
            real[number], fake[number] = word == "real", word == "fake"
        elif word == "real":
            notes.append(
                f"the crossing at ({pixel[0]:.0f}, {pixel[1]:.0f}) that was called real is not in the line graph; "
                "raise --option extension=PX"
            )
    return Annotations(real, fake, tuple(label), tuple(notes))


def facts_of(graph: LineGraph, corrected: CorrectedLines) -> tuple[tuple[ToldFact, ...], tuple[str, ...]]:
    """What a person says of the bodies of a graph's lines, by its nodes; and notes on lines that it has not."""
    ids = corrected.ids[rows_of(graph.segments, corrected)].tolist()
    node = {number: own for own, number in enumerate(ids)}
    told = [fact for each in corrected.all_facts if (fact := each.by(node))]
    missed = len(corrected.facts) - sum(not each.is_implied for each in told)
    note = (
        f"{missed} of {len(corrected.facts)} things that were said of bodies are left out: a line of theirs is too "
        "short or stands alone"
    )
    return tuple(told), (note,) * bool(missed)


def rows_of(segments: Segments, corrected: CorrectedLines) -> Int:
    """(M,) the row in `corrected` of each of M segments that were taken from there."""
    rows = corrected.segments.rows(segments)
    assert (rows >= 0).all()
    return rows


def as_found(graph: LineGraph, corrected: CorrectedLines | None) -> Segments:
    """What each line of a graph was before any edit; a line that was drawn is as it was drawn."""
    segments = graph.segments
    return segments if corrected is None else corrected.as_found.subset(rows_of(segments, corrected))


def by_hand(graph: LineGraph, corrected: CorrectedLines | None) -> Bool | None:
    """(N,) the lines of a graph that a person drew or told the length of; None without corrections."""
    if corrected is None:
        return None
    own = np.array([each == "drawn" for each in corrected.origin], bool) | np.isin(
        corrected.ids, list(corrected.lengths)
    )
    return own[rows_of(graph.segments, corrected)]
