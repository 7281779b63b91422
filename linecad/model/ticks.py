"""Ticks: stubs of detail that stand on a line and end nowhere, which a draughtsman does not draw.

Detection breaks off an edge that grows faint, and what is left of it may be shorter than the distance by which an end
misses a line: then its free end is near the line that it stands on, and nothing can close it.
"""

from dataclasses import replace

import numpy as np

from linecad.arrays import Bool, Float, Int, rows_of
from linecad.confidence import with_lines
from linecad.graph.connectivity import spanning_forest
from linecad.model.clean.ends import NEAR, ends_that_meet, ends_that_miss, nearest_crossings
from linecad.model.clean.joining import by_size
from linecad.model.clean.settling import at_outlines, outlines_of
from linecad.model.clean.sight import Sight
from linecad.model.clean.strokes import Strokes, strokes_of
from linecad.model.frame_ends import (
    ends_that_meet_others,
    ends_that_miss_others,
    strokes_in_frames,
    with_ends_closed,
)
from linecad.model.frames import FramedLines, in_frame, sight_in
from linecad.scene import DETAIL, Lines, Scene

LONGEST = 2 * NEAR  # of the depth; whatever its one end meets, the other end of a longer line is no near miss of it
LEAST_FREE = 0.2  # of the depth; a shorter line that only a face placed is none where both of its ends are in the air
LONGEST_BEFORE = 0.05  # of the depth; a shorter detail that ends just before or behind a line is not worth its gap
MOST_ROUNDS = 6  # lines that ended on a tick end elsewhere, and may be ticks by then


def without_ticks(scene: Scene, framed: FramedLines, sight: Sight) -> tuple[Scene, FramedLines]:
    """The scene without its ticks, by their ids as before, and with the ends closed that met nothing but them.

    Lines stay that a person said something about, and that alone connect others. Planes go that only ticks showed and
    no opening is in, and components that were nothing else, but for component 0. `framed` are the lines of the scene,
    row by row: what they meet and miss is looked for among those of their frame.
    """
    outlines = outlines_of(scene.planes)
    found = scene
    for _ in range(MOST_ROUNDS):
        ticks = _spare(found, _ticks(found, framed, outlines, sight))
        if not ticks.any():
            break
        found = with_lines(found, ~ticks)
        framed = with_ends_closed(framed.of_rows(np.flatnonzero(~ticks)), sight)
        found = replace(found, lines=framed.in_world())
    if len(found.lines) == len(scene.lines):
        return scene, framed
    shown = {plane.id for plane in scene.planes if not plane.lines} | {each.plane for each in scene.openings}
    planes = tuple(plane for plane in found.planes if plane.lines or plane.faces or plane.id in shown)
    crossings = replace(found.intersections, in_tree=_spanning(found, ~found.intersections.in_tree))
    lines = by_size(found.lines)
    found = replace(found, lines=lines, intersections=crossings, planes=planes)
    return found, replace(framed, lines=replace(framed.lines, component=lines.component))


def _spare(scene: Scene, ticks: Bool) -> Bool:
    """Of `ticks` (N,) those without which all others are connected as before, and component 0 has lines."""
    row = np.searchsorted(scene.lines.id, scene.intersections.lines)
    hang = _spanning(scene, ticks[row].sum(axis=1))
    spare = ticks & (np.bincount(row[hang].ravel(), minlength=len(ticks)) <= 1)
    main = scene.lines.component == 0
    return np.asarray(spare & (~main | (main & ~spare).any()))


def _spanning(scene: Scene, cost: Bool | Int) -> Bool:
    """Which crossings (E,) span all that real ones connect, those of the least `cost` (E,) first."""
    crossings = scene.intersections
    real = np.flatnonzero(crossings.real)
    real = real[np.argsort(cost[real], kind="stable")]
    row = np.searchsorted(scene.lines.id, crossings.lines[real])
    tree = np.zeros(len(crossings), bool)
    tree[real[spanning_forest(len(scene.lines), row)]] = True
    return tree


def _ticks(scene: Scene, framed: FramedLines, outlines: Float, sight: Sight) -> Bool:
    """Which lines (N,) are ticks, by the edges (E, 2, 3) of faces."""
    crossings = scene.intersections
    said = np.unique(crossings.lines[np.asarray(crossings.reason) == "annotated"])
    ticks, others = np.zeros(len(framed.lines), bool), ends_that_meet_others(framed, sight)
    missed = ends_that_miss_others(framed, sight)
    for frame in framed.frames:
        rows, seen = framed.of(frame), sight_in(sight, frame, scene.turns)
        there = in_frame(outlines, frame, scene.turns)
        ticks[rows] = _ticks_among(rows_of(framed.lines, rows), others[rows], there, seen)
    length = np.linalg.norm(np.diff(framed.lines.ends, axis=1)[:, 0], axis=1)
    spare = np.asarray(framed.lines.by_face) | (
        length < LONGEST_BEFORE * np.abs(strokes_in_frames(framed, sight).depth)
    )
    ticks |= ((missed.misses.any(axis=1) & spare) | missed.hugs) & (framed.lines.role == DETAIL)
    return ticks & ~np.isin(scene.lines.id, said)


def _ticks_among(lines: Lines, others: Bool, outlines: Float, sight: Sight) -> Bool:
    """Which lines (N,) of one frame are ticks, all in its axes; the ends `others` (N, 2) meet lines of others."""
    strokes = strokes_of(lines, sight.forward)
    meets = ends_that_meet(strokes) | others
    ticks: Bool = (np.ptp(strokes.reach, axis=1) < LONGEST * np.abs(strokes.depth)) & ~meets.all(axis=1)
    ticks &= (lines.role == DETAIL) | np.asarray(lines.by_face)  # without its short edges a face is as it was
    ends_well = meets[ticks] | (at_outlines(strokes.of(ticks), outlines, sight) & ~_misses(strokes, ticks))
    ticks[ticks] = ~ends_well.all(axis=1)
    return ticks | _hanging(lines, strokes, meets, outlines, sight) | _before_others(lines, strokes, meets)


def _hanging(lines: Lines, strokes: Strokes, meets: Bool, outlines: Float, sight: Sight) -> Bool:
    """Which details (N,) that only a face placed nearly meet a line, or are short and meet nothing."""
    own: Bool = np.asarray(lines.by_face) & (lines.role == DETAIL)
    ends_well = meets[own] | at_outlines(strokes.of(own), outlines, sight)
    is_short = np.ptp(strokes.reach[own], axis=1) < LEAST_FREE * np.abs(strokes.depth[own])
    hangs = np.zeros(len(lines), bool)
    hangs[own] = ends_that_miss(strokes, meets)[own].any(axis=1) | (is_short & ~ends_well.any(axis=1))
    return hangs


def _before_others(lines: Lines, strokes: Strokes, meets: Bool) -> Bool:
    """Which short details (N,) end before or behind a line of a parallel plane, where no move of an end closes them."""
    is_short: Bool = np.ptp(strokes.reach, axis=1) < LONGEST_BEFORE * np.abs(strokes.depth)
    return is_short & (lines.role == DETAIL) & ends_that_miss(strokes, meets).any(axis=1)


def _misses(strokes: Strokes, chosen: Bool) -> Bool:
    """Which ends (K, 2) of the masked lines (N,) are beyond a line that they cross, and near it."""
    line, end = np.nonzero(np.repeat(chosen[:, None], 2, axis=1))
    over = nearest_crossings(strokes, line, end)[1].reshape(-1, 2)
    misses: Bool = over <= NEAR * np.abs(strokes.end_depth[chosen])
    return misses
