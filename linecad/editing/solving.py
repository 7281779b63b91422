"""Solving in a process of its own that stays warm: the page answers while it works, and it can be stopped.

The process ends when the server does, however that ends: its pipe breaks then.
"""

import contextlib
import importlib
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from types import FrameType
from typing import TYPE_CHECKING

from linecad.camera.photo import Photo
from linecad.corrections.corrected import CorrectedLines
from linecad.corrections.edits import Fact
from linecad.depth.depth_map import DepthMap
from linecad.errors import ContradictionError, LinecadError
from linecad.finding import FoundLines
from linecad.options import Options
from linecad.pipeline import Prepared, Reconstruction, prepare, prepared_for, reconstruct_prepared
from linecad.progress import StageReport, silent
from solver.options import Progress

if TYPE_CHECKING:
    from multiprocessing.sharedctypes import Synchronized

BEHIND = 5  # niceness: the page answers before what is solved behind it
PATIENCE_S = 5.0  # that a process gets to end by itself
NO_TASK = -1
LOADED_LATE = (
    "solver.gain.search",
    "solver.paper.search",
    "solver.backends.scip_gain",
)  # by who needs them; here before

_CONTEXT = multiprocessing.get_context("spawn")  # a fork of a process with OpenCV's threads hangs now and then


@dataclass(frozen=True, eq=False)
class Task:
    """Lines to solve."""

    number: int
    found: FoundLines
    corrected: CorrectedLines


@dataclass(frozen=True, eq=False)
class Answer:
    """What came of a task: a reconstruction, or an error in one line."""

    number: int
    made: Reconstruction | None = None
    error: str = ""
    lines: tuple[int, ...] = ()  # ids of lines that stand in a contradiction
    crossings: tuple[tuple[int, int], ...] = ()  # pairs of line ids whose crossings cannot all be real
    facts: tuple[Fact, ...] = ()  # that cannot all hold
    seconds: float = 0.0  # that the whole of it took; told, and nothing more


@dataclass(frozen=True)
class Step:
    """How far a task has come: the search of its program, or another stage of its work in words."""

    number: int
    progress: Progress | None = None
    stage: str = ""


class SolvingProcess:
    """The process that solves; one task at a time, the last one asked for."""

    def __init__(
        self,
        photo: Photo,
        options: Options,
        on_step: Callable[[Step], None],
        on_answer: Callable[[Answer], None],
        depth: DepthMap | None = None,
    ) -> None:
        """The callbacks run in a thread of this object; `depth` is a map on the photo's pixels."""
        self._photo, self._options, self._depth = photo, options, depth
        self._on_step, self._on_answer = on_step, on_answer
        self._lock = threading.Lock()
        self._running: Task | None = None  # what the process works on
        self._waiting: Task | None = None  # what it gets next
        self._closed = False
        # The number of the task to stop: a signal alone may come before the process has taken the task up.
        self._asked = _CONTEXT.Value("q", NO_TASK, lock=False)
        self._process, self._pipe = self._launch()

    def start(self, task: Task) -> None:
        """Solve this next; what is being solved is stopped, and its answer is still delivered.

        A task that comes later than one with a larger number is over.
        """
        with self._lock:
            if any(known is not None and known.number > task.number for known in (self._running, self._waiting)):
                return
            self._waiting = task
            if self._running is None:
                self._next()
                return
        self.stop()

    def stop(self) -> None:
        """End the search with the best answer so far."""
        with self._lock:
            if self._running is not None and self._process.pid is not None:
                self._asked.value = self._running.number
                with contextlib.suppress(ProcessLookupError):
                    os.kill(self._process.pid, signal.SIGINT)

    def close(self) -> None:
        """End the process."""
        with self._lock:
            self._closed = True
            process = self._process
        # Its end closes the pipe; closed from here, it would break under the thread that listens.
        process.terminate()
        process.join(PATIENCE_S)
        if process.is_alive():
            process.kill()

    def _launch(self) -> tuple[BaseProcess, Connection]:
        ours, theirs = _CONTEXT.Pipe()
        process = _CONTEXT.Process(target=work, args=(theirs, self._asked), name="linecad solver", daemon=True)
        process.start()
        theirs.close()
        ours.send((self._photo, self._options, self._depth))
        threading.Thread(target=self._listen, args=(ours,), name="answers of the solver", daemon=True).start()
        return process, ours

    def _next(self) -> None:
        """Hand over what waits; call it with the lock."""
        self._running, self._waiting = self._waiting, None
        if self._running is None or self._closed:
            return
        try:
            self._pipe.send(self._running)
        except OSError:  # the process has died; its listener reports it, or has done so
            self._process, self._pipe = self._launch()
            self._pipe.send(self._running)

    def _listen(self, pipe: Connection) -> None:
        while True:
            try:
                message = pipe.recv()
            except (EOFError, OSError):
                self._lost(pipe)
                pipe.close()
                return
            if isinstance(message, Step):
                self._on_step(message)
                continue
            self._on_answer(message)
            with self._lock:
                self._next()

    def _lost(self, pipe: Connection) -> None:
        """The process has ended without being asked to."""
        with self._lock:
            if self._closed or pipe is not self._pipe:
                return
            task = self._running
            self._process, self._pipe = self._launch()
            self._running = None
        if task is not None:
            self._on_answer(Answer(task.number, error="the solver's process ended unexpectedly; solve again"))
        with self._lock:
            if self._running is None:
                self._next()


