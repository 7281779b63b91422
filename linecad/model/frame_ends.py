"""Ends closed at lines of other frames.

Two lines of different frames meet where a plane of each is one: level lines that are equally high, and an upright line
that stands in the plane of a level one. Where they would meet is a place on each, and the rest is as within a frame.
"""

from dataclasses import dataclass, fields, replace
from itertools import permutations

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.directions import UP, directions_of, level_axes, partner
from linecad.geometry import distances_to
from linecad.model.clean.ends import MEETS, NEAR, SEVERAL, Pairs, close_ends, ends_that_meet, short_of
from linecad.model.clean.joining import with_closed_ends, with_ends
from linecad.model.clean.sight import Sight
from linecad.model.clean.strokes import FREE, Strokes, pairs_within, strokes_of
from linecad.model.frames import FramedLines, sight_in

STEEPEST = 3.0  # times as far along a line as away from the other, that an end goes to meet it at a small angle
STANDS = 0.5  # of NEAR, between a line and one that stands on it at a small angle, and is not beside it


def with_ends_closed(framed: FramedLines, sight: Sight) -> FramedLines:
    """The lines with ends that nearly meet others, of whatever frame, moved along their lines to these."""
    if not framed.turns:
        return replace(framed, lines=with_closed_ends(framed.lines, sight.forward))
    return closed_across(framed, sight)


def closed_across(framed: FramedLines, sight: Sight) -> FramedLines:
    """The same where there are several frames; the lines as they are where there is one."""
    if not framed.turns:
        return framed
    strokes = strokes_in_frames(framed, sight)
    return replace(framed, lines=with_ends(framed.lines, close_ends(strokes, _across(framed, strokes))[0]))


def ends_that_meet_others(framed: FramedLines, sight: Sight) -> Bool:
    """Which ends (N, 2) meet a line of another frame."""
    if not framed.turns:
        return np.zeros((len(framed.lines), 2), bool)
    strokes = strokes_in_frames(framed, sight)
    own = np.arange(strokes.number.size).reshape(-1, 3)  # so that none meets another of its frame
    lone = replace(strokes, number=np.where(strokes.number == FREE, FREE, own))
    return ends_that_meet(lone, _across(framed, strokes))


@dataclass(frozen=True, eq=False)
class Misses:
    """Ends that nearly meet lines of another frame."""

    misses: Bool  # (N, 2) which ends do so, and meet no line
    hugs: Bool  # (N,) of lines with such an end, those that stand on a line and stay near it: no move closes them


def ends_that_miss_others(framed: FramedLines, sight: Sight) -> Misses:
    """Which ends meet no line, and nearly one of another frame."""
    misses, hugs = np.zeros((len(framed.lines), 2), bool), np.zeros(len(framed.lines), bool)
    if not framed.turns:
        return Misses(misses, hugs)
    lines = framed.in_world()
    limit = NEAR * np.abs(lines.ends @ sight.forward)
    strokes = strokes_in_frames(framed, sight)
    free = ~ends_that_meet(strokes, _across(framed, strokes))
    for row in np.flatnonzero(free.any(axis=1)).tolist():
        others = np.flatnonzero((framed.frame != framed.frame[row]) & (lines.component == lines.component[row]))
        others = others[lines.axis[others] != lines.axis[row]]
        away = distances_to(lines.ends[row], lines.ends[others]) / limit[row, :, None]  # (2, K)
        misses[row] = free[row] & (away <= 1).any(axis=1)
        hugs[row] = misses[row].any() and ((away <= 1).all(axis=0) & (away.min(axis=0) <= STANDS)).any()
    return Misses(misses, hugs)


def missed_pairs(framed: FramedLines, sight: Sight) -> Int:
    """Pairs (P, 2) of a line with an end that meets no line, and the line of another frame that it nearly meets."""
    if not framed.turns:
        return np.zeros((0, 2), np.int64)
    lines, strokes = framed.in_world(), strokes_in_frames(framed, sight)
    free = ~ends_that_meet(strokes, _across(framed, strokes))
    limit, along = NEAR * np.abs(lines.ends @ sight.forward), directions_of(framed.turns)[lines.axis]
    found = []
    for row in np.flatnonzero(free.any(axis=1)).tolist():
        others = np.flatnonzero((framed.frame != framed.frame[row]) & (lines.component == lines.component[row]))
        steep = np.linalg.norm(np.cross(along[row], along[others]), axis=1) * STEEPEST >= 1
        away = distances_to(lines.ends[row], lines.ends[others[steep]])
        near = free[row] & (away.min(axis=1, initial=np.inf) <= limit[row])
        found += [(row, int(others[steep][away[end].argmin()])) for end in np.flatnonzero(near).tolist()]
    return np.array(found, np.int64).reshape(-1, 2)


