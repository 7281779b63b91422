"""Openings made regular: sides at lines, rows and columns in line, equal ones equal."""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.model.openings.walls import NONE, UP, Rods, Wall
from linecad.scene import Lines, Opening, OpeningKind, Plane

POINTS = 2.5  # columns or rows of the raster within which a line is a side
ALONGSIDE = 0.3  # of a side that a line must show to be it
FLUSH = 0.003  # of the wall's distance: what is further off stands elsewhere than the photo shows it on the wall
SAME = 0.06  # of a side, by which sizes and places differ that are taken to be the same
FOOT = 0.2  # of its height: a door's foot is no higher above the ground, nor below it
TALL = 1.5  # height over width of a door, at least
LOWEST = 1.0  # per cent of the level lines that are below a wall's foot


@dataclass(frozen=True, eq=False)
class Seen:
    """Openings of one wall as the raster has them."""

    box: Float  # (N, 4) u0, u1, v0, v1
    step: Float  # (N, 2) how far apart columns and rows are there
    is_completed: Bool  # (N,)


def make_regular(wall: Wall, lines: Lines, seen: Seen, first: int, ground: float | None) -> list[Opening]:
    """The openings of a wall; ids count from `first`, shapes too. Doors stand on the `ground`, at that height.

    Where no ground is known, the lowest line of the wall stands for it.

    Each is put in the plane that the wall around it is in. A side is at its line's own coordinate where a line shows
    it, before openings of a row or column are put in line and those of about one size get the same size.
    """
    home = np.array([_home(wall, box) for box in seen.box], np.int64)
    openings: list[Opening] = []
    for number in np.unique(home).tolist():
        own = home == number
        plane = wall.planes[number]
        # The camera is at the origin, so that planes differ by a factor for whoever looks along the rays.
        ratio = plane.offset / wall.plane.offset
        pairs = zip(seen.box[own], seen.step[own], strict=True)
        found = np.array([_at_lines(wall, plane, lines, box, step) for box, step in pairs])
        placed = Seen(found, seen.step[own] * ratio, seen.is_completed[own])
        openings += _in_line(wall, plane, placed, first + len(openings), ground)
    return openings


def _home(wall: Wall, box: Float) -> int:
    """The place of the plane of most lines around an opening, those of the opening itself left out."""
    size = np.array([box[1] - box[0], box[3] - box[2]])
    shown = np.zeros(len(wall.planes))
    for rods, across, along in ((wall.upright, 0, 1), (wall.level, 1, 0)):
        at, span = box[2 * across : 2 * across + 2], box[2 * along : 2 * along + 2]
        near = (rods.at > at[0] - size[across]) & (rods.at < at[1] + size[across]) & (rods.plane != NONE)
        length = _shared(rods.ends, span[0] - size[along], span[1] + size[along])
        beside = (rods.at < at[0] - rods.reach) | (rods.at > at[1] + rods.reach)
        length -= np.where(beside, 0.0, _shared(rods.ends, span[0], span[1]))
        np.add.at(shown, rods.plane[near], length[near])
    return int(shown.argmax())


def _shared(ends: Float, start: float, end: float) -> Float:
    """Length (M,) that stretches (M, 2) share with the one from start to end."""
    shared: Float = (np.minimum(ends[:, 1], end) - np.maximum(ends[:, 0], start)).clip(min=0)
    return shared


def _in_line(wall: Wall, plane: Plane, seen: Seen, first: int, ground: float | None) -> list[Opening]:
    """Openings of one plane of a wall, in rows, columns and sizes."""
    box = seen.box
    own = np.column_stack([box[:, 0], box[:, 2], box[:, 1] - box[:, 0], box[:, 3] - box[:, 2]])
    alike = np.column_stack([_alike(own[:, k], seen.step[:, k % 2], own[:, 2 + k % 2]) for k in range(4)])
    left, low, wide, tall = _still_apart(own, alike).T
    foot = ground
    if foot is None:
        foot = float(np.percentile(wall.level.at, LOWEST)) * plane.offset / wall.plane.offset
    sizes: dict[tuple[float, float], int] = {}
    openings = []
    for row in range(len(box)):
        size = (float(wide[row]), float(tall[row]))
        is_door = low[row] < 0 and abs(low[row] - foot) <= FOOT * size[1] and size[1] >= TALL * size[0]
        kind: OpeningKind = "door" if is_door else "window"
        openings.append(
            Opening(
                id=first + row,
                plane=plane.id,
                u0=float(left[row]),
                u1=float(left[row]) + size[0],
                v0=float(low[row]),
                v1=float(low[row]) + size[1],
                kind=kind,
                is_completed=bool(seen.is_completed[row]),
                shape=first + sizes.setdefault(size, len(sizes)),
            )
        )
    return openings


def _still_apart(own: Float, alike: Float) -> Float:
    """Openings (N, 4) made alike, but for those that meet so where they were apart: these keep what is their own.

    Each has left and low side, width and height.
    """
    apart, kept = _gaps(own) > 0, np.zeros((len(own), 2), bool)
    while True:
        found = np.where(np.tile(kept, 2), own, alike)
        # What they were apart in is taken back, along u or v, and may make them meet others.
        meets = (_gaps(found) <= 0).all(axis=0) & apart
        more = kept | meets.any(axis=2).T
        if (more == kept).all():
            return np.asarray(found)
        kept = more


def _gaps(flat: Float) -> Float:
    """How far apart (2, N, N) rectangles (N, 4) are along u and v, 0 and less where they meet."""
    start, end = flat[:, :2].T, (flat[:, :2] + flat[:, 2:]).T
    return np.asarray(np.maximum(start[:, None] - end[:, :, None], start[:, :, None] - end[:, None]))


def _at_lines(wall: Wall, plane: Plane, lines: Lines, box: Float, step: Float) -> Float:
    """A box (4,) of the wall in a plane of it, with sides at lines of the plane where there are some."""
    found: Float = box * (plane.offset / wall.plane.offset)
    limit = np.repeat([found[1] - found[0], found[3] - found[2]], 2) / 4
    for side in range(4):
        rods, span = (wall.upright, box[2:]) if side < 2 else (wall.level, box[:2])
        line = _line_at(rods, float(box[side]), span, POINTS * float(step[side // 2]))
        if line is None:
            continue
        away = abs(lines.ends[line, 0, plane.axis] / plane.offset - 1)
        place = lines.ends[line, 0, 1 - plane.axis if side < 2 else UP]
        if away <= FLUSH and abs(place - found[side]) <= limit[side]:
            found[side] = place
    return found


def _line_at(rods: Rods, place: float, span: Float, reach: float) -> int | None:
    """The row of the line that shows most of a side from span[0] to span[1]; None where none shows enough."""
    shared = _shared(rods.ends, float(span[0]), float(span[1]))
    shared = np.where(np.abs(rods.at - place) <= np.maximum(rods.reach, reach), shared, 0.0)
    best = int(shared.argmax())
    return int(rods.row[best]) if shared[best] >= ALONGSIDE * (span[1] - span[0]) else None


def _alike(value: Float, step: Float, size: Float) -> Float:
    """Values (N,) of which those that hardly differ are the same: the middle one of their group."""
    found = value.copy()
    order: Int = np.argsort(value, kind="stable")
    group: list[int] = []
    for index in [*order.tolist(), -1]:
        if group:
            reach = max(SAME * float(size[group].min()), POINTS * float(step[group].min()))
            if index < 0 or value[index] - value[group[0]] > reach:
                found[group] = value[group[len(group) // 2]]
                group = []
        group.append(index)
    return found
