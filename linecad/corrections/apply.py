"""Corrections applied to the lines that were found: each named line is looked up again by its geometry.

What cannot be found again is told in a note and left out. Every line has an id that stays the same while edits are
added or taken back: found lines are numbered in their order, new ones follow in the order of the edits.
"""

from copy import copy
from dataclasses import replace
from functools import partial
from itertools import product
from typing import assert_never

import numpy as np
import shapely

from linecad.corrections.corrected import CorrectedLines, FoundPlace, ToldFact
from linecad.corrections.drawing import Drawing
from linecad.corrections.edits import (
    Anchor,
    Corrections,
    Cut,
    Delete,
    Draw,
    Edit,
    FaceAnchor,
    Fact,
    Foot,
    Join,
    KnownDistance,
    KnownLength,
    Label,
    LabelCrossing,
    Many,
    Meet,
    NameGroup,
    NoWindow,
    OnePlane,
    Part,
    Place,
    PlaceAt,
    Point,
    Region,
    SetAxis,
    SetEnds,
    SetFrame,
    Split,
    WallByEdges,
    Window,
    Withdraw,
    anchors_of,
)
from linecad.corrections.faces import ToldFace, told
from linecad.corrections.line import Line, segments_of
from linecad.corrections.lookup import LineTable
from linecad.directions import axis_name
from linecad.errors import CorrectionError
from linecad.line_graph import ManhattanFrame, Segments
from linecad.scene import Camera

MOST_NOTES = 5  # about single corrections; the rest is counted
FIRST_IDS = 100_000  # ids for the lines of one frame; those found with the next one are other lines


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
        # Of a step that holds many, those are left out that mean nothing any more.
        for part in edit.edits if isinstance(edit, Many) else (edit,):
            try:
                lines.apply(part, before_frame=bool(frames) and number < frames[-1])
            except CorrectionError as error:
                notes.append(f"correction {number + 1} is left out: {error}")
    if len(notes) > MOST_NOTES:
        notes[MOST_NOTES:] = [f"{len(notes) - MOST_NOTES} more corrections name lines that are not there any more"]
    return lines, tuple(notes)


