"""What each line is drawn for: the outline of walls, ground and roofs, the sides of an opening, or detail within them.

- opening: a side of a window or door, or of a hole in a face;
- outline: an edge of a face, or a line across most of it, such as eaves, a cornice or a plinth;
- detail: all others, such as courses and joints, bars and panes: a ladder of lines that are close together, the weaker
  of two that are almost one, and short lines that end in the air.
"""

from dataclasses import replace

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.graph.connectivity import group_numbers
from linecad.model.clean.bands import run_across
from linecad.model.clean.edges import Edges, drawn_to_corners, lie_on, ring_edges, sides_of
from linecad.model.clean.ends import close_ends, ends_that_meet, without_new_twins
from linecad.model.clean.joining import with_ends
from linecad.model.clean.rectangles import closed_rectangles
from linecad.model.clean.strokes import Strokes, parallel_pairs, strokes_of
from linecad.scene import DETAIL, OPENING, OUTLINE, Lines, Plane

DOUBLE = 0.0026  # of the depth; parallel lines that are nearer are a line and its double
OVERLAP = 0.5  # of the shorter of two lines that run beside each other
RUNG = 0.015  # of the depth, between two rungs of a ladder
LEAST_RUNGS = 6  # of a ladder
UNEVEN = 3.0  # ratio of the spaces on both sides of a rung

LEAST_FREE = 0.2  # of the depth; a shorter line with an end in the air is no outline


def with_roles(lines: Lines, planes: tuple[Plane, ...], forward: Float, openings: Float | None = None) -> Lines:
    """The lines with their roles, by the faces of planes, and outlines and openings drawn on to their corners.

    `forward` (3,) is the camera's z in the world. `openings` (W, 6) are rectangles in planes: the axis and the offset
    of the plane, and from where to where it reaches along the other two axes, the smaller axis first; None: those that
    lines close.
    """
    strokes = strokes_of(lines, forward)
    sides = sides_of(closed_rectangles(strokes) if openings is None else openings)
    holes = ring_edges([hole for plane in planes for face in plane.faces for hole in face.holes])
    outlines = ring_edges([face.outline for plane in planes for face in plane.faces])
    is_side = lie_on(strokes, sides)
    is_inner = _between_rungs(strokes) & ~is_side
    is_opening = (is_side | lie_on(strokes, holes)) & ~is_inner
    is_outline = (lie_on(strokes, outlines) | run_across(strokes, planes)) & ~is_inner & ~is_opening
    is_opening &= ~_doubles(strokes, is_opening)
    is_outline &= ~_doubles(strokes, is_outline | is_opening)
    free = ~ends_that_meet(strokes) & (is_outline | is_opening)[:, None]
    edges = Edges.joined([sides, holes, outlines])
    strokes = close_ends(without_new_twins(strokes, drawn_to_corners(strokes, edges, free)))[0]
    free = ~ends_that_meet(strokes)
    is_short = np.ptp(strokes.reach, axis=1) < LEAST_FREE * np.abs(strokes.depth)
    is_loose = free.all(axis=1) | (free.any(axis=1) & is_short)
    is_loose &= ~(lines.by_face & lie_on(strokes, edges))  # the edge of a face ends where the face does
    role = np.select([is_loose, is_opening, is_outline], [DETAIL, OPENING, OUTLINE], DETAIL)
    role[_doubles(strokes, role != DETAIL)] = DETAIL
    return replace(with_ends(lines, strokes), role=role)


def _beside(strokes: Strokes, share: float) -> tuple[Int, Int]:
    """Pairs of parallel strokes of one plane within a `share` of the depth that run beside each other."""
    first, second, _, overlap = parallel_pairs(strokes, share)
    length = np.ptp(strokes.reach, axis=1)
    beside = overlap > OVERLAP * np.minimum(length[first], length[second])
    return first[beside], second[beside]


def _between_rungs(strokes: Strokes) -> Bool:
    """Which strokes (N,) have a rung on both sides, about as far away, in a ladder of LEAST_RUNGS or more."""
    first, second = _beside(strokes, RUNG)
    inner = np.zeros(len(strokes.axis), bool)
    for normal in range(3):
        one = (strokes.number[first, normal] == strokes.number[second, normal]) & (strokes.axis[first] != normal)
        line, other = np.r_[first[one], second[one]], np.r_[second[one], first[one]]
        third = 3 - normal - strokes.axis[line]
        step = strokes.offset[other, third] - strokes.offset[line, third]
        above, below = np.full(len(inner), np.inf), np.full(len(inner), np.inf)
        np.minimum.at(above, line[step > 0], step[step > 0])
        np.minimum.at(below, line[step < 0], -step[step < 0])
        group = group_numbers(len(inner), np.column_stack([line, other]))
        is_ladder = np.bincount(group)[group] >= LEAST_RUNGS
        has_both = np.isfinite(above) & np.isfinite(below)
        even = np.maximum(above, below) <= UNEVEN * np.minimum(above, below)
        inner |= is_ladder & has_both & even
    return inner


def _doubles(strokes: Strokes, counts: Bool) -> Bool:
    """Which of the strokes that count (N,) run so near beside a longer one that counts that they are its double."""
    first, second = _beside(strokes, DOUBLE)
    both = counts[first] & counts[second]
    length = np.ptp(strokes.reach, axis=1)
    beside: dict[int, list[int]] = {}
    for one, other in zip(first[both].tolist(), second[both].tolist(), strict=True):
        beside.setdefault(one, []).append(other)
        beside.setdefault(other, []).append(one)
    double = np.zeros(len(length), bool)
    taken: set[int] = set()
    for line in sorted(beside, key=lambda each: (-length[each], each)):
        double[line] = not taken.isdisjoint(beside[line])
        if not double[line]:
            taken.add(line)
    return double
