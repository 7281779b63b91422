"""What a session is made of: lines after all edits, models, what cannot all hold, a state to show."""

from dataclasses import dataclass
from functools import cached_property

from linecad.camera.photo import Photo
from linecad.corrections.annotations import Annotations
from linecad.corrections.corrected import CorrectedLines
from linecad.corrections.edits import Corrections, Fact
from linecad.editing.bodies import ShownBodies
from linecad.errors import LinecadError
from linecad.finding import FoundLines
from linecad.line_graph import LineGraph
from linecad.pipeline import Reconstruction
from linecad.scene import Scene
from solver.options import Progress

CROSSING_BASE = 10**7  # ids of crossings are smaller id * this + larger id of their lines


class StaleError(LinecadError):
    """The page spoke of a state that is over."""


@dataclass(frozen=True, eq=False)
class Lines:
    """The lines after all edits, with their crossings."""

    corrected: CorrectedLines
    graph: LineGraph  # of all lines that are long enough
    annotations: Annotations
    ids: tuple[int, ...]  # of the graph's nodes
    crossings: tuple[int, ...]  # ids of the graph's edges

    @cached_property
    def edge(self) -> dict[int, int]:
        """The graph's edge by the id of the crossing."""
        return {crossing: edge for edge, crossing in enumerate(self.crossings)}


@dataclass(frozen=True, eq=False)
class ToSave:
    """What the files hold."""

    corrections: Corrections
    lines: Lines


@dataclass(frozen=True)
class Decided:
    """The decision about one crossing."""

    real: bool
    reason: str  # one of linecad.scene.REASONS


@dataclass(frozen=True, eq=False)
class Decisions:
    """What a model has of the crossings, by their ids."""

    decided: dict[int, Decided]
    changed: frozenset[int] = frozenset()  # whose decision differs from that of the model before
    far: frozenset[int] = frozenset()  # of `changed`, those far from all that was edited (`linecad.editing.distant`)


@dataclass(frozen=True, eq=False)
class Model:
    """A solved scene."""

    scene: Scene
    version: int  # of the state that it was solved for
    decisions: Decisions
    seconds: float  # from the lines to the scene
    bodies: ShownBodies | None = None  # None for programs without them


@dataclass(frozen=True)
class Contradiction:
    """What cannot all be true, by ids."""

    lines: tuple[int, ...]
    crossings: tuple[int, ...]
    text: str
    facts: tuple[Fact, ...] = ()


@dataclass(frozen=True, eq=False)
class Now:
    """A state to show: values that do not change any more."""

    version: int
    photo: Photo
    found: FoundLines
    lines: Lines
    corrections: Corrections
    model: Model | None
    progress: Progress | None  # of the search of the solve that runs, or of the last one
    stage: str  # what the solve that runs is at, in words; empty while it searches
    is_fresh: bool  # the model holds all edits
    is_running: bool
    error: str  # of the last solve
    contradiction: Contradiction | None
    order: tuple[int, ...]  # ids of all crossings, the most telling first (linecad.editing.telling)


def contradiction_of(
    lines: tuple[int, ...], crossings: tuple[tuple[int, int], ...], text: str, facts: tuple[object, ...]
) -> Contradiction:
    """By the ids of lines."""
    told = tuple(fact for fact in facts if isinstance(fact, Fact))
    return Contradiction(lines, tuple(crossing_id(*pair) for pair in crossings), text, told)


def crossing_id(one: int, other: int) -> int:
    """The id of the crossing of two lines."""
    return min(one, other) * CROSSING_BASE + max(one, other)


def lines_of_crossing(crossing: int) -> tuple[int, int]:
    """The ids of the two lines of a crossing, the smaller first."""
    return divmod(crossing, CROSSING_BASE)


def decisions(made: Reconstruction, lines: Lines, largest_alone: bool) -> dict[int, Decided]:
    """What was decided, by the id of each crossing; lines that were not solved are in too small a group, or another."""
    row = {
        (axis, ends.tobytes()): ids
        for axis, ends, ids in zip(lines.graph.axis.tolist(), lines.graph.segments.ends, lines.ids, strict=True)
    }
    graph, decision = made.graph, made.decision
    ids = [row[axis, ends.tobytes()] for axis, ends in zip(graph.axis.tolist(), graph.segments.ends, strict=True)]
    unsolved = "other group" if largest_alone else "small group"
    found = {
        crossing: Decided(False, unsolved) if label in (None, "unsure") else Decided(label == "real", "annotated")
        for crossing, label in zip(lines.crossings, lines.annotations.label, strict=True)
    }
    rows = zip(graph.edges.tolist(), decision.real.tolist(), decision.reason.tolist(), strict=True)
    for (i, j), real, reason in rows:
        found[crossing_id(ids[i], ids[j])] = Decided(real, reason)
    return found
