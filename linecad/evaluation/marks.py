"""Crossings that were labelled outside the line graph, by hand or by a survey, found again in it by their geometry."""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Float, Int
from linecad.evaluation.labels import UNDECIDED
from linecad.evaluation.overlap import find_overlaps
from linecad.geometry import PhotoLength
from linecad.line_graph import LineGraph
from linecad.scene import Camera

POINT_REACH = PhotoLength(20.0, floor=5.0)  # between a marked crossing and one of the graph
ACROSS = PhotoLength(6.0, floor=2.5)  # between a marked segment and one of the graph
ANGLE = np.radians(3.0)  # between the two
LEAST_OVERLAP = 0.5  # of the shorter of the two

UNKNOWN_AXIS = -1


@dataclass(frozen=True, eq=False)
class MarkedCrossings:
    """M labelled crossings, in pixels of the undistorted photo."""

    pixel: Float  # (M, 2) px
    segments: Float  # (M, 2, 2, 2) px, the ends of both segments
    axis: Int  # (M, 2) axis of each, UNKNOWN_AXIS where it is not known
    label: Int  # (M,) REAL, FAKE or UNDECIDED


def label_by_marks(marks: MarkedCrossings, graph: LineGraph, camera: Camera) -> Int:
    """The label of each crossing (E,) of a graph: that of the mark it is, UNDECIDED where there is none.

    A crossing is a marked one when their points are near, and each marked segment runs along one of its two segments
    over half of the shorter one and, where its axis is known, along that axis. Of several such crossings the nearest is
    taken. Marks that contradict each other on one crossing leave it undecided.
    """
    point_reach, across = POINT_REACH.px(camera.width), ACROSS.px(camera.width)
    label = np.full(len(graph.edges), UNDECIDED, np.int64)
    found: dict[int, set[int]] = {}
    for number in range(len(marks.pixel)):
        distance = np.linalg.norm(graph.crossing - marks.pixel[number], axis=1)
        near = np.flatnonzero(distance <= point_reach)
        for edge in near[np.argsort(distance[near], kind="stable")].tolist():
            if _is_same(marks, number, graph, edge, across):
                found.setdefault(edge, set()).add(int(marks.label[number]))
                break
    for edge, labels in found.items():
        label[edge] = labels.pop() if len(labels) == 1 else UNDECIDED
    return label


def _is_same(marks: MarkedCrossings, number: int, graph: LineGraph, edge: int, across: float) -> bool:
    """Whether the two segments of an edge are those of a mark, in either order."""
    i, j = graph.edges[edge].tolist()
    return any(
        all(
            _runs_along(marks.segments[number, side], graph.segments.ends[line], across)
            and marks.axis[number, side] in (UNKNOWN_AXIS, graph.axis[line])
            for side, line in enumerate(order)
        )
        for order in ((i, j), (j, i))
    )


def _runs_along(marked: Float, segment: Float, across: float) -> bool:
    found = find_overlaps(segment, marked[None], across, ANGLE)
    shorter = min(np.linalg.norm(marked[1] - marked[0]), np.linalg.norm(segment[1] - segment[0]))
    return bool((found.end - found.start).sum() >= LEAST_OVERLAP * shorter)
