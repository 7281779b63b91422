"""One photo being corrected: its lines, their annotations, the model of the last solve, undo and redo.

Everything here is kept by one lock; the server's threads and the one that hears the solver call in.
"""

import threading
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

from linecad.camera.photo import Photo
from linecad.corrections.annotations import Annotations, annotations_of, rows_of
from linecad.corrections.apply import CorrectedLines, Correcting, correcting_of
from linecad.corrections.edits import Corrections, Edit, KnownLength, NameGroup, SetFrame
from linecad.corrections.lengths import measured
from linecad.editing.solving import Answer, Step, Task
from linecad.editing.telling import Order
from linecad.errors import CorrectionError, LinecadError
from linecad.finding import FoundLines, connect_all, name_lines
from linecad.line_graph import LineGraph, Segments
from linecad.options import Options
from linecad.pipeline import Reconstruction
from linecad.scene import Scene
from solver.options import Progress

MODELS_KEPT = 12  # solved before, shown again at once when an undo or redo comes back to what they were solved for
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
class Model:
    """A solved scene."""

    scene: Scene
    version: int  # of the state that it was solved for
    decided: dict[int, Decided]  # by the id of the crossing
    changed: frozenset[int]  # crossings whose decision differs from that of the model before
    seconds: float  # from the lines to the scene


@dataclass(frozen=True)
class Contradiction:
    """What cannot all be true, by ids."""

    lines: tuple[int, ...]
    crossings: tuple[int, ...]
    text: str


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


Content = tuple[Edit, ...]


