"""A batch: photos through an executor, each with one row in the record, going on where an earlier run was stopped."""

import contextlib
import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path

from exporters.formats import FORMATS
from linecad.batch.inputs import output_names
from linecad.batch.job import THUMBNAILS, Executor, Job, Limits, Outcome
from linecad.batch.lock import locked
from linecad.batch.page import write_page
from linecad.batch.record import NAME, Record, Row, options_hash, settled
from linecad.batch.work import photo_hash
from linecad.convert import Conversion
from linecad.depth.read import check_depth_file
from linecad.errors import LinecadError, OutputError
from linecad.io.files import remove_unfinished

TICK = 0.5  # s between two looks at what else there is to do
LARGEST_LOSSES = 3  # times that a photo is begun again after its executor broke under it


@dataclass(frozen=True)
class Plan:
    """What a batch makes, and where."""

    photos: tuple[Path, ...]  # absolute, each once
    folder: Path
    suffixes: tuple[str, ...]
    conversion: Conversion
    limits: Limits
    maps: Mapping[Path, Path] = field(default_factory=dict)  # the depth map of each photo that has one


@dataclass
class Progress:
    """How far a batch is."""

    total: int
    done: int = 0  # converted in this run
    skipped: int = 0  # done by an earlier run, with the same photo and options
    failed: int = 0
    running: int = 0
    damaged: int = 0  # lines of the record that are not read

    @property
    def over(self) -> int:
        """Photos that need nothing more in this run."""
        return self.done + self.skipped + self.failed


OnRow = Callable[[Progress, Row | None], None]  # the row is that of a photo that has just ended; None now and then


@dataclass(frozen=True)
class Result:
    """The latest row of every photo of the plan, in its order, and how the run went."""

    rows: tuple[Row, ...]
    progress: Progress
    seconds: float


def run_batch(plan: Plan, start: Callable[[int], Executor], on_row: OnRow) -> Result:
    """Convert all photos of the plan that are not done yet. `start` makes the executor; it gets the lock's descriptor.

    Raises LinecadError when another batch works in the folder, the executor cannot be started or reached, or the
    record or the page cannot be written. A photo that fails is a row.
    """
    began = time.monotonic()
    with contextlib.ExitStack() as stack:
        descriptor = stack.enter_context(locked(plan.folder))
        _prepare(plan.folder)
        record = stack.enter_context(Record(plan.folder / NAME))
        run = _Run(plan, record, on_row)
        executor = start(descriptor)
        stack.callback(executor.close)
        try:
            run.work(executor)
        finally:
            write_page(plan.folder, run.result(time.monotonic() - began).rows)
    return run.result(time.monotonic() - began)


def _prepare(folder: Path) -> None:
    """Remove what a killed run left half written, and make the folder of small pictures."""
    thumbnails = folder / THUMBNAILS
    try:
        if thumbnails.is_symlink():
            raise OutputError(f"{thumbnails} is a link, and files would go elsewhere; remove it")
        thumbnails.mkdir(exist_ok=True)
        parts = [place for row in FORMATS.values() for place in row.beside.folders_in(folder)]
        for place in (folder, thumbnails, *parts):
            if not place.is_symlink():
                remove_unfinished(place)
    except OSError as error:
        raise OutputError(f"{folder} cannot be used: {error.strerror}; choose another folder") from error


