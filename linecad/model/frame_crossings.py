"""Crossings of lines of different frames made exact, by moving planes a little.

Cleaning makes exact what meets within a frame. Level lines of two frames meet where they are equally high, and an
upright line meets a level one of any frame where it stands in that one's plane: linear conditions on the offsets of
planes. Of all offsets that meet them those are taken that move the least.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import coo_array, csr_array, vstack

from linecad.arrays import Bool, Float, Int
from linecad.directions import UP, Turns, directions_of, level_axes
from linecad.graph.connectivity import group_numbers
from linecad.model.clean.clean import Cleaned
from linecad.model.clean.joining import with_ends
from linecad.model.clean.offsets import Offsets, offsets_of, with_offsets
from linecad.model.clean.sight import Sight
from linecad.model.clean.strokes import FREE, Strokes, strokes_of
from linecad.model.frame_ends import closed_across, missed_pairs, strokes_in_frames
from linecad.model.frames import FramedLines, clean_frames, sight_in, without_rounding
from linecad.model.least_moves import FARTHEST, PlaneOffsets, least_moves, missed_share
from linecad.scene import Intersections, Lines, Scene

HOLDS = 1e-11  # of the depth; rounding of several
APART = 1e-9  # of the depth, from which crossings are told to be inexact
PARALLEL = 1e-6  # sine; the pieces of one line have no crossing


@dataclass(frozen=True, eq=False)
class _Planes:
    """The offsets of all frames, C of them, numbered through."""

    number: Int  # (N, 3) of each line's offsets in its frame; FREE along its axis
    offsets: PlaneOffsets


def clean_and_cross(
    framed: FramedLines, crossings: Intersections, sight: Sight, width: float
) -> tuple[Cleaned, FramedLines]:
    """The lines cleaned within each frame, with exact crossings and closed ends across all; the photo's `width` in px.

    Crossings are made exact before, so that cleaning finds what they make one, and again after it moved planes: then
    ends that nearly meet a line of another frame meet it too, where that asks no more.
    """
    before = framed
    cleaned, framed = clean_frames(with_exact_crossings(framed, crossings, sight), crossings, sight, width)
    framed = closed_across(with_exact_crossings(framed, cleaned.intersections, sight), sight)
    missed = missed_pairs(framed, sight)
    framed = with_exact_crossings(framed, cleaned.intersections, sight, missed)
    if framed.turns:  # planes that met one of another frame are one
        moved = _moved(before, framed, cleaned.row, sight)
        cleaned = replace(cleaned, shared=strokes_in_frames(framed, sight).number, moved=moved)
    return cleaned, closed_across(framed, sight)


def _moved(before: FramedLines, after: FramedLines, row: Int, sight: Sight) -> float:
    """By which share of its depth the line moved that moved furthest, of lines that became those in their `row` (N,).

    What went into a line of another frame is left out.
    """
    old, new = (strokes_in_frames(each, sight) for each in (before, after))
    same = before.frame == after.frame[row]
    share = np.linalg.norm(new.offset[row] - old.offset, axis=1)[same] / np.abs(old.depth[same])
    return float(share.max(initial=0.0))


def with_exact_crossings(
    framed: FramedLines, crossings: Intersections, sight: Sight, missed: Int | None = None
) -> FramedLines:
    """The lines, whose ids are their rows, with real crossings of two frames exact where no plane moves far for it.

    Pairs of rows that `missed` (P, 2) meet too, where no crossing has to go for it.
    """
    if not framed.turns:
        return framed
    frames = [frame for frame in framed.frames if len(framed.of(frame))]
    strokes = {frame: _strokes(framed, frame, sight) for frame in frames}
    offsets = {frame: offsets_of(strokes[frame]) for frame in frames}
    planes, first = _planes(framed, strokes, offsets)
    pairs = crossings.lines[crossings.real]
    pairs = pairs[framed.frame[pairs[:, 0]] != framed.frame[pairs[:, 1]]]
    conditions = _conditions(framed, planes, pairs)
    moves = _moves(conditions, planes.offsets, np.ones(conditions.shape[0], bool))
    met = planes.offsets.moved(moves)
    if missed is not None and len(missed):
        parts = [_exact(conditions, met), _conditions(framed, planes, missed)]
        firm = np.repeat([True, False], [part.shape[0] for part in parts])
        met = met.moved(_moves(csr_array(vstack(parts)), met, firm))

    def moved(lines: Lines, frame: int) -> Lines:
        old, start = offsets[frame], first[frame]
        own = met.value[start : start + len(old.value)].copy()
        for axis in range(3):
            own[old.axis == axis] = without_rounding(own[old.axis == axis])
        new = Offsets(old.axis, old.start, old.weight, old.nearest, old.lead, own)
        return with_ends(lines, with_offsets(strokes[frame], old, new))

    return framed.each(moved)


def inexact_crossings(scene: Scene) -> str:
    """How many real crossings of two frames stayed apart, and how far, for people; "" where none did."""
    lines, crossings, vectors = scene.lines, scene.intersections, directions_of(scene.turns)
    order = np.argsort(lines.id)
    first, second = order[np.searchsorted(lines.id[order], crossings.lines[crossings.real])].T
    across = np.cross(vectors[lines.axis[first]], vectors[lines.axis[second]])
    length = np.linalg.norm(across, axis=1)
    apart = np.abs(((lines.ends[first, 0] - lines.ends[second, 0]) * across).sum(axis=1))
    meets = length > PARALLEL
    depth = np.abs(lines.ends[first].mean(axis=1) @ scene.rotation[2])
    share = apart[meets] / (length * depth)[meets]
    count = int((share > APART).sum())
    if not count:
        return ""
    return (
        f"{count} of {len(first)} real crossings join lines of two frames that stay apart in space, by at most "
        f"{share.max():.1%} of the depth: planes move by at most {FARTHEST:.1%} for them, before and after cleaning"
    )


def _strokes(framed: FramedLines, frame: int, sight: Sight) -> Strokes:
    lines = framed.of_rows(framed.of(frame)).lines
    return strokes_of(lines, sight_in(sight, frame, framed.turns).forward)


def _planes(
    framed: FramedLines, strokes: dict[int, Strokes], offsets: dict[int, Offsets]
) -> tuple[_Planes, dict[int, int]]:
    """The offsets of all frames, and the number of the first of each frame."""
    number, first, count = np.full((len(framed.lines), 3), FREE), {}, 0
    for frame, own in strokes.items():
        first[frame] = count
        number[framed.of(frame)] = np.where(own.number != FREE, own.number + count, FREE)
        count += len(offsets[frame].value)
    parts = offsets.values()
    value, nearest, weight = (
        np.concatenate([getattr(part, name) for part in parts]) for name in ("value", "nearest", "weight")
    )
    return _Planes(number, PlaneOffsets(value, nearest, weight)), first


def _conditions(framed: FramedLines, planes: _Planes, pairs: Int) -> csr_array:
    """Rows (R, C) whose products with the offsets must be 0 for pairs (P, 2) of lines to meet."""
    rows: list[tuple[Int, Float]] = []
    for pair in pairs.tolist():
        upright = [line for line in pair if framed.lines.axis[line] == UP]
        level = [line for line in pair if framed.lines.axis[line] != UP]
        if not upright:
            rows.append((planes.number[level, UP], np.array([1.0, -1.0])))
        elif level:
            rows.append(_in_plane(framed, planes, upright[0], level[0]))
    count = [len(numbers) for numbers, _ in rows]
    row = np.repeat(np.arange(len(rows)), count)
    column = np.concatenate([np.zeros(0, np.int64), *(numbers for numbers, _ in rows)])
    factor = np.concatenate([np.zeros(0), *(factors for _, factors in rows)])
    return csr_array(coo_array((factor, (row, column)), (len(rows), len(planes.offsets.value))))


def _in_plane(framed: FramedLines, planes: _Planes, upright: int, level: int) -> tuple[Int, Float]:
    """The condition that an upright line stands in the upright plane of a level line of another frame."""
    normal = 1 - int(framed.lines.axis[level])  # in the frame of the level line
    along = _level_vectors(int(framed.frame[upright]), framed.turns)
    factors = along @ _level_vectors(int(framed.frame[level]), framed.turns)[normal]
    numbers = np.array([*planes.number[upright, :UP], planes.number[level, normal]])
    return numbers, np.array([*factors, -1.0])


def _level_vectors(frame: int, turns: Turns) -> Float:
    """(2, 3) the level axes of a frame in the world."""
    vectors: Float = directions_of(turns)[list(level_axes(frame))]
    return vectors


def _exact(conditions: csr_array, offsets: PlaneOffsets) -> csr_array:
    """Those of the conditions (R, C) that hold."""
    return conditions[np.flatnonzero(missed_share(conditions, offsets) <= HOLDS)]


def _moves(conditions: csr_array, offsets: PlaneOffsets, firm: Bool) -> Float:
    """The least moves (C,) with which all conditions (R, C) hold that no plane has to move FARTHEST for.

    Those that are not `firm` (R,) hold where no other has to go for it.
    """
    moves = np.zeros(conditions.shape[1])
    kept = np.flatnonzero(missed_share(conditions, offsets) <= FARTHEST)
    row, column = conditions[kept].nonzero()
    group = group_numbers(len(kept) + len(moves), np.column_stack([row, len(kept) + column]))[: len(kept)]
    for number in np.unique(group).tolist():
        rows = kept[group == number]
        own = conditions[rows]
        columns = np.unique(own.nonzero()[1])
        moves[columns] = least_moves(own[:, columns].toarray(), offsets.subset(columns), firm[rows])
    return moves
