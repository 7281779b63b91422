"""Locks that one process at a time holds, each in a file that says which one; the system frees them when it ends."""

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
    """The descriptor that holds the lock in the file `path`, made where it is not there; closing it gives it back.

    A process that inherits the descriptor holds the lock too. Raises LinecadError, which begins with `who` works there
    and ends with `advice`, when another process still holds it after `patience` seconds, and OSError where the file or
    the system has no locks.
    """
    end = time.monotonic() + patience
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o666)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
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
    """Hold the lock in the file `path`, which is there only as long. Raises LinecadError as `acquire` does, at once.

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
                path.unlink()  # while it is held, so that it is nobody else's
            os.close(descriptor)


def _is_at(descriptor: int, path: Path) -> bool:
    """Whether the open file still lies at `path`: the process that held it before may have removed it."""
    try:
        return os.path.samestat(os.fstat(descriptor), path.stat(follow_symlinks=False))
    except FileNotFoundError:
        return False