class _Run:
    """The state of one run."""

    def __init__(self, plan: Plan, record: Record, on_row: OnRow) -> None:
        self.plan, self.record, self.on_row = plan, record, on_row
        self.options = options_hash(plan.conversion, plan.suffixes)
        self.rows = {row.photo: row for row in record.rows}  # later ones stand for earlier ones
        self.names = output_names(plan.photos, {photo: row.name for photo, row in self.rows.items()})
        self.progress = Progress(len(plan.photos), damaged=record.damaged)
        self.by_content: dict[str, list[Row]] = {}
        for row in self.rows.values():
            self.by_content.setdefault(row.sha256, []).append(row)
        self.waiting = deque(plan.photos)
        self.running: dict[int, Job] = {}
        self.losses: dict[Path, int] = {}
        self.tickets = 0

    def work(self, executor: Executor) -> None:
        """Until every photo is over."""
        while self.waiting or self.running:
            while self.waiting and len(self.running) < executor.capacity:
                self._begin(executor, self.waiting.popleft())
                for ticket, outcome in executor.wait(0):
                    self._end(ticket, outcome)
            self._report(None)
            if self.running:
                for ticket, outcome in executor.wait(TICK):
                    self._end(ticket, outcome)

    def result(self, seconds: float) -> Result:
        """What is known by now."""
        rows = [self.rows[str(photo)] for photo in self.plan.photos if str(photo) in self.rows]
        return Result(tuple(rows), self.progress, seconds)

    def _begin(self, executor: Executor, photo: Path) -> None:
        """Give a photo to the executor, unless it is done already or cannot even be read."""
        try:
            job = self._job(photo)
        except LinecadError as error:
            failed = Outcome("failed", str(error))
            depth = str(self.plan.maps.get(photo, ""))
            self._row(Row(str(photo), "", self.options, self.names[photo], failed, depth=depth))
            return
        earlier = self._settled(job)
        if earlier is not None:
            self.rows[str(photo)] = earlier
            self.progress.skipped += 1
            self._report(None)
            return
        self.tickets += 1
        self.running[self.tickets] = job
        executor.submit(self.tickets, job)

    def _job(self, photo: Path) -> Job:
        plan = self.plan
        conversion, options = plan.conversion, self.options
        if photo in plan.maps:
            check_depth_file(plan.maps[photo])  # first, for what is far too large is not even hashed
            conversion = replace(conversion, depth=plan.maps[photo])
            options = options_hash(conversion, plan.suffixes)
        sha256, name = photo_hash(photo), self.names[photo]
        job = Job(photo, sha256, name, plan.folder, plan.suffixes, conversion, plan.limits, options)
        for path in job.places:
            if path.is_symlink():
                raise OutputError(f"{path} is a link, and the file would go elsewhere; remove it")
            for given in job.inputs:
                if path.exists() and path.samefile(given):
                    what = "the photo itself" if given == photo else "the depth map"
                    raise OutputError(f"{path} is {what} and would be lost; choose another folder")
        return job

    def _settled(self, job: Job) -> Row | None:
        """The row that says that this job is done: the photo's own, or that of the same photo before it was moved."""
        own = self.rows.get(str(job.photo))
        for row in [own] if own is not None else self.by_content.get(job.sha256, []):
            is_same = row.sha256 == job.sha256 and row.options == job.options
            was_moved = row is not own and not Path(row.photo).exists()
            if is_same and (row is own or was_moved) and settled(row, self.plan.folder):
                return replace(row, photo=str(job.photo), depth=_depth(job))
        return None

    def _end(self, ticket: int, outcome: Outcome) -> None:
        job = self.running.pop(ticket)
        if outcome.is_lost:
            self.losses[job.photo] = self.losses.get(job.photo, 0) + 1
            if self.losses[job.photo] <= LARGEST_LOSSES:
                self.waiting.appendleft(job.photo)
                return
        self._row(Row(str(job.photo), job.sha256, job.options, job.name, outcome, depth=_depth(job)))

    def _row(self, row: Row) -> None:
        row = replace(row, finished=datetime.now(UTC).isoformat(timespec="seconds"))
        self.record.add(row)
        self.rows[row.photo] = row
        if row.outcome.status == "done":
            self.progress.done += 1
        else:
            self.progress.failed += 1
        self._report(row)

    def _report(self, row: Row | None) -> None:
        self.progress.running = len(self.running)
        self.on_row(self.progress, row)


def _depth(job: Job) -> str:
    """The depth map of a job as its row tells it."""
    return str(job.conversion.depth or "")
