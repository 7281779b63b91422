"""What a line becomes that a person draws or stretches: its axis, and what its ends snap to.

Snapping moves an end and never the line: an end takes the place of another line's end, or slides along its own line to
where that crosses another one (docs/decisions/0107).
"""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Float
from linecad.corrections.drawing import Drawing
from linecad.corrections.lookup import LineTable
from linecad.errors import CorrectionError
from linecad.geometry import PhotoLength, segment_coordinates

FLUSH = PhotoLength(4.0, floor=2.0)  # from two ends to the line along an axis that is said to join them
BENT = float(np.radians(4.0))  # a line that was drawn farther off its axis is not turned there unasked
LONGEST_REACH = PhotoLength(60.0, floor=20.0)  # however small the photo is on the screen


@dataclass(frozen=True, eq=False)
class Snap:
    """Where an end snaps to."""

    point: Float  # (2,) px
    line: int  # id of the line that is there
    is_end: bool  # its end; else a place on it


Snaps = tuple[Snap | None, Snap | None]


@dataclass(frozen=True, eq=False)
class Proposal:
    """What a drawn or stretched line would be."""

    ends: Float  # (2, 2) px
    axis: int
    snaps: Snaps  # of each end
    off: float  # rad, between what was drawn and the axis

    @property
    def is_bent(self) -> bool:
        """Whether it is another line than the one that was drawn, so that a person is to say what is meant."""
        return self.off > BENT


def find_snap(point: Float, lines: LineTable, reach: float) -> Snap | None:
    """What a point (2,) px snaps to within `reach` px: the nearest end of a line, else the nearest place on one."""
    if len(lines.ids) == 0:
        return None
    away = np.linalg.norm(lines.ends - point, axis=2)
    row, end = np.unravel_index(int(away.argmin()), away.shape)
    if away[row, end] <= reach:
        return Snap(lines.ends[row, end], int(lines.ids[row]), True)
    place, _ = segment_coordinates(point, lines.ends)
    along = lines.ends[:, 1] - lines.ends[:, 0]
    length = np.linalg.norm(along, axis=1)
    feet = lines.ends[:, 0] + (np.clip(place, 0, length) / length)[:, None] * along
    distance = np.linalg.norm(feet - point, axis=1)
    nearest = int(distance.argmin())
    return Snap(feet[nearest], int(lines.ids[nearest]), False) if distance[nearest] <= reach else None


def propose(drawing: Drawing, lines: LineTable, drawn: Float, axis: int | None, reach: float) -> Proposal:
    """What a line drawn from one end to the other (2, 2) px would be, along an axis or else the nearest one.

    Ends snap to `lines` within `reach` px. CorrectionError for a line that is too short.
    """
    if np.linalg.norm(drawn[1] - drawn[0]) < 1:
        raise CorrectionError("a line has two ends; draw it longer")
    off = drawing.off_axes(drawn)
    own = int(off.argmin()) if axis is None else axis
    at_ends = [snap if snap and snap.is_end else None for snap in (find_snap(end, lines, reach) for end in drawn)]
    target = np.array([end if snap is None else snap.point for end, snap in zip(drawn, at_ends, strict=True)])
    held = _held(drawing, drawn, target, at_ends, own)
    point = target.mean(axis=0) if len(held) != 1 else target[held[0]]
    ends = drawing.through(point, target if len(held) == 2 else _with(drawn, held, target), own, *held[:1])
    snaps: list[Snap | None] = [at_ends[end] if end in held else None for end in range(2)]
    for end in {0, 1} - set(held):
        snaps[end] = _crossed(ends, end, lines, reach)
    reached = np.array([ends[end] if end in held or snap is None else snap.point for end, snap in enumerate(snaps)])
    turn = float(off[own])  # `through` has refused an axis that the photo has not
    return Proposal(drawing.long_enough(reached), own, (snaps[0], snaps[1]), turn)


def stretch(drawing: Drawing, lines: LineTable, number: int, end: int, at: Float, reach: float) -> Proposal:
    """What the line of an id is when one of its ends is dragged to a point (2,) px: the other end and its line stay.

    CorrectionError where it would be too short, or its ends would change places.
    """
    own = lines.ids == number
    ends, axis = lines.ends[own][0], int(lines.axis[own][0])
    along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    moved = ends.copy()
    moved[end] = ends[0] + float((at - ends[0]) @ along) * along
    others = LineTable(lines.ids[~own], lines.ends[~own], lines.axis[~own])
    snap = _crossed(moved, end, others, reach, ends)
    if snap is not None:
        moved[end] = snap.point
    if (moved[1] - moved[0]) @ along < drawing.shortest:
        raise CorrectionError(f"the line would be shorter than {drawing.shortest:.0f} px, too short to be one")
    snaps: list[Snap | None] = [None, None]
    snaps[end] = snap
    return Proposal(moved, axis, (snaps[0], snaps[1]), 0.0)


def _held(drawing: Drawing, drawn: Float, target: Float, snaps: list[Snap | None], axis: int) -> list[int]:
    """The ends that snap to ends of other lines: both only where a line along the axis joins these."""
    held = [end for end, snap in enumerate(snaps) if snap is not None]
    if len(held) < 2:
        return held
    joined = drawing.through(target.mean(axis=0), target, axis)
    if np.linalg.norm(target[1] - target[0]) >= 1 and _off(joined, target) <= FLUSH.px(drawing.width):
        return held
    return [int(np.linalg.norm(target - drawn, axis=1).argmin())]


def _off(ends: Float, points: Float) -> float:
    """px, how far points (N, 2) lie beside a segment's line at most."""
    return float(np.abs(segment_coordinates(points, ends)[1]).max())


def _with(drawn: Float, held: list[int], target: Float) -> Float:
    """The drawn ends (2, 2), those that are held at their targets."""
    ends = drawn.copy()
    ends[held] = target[held]
    return ends


def _crossed(ends: Float, end: int, lines: LineTable, reach: float, line: Float | None = None) -> Snap | None:
    """Where the line of `ends` crosses another segment nearest to one end of it, within `reach` px.

    A segment whose end is within `reach` of the place is crossed there too, however slanted it is. `line` tells the
    direction, where the ends may have met.
    """
    if len(lines.ids) == 0:
        return None
    base = ends if line is None else line
    place, beside = segment_coordinates(lines.ends, base)  # (N, 2)
    turn = beside[:, 1] - beside[:, 0]
    length = np.linalg.norm(lines.ends[:, 1] - lines.ends[:, 0], axis=1)
    steep = np.abs(turn) > 0.05 * length
    share = np.where(steep, -beside[:, 0] / np.where(steep, turn, 1.0), 0.0)
    margin = reach / np.maximum(length, 1e-9)
    there = steep & (share >= -margin) & (share <= 1 + margin)
    at = place[:, 0] + share * (place[:, 1] - place[:, 0])
    own = float(segment_coordinates(ends[end], base)[0])
    away = np.where(there, np.abs(at - own), np.inf)
    nearest = int(away.argmin())
    if away[nearest] > reach:
        return None
    along = (base[1] - base[0]) / np.linalg.norm(base[1] - base[0])
    return Snap(base[0] + at[nearest] * along, int(lines.ids[nearest]), False)
