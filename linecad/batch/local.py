"""The executor of this machine: each photo in a process of its own, with limits of time and memory."""

import contextlib
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable
from dataclasses import dataclass, replace
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from exporters.formats import FORMATS
from linecad.batch.job import Job, Outcome, Status
from linecad.errors import LinecadError
from linecad.threads import ONE_THREAD

START_SECONDS = 300.0  # in which all libraries are loaded, from a network disk that is busy too
END_SECONDS = 10.0


@dataclass
class _Running:
    job: Job
    started: float  # time.monotonic()
    is_overdue: bool = False


class LocalExecutor:
    """Up to `workers` photos at a time. `inherited` descriptors stay open in all processes, until the last has ended.

    Raises LinecadError where its processes cannot be started, and on systems that cannot fork.
    """

    def __init__(self, workers: int, suffixes: Iterable[str], inherited: tuple[int, ...] = ()) -> None:
        if not hasattr(os, "fork"):
            raise LinecadError("linecad batch needs a system that can fork processes, such as Linux or macOS")
        self._workers = workers
        self._modules = sorted({FORMATS[suffix].module for suffix in suffixes if suffix in FORMATS})
        self._inherited = inherited
        self._running: dict[int, _Running] = {}
        self._process: subprocess.Popen[bytes] | None = None
        self._control: Connection[Any, Any] | None = None
        self._start()

    @property
    def capacity(self) -> int:
        """How many photos are worked on at a time."""
        return self._workers

    def submit(self, ticket: int, job: Job) -> None:
        """Start to work on a job."""
        if self._control is None:
            self._start()
        self._running[ticket] = _Running(job, time.monotonic())
        with contextlib.suppress(OSError):  # the fork server is gone: `wait` notices, and answers for every job
            self._send(("start", ticket, job))

    def wait(self, seconds: float) -> list[tuple[int, Outcome]]:
        """Jobs that have ended, after at most `seconds`."""
        end = time.monotonic() + seconds
        while True:
            self._kill_overdue()
            deadlines = [run.started + run.job.limits.seconds for run in self._running.values() if not run.is_overdue]
            until = min([end, *deadlines])
            try:
                ended = self._receive(max(until - time.monotonic(), 0))
            except (EOFError, OSError):
                return self._all_lost()
            if ended or time.monotonic() >= end:
                return ended

    def close(self) -> None:
        """End all processes; returns when they are gone."""
        if self._control is not None:
            self._control.close()
            self._control = None
        if self._process is not None:
            try:
                self._process.wait(END_SECONDS)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
            self._process = None
        self._running.clear()

    def _start(self) -> None:
        """Start the fork server and wait until it has loaded everything."""
        ours, theirs = Pipe()
        command = [sys.executable, "-m", "linecad.batch.fork_server", str(theirs.fileno()), *self._modules]
        # The packages are found there as they were found here, also where the working folder made the difference.
        path = os.pathsep.join(path or str(Path.cwd()) for path in sys.path)
        environment = {**os.environ, **ONE_THREAD, "PYTHONPATH": path}
        with theirs, tempfile.TemporaryFile() as errors:
            self._process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=errors, env=environment,
                pass_fds=(theirs.fileno(), *self._inherited), start_new_session=True,
            )  # fmt: skip
            theirs.close()
            self._control = ours
            try:
                is_ready = ours.poll(START_SECONDS) and ours.recv() == ("ready",)
            except (EOFError, OSError):
                is_ready = False
            if not is_ready:
                self._process.kill()
                self.close()
                errors.seek(0)
                lines = errors.read().decode(errors="replace").splitlines() or ["no reason was given"]
                raise LinecadError(f"the processes of the batch cannot be started: {lines[-1]}; check the installation")

    def _send(self, message: tuple[Any, ...]) -> None:
        if self._control is not None:
            self._control.send(message)

    def _receive(self, seconds: float) -> list[tuple[int, Outcome]]:
        """All answers that are there, or come within `seconds`."""
        ended: list[tuple[int, Outcome]] = []
        if self._control is None:
            return ended
        while self._control.poll(0 if ended else seconds):
            try:
                _, ticket, outcome, status, cpu_seconds, memory_mb = self._control.recv()
            except (EOFError, OSError):
                if ended:  # what was heard before the end counts; the next call meets the end again
                    return ended
                raise
            run = self._running.pop(ticket)
            answer = outcome if outcome is not None else _died(run, status, memory_mb)
            elapsed = time.monotonic() - run.started
            ended.append((ticket, replace(answer, seconds=elapsed, cpu_seconds=cpu_seconds, memory_mb=memory_mb)))
        return ended

    def _kill_overdue(self) -> None:
        now = time.monotonic()
        for ticket, run in self._running.items():
            if not run.is_overdue and now - run.started >= run.job.limits.seconds:
                run.is_overdue = True
                self._send(("kill", ticket))

    def _all_lost(self) -> list[tuple[int, Outcome]]:
        """The fork server is gone, and with it everything that was being worked on; the next job starts another one."""
        lost = Outcome("killed", "the process that all others come from was killed; run the batch again", is_lost=True)
        tickets = list(self._running)
        self.close()
        return [(ticket, lost) for ticket in tickets]


def _died(run: _Running, status: int, memory_mb: float) -> Outcome:
    """The outcome of a job whose process ended without an answer; `status` as os.wait tells it."""
    if run.is_overdue:
        limit = run.job.limits.seconds
        return Outcome("time limit", f"stopped after {limit:g} s; raise --photo-limit, or lower --time-limit")
    status_word: Status = "killed"
    if os.WIFSIGNALED(status):
        number = os.WTERMSIG(status)
        how = f"was ended by {signal.Signals(number).name if number in set(signal.Signals) else f'signal {number}'}"
    else:
        how = f"ended with code {os.waitstatus_to_exitcode(status)}"
    return Outcome(
        status_word,
        f"its process {how} with {memory_mb:.0f} MiB of {run.job.limits.memory_mb} MiB; "
        "if memory ran out, use fewer --workers or smaller photos",
    )
