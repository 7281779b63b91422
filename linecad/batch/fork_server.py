"""A process that has everything loaded and forks itself for each job: `python -m linecad.batch.fork_server DESCRIPTOR`.

Loading all libraries takes seconds, a fork of them milliseconds, so each photo has a process of its own, with its own
limits, whose death harms no other, and whose memory is gone when it ends. The process at the other end of the pipe
gives the orders:

    ("start", ticket, job)   work on a job
    ("kill", ticket)         end it, if it has not ended yet

and hears ("ready",) once, and for each job ("ended", ticket, outcome or None, status of the process, cpu seconds,
memory in MiB). When that process ends, however it ends, so do this one and all that it forked.
"""

import ctypes
import gc
import importlib
import os
import resource
import signal
import sys
from multiprocessing.connection import Connection, wait
from typing import Any, NoReturn

from linecad.batch.job import Job, Outcome
from linecad.threads import compute_with_one_thread

MIB = 2**20
KILLED_WITH_PARENT = 1  # Linux's PR_SET_PDEATHSIG
# What every conversion needs; the modules of the formats come with the arguments.
NEEDED = (
    "linecad.batch.work",
    "solver.gain.search",
    "solver.paper.search",
    "solver.backends.scip",
    "solver.backends.scip_gain",
)


def main(arguments: list[str]) -> None:
    """Serve the pipe whose descriptor is the first argument; the other arguments are modules to load before."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the process that gives the jobs
    control: Connection[Any, Any] = Connection(int(arguments[0]))
    for name in (*NEEDED, *arguments[1:]):
        importlib.import_module(name)
    compute_with_one_thread()
    gc.freeze()  # what is loaded is never collected, so that its pages stay shared with the forks
    _ForkServer(control).serve()


class _ForkServer:
    """The forked processes, by ticket."""

    def __init__(self, control: "Connection[Any, Any]") -> None:
        self.control = control
        self.processes: dict[int, int] = {}
        self.pipes: dict[Connection[Any, Any], int] = {}

    def serve(self) -> None:
        """Obey the orders from the pipe until it closes."""
        try:
            self.control.send(("ready",))
            while True:
                ready = wait([self.control, *self.pipes])
                if self.control in ready:
                    self._obey(self.control.recv())
                for pipe in [pipe for pipe in self.pipes if pipe in ready]:
                    self._end(self.pipes[pipe], pipe)
        except (EOFError, OSError):  # the other end is gone
            pass
        finally:
            for process in self.processes.values():
                os.kill(process, signal.SIGKILL)
            for process in self.processes.values():
                os.waitpid(process, 0)

    def _obey(self, message: tuple[Any, ...]) -> None:
        if message[0] == "start":
            self._start(message[1], message[2])
        elif message[1] in self.processes:
            os.kill(self.processes[message[1]], signal.SIGKILL)  # not reaped yet, so the number is still its own

    def _start(self, ticket: int, job: Job) -> None:
        read, write = os.pipe()
        parent = os.getpid()
        process = os.fork()
        if process == 0:
            self.control.close()
            os.close(read)
            _work(job, Connection(write, readable=False), parent)
        os.close(write)
        self.processes[ticket] = process
        self.pipes[Connection(read, writable=False)] = ticket

    def _end(self, ticket: int, pipe: "Connection[Any, Any]") -> None:
        """The process of a job has answered or died: in both cases nothing more comes from it."""
        try:
            outcome = pipe.recv()
        except (EOFError, OSError):
            outcome = None
        pipe.close()
        del self.pipes[pipe]
        _, status, usage = os.wait4(self.processes.pop(ticket), 0)
        self.control.send(
            ("ended", ticket, outcome, status, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / _RSS_PER_MIB)
        )


_RSS_PER_MIB = MIB if sys.platform == "darwin" else 1024  # Linux counts kilobytes, macOS bytes


def _work(job: Job, answer: "Connection[Any, Any]", parent: int) -> NoReturn:
    """What a forked process does: it never returns into the loop that it came from."""
    code = 1
    try:
        _die_with(parent)
        _limit(job.limits.memory_mb)
        from linecad.batch.work import do

        outcome: Outcome = do(job)
        answer.send(outcome)
        code = 0
    finally:
        os._exit(code)


def _die_with(parent: int) -> None:
    """On Linux, die when the parent is killed; elsewhere a fork whose parent was killed ends its photo first."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(KILLED_WITH_PARENT, signal.SIGKILL)
        if os.getppid() != parent:
            os._exit(1)


def _limit(memory_mb: int) -> None:
    """From here on an allocation beyond the limit fails, in Python as a MemoryError."""
    kind = resource.RLIMIT_DATA if sys.platform == "linux" else resource.RLIMIT_AS
    _, hard = resource.getrlimit(kind)
    wanted = memory_mb * MIB
    resource.setrlimit(kind, (wanted if hard == resource.RLIM_INFINITY else min(wanted, hard), hard))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # thousands of photos, and no gigabytes of core files


if __name__ == "__main__":
    main(sys.argv[1:])
