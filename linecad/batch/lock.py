"""A lock on the output folder of a batch, held until the last of its processes is gone."""

import contextlib
import os
import time
from collections.abc import Iterator
from pathlib import Path

from linecad.errors import LinecadError, OutputError

NAME = "batch.lock"
PATIENCE = 5.0  # s, in which the processes of a batch that was killed have time to die
STEP = 0.05  # s


@contextlib.contextmanager
def locked(folder: Path, patience: float | None = None) -> Iterator[int]:
    """Hold the lock; gives the descriptor that processes must inherit, so that they hold it too.

    The system frees the lock when the last of them ends, in whatever way. Raises LinecadError when another batch works
    in the folder, and OutputError when the folder cannot be written.
    """
    import fcntl  # no such module on Windows, where no batch runs either (linecad.batch.local)

    path = folder / NAME
    try:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o666)
    except OSError as error:
        raise OutputError(f"{path} cannot be opened: {error.strerror}; choose another folder") from error
    try:
        end = time.monotonic() + (PATIENCE if patience is None else patience)
        while True:
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                if time.monotonic() >= end:
                    owner = os.pread(descriptor, 32, 0).decode(errors="replace").strip() or "unknown"
                    raise LinecadError(
                        f"another batch works in {folder} (process {owner}); wait for it, or choose another folder"
                    ) from None
                time.sleep(STEP)
            except OSError as error:
                raise OutputError(f"{folder} cannot be locked: {error.strerror}; choose another folder") from error
        os.ftruncate(descriptor, 0)
        os.pwrite(descriptor, f"{os.getpid()}\n".encode(), 0)
        yield descriptor
    finally:
        os.close(descriptor)