class Session:
    """The state of the page; every method may be called from any thread."""

    def __init__(
        self,
        photo: Photo,
        raw: Segments,
        options: Options,
        corrections: Corrections,
        on_change: Callable[[ToSave], None],
    ) -> None:
        """`raw` are the photo's segments (`linecad.lines.segments.find_segments`)."""
        self.photo, self.options = photo, options
        self._raw, self._on_change = raw, on_change
        self._lock = threading.RLock()
        self._version = 1
        self._corrections = corrections
        self._found: dict[SetFrame | None, FoundLines] = {}
        self._models: OrderedDict[Content, Model] = OrderedDict()
        self._solved: Model | None = None  # the model that is shown, as it came
        self._model: Model | None = None  # the same with its scale
        self._task = 0  # number of the last solve that was asked for
        self._solving: tuple[int, Content] | None = None  # number and content of the one that runs
        self._progress: Progress | None = None
        self._stage = ""
        self._error = ""
        self._contradiction: Contradiction | None = None
        self._orders = Order()
        self._editing, self._notes = self._replay(corrections)
        self._lines = self._connect()

    def now(self) -> Now:
        """The state to show."""
        with self._lock:
            return Now(
                self._version,
                self.photo,
                self._found_now(),
                self._lines,
                self._corrections,
                self._model,
                self._progress,
                self._stage,
                self._solved is not None and self._models.get(self._content()) is self._solved,
                self._solving is not None,
                self._error,
                self._contradiction,
                self._order(),
            )

    def edit(self, base: int, make: Callable[["Session"], Edit]) -> None:
        """Add the edit that `make` makes of this session, which it may look at.

        StaleError when `base` is not the version any more, CorrectionError or ReconstructionError when it cannot be
        done; then nothing has changed.
        """
        with self._lock:
            self._check(base)
            edit = make(self)
            edits = (*self._corrections.edits, edit)
            self._change(replace(self._corrections, edits=edits, undone=()), added=edit)

    def undo(self, base: int) -> None:
        """Take the last edit back; CorrectionError when there is none."""
        with self._lock:
            self._check(base)
            *edits, last = self._corrections.edits or self._nothing("undo")
            undone = (*self._corrections.undone, last)
            self._change(replace(self._corrections, edits=tuple(edits), undone=undone))

    def redo(self, base: int) -> None:
        """Add again what was taken back last; CorrectionError when there is nothing."""
        with self._lock:
            self._check(base)
            *undone, last = self._corrections.undone or self._nothing("do again")
            edits = (*self._corrections.edits, last)
            self._change(replace(self._corrections, edits=edits, undone=tuple(undone)), added=last)

    @property
    def lines(self) -> Lines:
        """The lines as they are now."""
        return self._lines

    @property
    def editing(self) -> Correcting:
        """The lines as edits see them: to find, to name, to propose."""
        return self._editing

    def crossing_pair(self, crossing: int) -> tuple[int, int]:
        """The ids of the two lines of a crossing; CorrectionError when there is none with this id."""
        if crossing not in self._lines.edge:
            raise CorrectionError(f"there is no crossing {crossing} any more; reload the page")
        return divmod(crossing, CROSSING_BASE)

    def next_unlabelled(self, after: int | None) -> int | None:
        """The next crossing without a label behind `after`, the most telling first and around."""
        with self._lock:
            lines, order = self._lines, self._order()
            start = order.index(after) + 1 if after in lines.edge else 0
            for crossing in (*order[start:], *order[:start]):
                if lines.annotations.label[lines.edge[crossing]] is None:
                    return crossing
            return None

    def task(self, base: int) -> Task:
        """What to solve now; from here on it counts as running."""
        with self._lock:
            self._check(base)
            self._task += 1
            self._solving = (self._task, self._content())
            self._progress, self._stage, self._error, self._contradiction = None, "", "", None
            # The process that solves has the photo already.
            return Task(self._task, replace(self._found_now(), pixels=None), self._lines.corrected)

    def hear(self, step: Step) -> None:
        """Take note of how far a solve has come."""
        with self._lock:
            if self._solving is not None and self._solving[0] == step.number:
                self._progress, self._stage = step.progress or self._progress, step.stage

    def take(self, answer: Answer) -> None:
        """Take over the answer of a solve, unless another one was asked for or the lines have changed since."""
        with self._lock:
            if self._solving is None or self._solving[0] != answer.number:
                return
            _, content = self._solving
            self._solving = None
            self._version += 1
            if content != self._content():
                return
            self._error = answer.error
            if answer.lines:
                crossings = tuple(crossing_id(*pair) for pair in answer.crossings)
                self._contradiction = Contradiction(answer.lines, crossings, answer.error)
            if answer.made is not None:
                self._models[content] = self._model_of(answer.made, answer.seconds)
                self._show(self._models[content])
                while len(self._models) > MODELS_KEPT:
                    self._models.popitem(last=False)

    def scene(self) -> Scene:
        """The scene of the model that is shown, with the scale that is known now; LinecadError when there is none."""
        with self._lock:
            if self._model is None:
                raise CorrectionError("there is no model yet; solve first")
            return self._model.scene

    def _check(self, base: int) -> None:
        if base != self._version:
            raise StaleError("the lines have changed in the meantime; the page shows them now, try again")

    def _nothing(self, what: str) -> tuple[Edit, ...]:
        raise CorrectionError(f"there is nothing to {what}")

    def _change(self, corrections: Corrections, added: Edit | None = None) -> None:
        """Make these the corrections; the last one was `added` to those before, or they are others."""
        before = self._lines.corrected
        if added is not None and not isinstance(added, SetFrame):
            self._editing.apply(added)
        else:
            self._editing, self._notes = self._replay(corrections)
        self._corrections = corrections
        self._version += 1
        self._lines = self._connect(before)
        self._contradiction = None
        known = self._models.get(self._content())
        if known is not None:
            self._models.move_to_end(self._content())
            self._show(known)
        elif self._solved is not None:
            self._show(self._solved)
        self._on_change(ToSave(corrections, self._lines))

    def _replay(self, corrections: Corrections) -> tuple[Correcting, tuple[str, ...]]:
        frame = corrections.frame
        if frame not in self._found:
            found = name_lines(self.photo, self._raw, faint=self.options.faint, drawn=frame)
            self._found[frame] = found.grouped(self.options)
        found = self._found[frame]
        return correcting_of(found.segments, found.camera, found.frame, corrections)

    def _found_now(self) -> FoundLines:
        return self._found[self._corrections.frame]

    def _connect(self, before: CorrectedLines | None = None) -> Lines:
        """The lines and crossings now; the graph is that of `before` where no line has changed."""
        corrected = self._editing.result(self._notes)
        if before is not None and corrected.is_like(before):
            graph = self._lines.graph
        else:
            graph = connect_all(replace(self._found_now(), segments=corrected.segments), self.options)
        ids = corrected.ids[rows_of(graph.segments, corrected)]
        crossings = tuple(crossing_id(*pair) for pair in ids[graph.edges].tolist())
        return Lines(corrected, graph, annotations_of(graph, corrected), tuple(ids.tolist()), crossings)

    def _order(self) -> tuple[int, ...]:
        model, lines = self._solved, self._lines
        scene, decided = (None, {}) if model is None else (model.scene, model.decided)
        return self._orders.of(lines.graph, lines.crossings, scene, decided)

    def _content(self) -> Content:
        """The edits that bear on the solve."""
        return tuple(edit for edit in self._corrections.edits if not isinstance(edit, KnownLength | NameGroup))

    def _show(self, model: Model) -> None:
        """Show a model, with the scale that known lengths give now."""
        self._solved = model
        self._model = replace(model, scene=measured(model.scene, self._lines.corrected))

    def _model_of(self, made: Reconstruction, seconds: float) -> Model:
        now = decisions(made, self._lines, self.options.largest_component)
        before = {} if self._model is None else self._model.decided
        changed = frozenset(
            crossing for crossing, found in now.items() if before.get(crossing, found).real != found.real
        )
        return Model(made.scene, self._version, now, changed, seconds)


def crossing_id(one: int, other: int) -> int:
    """The id of the crossing of two lines."""
    return min(one, other) * CROSSING_BASE + max(one, other)


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
