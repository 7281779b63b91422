"""The process that solves for the page, by itself."""

import threading
import time

from linecad.editing.solving import SolvingProcess
from linecad.options import Options


def test_the_pipe_is_closed_by_the_thread_that_listens_to_it(made_photo):
    """Closed by another one, it once broke in the middle of a read: TypeError in place of an end."""
    solver = SolvingProcess(made_photo, Options(), lambda _: None, lambda _: None)
    pipe, closing = solver._pipe, solver._pipe.close
    closed_by = []

    def close():
        closed_by.append(threading.current_thread().name)
        closing()

    pipe.close = close
    solver.close()
    end = time.monotonic() + 60
    while not pipe.closed:
        assert time.monotonic() < end, "nobody closes the pipe"
        time.sleep(0.01)
    assert closed_by == ["answers of the solver"]
