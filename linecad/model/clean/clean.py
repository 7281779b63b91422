"""One line for the pieces and the near duplicates of a line, and ends that meet what they nearly meet.

Detection gives one edge of a building in pieces, and often twice. Where image and space agree that lines are one, they
become one; where lines of one plane nearly meet, they are drawn to the corner or to the line. Nothing is bent: a line
stays parallel to its axis, all lines of a plane move together, and real crossings meet in space to the last digit.
"""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.graph.connectivity import group_numbers
from linecad.model.clean.ends import NEAR, close_ends, missed_offsets
from linecad.model.clean.gaps import continued
from linecad.model.clean.joining import joined_crossings, joined_lines, joined_strokes
from linecad.model.clean.offsets import join_offsets, offsets_of, with_offsets
from linecad.model.clean.sight import Sight
from linecad.model.clean.strokes import SAME, Strokes, parallel_pairs, strokes_of
from linecad.scene import Intersections, Lines

FARTHEST = 0.002  # of the depth, by which an offset may move in all to become one with others
MOST_ROUNDS = 6  # a line that became longer may meet more; two or three are usual


@dataclass(frozen=True, eq=False)
class Cleaned:
    """Lines and crossings as a draughtsman has them."""

    lines: Lines  # M
    intersections: Intersections
    row: Int  # (N,) row of the line that each of the N lines became
    shared: Int  # (M, 3) numbers of the offsets, as `linecad.model.planes` takes them
    moved: float  # by which share of its depth the line that moved furthest did, across its direction
    depth: Float  # (M, 2) of both ends
    reach: Float  # (M, 2) from where to where the pieces of each line reached along it before any end was moved

    def note(self, kept: Bool, before: Lines, after: Lines) -> str:
        """What became of the lines, those `kept` (M,) of them, for people; "" where nothing did.

        These are the first of the lines `before` and `after` their ends were moved a second time: what they took in
        from others between is no end that was moved.
        """
        joined = len(self.row) - len(self.lines)
        count = int(kept.sum())
        moved = _along(self.lines)[kept] - self.reach[kept] + _along(after)[:count] - _along(before)[:count]
        ends = np.abs(moved) / self.depth[kept]
        parts = []
        if joined:
            parts.append(f"{joined} lines that continue or repeat others were joined to them")
        if self.moved:
            parts.append(
                f"planes that were nearly one became one, which moved lines by up to {self.moved:.2%} of their depth"
            )
        if ends.max(initial=0) > self.moved:
            far = int((ends > NEAR).sum())
            parts.append(
                f"ends were moved along their lines to where these stop, {far} of {ends.size} by more than "
                f"{NEAR:.0%}, at most by {ends.max():.1%}"
            )
        return "; ".join(parts)


def _along(lines: Lines) -> Float:
    """From where to where (M, 2) lines reach along their axes."""
    rows = np.arange(len(lines))[:, None]
    reach: Float = np.sort(lines.ends[rows, np.arange(2), lines.axis[:, None]], axis=1)
    return reach


def clean_lines(lines: Lines, crossings: Intersections, sight: Sight) -> Cleaned:
    """The lines joined and closed, and the crossings between those that are left.

    Lines that a person said are two stay two. Ids are new, from 0 on, in the order of the old ones.
    """
    before = strokes = strokes_of(lines, sight.forward)
    offsets = offsets_of(strokes)
    two, pieces = _kept_apart(lines, crossings), continued(strokes, sight)
    row = np.arange(len(lines))
    for _ in range(MOST_ROUNDS):
        lead = offsets.lead
        first, second = _alike(strokes, row[two], row[pieces])
        at, normal = np.nonzero(strokes.number[first] != strokes.number[second])
        same = np.column_stack([strokes.number[first[at], normal], strokes.number[second[at], normal]])
        old, offsets = offsets, join_offsets(offsets, strokes, same, FARTHEST)
        strokes = with_offsets(strokes, old, offsets)
        first, second = _alike(strokes, row[two], row[pieces])
        are_one = (strokes.number[first] == strokes.number[second]).all(axis=1)
        group = group_numbers(len(strokes.axis), np.column_stack([first[are_one], second[are_one]]))
        strokes, row = joined_strokes(strokes, group), group[row]
        strokes, meets = close_ends(strokes)
        old, offsets = offsets, join_offsets(offsets, strokes, missed_offsets(strokes, meets), FARTHEST)
        strokes = with_offsets(strokes, old, offsets)
        if not are_one.any() and np.array_equal(lead, offsets.lead):
            break
    moved = np.linalg.norm(strokes.offset[row] - before.offset, axis=1) / np.abs(before.depth)
    return Cleaned(
        lines=joined_lines(lines, strokes, row),
        intersections=joined_crossings(crossings, lines.id, row, len(strokes.axis)),
        row=row,
        shared=strokes.number,
        moved=float(moved.max(initial=0.0)),
        reach=joined_strokes(before, row).reach,
        depth=np.abs(strokes.end_depth),
    )


def _kept_apart(lines: Lines, crossings: Intersections) -> Int:
    """Pairs (P, 2) of rows of lines on one image line that a person said are two."""
    said = (crossings.kind == "collinear") & (np.asarray(crossings.reason) == "annotated") & ~crossings.real
    order = np.argsort(lines.id)
    return np.asarray(order[np.searchsorted(lines.id[order], crossings.lines[said])]).reshape(-1, 2)


def _alike(strokes: Strokes, two: Int, pieces: Int) -> tuple[Int, Int]:
    """Pairs of parallel strokes that are nearly one, nearest first, but for the pairs `two` (P, 2).

    Those that overlap or have a gap below NEAR come before those of `pieces` (Q, 2), which go on to each other.
    """
    first, second, apart, overlap = parallel_pairs(strokes, SAME)
    depth, count = np.abs(strokes.depth), len(strokes.axis)
    number, kept, gone_on = (np.sort(each) @ [count, 1] for each in (np.column_stack([first, second]), two, pieces))
    near = overlap >= -NEAR * np.minimum(depth[first], depth[second])
    alike = (near | np.isin(number, gone_on)) & ~np.isin(number, kept)
    order = np.flatnonzero(alike)[np.lexsort((apart[alike], ~near[alike]))]
    return first[order], second[order]
