"""A lock on the output folder of a batch, which lasts until the last of its processes is gone."""

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

from linecad.errors import OutputError
from linecad.io.locks import acquire

NAME = "batch.lock"
PATIENCE = 5.0  # s, in which the processes of a batch that was killed have time to die


@contextlib.contextmanager
def locked(folder: Path, patience: float | None = None) -> Iterator[int]:
    """Lock the folder; gives the descriptor that processes must inherit, so that they have the lock too.

    The system frees the lock when the last of them ends, in whatever way. Raises LinecadError when another batch works
    in the folder, and OutputError when the folder cannot be written.
    """
    try:
        descriptor = acquire(
            folder / NAME,
            f"another batch works in {folder}",
            "wait for it, or choose another folder",
            PATIENCE if patience is None else patience,
        )
    except OSError as error:
        raise OutputError(f"{folder} cannot be locked: {error.strerror}; choose another folder") from error
    try:
        yield descriptor
    finally:
        os.close(descriptor)
