"""The lines of each frame in the frame's own axes, where they are Manhattan lines, and back in the world.

What is known of three axes at right angles, from pieces of one line to the corners that they close, holds within one
frame. So the lines are taken frame by frame, each as if its frame were the only one, and an upright line with the frame
that most of its crossings are in.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from linecad.arrays import Float, Int, rows_of
from linecad.directions import UP, Turns, components, directions_of, frame_axes, frame_of
from linecad.geometry import depths_beside, world_rays
from linecad.model.clean.clean import Cleaned, clean_lines
from linecad.model.clean.joining import by_size, joined_crossings, with_pieces
from linecad.model.clean.sight import Sight
from linecad.model.frame_repeats import edges_repeated
from linecad.model.openings.find import FrameView
from linecad.model.planes import find_planes
from linecad.scene import Face, Intersections, Lines, Plane

ROUNDING = 1e-9  # of a coordinate, or of the scene's unit if that is more


@dataclass(frozen=True, eq=False)
class FramedLines:
    """N lines, each in the axes of its frame, where it runs along x, y or z."""

    lines: Lines  # N; of the main frame the world's axes
    frame: Int  # (N,) 0 is the main one
    turns: Turns

    def of(self, frame: int) -> Int:
        """Rows of the lines of a frame."""
        return np.flatnonzero(self.frame == frame)

    def of_rows(self, rows: Int) -> "FramedLines":
        """Some of the lines."""
        return FramedLines(rows_of(self.lines, rows), self.frame[rows], self.turns)

    @property
    def frames(self) -> range:
        """The numbers of all frames."""
        return range(len(self.turns) + 1)

    def each(self, change: Callable[[Lines, int], Lines]) -> "FramedLines":
        """The same with the lines of each frame as `change` makes them, of the lines and the number of the frame."""
        if not self.turns:
            return replace(self, lines=change(self.lines, 0))
        rows = [self.of(frame) for frame in self.frames if len(self.of(frame))]
        parts = [change(rows_of(self.lines, own), int(self.frame[own[0]])) for own in rows]
        order = np.argsort(np.concatenate(rows))
        return replace(self, lines=rows_of(together(parts), order))

    def in_world(self) -> Lines:
        """The lines in the world, along the directions of all frames."""
        if not self.turns:
            return self.lines
        return replace(self.lines, axis=self.axis, ends=_turned_back(self.lines.ends, self.frame, self.turns))

    def along(self, frame: int) -> Lines:
        """The lines that run along the axes of a frame, in these; uprights are those of all frames."""
        if not self.turns:
            return self.lines
        axes = frame_axes(frame)
        rows = np.flatnonzero(np.isin(self.axis, axes))
        ends = in_frame(_turned_back(self.lines.ends[rows], self.frame[rows], self.turns), frame, self.turns)
        own = self.frame[rows] == frame
        ends = np.where(own[:, None, None], self.lines.ends[rows], ends)
        return replace(rows_of(self.lines, rows), ends=ends)

    @property
    def axis(self) -> Int:
        """(N,) the direction of each line."""
        axes = np.array([frame_axes(frame) for frame in self.frames])
        return np.asarray(axes[self.frame, self.lines.axis])


def in_frame(points: Float, frame: int, turns: Turns) -> Float:
    """World points or directions (..., 3) in the axes of a frame."""
    if not frame:
        return points
    turned: Float = components(points, turns)[..., frame_axes(frame)]
    return turned


def sight_in(sight: Sight, frame: int, turns: Turns) -> Sight:
    """The same photo for lines in the axes of a frame."""
    return replace(sight, rotation=in_frame(sight.rotation, frame, turns)) if frame else sight


def planes_in(planes: tuple[Plane, ...], frame: int, turns: Turns) -> tuple[Plane, ...]:
    """The planes that a frame has, and the level ones, in its axes."""
    if not turns:
        return planes
    axes = frame_axes(frame)
    return tuple(
        replace(plane, axis=axes.index(plane.axis), faces=tuple(_turned(face, frame, turns) for face in plane.faces))
        for plane in planes
        if plane.axis in axes
    )


def frame_views(framed: FramedLines, planes: tuple[Plane, ...], rotation: Float) -> list[FrameView]:
    """Lines, planes and `rotation` (3, 3), world to camera, in the axes of each frame, the main one first."""
    turns = framed.turns
    return [
        FrameView(planes_in(planes, frame, turns), framed.along(frame), in_frame(rotation, frame, turns), frame)
        for frame in framed.frames
    ]


def in_frames(lines: Lines, offset: Float, home: Int, turns: Turns) -> FramedLines:
    """Lines in the axes of their frames `home` (N,); `offset` (N, K) are the components that lines share exactly."""
    if not turns:
        return FramedLines(lines, np.zeros(len(lines), np.int64), ())
    ends, axis = lines.ends.copy(), lines.axis.copy()
    for frame in range(1, len(turns) + 1):
        own = np.flatnonzero(home == frame)
        axes = frame_axes(frame)
        turned = in_frame(lines.ends[own], frame, turns)
        fixed = offset[own][:, None, axes]
        ends[own] = np.where(np.isnan(fixed), turned, fixed)
        level = own[lines.axis[own] != UP]
        axis[level] = lines.axis[level] - axes[0]
        along = axis[own]
        rows = np.arange(len(own))
        ends[own[:, None], np.arange(2), along[:, None]] = turned[rows[:, None], np.arange(2), along[:, None]]
    return FramedLines(replace(lines, axis=axis, ends=ends), home, turns)


def framed_lines(lines: Lines, crossings: Intersections, turns: Turns) -> FramedLines:
    """The lines of a scene in the axes of their frames; what is equal there but for rounding is equal.

    An upright line is of the frame in which most of its real `crossings` are, the first of equals.
    """
    home = frame_of(lines.axis)
    if not turns:
        return FramedLines(lines, home, ())
    real = np.searchsorted(lines.id, crossings.lines[crossings.real], sorter=np.argsort(lines.id))
    row = np.argsort(lines.id)[real]
    count = np.zeros((len(lines), len(turns) + 1), np.int64)
    for line, other in (row.T, row.T[::-1]):
        np.add.at(count, (line, home[other]), lines.axis[other] != UP)
    home = np.where(lines.axis == UP, count.argmax(axis=1), home)
    offset = components(lines.ends[:, 0], turns)
    for frame in range(1, len(turns) + 1):
        own = np.flatnonzero(home == frame)
        for axis in frame_axes(frame):
            offset[own, axis] = without_rounding(offset[own, axis])
    offset[np.arange(len(lines)), lines.axis] = np.nan
    return in_frames(lines, offset, home, turns)


def without_rounding(values: Float) -> Float:
    """The values (M,), those that rounding alone parts equal to the least of them."""
    order = np.argsort(values, kind="stable")
    ordered = values[order]
    first = np.diff(ordered, prepend=-np.inf) > ROUNDING * np.maximum(np.abs(ordered), 1.0)
    found = values.copy()
    found[order] = ordered[np.flatnonzero(first)[np.cumsum(first) - 1]]
    return found


def _turned_back(ends: Float, frame: Int, turns: Turns) -> Float:
    """Points (N, M, 3) in the axes of frames (N,), in the world."""
    found = ends.copy()
    vectors = directions_of(turns)
    for number in range(1, len(turns) + 1):
        own = frame == number
        found[own] = ends[own] @ vectors[frame_axes(number)]
    return found


def _turned(face: Face, frame: int, turns: Turns) -> Face:
    outline = in_frame(face.outline, frame, turns)
    holes, hidden = (tuple(in_frame(ring, frame, turns) for ring in rings) for rings in (face.holes, face.hidden))
    return replace(face, outline=outline, holes=holes, hidden=hidden)


def clean_frames(
    framed: FramedLines, crossings: Intersections, sight: Sight, width: float
) -> tuple[Cleaned, FramedLines]:
    """The lines joined and closed within each frame (`linecad.model.clean.clean`), and the crossings of all.

    What repeats an edge of another frame goes into it, unless a person spoke of it. Components are numbered by the size
    that they have then; the photo is `width` px wide.
    """
    if not framed.turns:
        cleaned = clean_lines(framed.lines, crossings, sight)
        main = np.zeros(len(cleaned.lines), np.int64)
        return cleaned, FramedLines(by_size(cleaned.lines), main, ())
    parts, frames, row, count = [], [], np.zeros(len(framed.lines), np.int64), 0
    highest = 0
    for frame in framed.frames:
        own = framed.of(frame)
        if len(own) == 0:
            continue
        lines = rows_of(framed.lines, own)
        inside = np.isin(crossings.lines, lines.id).all(axis=1)
        part = clean_lines(lines, rows_of(crossings, np.flatnonzero(inside)), sight_in(sight, frame, framed.turns))
        row[own] = part.row + count
        shared = np.where(part.shared >= 0, part.shared + highest, part.shared)
        highest = int(shared.max(initial=highest)) + 1
        ids = np.arange(count, count + len(part.lines))
        parts.append(replace(part, shared=shared, lines=replace(part.lines, id=ids)))
        frames.append(np.full(len(part.lines), frame))
        count += len(part.lines)
    every = FramedLines(together([part.lines for part in parts]), np.concatenate(frames), framed.turns)
    spare = np.ones(count, bool)
    spare[row[np.isin(framed.lines.id, crossings.lines[np.asarray(crossings.reason) == "annotated"])]] = False
    home = edges_repeated(every.in_world(), every.frame, sight.forward, width, spare)
    kept = np.flatnonzero(home == np.arange(count))
    row = np.searchsorted(kept, home[row])
    lines = replace(rows_of(with_repeats(every, home, sight), kept), id=np.arange(len(kept)))
    shared, depth, reach = (
        np.concatenate([getattr(part, name) for part in parts])[kept] for name in ("shared", "depth", "reach")
    )
    cleaned = Cleaned(
        lines=lines,
        intersections=joined_crossings(crossings, framed.lines.id, row, len(kept)),
        row=row,
        shared=shared,
        moved=max(part.moved for part in parts),
        depth=depth,
        reach=reach,
    )
    return cleaned, FramedLines(by_size(lines), every.frame[kept], framed.turns)


def with_repeats(framed: FramedLines, home: Int, sight: Sight) -> Lines:
    """The lines (N) with those that went into another, `home` (N,), among its pieces; it reaches as far as they do.

    How far is told by the photo, since a piece of another frame has another direction in space. Where a line runs away
    from the camera a pixel may be any length: it grows at either end by no more than its own.
    """
    lines = with_pieces(framed.lines, home)
    ends = lines.ends.copy()
    for row in np.flatnonzero(home != np.arange(len(lines))).tolist():
        into = int(home[row])
        axis, rotation = lines.axis[into], sight_in(sight, int(framed.frame[into]), framed.turns).rotation
        rays = world_rays(framed.lines.segment[row], sight.matrix, rotation)
        depth = depths_beside(rays, ends[into, :1].repeat(2, axis=0), axis.repeat(2))
        order = np.argsort(ends[into, :, axis])
        low, high = ends[into, order, axis]
        place = (rays[:, axis] * depth)[depth > 0]
        place = place[np.abs(place - (low + high) / 2) <= 1.5 * (high - low)]
        ends[into, order, axis] = min(low, place.min(initial=low)), max(high, place.max(initial=high))
    return replace(lines, ends=ends)


def planes_of(framed: FramedLines, shared: Int) -> tuple[Plane, ...]:
    """The planes of all frames, of lines with offsets numbered by `shared` (N, 3) in their frames' axes."""
    found: list[Plane] = []
    for frame in framed.frames:
        own = framed.of(frame)
        lines = framed.lines
        planes = find_planes(lines.ends[own, 0], shared[own], lines.id[own])
        found += [replace(plane, axis=frame_axes(frame)[plane.axis]) for plane in planes]
    if framed.turns:
        found.sort(key=lambda plane: (-len(plane.lines), plane.lines[0], plane.axis))
    return tuple(replace(plane, id=number) for number, plane in enumerate(found))


def together(parts: list[Lines]) -> Lines:
    """The lines of several records, which tell the same of each."""
    values: dict[str, Any] = {}
    for each in fields(Lines):
        found = [getattr(part, each.name) for part in parts]
        is_tuple = isinstance(found[0], tuple)
        values[each.name] = tuple(one for part in found for one in part) if is_tuple else np.concatenate(found)
    return Lines(**values)
