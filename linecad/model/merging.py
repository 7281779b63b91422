"""Pieces of one line that were drawn on to each other, made one line of a scene."""

from dataclasses import replace

import numpy as np

from linecad.arrays import Bool, Int
from linecad.confidence import with_lines
from linecad.directions import UP
from linecad.graph.connectivity import group_numbers
from linecad.model.clean.ends import MEETS, NEAR
from linecad.model.clean.joining import by_size, joined_crossings, with_ends, with_pieces
from linecad.model.clean.sight import Sight
from linecad.model.clean.strokes import Strokes, pairs_within
from linecad.model.frame_ends import strokes_in_frames
from linecad.model.frame_repeats import edges_repeated
from linecad.model.frames import FramedLines
from linecad.scene import Lines, Scene


def with_merged_lines(scene: Scene, framed: FramedLines, sight: Sight) -> tuple[Scene, FramedLines]:
    """The scene with one line for those that are one to the last digit and overlap, or have a gap of less than NEAR.

    `framed` are its lines, row by row, and come back so. Of each such group the longest in the photo stays, by its id,
    and reaches as far as all do; lines stay as they are of which a person said that they are two. What faces placed
    along an edge of another frame goes into that.
    """
    strokes = strokes_in_frames(framed, sight)
    strokes = replace(strokes, number=_uprights_as_one(framed, strokes))
    home = _homes(strokes, _said_two(scene))
    reach = strokes.reach.copy()
    np.minimum.at(reach[:, 0], home, strokes.reach[:, 0])
    np.maximum.at(reach[:, 1], home, strokes.reach[:, 1])
    lone = np.bincount(home, minlength=len(home))[home] == 1
    by_face = lone & np.asarray(scene.lines.by_face)
    home = home[edges_repeated(scene.lines, framed.frame, sight.forward, scene.camera.width, by_face)]
    kept = home == strokes.rows
    if kept.all():
        return scene, framed
    lines = _told_by_all(with_ends(framed.lines, replace(strokes, reach=reach)), home)
    crossings = joined_crossings(scene.intersections, lines.id, home, len(home))
    crossings = replace(crossings, lines=lines.id[crossings.lines])
    framed = replace(framed, lines=lines)
    found = with_lines(replace(scene, lines=framed.in_world(), intersections=crossings), kept)
    framed = framed.of_rows(np.flatnonzero(kept))
    framed = replace(framed, lines=by_size(framed.lines))
    return replace(found, lines=framed.in_world()), framed


def _uprights_as_one(framed: FramedLines, strokes: Strokes) -> Int:
    """The numbers (N, 3) of the offsets, the same for uprights of different frames that rounding alone parts."""
    if not framed.turns:
        return strokes.number
    number, upright = strokes.number.copy(), np.flatnonzero(strokes.axis == UP)
    foot = framed.in_world().ends[upright, 0, :UP]
    near = MEETS * np.abs(strokes.depth[upright])
    first, second = pairs_within(foot, foot, near)
    same = (np.abs(foot[first] - foot[second]) <= near[first, None]).all(axis=1)
    group = group_numbers(len(upright), np.column_stack([first[same], second[same]]))
    number[upright, :UP] = int(number.max(initial=0)) + 1 + group[:, None]
    return number


def _said_two(scene: Scene) -> Bool:
    """Which lines (N,) lie on one image line with another of which a person said that they are two."""
    crossings = scene.intersections
    two = (crossings.kind == "collinear") & (np.asarray(crossings.reason) == "annotated") & ~crossings.real
    return np.asarray(np.isin(scene.lines.id, crossings.lines[two]))


def _homes(strokes: Strokes, stays: Bool) -> Int:
    """The row (N,) of the line that each goes into, its own for most; lines that stay (N,) are in no group."""
    own = np.where(stays, 1 + strokes.rows, 0)
    keys = np.column_stack([strokes.axis, strokes.component, own, strokes.number])
    order = np.lexsort((strokes.reach[:, 0], *keys.T))
    home, depth = strokes.rows.copy(), np.abs(strokes.depth)
    group: list[int] = []
    for row in [*order.tolist(), None]:
        if group and row is not None and (keys[row] == keys[group[0]]).all():
            high = strokes.reach[group, 1].max()
            if strokes.reach[row, 0] - high <= NEAR * min(depth[row], depth[group].min()):
                group.append(row)
                continue
        if len(group) > 1:
            home[group] = max(group, key=lambda each: (strokes.weight[each], -each))
        group = [] if row is None else [row]
    return home


def _told_by_all(lines: Lines, home: Int) -> Lines:
    """The lines with what their pieces tell: a boundary is one, and a face or a depth map alone placed what all say."""
    count = len(lines)
    by_face, by_map = (np.bincount(home, ~np.asarray(each), count) == 0 for each in (lines.by_face, lines.by_depth_map))
    is_boundary = np.bincount(home, lines.is_boundary, count) > 0
    lines = with_pieces(lines, home)
    return replace(lines, is_boundary=is_boundary, by_face=by_face, by_depth_map=by_map)
