"""Which tab of the browser edits: the first one that said hello, until it falls silent or another takes over."""

import threading
from collections.abc import Callable

SILENCE_S = 15.0  # after which a tab counts as closed; the page says hello every five seconds


class Tabs:
    """The tab that owns the page."""

    def __init__(self, clock: Callable[[], float]) -> None:
        """`clock` in seconds, from anywhere on."""
        self._clock = clock
        self._lock = threading.Lock()
        self._owner = ""
        self._heard = 0.0

    def leave(self, tab: str) -> None:
        """This tab closes, or is loaded again: nobody has to wait for its silence."""
        with self._lock:
            if tab == self._owner:
                self._owner = ""

    def hello(self, tab: str, takes_over: bool) -> bool:
        """Whether this tab, by its name, is the owner now."""
        with self._lock:
            now = self._clock()
            if takes_over or not self._owner or now - self._heard > SILENCE_S:
                self._owner = tab
            if tab == self._owner:
                self._heard = now
            return tab == self._owner
