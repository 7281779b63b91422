"""A dataset evaluated photo by photo, in one process each, with the same figures whatever their number."""

import signal
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import active_children, get_context

from linecad.errors import LinecadError
from linecad.evaluation.datasets import Case
from linecad.evaluation.measure import PhotoResult, measure_photo
from linecad.evaluation.methods import Settings
from linecad.threads import compute_with_one_thread, start_with_one_thread

PhotoReport = Callable[[int, int, PhotoResult], None]  # how many are done, of how many, the last one


def evaluate(
    cases: tuple[Case, ...], settings: Settings, workers: int, on_photo: PhotoReport | None = None
) -> list[PhotoResult]:
    """Measure all photos, `workers` at a time, in new processes; the results in the order of the cases.

    Raises LinecadError when a process dies, such as for want of memory.
    """
    results: dict[int, PhotoResult] = {}
    others = set(active_children())
    spawn = get_context("spawn")
    with start_with_one_thread(), ProcessPoolExecutor(min(workers, len(cases)), spawn, _set_up) as pool:
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


def _set_up() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the process that waits for this one ends it
    compute_with_one_thread()
