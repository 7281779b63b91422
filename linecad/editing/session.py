"""One photo being corrected: its lines, their annotations, the model of the last solve, undo and redo.

Everything here is kept by one lock; the server's threads and the one that hears the solver call in.
"""

import threading
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import replace

from linecad.camera.photo import Photo
from linecad.corrections.annotations import annotations_of, rows_of
from linecad.corrections.apply import Correcting, correcting_of
from linecad.corrections.corrected import ToldFact
from linecad.corrections.edits import (
    Corrections,
    Edit,
    Fact,
    KnownDistance,
    KnownLength,
    NameGroup,
    SetFrame,
    Withdraw,
)
from linecad.editing.bodies import ShownBodies
from linecad.editing.distant import between, distant
from linecad.editing.solving import Answer, Step, Task
from linecad.editing.state import (
    Contradiction,
    Decisions,
    Lines,
    Model,
    Now,
    StaleError,
    ToSave,
    contradiction_of,
    crossing_id,
    decisions,
    lines_of_crossing,
)
from linecad.editing.telling import Order
from linecad.errors import ContradictionError, CorrectionError
from linecad.finding import FoundLines, connect_all, name_lines
from linecad.line_graph import Segments
from linecad.model.known_lengths import measured
from linecad.options import Options
from linecad.pipeline import Reconstruction
from linecad.scene import Scene
from solver.options import Progress

Content = tuple[Edit, ...]