def work(pipe: Connection, asked: "Synchronized[int]") -> None:
    """What the process does: tasks in, steps and answers out, until the pipe breaks."""
    # A Ctrl-C in the terminal goes to all its processes; the server alone decides.
    if hasattr(os, "setsid"):
        os.setsid()
    if hasattr(os, "nice"):
        os.nice(BEHIND)
    signal.signal(signal.SIGINT, _pass)  # between searches; a search has a handler of its own
    with contextlib.suppress(EOFError, OSError):
        photo, options, depth = pipe.recv()
        _warm()
        solver = TaskSolver(photo, options, depth)
        while True:
            task = pipe.recv()
            pipe.send(solver.answer(task, _teller(task, pipe, asked), _stage_teller(task, pipe)))


def _pass(_number: int, _frame: FrameType | None) -> None:
    """A signal that came too late, or too early: `asked` tells."""


def _warm() -> None:
    """Load what the first task would wait for."""
    for name in LOADED_LATE:
        importlib.import_module(name)


def _teller(task: Task, pipe: Connection, asked: "Synchronized[int]") -> Callable[[Progress], None]:
    def tell(at: Progress) -> None:
        pipe.send(Step(task.number, at))
        if asked.value == task.number:
            signal.raise_signal(signal.SIGINT)

    return tell


def _stage_teller(task: Task, pipe: Connection) -> StageReport:
    return lambda words: pipe.send(Step(task.number, stage=words))


class TaskSolver:
    """Solves tasks of one photo in this process; what two of them have in common is found once."""

    def __init__(self, photo: Photo, options: Options, depth: DepthMap | None = None) -> None:
        """`depth` is a map on the photo's pixels."""
        self._photo, self._options, self._depth = photo, options, depth
        self._prepared: Prepared | None = None
        self._found: FoundLines | None = None  # of the last task

    def answer(self, task: Task, tell: Callable[[Progress], None], on_stage: StageReport = silent) -> Answer:
        """The answer to a task."""
        began = time.monotonic()
        try:
            made = self._made(task, tell, on_stage)
        except ContradictionError as error:
            facts = tuple(told.fact for told in task.corrected.facts if told.fact in error.facts)
            return Answer(task.number, error=str(error), lines=error.lines, crossings=error.crossings, facts=facts)
        except LinecadError as error:
            return Answer(task.number, error=str(error))
        if made.places is not None:
            evidence = made.places.evidence.without_photo()
            made = replace(made, places=replace(made.places, evidence=evidence))
        return Answer(task.number, made, seconds=time.monotonic() - began)

    def _made(self, task: Task, tell: Callable[[Progress], None], on_stage: StageReport) -> Reconstruction:
        prepared = self._prepared
        known = None if prepared is None else prepared.corrected
        if prepared is not None and known is not None and known.differs_in_facts(task.corrected):
            if not prepared.is_for(task.corrected):
                prepared = prepared_for(prepared, self._options, task.corrected, on_stage)
        else:
            found = replace(task.found, pixels=self._photo.pixels)
            same = prepared is not None and self._found is not None and self._found.is_like(found)
            parts = prepared.parts if prepared is not None and same else None
            prepared = prepare(found, self._options, on_stage, task.corrected, self._depth, parts)
        self._prepared, self._found = prepared, task.found
        return reconstruct_prepared(self._photo.name, prepared, self._options, tell, on_stage, task.corrected)