class Correcting:
    """Lines that edits are applied to, one after another."""

    def __init__(self, segments: Segments, camera: Camera, frame: ManhattanFrame, first_id: int = 0) -> None:
        self.drawing = Drawing(camera, frame)
        self.lines: dict[int, Line] = {
            first_id + number: Line(ends, axis, "found")
            for number, (ends, axis) in enumerate(zip(segments.ends, segments.axis.tolist(), strict=True))
        }
        self.next_id = first_id + len(segments)
        self.became: dict[int, tuple[int, ...]] = {}  # lines that were split or joined, and their successors
        self.labels: dict[tuple[int, int], tuple[Point, Label]] = {}
        self.lengths: dict[int, float] = {}
        self.distances: dict[tuple[Place, Place], tuple[FoundPlace, FoundPlace, float]] = {}
        self.names: dict[int, str] = {}
        self.parted: list[tuple[int, int]] = []
        self.facts: dict[Fact, ToldFact] = {}
        self.faces: list[ToldFace] = []
        self._table: LineTable | None = None

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
                    self._turn(self.find(edit.line, before_frame), edit.axis)
            case Delete():
                self._drop(self.find(edit.line, before_frame), ())
            case SetEnds():
                number = self.find(edit.line, before_frame)
                line = self.lines[number]
                self._put(number, line.changed(self.drawing.reaching(line.ends, np.array(edit.ends))))
            case Many():
                self._apply_all(edit.edits, before_frame)
            case Split():
                self._split(self.find(edit.line, before_frame), edit.at)
            case Join():
                self._join(self.find(edit.lines[0], before_frame), self.find(edit.lines[1], before_frame))
            case Draw():
                ends = np.array(edit.line.ends)
                axis = self.drawing.nearest_axis(ends) if before_frame else edit.line.axis
                drawn = Line(self.drawing.long_enough(self.drawing.turned(ends, axis)), axis, "drawn")
                self._check_new(drawn)
                self._add(drawn)
            case KnownLength():
                number = self.find(edit.line, before_frame)
                self.lengths.pop(number, None)
                if edit.metres is not None:
                    self.lengths[number] = edit.metres
            case Meet() | OnePlane() | Foot() | Cut() | PlaceAt():
                self._tell(edit, before_frame)
            case Withdraw():
                if self.facts.pop(edit.fact, None) is None and not before_frame:
                    raise CorrectionError("what is taken back was not said, or was taken back before")
            case KnownDistance():
                first_place, second_place = (self.found_place(place, before_frame) for place in edit.places)
                self.distances.pop(edit.places, None)
                if edit.metres is not None:
                    self.distances[edit.places] = (first_place, second_place, edit.metres)
            case NameGroup():
                number = self.find(edit.line, before_frame)
                self.names.pop(number, None)
                if edit.name is not None:
                    self.names[number] = edit.name
            case SetFrame():
                pass  # the lines were found with it
            case Region() | Window() | NoWindow() | WallByEdges():
                find = partial(self.find, any_axis=before_frame)
                self.faces.append(told(edit, find, self._look, before_frame))
            case _:
                assert_never(edit)

    def result(self, notes: tuple[str, ...] = ()) -> CorrectedLines:
        """The lines as they are now."""
        lines = list(self.lines.values())
        faces = [face.now(self._look) for face in self.faces]
        if None in faces:
            notes = (*notes, "a wall by four edges is left out: one of its edges was taken away")
        return CorrectedLines(
            segments=segments_of(lines),
            ids=np.array(list(self.lines), np.int64),
            origin=tuple(line.origin for line in lines),
            as_found=segments_of(line.as_found for line in lines),
            labels=self._final_labels(),
            lengths={own: metres for number, metres in self.lengths.items() for own in self._now(number)[:1]},
            parted=tuple((a, b) for one, other in self.parted for a, b in product(self._now(one), self._now(other))),
            notes=notes,
            facts=tuple(now for told in self.facts.values() if (now := self._told_now(told))),
            distances=tuple(
                (one, other, metres)
                for first, second, metres in self.distances.values()
                for one, other in product(self._place_now(first), self._place_now(second))
            ),
            names={own: name for number, name in self.names.items() for own in self._now(number)[:1]},
            faces=tuple(face for face in faces if face is not None),
        )

    def anchor(self, number: int) -> Anchor:
        """What a line looks like now; CorrectionError when there is none with this id."""
        if number not in self.lines:
            raise CorrectionError(f"there is no line {number} any more; reload the page")
        line = self.lines[number]
        (a, b), (c, d) = line.ends.tolist()
        return Anchor(((a, b), (c, d)), line.axis)

    def _look(self, number: int) -> Anchor | None:
        """What a line looks like now, or the first piece of what it has become; None when nothing is left of it."""
        now = self._now(number)
        return self.anchor(now[0]) if now else None

    def find(self, anchor: Anchor, any_axis: bool = False) -> int:
        """The id of the line that an anchor names (`LineTable.find`); CorrectionError when there is none."""
        return self.table.find(anchor, self.drawing.width, any_axis)

    def _tell(self, fact: Fact, before_frame: bool) -> None:
        if before_frame:
            raise CorrectionError("it was said of lines along other axes; say it again")
        if fact in self.facts:
            raise CorrectionError("this was said already; take it back first to say something else")
        told = self.by_ids(fact)
        if len(set(told.lines)) < len(told.lines):
            raise CorrectionError("this takes two lines; choose another one")
        self.facts[fact] = told

    def by_ids(self, fact: Fact) -> ToldFact:
        """A fact by the ids of its lines; CorrectionError where one that it is about is not there."""
        part = self.table.find_all(fact.part, self.drawing.width) if isinstance(fact, PlaceAt) else ()
        return ToldFact(fact, tuple(self.find(anchor) for anchor in anchors_of(fact)), part=part)

    def _told_now(self, told: ToldFact) -> ToldFact | None:
        """A fact about lines as they are now, of one that was split the piece nearest to where it was named."""
        middles = (tuple(np.mean(anchor.ends, axis=0).tolist()) for anchor in anchors_of(told.fact))
        now = [self._nearest(own, middle) for own, middle in zip(told.lines, middles, strict=True)]
        found = tuple(own for own in now if own is not None)
        part = tuple(now for own in told.part for now in self._now(own))
        return replace(told, lines=found, part=part) if len(set(found)) == len(told.lines) else None

    def found_place(self, place: Place, before_frame: bool = False) -> FoundPlace:
        """The point with its line found again; CorrectionError when that is not there."""
        if isinstance(place.on, FaceAnchor):
            return FoundPlace(place.pixel, face=place.on.pixel, normal=None if before_frame else place.on.axis)
        return FoundPlace(place.pixel, line=self.find(place.on, before_frame))

    def _place_now(self, place: FoundPlace) -> list[FoundPlace]:
        """The place on the line that its line has become, the nearest piece; none where that was deleted."""
        if place.line is None:
            return [place]
        now = self._nearest(place.line, place.pixel)
        return [] if now is None else [replace(place, line=now)]

    @property
    def table(self) -> LineTable:
        """The lines as they are now."""
        if self._table is None:
            lines = segments_of(self.lines.values())
            self._table = LineTable(np.array(list(self.lines), np.int64), lines.ends, lines.axis)
        return self._table

    def _turn(self, number: int, axis: int) -> None:
        """Let a line run along another axis."""
        line = self.lines[number]
        turned = line.changed(self.drawing.turned(line.ends, axis), axis)
        if axis != line.axis:
            self._check_new(turned)
            self._put(number, turned)

    def _apply_all(self, edits: tuple[Part, ...], before_frame: bool) -> None:
        """Apply edits one after another, all or none."""
        before = {name: copy(value) for name, value in vars(self).items()}
        try:
            for edit in edits:
                self.apply(edit, before_frame)
        except CorrectionError:
            vars(self).update(before)
            raise

    def _label(self, pair: tuple[int, int], pixel: Point, label: Label | None) -> None:
        self.labels.pop(pair, None)
        if label is not None:
            self.labels[pair] = (pixel, label)

    def _put(self, number: int, line: Line) -> None:
        self.lines[number] = line
        self._table = None

    def _check_new(self, line: Line) -> None:
        if self.table.has(line.ends, line.axis):
            raise CorrectionError("this line is there already; draw another one")

    def _add(self, line: Line) -> int:
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
        pieces = self.drawing.split(line.ends, at)
        one, other = (self._add(line.changed(piece, origin="split")) for piece in pieces)
        self._drop(number, (one, other))
        self.parted.append((one, other))

    def _join(self, first: int, second: int) -> None:
        if first == second:
            raise CorrectionError("a line cannot be joined to itself; choose two")
        one, other = self.lines[first], self.lines[second]
        if one.axis != other.axis:
            raise CorrectionError(
                f"one line runs along {axis_name(one.axis)}, the other along {axis_name(other.axis)}; "
                "give them one axis first"
            )
        ends = self.drawing.joined(one.ends, other.ends, one.axis)
        whole = self._add(one.changed(ends, origin="joined"))
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
        for pair, (pixel, label) in self.labels.items():
            one, other = (self._nearest(own, pixel) for own in pair)
            if one is not None and other is not None and one != other:
                found[min(one, other), max(one, other)] = (pixel, label)
        return found

    def _nearest(self, number: int, pixel: Point) -> int | None:
        now = self._now(number)
        if len(now) < 2:
            return now[0] if now else None
        point = shapely.Point(pixel)
        return min(now, key=lambda own: shapely.distance(shapely.linestrings(self.lines[own].ends), point))