def strokes_in_frames(framed: FramedLines, sight: Sight) -> Strokes:
    """All lines, each in the axes of its frame; no number is one of two frames."""
    strokes = strokes_of(framed.lines, sight.forward)
    forward = np.array([sight_in(sight, frame, framed.turns).forward for frame in framed.frames])
    highest = int(strokes.number.max(initial=0)) + 1
    number = np.where(strokes.number == FREE, FREE, strokes.number + highest * framed.frame[:, None])
    return replace(strokes, forward=forward[framed.frame], number=number)


def _across(framed: FramedLines, strokes: Strokes) -> Pairs:
    """The pairs of lines of two frames that have a plane in common and would meet near an end of the first."""
    found = [_level(framed, strokes, *frames) for frames in permutations(framed.frames, 2)]
    found += [_upright(framed, strokes, *frames) for frames in permutations(framed.frames, 2)]
    pairs = found[0]
    for each in found[1:]:
        pairs = pairs.joined(each)
    line, other = pairs.line, pairs.other
    limit = NEAR * np.abs(strokes.end_depth).max(axis=1)[line]
    away = np.abs(pairs.place[:, None] - strokes.reach[line]).min(axis=1) * pairs.sine
    near = (away <= SEVERAL * limit) & (pairs.sine * STEEPEST >= 1)
    near &= (strokes.component[line] == strokes.component[other]) & (short_of(strokes, other, pairs.across) <= limit)
    return Pairs(*(getattr(pairs, each.name)[near] for each in fields(Pairs)))


def _level(framed: FramedLines, strokes: Strokes, frame: int, other_frame: int) -> Pairs:
    """Level lines of a frame and those of another that are equally high."""
    one, other = (rows[framed.lines.axis[rows] != UP] for rows in (framed.of(frame), framed.of(other_frame)))
    first, second = _equal(strokes, one, strokes.offset[one, UP], strokes.offset[other, UP])
    line, other = one[first], other[second]
    vectors = directions_of(framed.turns)
    axis, beside = framed.axis[line], framed.axis[other]
    along, normal, across, wall = (vectors[each] for each in (axis, partner(axis), beside, partner(beside)))
    own, there = (strokes.offset[rows, 1 - strokes.axis[rows]] for rows in (line, other))
    sine, cosine = ((along * wall).sum(axis=1), (normal * wall).sum(axis=1))
    place = (there - own * cosine) / sine
    beyond = (own - there * cosine) / (across * normal).sum(axis=1)
    return Pairs(line, other, place, beyond, np.abs(sine))


def _upright(framed: FramedLines, strokes: Strokes, frame: int, other_frame: int) -> Pairs:
    """Uprights of a frame and level lines of another in whose planes they stand, both ways round."""
    turns = framed.turns
    posts, beams = framed.of(frame), framed.of(other_frame)
    posts, beams = posts[framed.lines.axis[posts] == UP], beams[framed.lines.axis[beams] != UP]
    vectors = directions_of(turns)
    foot = strokes.offset[posts, :UP] @ vectors[list(level_axes(frame))] @ vectors[list(level_axes(other_frame))].T
    lines, others, places, beyond = [], [], [], []
    for axis in range(UP):
        own = beams[framed.lines.axis[beams] == axis]
        first, second = _equal(strokes, posts, foot[:, 1 - axis], strokes.offset[own, 1 - axis])
        post, beam = posts[first], own[second]
        at_post, at_beam = strokes.offset[beam, UP], foot[first, axis]
        lines += [post, beam]
        others += [beam, post]
        places += [at_post, at_beam]
        beyond += [at_beam, at_post]
    line, other, place, across = (np.concatenate(each) for each in (lines, others, places, beyond))
    return Pairs(line, other, place, across, np.ones(len(line)))


def _equal(strokes: Strokes, rows: Int, values: Float, others: Float) -> tuple[Int, Int]:
    """Pairs of places in `values` (M,) of the strokes `rows` (M,) and in `others` (K,) that rounding alone parts."""
    return pairs_within(values[:, None], others[:, None], MEETS * np.abs(strokes.depth[rows]))
