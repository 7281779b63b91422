"""How many threads a process computes with.

Where several processes work at a time, each computes with one thread: more would fight for the cores, and sums would
come out in another order. Libraries of linear algebra read the environment when they are loaded, so that has to be
set before the process starts; OpenCV is told in the process itself.
"""

import contextlib
import os
from collections.abc import Iterator

THREADS = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
    "NUMEXPR_NUM_THREADS",
)
ONE_THREAD = dict.fromkeys(THREADS, "1")  # what the environment of a process of one thread has


def thread_count() -> int:
    """As many as this process may use: OMP_NUM_THREADS where that is set, as by runs of many photos, else the cores."""
    asked = os.environ.get(THREADS[0], "")
    return max(1, int(asked)) if asked.isdigit() else os.cpu_count() or 1


@contextlib.contextmanager
def start_with_one_thread() -> Iterator[None]:
    """Processes that start in here have ONE_THREAD, also where no environment can be given, as to multiprocessing.

    Not for use by several threads at a time: they have one environment.
    """
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(ONE_THREAD)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def compute_with_one_thread() -> None:
    """What a process that has ONE_THREAD must do as well: OpenCV and OpenCL do not read the environment."""
    import cv2

    cv2.setNumThreads(1)
    cv2.ocl.setUseOpenCL(False)
