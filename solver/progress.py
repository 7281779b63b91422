"""What every search shares while it runs: Ctrl-C as an event, and progress that never gets worse."""

import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from solver.options import Progress, relative_gap


@contextmanager
def catch_interrupt() -> Iterator[threading.Event]:
    """While this is open, Ctrl-C sets the event instead of raising; in the main thread, as Python allows no other.

    A process that ignores SIGINT, as shells start it in the background of a script, goes on ignoring it.
    """
    stop = threading.Event()
    is_main = threading.current_thread() is threading.main_thread()
    if not is_main or signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        yield stop
        return
    previous = signal.signal(signal.SIGINT, lambda _number, _frame: stop.set())
    try:
        yield stop
    finally:
        signal.signal(signal.SIGINT, signal.SIG_DFL if previous is None else previous)


class Reporter:
    """Turns what a solver knows into Progress that never gets worse, and passes it on when it has changed."""

    def __init__(
        self, began: float, objective: float, bound: float, on_progress: Callable[[Progress], None] | None
    ) -> None:
        """`began` is the `time.monotonic()` of the start, `objective` and `bound` what is known before the search."""
        self.began = began
        self.objective = objective
        self.bound = bound
        self.nodes = 0
        self.on_progress = on_progress
        self.told: tuple[float, float] | None = None

    def note(self, objective: float, bound: float, nodes: int) -> None:
        """Take over a solver's numbers; where it knows none yet they are infinite, which never wins."""
        self.objective = max(self.objective, objective)
        self.bound = min(self.bound, bound)
        self.nodes = max(self.nodes, nodes)

    def report(self) -> None:
        """Call the callback if the objective or the bound has changed."""
        objective, bound = self.objective, max(self.objective, self.bound)
        if self.told != (objective, bound):
            self.finish(objective, bound)

    def finish(self, objective: float, bound: float) -> None:
        """Call the callback with these numbers."""
        self.told = (objective, bound)
        if self.on_progress is not None:
            seconds = time.monotonic() - self.began
            self.on_progress(Progress(seconds, objective, bound, relative_gap(objective, bound), self.nodes))
