"""What changes saved as it changes: at once, whole or not at all, by a thread that never delays the page."""

import threading
import time
from collections.abc import Callable
from typing import Generic, TypeVar

from linecad.errors import OutputError

State = TypeVar("State")

RETRY_S = 1.0  # after a failure, such as on a full disk


class Saver(Generic[State]):
    """Writes the newest state; one that is overtaken while another save runs is never written."""

    def __init__(self, write: Callable[[State], None]) -> None:
        """`write` may raise OutputError; then the state is tried again."""
        self._write = write
        self._changed = threading.Condition()
        self._newest: State | None = None
        self._closed = False
        self._error = ""
        self._thread = threading.Thread(target=self._run, name="saving", daemon=True)
        self._thread.start()

    @property
    def is_saved(self) -> bool:
        """Whether the newest state is on the disk."""
        with self._changed:
            return self._newest is None

    @property
    def error(self) -> str:
        """Why it is not, if the last try failed."""
        return self._error

    def save(self, state: State) -> None:
        """Write this soon."""
        with self._changed:
            self._newest = state
            self._changed.notify()

    def close(self) -> None:
        """Return when everything is written, or was tried once more; OutputError when that failed."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        self._thread.join()
        if self._newest is not None:
            raise OutputError(self._error)

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._newest is not None or self._closed)
                newest = self._newest
                if newest is None:
                    return
            try:
                self._write(newest)
            except OutputError as error:
                self._error = str(error)
                if self._closed:
                    return
                time.sleep(RETRY_S)
                continue
            with self._changed:
                self._error = ""
                if self._newest is newest:
                    self._newest = None
