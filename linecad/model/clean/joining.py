"""Lines that are one as one line: the records of lines and crossings with the pieces of each line joined."""

from dataclasses import replace

import numpy as np

from linecad.arrays import Float, Int
from linecad.geometry import segment_coordinates
from linecad.graph.connectivity import spanning_forest
from linecad.model.clean.ends import close_ends
from linecad.model.clean.strokes import Strokes, strokes_of
from linecad.scene import Intersections, Lines


def joined_strokes(strokes: Strokes, group: Int) -> Strokes:
    """One stroke for each group (N,) of strokes that lie on each other, from the first of its ends to the last."""
    count = int(group.max(initial=-1)) + 1
    first = np.unique(group, return_index=True)[1]
    low, high, weight = np.full(count, np.inf), np.full(count, -np.inf), np.zeros(count)
    np.minimum.at(low, group, strokes.reach[:, 0])
    np.maximum.at(high, group, strokes.reach[:, 1])
    np.add.at(weight, group, strokes.weight)
    return replace(
        strokes,
        axis=strokes.axis[first],
        component=strokes.component[first],
        weight=weight,
        offset=strokes.offset[first],
        number=strokes.number[first],
        reach=np.column_stack([low, high]),
    )


def joined_lines(lines: Lines, strokes: Strokes, row: Int) -> Lines:
    """The lines of M strokes, of which each of N lines became the one in its `row` (N,).

    What is no geometry a line has from its longest piece, and so the line in the photo that its segment lies on. It is
    a boundary where one of the pieces is, and known by a depth map alone where all are.
    """
    length = np.linalg.norm(lines.segment[:, 1] - lines.segment[:, 0], axis=1)
    order = np.lexsort((-length, row))
    lead = order[np.unique(row[order], return_index=True)[1]]
    pieces = np.split(np.argsort(row, kind="stable"), np.cumsum(np.bincount(row))[:-1]) if len(row) else []
    segment = lines.segment[lead].copy()
    for number, own in enumerate(pieces):
        if len(own) > 1:
            segment[number] = whole_segment(lines.segment[lead[number]], lines.segment[own])
    several = [lines.segment[own] if len(own) > 1 else np.zeros((0, 2, 2)) for own in pieces]
    return Lines(
        id=np.arange(len(lead)),
        axis=strokes.axis,
        segment=segment,
        ends=_ends(lines, lead, strokes),
        is_boundary=np.bincount(row, lines.is_boundary) > 0,
        component=strokes.component,
        confidence=lines.confidence[lead],
        probability=np.asarray(lines.probability)[lead] if len(lines.probability) else (),
        by_depth_map=np.bincount(row, ~np.asarray(lines.by_depth_map)) == 0,
        pieces=tuple(several),
    )


def with_pieces(lines: Lines, home: Int) -> Lines:
    """The lines, those of N that went into another, `home` (N,), among the pieces of that one."""
    pieces, segment = list(lines.pieces) or [np.zeros((0, 2, 2))] * len(lines), lines.segment.copy()
    for row in np.flatnonzero(home != np.arange(len(lines))).tolist():
        into = int(home[row])
        own = [pieces[each] if len(pieces[each]) else lines.segment[each : each + 1] for each in (into, row)]
        pieces[into] = np.concatenate(own)
        segment[into] = whole_segment(segment[into], pieces[into])
    return replace(lines, segment=segment, pieces=tuple(pieces))


def with_ends(lines: Lines, strokes: Strokes) -> Lines:
    """The lines with the ends of their strokes."""
    return replace(lines, ends=_ends(lines, strokes.rows, strokes))


def with_closed_ends(lines: Lines, forward: Float) -> Lines:
    """The lines with ends that nearly meet others moved to these; `forward` (3,) is where the camera looks."""
    return with_ends(lines, close_ends(strokes_of(lines, forward))[0])


def _ends(lines: Lines, rows: Int, strokes: Strokes) -> Float:
    """The ends (M, 2, 3) of M strokes in the order of the lines in `rows` (M,)."""
    along = lines.ends[rows[:, None], np.arange(2), lines.axis[rows, None]]
    ends = strokes.points(strokes.reach)
    backwards = along[:, 0] > along[:, 1]
    ends[backwards] = ends[backwards, ::-1]
    return ends


def whole_segment(lead: Float, pieces: Float) -> Float:
    """The segment (2, 2) on the line of `lead` (2, 2) that reaches as far as the pieces (K, 2, 2) along it."""
    place = segment_coordinates(pieces, lead)[0]
    length = float(np.linalg.norm(lead[1] - lead[0]))
    direction = (lead[1] - lead[0]) / max(length, np.finfo(float).tiny)
    whole = lead.copy()
    if place.min() < 0:
        whole[0] = lead[0] + place.min() * direction
    if place.max() > length:
        whole[1] = lead[0] + place.max() * direction
    return whole


def joined_crossings(crossings: Intersections, ids: Int, row: Int, count: int) -> Intersections:
    """The crossings of N lines with `ids` (N,) after each became the line of its `row` (N,), of `count` with ids 0 on.

    A crossing of two pieces of one line is none any more. Of several crossings of one pair, a real one stays, else the
    first; the tree is one again.
    """
    order = np.argsort(ids)
    lines = row[order[np.searchsorted(ids[order], crossings.lines)]].reshape(-1, 2)
    pair = np.sort(lines, axis=1) @ np.array([count, 1])
    best = np.lexsort((~crossings.in_tree, ~crossings.real, pair))
    kept = np.sort(best[np.unique(pair[best], return_index=True)[1]])
    kept = kept[lines[kept, 0] != lines[kept, 1]]
    tree = np.flatnonzero(crossings.in_tree[kept])
    in_tree = np.zeros(len(kept), bool)
    in_tree[tree[spanning_forest(count, lines[kept][tree])]] = True
    return Intersections(
        lines=lines[kept],
        kind=crossings.kind[kept],
        pixel=crossings.pixel[kept],
        real=crossings.real[kept],
        in_tree=in_tree,
        weight=crossings.weight[kept],
        reason=np.asarray(crossings.reason)[kept],
    )


def by_size(lines: Lines) -> Lines:
    """The lines with the components behind component 0 numbered by their size, which joining lines changed."""
    count = np.bincount(lines.component)
    number = np.zeros(len(count), np.int64)
    number[1 + np.argsort(-count[1:], kind="stable")] = np.arange(1, len(count))
    return replace(lines, component=number[lines.component])
