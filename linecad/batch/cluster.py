"""The executor of a Dask cluster: jobs go to the scheduler, files by a folder that all see or as bytes with the job."""

import contextlib
import queue
import time
import uuid
from typing import Any

import dask
from distributed import Client, Future
from distributed.scheduler import KilledWorker

from linecad import __version__
from linecad.batch import remote
from linecad.batch.job import Job, Outcome
from linecad.errors import LinecadError, OutputError
from linecad.io.files import write_bytes_atomically

CONNECT_SECONDS = 30.0
SIZE_SECONDS = 5.0  # how long the number of the cluster's threads is taken to stay what it was
AHEAD = 0.1  # share of the threads for which a photo waits at the scheduler, so that none of them idles
# Photos travel inside their tasks; Dask advises against that because it expects them to be used again.
LARGE_TASKS = {"distributed.admin.large-graph-warning-threshold": "100GB"}


class ClusterExecutor:
    """Photos on the workers of a Dask scheduler at `address`, one a thread.

    With `shared_files` the workers read and write the same paths as this process; otherwise photos and results travel
    as bytes. Raises LinecadError where the scheduler cannot be reached or its workers have no linecad, or another one.
    """

    def __init__(self, address: str, shared_files: bool) -> None:
        self._shared_files = shared_files
        self._answers: queue.SimpleQueue[tuple[int, Future[Any] | Outcome]] = queue.SimpleQueue()
        self._running: dict[int, tuple[Job, Future[Any]]] = {}
        self._threads, self._counted = 1, float("-inf")
        self._batch = uuid.uuid4().hex
        try:
            self._client = Client(address, timeout=CONNECT_SECONDS, set_as_default=False)
        except (OSError, TimeoutError, ValueError) as error:
            raise LinecadError(
                f"no Dask scheduler answers at {address} ({_reason(error)}); check its address"
            ) from error
        try:
            self._check_workers()
        except BaseException:
            self.close()
            raise

    @property
    def capacity(self) -> int:
        """A photo for each thread of the cluster as it is now, and a few that wait there."""
        if time.monotonic() - self._counted > SIZE_SECONDS:
            self._threads = sum(self._asked(self._client.nthreads).values())
            self._counted = time.monotonic()
        return self._threads + max(round(AHEAD * self._threads), 1)

    def submit(self, ticket: int, job: Job) -> None:
        """Send a job to the scheduler."""
        try:
            parcel = None if self._shared_files else _packed(job)
        except OSError as error:  # a file went after its hash was taken
            name = error.filename or job.photo
            gone = Outcome("failed", f"{name} cannot be read: {error.strerror}; check its permissions")
            self._answers.put((ticket, gone))
            return
        with dask.config.set(LARGE_TASKS):
            future = self._client.submit(
                remote.work, job, parcel, __version__, key=f"linecad-{self._batch}-{ticket}", pure=False
            )
        self._running[ticket] = (job, future)
        future.add_done_callback(lambda done: self._answers.put((ticket, done)))

    def wait(self, seconds: float) -> list[tuple[int, Outcome]]:
        """Jobs that have ended, after at most `seconds`."""
        ended: list[tuple[int, Outcome]] = []
        end = time.monotonic() + seconds
        while True:
            try:
                ticket, answer = self._answers.get(timeout=0 if ended else max(end - time.monotonic(), 0))
            except queue.Empty:
                if self._client.status not in ("running", "connecting"):
                    raise LinecadError(
                        "the connection to the Dask scheduler was lost; run the batch again, and it goes on"
                    ) from None
                return ended
            ended.append((ticket, self._outcome(ticket, answer)))

    def close(self) -> None:
        """Leave the cluster; it drops the photos that it has not begun."""
        self._running.clear()
        self._client.close(timeout=CONNECT_SECONDS)

    def _outcome(self, ticket: int, answer: "Future[Any] | Outcome") -> Outcome:
        if isinstance(answer, Outcome):
            return answer
        job, _ = self._running.pop(ticket)
        if answer.status == "finished":
            outcome: Outcome
            outcome, files = self._asked(answer.result)
            try:
                _unpack(job, files)
            except OutputError as unwritten:
                return Outcome("failed", str(unwritten))
            return outcome
        if answer.status in ("cancelled", "lost"):
            return Outcome("killed", "the cluster dropped the photo; run the batch again", is_lost=True)
        broken = self._asked(answer.exception)
        if isinstance(broken, KilledWorker):
            return Outcome("killed", "the workers of the cluster that took the photo died; look into their logs")
        return Outcome("failed", f"a worker of the cluster broke on this photo: {_reason(broken)}")

    def _check_workers(self) -> None:
        """Raise LinecadError where a worker has no linecad or another version; those that come later say so by job."""
        found = self._asked(self._client.run, remote.version, on_error="return")
        for worker, answer in found.items():
            if answer != __version__:
                what = _reason(answer) if isinstance(answer, BaseException) else f"linecad {answer}"
                raise LinecadError(f"the Dask worker {worker} has not linecad {__version__}: {what}; install it there")

    def _asked(self, question: Any, *arguments: Any, **more: Any) -> Any:
        """The scheduler's answer; LinecadError when the connection is gone."""
        try:
            return question(*arguments, **more)
        except (OSError, TimeoutError) as error:
            raise LinecadError(
                f"the connection to the Dask scheduler was lost ({_reason(error)}); run the batch again, and it goes on"
            ) from error


def _packed(job: Job) -> remote.Parcel:
    camera = job.conversion.camera
    photo, *maps = job.inputs
    depth = {file.name: file.read_bytes() for file in maps}
    return remote.Parcel(photo.read_bytes(), None if camera is None else camera.read_bytes(), depth)


def _unpack(job: Job, files: dict[str, bytes]) -> None:
    """Write what came back. Only files that the job may make are written, whatever names the worker gives."""
    for file, data in files.items():
        path = job.folder / file
        if not job.may_make(file):
            raise OutputError(f"a worker of the cluster sent {path.name!r}, no file of this photo; look into its logs")
        with contextlib.suppress(OSError):  # the writing says what is wrong
            path.parent.mkdir(exist_ok=True)
        write_bytes_atomically(path, data)


def _reason(error: BaseException | None) -> str:
    return " ".join(str(error).split()) or type(error).__name__
