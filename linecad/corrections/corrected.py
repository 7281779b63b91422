"""The lines of a photo after all edits, and what a person knows beside them."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from linecad.arrays import Int
from linecad.corrections.edits import Anchor, Cut, FaceEdit, Fact, Label, OnePlane, PlaceAt, Point, WallByEdges
from linecad.directions import UP, partner
from linecad.line_graph import Segments

Origin = Literal["found", "drawn", "split", "joined"]


@dataclass(frozen=True)
class FoundPlace:
    """A point that a person measured from or to, its line found again."""

    pixel: Point
    line: int | None = None  # id; None for a point in a plane
    face: Point | None = None  # px where the photo shows the plane; None for a point on a line
    normal: int | None = None  # axis of the plane; None where a frame given later made it another one


@dataclass(frozen=True)
class ToldFact:
    """A fact, and the lines that it names now: by their ids, or as the nodes of a line graph."""

    fact: Fact
    lines: tuple[int, ...]
    is_implied: bool = False  # by what a person told of faces; it gives way to what was told of bodies
    part: tuple[int, ...] = ()  # the lines of a part of a body, those that are still there

    def by(self, number: Mapping[int, int]) -> "ToldFact | None":
        """The same by other numbers of the lines; None where one that it is about has none."""
        if any(line not in number for line in self.lines):
            return None
        lines, part = (tuple(number[line] for line in own if line in number) for own in (self.lines, self.part))
        return replace(self, lines=lines, part=part)


@dataclass(frozen=True, eq=False)
class CorrectedLines:
    """The lines of a photo after all edits."""

    segments: Segments  # N
    ids: Int  # (N,) stable numbers
    origin: tuple[Origin, ...]  # N
    as_found: Segments  # N, what each was before any edit; one that was drawn as it is, a piece as the whole line
    labels: dict[tuple[int, int], tuple[Point, Label]]  # by the ids of two lines, the smaller first
    lengths: dict[int, float]  # m, by id
    parted: tuple[tuple[int, int], ...]  # ids of pieces that a split parted
    notes: tuple[str, ...]  # what could not be found again
    facts: tuple[ToldFact, ...] = ()  # about the bodies of lines, by id
    distances: tuple[tuple[FoundPlace, FoundPlace, float], ...] = ()  # m, between two points
    names: dict[int, str] = field(default_factory=dict)  # of groups, by the id of a line of each; the newest last
    faces: tuple[FaceEdit, ...] = ()  # what is known about faces, in order, by lines as they look now

    def is_like(self, other: "CorrectedLines") -> bool:
        """Whether the lines are the same, whatever their annotations."""
        return np.array_equal(self.ids, other.ids) and self.segments.is_like(other.segments)

    def changes_evidence(self, found: Segments) -> bool:
        """Whether lines differ from those found, or something is told of crossings or of where bodies are parted."""
        return not self.segments.is_like(found) or bool(self.labels or self.parted or self.cuts or self.parts)

    @property
    def cuts(self) -> frozenset[Fact]:
        """The facts that say where bodies are parted, wherever the parts stand."""
        return frozenset(told.fact for told in self.facts if isinstance(told.fact, Cut))

    @property
    def parts(self) -> frozenset[tuple[Anchor, ...]]:
        """The parts of bodies that were placed by themselves."""
        return frozenset(told.fact.part for told in self.facts if isinstance(told.fact, PlaceAt) and told.fact.part)

    @property
    def implied(self) -> tuple[ToldFact, ...]:
        """What walls by their edges say of bodies: all edges lie in one plane; by ids of lines."""
        number = {(axis, ends.tobytes()): own for axis, ends, own in
                  zip(self.segments.axis.tolist(), self.segments.ends, self.ids.tolist(), strict=True)}  # fmt: skip
        found = []
        for wall in self.faces:
            if not isinstance(wall, WallByEdges):
                continue
            edges = [(line, number.get((line.axis, np.array(line.ends).tobytes()))) for line in wall.lines]
            normal = next(int(partner(line.axis)) for line in wall.lines if line.axis != UP)
            (first, own), *others = edges
            for line, other in others:
                if own is not None and other is not None:
                    found.append(ToldFact(OnePlane((first, line), normal), (own, other), is_implied=True))
        return tuple(found)

    @property
    def all_facts(self) -> tuple[ToldFact, ...]:
        """The facts that were told and then those that are implied."""
        return (*self.facts, *self.implied)

    def differs_in_places(self, other: "CorrectedLines") -> bool:
        """Whether nothing differs but facts that say where bodies stand."""
        return self.differs_at_once(other) and self.parts == other.parts

    def differs_at_once(self, other: "CorrectedLines") -> bool:
        """The same, or facts that place a part of a body."""
        return self.differs_in_facts(other) and self.cuts == other.cuts

    def differs_in_facts(self, other: "CorrectedLines") -> bool:
        """Whether nothing differs but facts about bodies."""
        return self.is_like(other) and (self.labels, self.parted) == (other.labels, other.parted)
