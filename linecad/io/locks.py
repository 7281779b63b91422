"""Locks between processes: each is a file or a folder that one process at a time has locked, and the system frees it
when that process ends.
"""

import contextlib
import os
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from linecad.errors import LinecadError

if sys.platform != "win32":
    import fcntl

STEP = 0.05  # s between two tries


def acquire(path: Path, who: str, advice: str, patience: float = 0.0) -> int:
    """The descriptor of the file `path`, locked, made where it is not there; closing it frees the lock.

    The file says which process has the lock. A process that inherits the descriptor has the lock too. Raises
    LinecadError, which begins with `who` works there and ends with `advice`, when another process still has it after
    `patience` seconds, and OSError where the file or the system has no locks.
    """
    end = time.monotonic() + patience
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o666)
        try:
            _lock(descriptor, waits=False)
            if _is_at(descriptor, path):
                os.ftruncate(descriptor, 0)
                os.pwrite(descriptor, f"{os.getpid()}\n".encode(), 0)
                return descriptor
        except BlockingIOError:
            if time.monotonic() >= end:
                owner = os.pread(descriptor, 32, 0).decode(errors="replace").strip() or "unknown"
                os.close(descriptor)
                raise LinecadError(f"{who} (process {owner}); {advice}") from None
            time.sleep(STEP)
        except OSError:
            os.close(descriptor)
            raise
        os.close(descriptor)


@contextlib.contextmanager
def alone(path: Path, who: str, advice: str) -> Iterator[None]:
    """Lock the file `path`, which is there only as long. Raises LinecadError as `acquire` does, at once.

    Where no lock can be had, as on Windows and some network disks, nobody is kept out.
    """
    try:
        descriptor = None if sys.platform == "win32" else acquire(path, who, advice)
    except OSError:
        descriptor = None
    try:
        yield
    finally:
        if descriptor is not None:
            with contextlib.suppress(OSError):
                path.unlink()  # while it is locked, so that it is nobody else's
            os.close(descriptor)


@contextlib.contextmanager
def waiting_for(folder: Path) -> Iterator[bool]:
    """Lock a folder, once every other process that does so has left it; no file is made.

    Gives False where no lock can be had, as on Windows and some network disks: others may be at work there.
    """
    try:
        descriptor = os.open(folder, os.O_RDONLY)
    except OSError:
        yield False
        return
    try:
        try:
            _lock(descriptor, waits=True)
            locked = True
        except OSError:
            locked = False
        yield locked
    finally:
        os.close(descriptor)


def _lock(descriptor: int, waits: bool) -> None:
    """Lock an open file, or raise BlockingIOError where another process has it and `waits` is false; OSError."""
    if sys.platform == "win32":  # where not even a folder can be opened
        raise OSError("Windows has no such locks")
    fcntl.flock(descriptor, fcntl.LOCK_EX | (0 if waits else fcntl.LOCK_NB))


def _is_at(descriptor: int, path: Path) -> bool:
    """Whether the open file still lies at `path`: the process that had it before may have removed it."""
    try:
        return os.path.samestat(os.fstat(descriptor), path.stat(follow_symlinks=False))
    except FileNotFoundError:
        return False