MODELS_KEPT = 12  # solved before, shown again at once when an undo or redo comes back to what they were solved for


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
        self._changed = 1  # version at the last change of what a person said
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
            self._check_fact(edit)
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

    def preview(
        self, base: int, make: Callable[["Session"], Edit]
    ) -> tuple[dict[int, float], Contradiction | None, str | None]:
        """What a fact would do: the log factors by which bodies would move, what it contradicts, why it says nothing.

        StaleError as for `edit`, CorrectionError where it is no fact; nothing changes.
        """
        with self._lock:
            self._check(base)
            edit = make(self)
            if isinstance(edit, Withdraw) or not isinstance(edit, Fact):
                raise CorrectionError("only what is said of bodies can be tried out")
            try:
                told = self._check_fact(edit)
            except CorrectionError as error:
                return {}, None, str(error)
            assert told is not None
            bodies = self._bodies_now()
            corrected = replace(self._lines.corrected, facts=(*self._lines.corrected.facts, told))
            try:
                return bodies.preview(corrected, self.options), None, None
            except ContradictionError as error:
                return {}, contradiction_of(error.lines, error.crossings, str(error), error.facts), None

    @property
    def wants_solve(self) -> bool:
        """Whether the last change was about bodies, so that the scene should be built anew without being asked."""
        with self._lock:
            model = self._solved
            if self._contradiction is not None or self._content() in self._models or model is None:
                return False
            bodies, corrected = model.bodies, self._lines.corrected
            return bodies is not None and bodies.corrected.differs_in_facts(corrected)

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
        return lines_of_crossing(crossing)

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
                self._contradiction = contradiction_of(answer.lines, answer.crossings, answer.error, answer.facts)
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
        # A model that came since has changed no line: who has not heard of it yet speaks of the same lines.
        if not self._changed <= base <= self._version:
            raise StaleError("the lines have changed in the meantime; the page shows them now, try again")

    def _nothing(self, what: str) -> tuple[Edit, ...]:
        raise CorrectionError(f"there is nothing to {what}")

    def _change(self, corrections: Corrections, added: Edit | None = None) -> None:
        """Make these the corrections; the last one was `added` to those before, or they are others."""
        if added is not None and not isinstance(added, SetFrame):
            self._editing.apply(added)
        else:
            self._editing, self._notes = self._replay(corrections)
        self._corrections = corrections
        self._version += 1
        self._changed = self._version
        self._lines = self._connect(self._lines)
        self._contradiction = None
        known = self._models.get(self._content())
        if known is not None:
            self._models.move_to_end(self._content())
            self._show(known)
        elif self._solved is not None:
            self._show(self._moved(self._solved))
        self._on_change(ToSave(corrections, self._lines))

    def _check_fact(self, edit: Edit) -> ToldFact | None:
        """The fact that an edit tells, by ids of lines, or None; CorrectionError where it would say nothing.

        A cut is not checked here but for its lines.
        """
        if isinstance(edit, Withdraw) or not isinstance(edit, Fact):
            return None
        bodies = self._bodies_now()
        told = self._editing.by_ids(edit)
        bodies.check(told)
        return told

    def _bodies_now(self) -> ShownBodies:
        """The bodies that are shown, of lines as they are now; CorrectionError when there are none."""
        bodies = None if self._solved is None else self._solved.bodies
        if bodies is None:
            if self.options.uses_bodies:
                raise CorrectionError("the bodies are not known yet; wait until the model is there")
            raise CorrectionError("this program places no bodies; start linecad edit without --option formulation")
        return bodies

    def _moved(self, model: Model) -> Model:
        """The model with its bodies where the facts put them that are told now."""
        bodies, corrected = model.bodies, self._lines.corrected
        if bodies is None or not bodies.corrected.differs_at_once(corrected):
            return model
        try:
            return replace(model, bodies=bodies.with_facts(corrected, self.options))
        except ContradictionError as error:
            self._contradiction = contradiction_of(error.lines, error.crossings, str(error), error.facts)
            return model

    def _replay(self, corrections: Corrections) -> tuple[Correcting, tuple[str, ...]]:
        frame = corrections.frame
        if frame not in self._found:
            found = name_lines(self.photo, self._raw, faint=self.options.faint, drawn=frame)
            self._found[frame] = found.grouped(self.options)
        found = self._found[frame]
        return correcting_of(found.segments, found.camera, found.frame, corrections)

    def _found_now(self) -> FoundLines:
        return self._found[self._corrections.frame]

    def _connect(self, before: Lines | None = None) -> Lines:
        """The lines and crossings now; what `before` had stays as it is where no line or no label has changed."""
        corrected = self._editing.result(self._notes)
        if before is not None and corrected.differs_in_facts(before.corrected):
            return replace(before, corrected=corrected)
        if before is not None and corrected.is_like(before.corrected):
            graph = before.graph
        else:
            graph = connect_all(replace(self._found_now(), segments=corrected.segments), self.options)
        ids = corrected.ids[rows_of(graph.segments, corrected)]
        crossings = tuple(crossing_id(*pair) for pair in ids[graph.edges].tolist())
        return Lines(corrected, graph, annotations_of(graph, corrected), tuple(ids.tolist()), crossings)

    def _order(self) -> tuple[int, ...]:
        model, lines = self._solved, self._lines
        scene, decided = (None, {}) if model is None else (model.scene, model.decisions.decided)
        return self._orders.of(lines.graph, lines.crossings, scene, decided)

    def _content(self) -> Content:
        """The edits that bear on the solve."""
        idle = KnownLength | KnownDistance | NameGroup
        return tuple(edit for edit in self._corrections.edits if not isinstance(edit, idle))

    def _show(self, model: Model) -> None:
        """Show a model, with the scale that known lengths give now."""
        self._solved = model
        self._model = replace(model, scene=measured(model.scene, self._lines.corrected))

    def _model_of(self, made: Reconstruction, seconds: float) -> Model:
        now = decisions(made, self._lines, self.options.largest_component)
        before = {} if self._model is None else self._model.decisions.decided
        changed = frozenset(
            crossing for crossing, found in now.items() if before.get(crossing, found).real != found.real
        )
        bodies = None
        if made.places is not None:
            bodies = ShownBodies.of(made.places, made.graph, self._lines.corrected)
        shown = next((content for content, model in self._models.items() if model is self._solved), None)
        edited = () if shown is None else between(shown, self._content())
        pixel = {crossing: self._lines.graph.crossing[self._lines.edge[crossing]] for crossing in changed}
        far = distant(changed, pixel, edited, self.photo.width)
        return Model(made.scene, self._version, Decisions(now, changed, far), seconds, bodies)
