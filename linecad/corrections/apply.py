"""Corrections applied to the lines that were found: each named line is looked up again by its geometry.

What cannot be found again is told in a note and left out. Every line has an id that stays the same while edits are
added or taken back: found lines are numbered in their order, new ones follow in the order of the edits.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import product
from typing import Literal, assert_never

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.corrections.edits import (
    Anchor,
    Corrections,
    Delete,
    Draw,
    Edit,
    Join,
    KnownLength,
    Label,
    LabelCrossing,
    Point,
    SetAxis,
    SetFrame,
    Split,
)
from linecad.errors import CorrectionError
from linecad.geometry import REFERENCE_WIDTH, angles_to, directions_to, vanishing_points
from linecad.line_graph import LineGraph, ManhattanFrame, Segments
from linecad.scene import AXES, Camera

ACROSS = 6.0  # px at the reference width between a line as it was named and as it is found again
ACROSS_FLOOR = 2.5  # px
LEAST_OVERLAP = 0.5  # of the shorter of the two
JOIN_ACROSS = 20.0  # px at the reference width between two pieces of one line
JOIN_ACROSS_FLOOR = 6.0  # px
SNAP = 24.0  # px at the reference width between the end of a drawn line and one that is there
SNAP_FLOOR = 8.0  # px
SHORTEST_PIECE = 25.0  # px at the reference width; shorter lines take no part in the line graph
SHORTEST_PIECE_FLOOR = 10.0  # px
SAME_LINE = 0.5  # px between the ends of two lines that are one
MOST_NOTES = 5  # about single corrections; the rest is counted
FIRST_IDS = 100_000  # ids for the lines of one frame; those found with the next one are other lines

Origin = Literal["found", "drawn", "split", "joined"]


@dataclass(frozen=True, eq=False)
class CorrectedLines:
    """The lines of a photo after all edits."""

    segments: Segments  # N
    ids: Int  # (N,) stable numbers
    origin: tuple[Origin, ...]  # N
    labels: dict[tuple[int, int], tuple[Point, Label]]  # by the ids of two lines, the smaller first
    lengths: dict[int, float]  # m, by id
    parted: tuple[tuple[int, int], ...]  # ids of pieces that a split parted
    notes: tuple[str, ...]  # what could not be found again

    def is_like(self, other: "CorrectedLines") -> bool:
        """Whether the lines are the same, whatever is said about them."""
        return bool(
            np.array_equal(self.ids, other.ids)
            and np.array_equal(self.segments.axis, other.segments.axis)
            and np.array_equal(self.segments.ends, other.segments.ends)
        )


@dataclass(frozen=True, eq=False)
class Said:
    """What a person said about the E crossings of a line graph."""

    real: Bool  # (E,)
    fake: Bool  # (E,)
    label: tuple[Label | None, ...]  # E
    notes: tuple[str, ...]  # what names no crossing of this graph


def correct(segments: Segments, camera: Camera, frame: ManhattanFrame, corrections: Corrections) -> CorrectedLines:
    """The lines after all edits; `frame` must be that of `corrections.frame`, if there is one."""
    lines, notes = correcting_of(segments, camera, frame, corrections)
    return lines.result(notes)


def correcting_of(
    segments: Segments, camera: Camera, frame: ManhattanFrame, corrections: Corrections
) -> tuple["Correcting", tuple[str, ...]]:
    """The same, for more edits to come, and the notes on edits that could not be applied."""
    frames = [number for number, edit in enumerate(corrections.edits) if isinstance(edit, SetFrame)]
    lines = Correcting(segments, camera, frame, first_id=FIRST_IDS * len(frames))
    notes = []
    for number, edit in enumerate(corrections.edits):
        try:
            lines.apply(edit, before_frame=bool(frames) and number < frames[-1])
        except CorrectionError as error:
            notes.append(f"correction {number + 1} is left out: {error}")
    if len(notes) > MOST_NOTES:
        notes[MOST_NOTES:] = [f"{len(notes) - MOST_NOTES} more corrections name lines that are not there any more"]
    return lines, tuple(notes)


@dataclass
class _Line:
    ends: Float  # (2, 2) px
    axis: int
    origin: Origin


@dataclass
class _Table:
    """The lines as arrays, for looking them up; made anew when a line changes."""

    ids: Int
    ends: Float
    axis: Int
    exact: dict[tuple[int, bytes], int] = field(default_factory=dict)


class Correcting:
    """Lines that edits are applied to, one after another."""

    def __init__(self, segments: Segments, camera: Camera, frame: ManhattanFrame, first_id: int = 0) -> None:
        self.scale = camera.width / REFERENCE_WIDTH
        self.vanishing = vanishing_points(camera.matrix, frame.rotation)
        self.lines: dict[int, _Line] = {
            first_id + number: _Line(ends, axis, "found")
            for number, (ends, axis) in enumerate(zip(segments.ends, segments.axis.tolist(), strict=True))
        }
        self.next_id = first_id + len(segments)
        self.became: dict[int, tuple[int, ...]] = {}  # lines that were split or joined, and their successors
        self.labels: dict[tuple[int, int], tuple[Point, Label]] = {}
        self.lengths: dict[int, float] = {}
        self.parted: list[tuple[int, int]] = []
        self._table: _Table | None = None

    def apply(self, edit: Edit, before_frame: bool = False) -> None:
        """Apply one edit; CorrectionError, and nothing changes, where that cannot be done.

        `before_frame`: the frame was given anew later, so the axes that this edit names meant others.
        """
        match edit:
            case LabelCrossing():
                first, second = (self.find(anchor, before_frame) for anchor in edit.lines)
                if first == second:
                    raise CorrectionError("both lines of a crossing are one line now")
                self._label((min(first, second), max(first, second)), edit.pixel, edit.label)
            case SetAxis():
                if not before_frame:
                    number = self.find(edit.line, before_frame)
                    line = self.lines[number]
                    turned = _Line(self.turned(line.ends, edit.axis), edit.axis, line.origin)
                    if edit.axis != line.axis:
                        self._check_new(turned)
                        self._put(number, turned)
            case Delete():
                self._drop(self.find(edit.line, before_frame), ())
            case Split():
                self._split(self.find(edit.line, before_frame), edit.at)
            case Join():
                self._join(self.find(edit.lines[0], before_frame), self.find(edit.lines[1], before_frame))
            case Draw():
                ends = np.array(edit.line.ends)
                axis = self.nearest_axis(ends) if before_frame else edit.line.axis
                drawn = _Line(self.long_enough(self.turned(ends, axis)), axis, "drawn")
                self._check_new(drawn)
                self._add(drawn)
            case KnownLength():
                number = self.find(edit.line, before_frame)
                self.lengths.pop(number, None)
                if edit.metres is not None:
                    self.lengths[number] = edit.metres
            case SetFrame():
                pass  # the lines were found with it
            case _:
                assert_never(edit)

    def result(self, notes: tuple[str, ...] = ()) -> CorrectedLines:
        """The lines as they are now."""
        lines = list(self.lines.values())
        ends = np.array([line.ends for line in lines]).reshape(-1, 2, 2)
        return CorrectedLines(
            segments=Segments(ends, np.array([line.axis for line in lines], np.int64)),
            ids=np.array(list(self.lines), np.int64),
            origin=tuple(line.origin for line in lines),
            labels=self._final_labels(),
            lengths={own: metres for number, metres in self.lengths.items() for own in self._now(number)[:1]},
            parted=tuple((a, b) for one, other in self.parted for a, b in product(self._now(one), self._now(other))),
            notes=notes,
        )

    def anchor(self, number: int) -> Anchor:
        """What a line looks like now; CorrectionError when there is none with this id."""
        if number not in self.lines:
            raise CorrectionError(f"there is no line {number} any more; reload the page")
        line = self.lines[number]
        (a, b), (c, d) = line.ends.tolist()
        return Anchor(((a, b), (c, d)), line.axis)

    def find(self, anchor: Anchor, any_axis: bool = False) -> int:
        """The id of the line that an anchor names; CorrectionError when there is none.

        The line itself if it is there to the last digit; else the one that runs along it best.
        """
        table = self._lookup()
        ends = np.array(anchor.ends)
        exact = table.exact.get((anchor.axis, ends.tobytes()))
        if exact is not None:
            return exact
        share = _shared(ends, table.ends, max(ACROSS * self.scale, ACROSS_FLOOR))
        own = np.where(table.axis == anchor.axis, share, 0.0)
        if any_axis and not own.any():
            own = share
        if not own.any():
            (a, b), (c, d) = anchor.ends
            raise CorrectionError(
                f"no line runs from ({a:.0f}, {b:.0f}) to ({c:.0f}, {d:.0f}) along {AXES[anchor.axis]} any more"
            )
        return int(table.ids[own.argmax()])

    def turned(self, ends: Float, axis: int) -> Float:
        """A segment (2, 2) turned about its middle to pass through the vanishing point of an axis."""
        return self.through(ends.mean(axis=0), ends, axis)

    def through(self, point: Float, ends: Float, axis: int) -> Float:
        """The segment (2, 2) on the line from a point (2,) to a vanishing point that reaches as far as `ends` do."""
        along = directions_to(point, self.vanishing[axis])
        span = ends[1] - ends[0]
        length = float(np.linalg.norm(span))
        if along @ span < 0:
            along = -along
        # What is turned far keeps its length; what is turned little keeps the feet of its ends.
        reach = (ends - point) @ along
        if reach[1] - reach[0] < length / 2:
            reach = np.array([-length / 2, length / 2])
        moved: Float = point + reach[:, None] * along
        return moved

    def nearest_axis(self, ends: Float) -> int:
        """The axis whose vanishing point a segment (2, 2) points to best."""
        return int(angles_to(ends[None], self.vanishing)[:, 0].argmin())

    def snapped(self, ends: Float, axis: int | None) -> tuple[Float, int, tuple[bool, bool]]:
        """What a line drawn from one end to the other (2, 2) would be: ends, axis, and which ends snap to others."""
        if np.linalg.norm(ends[1] - ends[0]) < 1:
            raise CorrectionError("a line has two ends; draw it longer")
        own = self.nearest_axis(ends) if axis is None else axis
        there = self._lookup().ends.reshape(-1, 2)
        near = []
        for end in ends:
            distance = np.linalg.norm(there - end, axis=1)
            found = len(there) > 0 and bool(distance.min() <= max(SNAP * self.scale, SNAP_FLOOR))
            near.append(there[distance.argmin()] if found else None)
        held = [point for point in near if point is not None]
        target = np.array([end if point is None else point for end, point in zip(ends, near, strict=True)])
        through = held[0] if len(held) == 1 else target.mean(axis=0)
        result = self.long_enough(self.through(through, target, own))
        return result, own, (near[0] is not None, near[1] is not None)

    def long_enough(self, ends: Float) -> Float:
        """The same segment; CorrectionError when it is too short to be a line."""
        least, length = self.shortest, float(np.linalg.norm(ends[1] - ends[0]))
        if length < least:
            raise CorrectionError(f"a line of {length:.0f} px is too short; at least {least:.0f} px are needed")
        return ends

    @property
    def shortest(self) -> float:
        """Px below which a segment is no line of the graph."""
        return max(SHORTEST_PIECE * self.scale, SHORTEST_PIECE_FLOOR)

    def _lookup(self) -> _Table:
        if self._table is None:
            ids, lines = list(self.lines), list(self.lines.values())
            table = _Table(
                np.array(ids, np.int64),
                np.array([line.ends for line in lines]).reshape(-1, 2, 2),
                np.array([line.axis for line in lines], np.int64),
            )
            table.exact = {(line.axis, line.ends.tobytes()): number for number, line in zip(ids, lines, strict=True)}
            self._table = table
        return self._table

    def _label(self, pair: tuple[int, int], pixel: Point, label: Label | None) -> None:
        self.labels.pop(pair, None)
        if label is not None:
            self.labels[pair] = (pixel, label)

    def _put(self, number: int, line: _Line) -> None:
        self.lines[number] = line
        self._table = None

    def _check_new(self, line: _Line) -> None:
        table = self._lookup()
        off = np.minimum(*(np.abs(table.ends - ends).max(axis=(1, 2)) for ends in (line.ends, line.ends[::-1])))
        if ((off < SAME_LINE) & (table.axis == line.axis)).any():
            raise CorrectionError("this line is there already; draw another one")

    def _add(self, line: _Line) -> int:
        number = self.next_id
        self.next_id += 1
        self._put(number, line)
        return number

    def _drop(self, number: int, successors: tuple[int, ...]) -> None:
        del self.lines[number]
        self.became[number] = successors
        self._table = None

    def _split(self, number: int, at: Point) -> None:
        line = self.lines[number]
        along = line.ends[1] - line.ends[0]
        place = float((np.array(at) - line.ends[0]) @ along / (along @ along))
        length = float(np.linalg.norm(along))
        if min(place, 1 - place) * length < self.shortest:
            raise CorrectionError(
                f"a piece would be shorter than {self.shortest:.0f} px, too short to be a line; split nearer the middle"
            )
        point = line.ends[0] + place * along
        one = self._add(_Line(np.array([line.ends[0], point]), line.axis, "split"))
        other = self._add(_Line(np.array([point, line.ends[1]]), line.axis, "split"))
        self._drop(number, (one, other))
        self.parted.append((one, other))

    def _join(self, first: int, second: int) -> None:
        if first == second:
            raise CorrectionError("a line cannot be joined to itself; choose two")
        one, other = self.lines[first], self.lines[second]
        if one.axis != other.axis:
            raise CorrectionError(
                f"one line runs along {AXES[one.axis]}, the other along {AXES[other.axis]}; give them one axis first"
            )
        length = np.array([np.linalg.norm(line.ends[1] - line.ends[0]) for line in (one, other)])
        middle = np.average([line.ends.mean(axis=0) for line in (one, other)], axis=0, weights=length)
        along = directions_to(middle, self.vanishing[one.axis])
        points = np.concatenate([one.ends, other.ends]) - middle
        across = float(np.abs(points @ np.array([-along[1], along[0]])).max())
        allowed = max(JOIN_ACROSS * self.scale, JOIN_ACROSS_FLOOR)
        if across > allowed:
            raise CorrectionError(
                f"the two lines are {across:.0f} px beside each other, pieces of one line at most {allowed:.0f} px; "
                "choose two pieces of one line"
            )
        reach = points @ along
        ends = middle + np.array([[reach.min()], [reach.max()]]) * along
        whole = self._add(_Line(ends, one.axis, "joined"))
        self._drop(first, (whole,))
        self._drop(second, (whole,))

    def _now(self, number: int) -> list[int]:
        """The lines that a line has become."""
        if number in self.lines:
            return [number]
        return [now for successor in self.became.get(number, ()) for now in self._now(successor)]

    def _final_labels(self) -> dict[tuple[int, int], tuple[Point, Label]]:
        """The labels of lines that are there still, or of those that they became, the piece nearest to the crossing."""
        found = {}
        for (one, other), said in self.labels.items():
            pair = [self._nearest(own, said[0]) for own in (one, other)]
            if pair[0] is not None and pair[1] is not None and pair[0] != pair[1]:
                found[min(pair[0], pair[1]), max(pair[0], pair[1])] = said
        return found

    def _nearest(self, number: int, pixel: Point) -> int | None:
        now = self._now(number)
        if len(now) < 2:
            return now[0] if now else None
        return min(now, key=lambda own: _distance(np.array(pixel), self.lines[own].ends))


def said_of(graph: LineGraph, corrected: CorrectedLines) -> Said:
    """What the labels say about the crossings of a line graph of these lines.

    Pieces that a split parted are two lines, so their collinear crossing is fake.
    """
    rows = rows_of(graph.segments, corrected)
    node = {int(corrected.ids[row]): k for k, row in enumerate(rows.tolist())}
    edge = {pair: e for e, pair in enumerate(map(tuple, graph.edges.tolist()))}
    real, fake = np.zeros(len(graph.edges), bool), np.zeros(len(graph.edges), bool)
    label: list[Label | None] = [None] * len(graph.edges)
    notes = []
    for pair in corrected.parted:
        for e in _edges(edge, node, pair):
            fake[e] = graph.kind[e] == "collinear"
    for pair, (pixel, word) in corrected.labels.items():
        for e in _edges(edge, node, pair):
            label[e] = word
            real[e], fake[e] = word == "real", word == "fake"
            break
        else:
            if word == "real":
                notes.append(
                    f"the crossing at ({pixel[0]:.0f}, {pixel[1]:.0f}) that was called real is not in the line graph; "
                    "raise --extension"
                )
    return Said(real, fake, tuple(label), tuple(notes))


def rows_of(segments: Segments, corrected: CorrectedLines) -> Int:
    """(M,) the row in `corrected` of each of M segments that were taken from there."""
    place = {
        (axis, ends.tobytes()): row
        for row, (ends, axis) in enumerate(zip(corrected.segments.ends, corrected.segments.axis.tolist(), strict=True))
    }
    pairs = zip(segments.ends, segments.axis.tolist(), strict=True)
    return np.array([place[axis, ends.tobytes()] for ends, axis in pairs], np.int64)


def _edges(edge: dict[tuple[int, ...], int], node: dict[int, int], pair: tuple[int, int]) -> Iterator[int]:
    """The crossing of two lines given by their ids, if the graph has it."""
    if pair[0] in node and pair[1] in node:
        key = tuple(sorted((node[pair[0]], node[pair[1]])))
        if key in edge:
            yield edge[key]


def _shared(ends: Float, others: Float, across: float) -> Float:
    """(N,) the stretch that a segment (2, 2) and others (N, 2, 2) have in common over all that either covers.

    0 where the ends of one are further than `across` from the line of the other, or they share less than LEAST_OVERLAP
    of the shorter one.
    """
    if len(others) == 0:
        return np.zeros(0)
    own = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    from_own = others - ends[0]
    off_own = np.abs(from_own[..., 0] * own[1] - from_own[..., 1] * own[0]).max(axis=1)
    along = others[:, 1] - others[:, 0]
    length = np.linalg.norm(along, axis=1)
    unit = along / length[:, None]
    to = ends[None] - others[:, :1]
    reach = np.einsum("nik,nk->ni", to, unit)
    off = np.abs(to[..., 0] * unit[:, None, 1] - to[..., 1] * unit[:, None, 0]).max(axis=1)
    off = np.minimum(off, off_own)  # the longer one tells its direction better
    low, high = reach.min(axis=1), reach.max(axis=1)
    common = np.minimum(high, length) - np.maximum(low, 0)
    enough = (off <= across) & (common >= LEAST_OVERLAP * np.minimum(length, high - low))
    share: Float = np.where(enough, common / (np.maximum(high, length) - np.minimum(low, 0)), 0.0)
    return share


def _distance(point: Float, ends: Float) -> float:
    """From a point (2,) to a segment (2, 2)."""
    along = ends[1] - ends[0]
    place = np.clip((point - ends[0]) @ along / (along @ along), 0, 1)
    return float(np.linalg.norm(ends[0] + place * along - point))
