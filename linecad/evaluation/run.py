"""A dataset evaluated photo by photo, in one process each, with the same figures whatever their number."""

import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import active_children, get_context

from linecad.errors import LinecadError
from linecad.evaluation.datasets import Case
from linecad.evaluation.measure import PhotoResult, measure_photo
from linecad.evaluation.methods import Settings
from linecad.threads import THREADS

PhotoReport = Callable[[int, int, PhotoResult], None]  # how many are done, of how many, the last one


def evaluate(
    cases: tuple[Case, ...], settings: Settings, workers: int, on_photo: PhotoReport | None = None
) -> list[PhotoResult]:
    """Measure all photos, `workers` at a time, in new processes; the results in the order of the cases.

    Raises LinecadError when a process dies, such as for want of memory.
    """
    results: dict[int, PhotoResult] = {}
    others = set(active_children())
    with _one_thread(), ProcessPoolExecutor(min(workers, len(cases)), get_context("spawn"), _set_up) as pool:
        pending = {pool.submit(measure_photo, case, settings): index for index, case in enumerate(cases)}
        try:
            for done in as_completed(pending):
                results[pending[done]] = done.result()
                if on_photo is not None:
                    on_photo(len(results), len(cases), done.result())
        except BrokenProcessPool as error:
            raise LinecadError(
                "a process of the evaluation died, perhaps for want of memory; use fewer --workers"
            ) from error
        except BaseException:  # Ctrl-C above all: nobody waits for the photos that are being measured
            pool.shutdown(wait=False, cancel_futures=True)
            for process in set(active_children()) - others:
                process.terminate()
            raise
    return [results[index] for index in range(len(cases))]


@contextmanager
def _one_thread() -> Iterator[None]:
    """Processes that start in here compute with one thread each.

    Several would fight for the cores, and sums would come out in another order.
    """
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def _set_up() -> None:
    import cv2

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the process that waits for this one ends it
    cv2.setNumThreads(1)
    cv2.ocl.setUseOpenCL(False)
