"""From the arguments of `linecad batch` to a plan and an executor for it."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from linecad.batch.inputs import find_photos
from linecad.batch.job import Executor, Limits
from linecad.batch.local import LocalExecutor
from linecad.batch.resources import need_mb, usual_limits, usual_workers
from linecad.batch.run import OnRow, Plan, Result, run_batch
from linecad.convert import Conversion
from linecad.depth.beside import find_maps, photos_alone
from linecad.errors import LinecadError, OutputError

CLUSTER_MEMORY = 2.0  # times what a photo needs is what it may take on machines that we cannot look into


@dataclass(frozen=True)
class Means:
    """With what a batch works; None: as usual."""

    workers: int | None = None
    scheduler: str | None = None  # address of a Dask cluster
    shared_files: bool = False  # the cluster sees the same folders
    photo_limit_s: float | None = None
    memory_limit_mb: int | None = None


def make_plan(
    given: Iterable[str],
    folder: Path,
    suffixes: tuple[str, ...],
    conversion: Conversion,
    means: Means,
    depth_maps: bool = False,
) -> tuple[Plan, int]:
    """The plan of a batch, and its number of workers (0 on a cluster). Makes the output folder.

    With `depth_maps`, photos are given the maps that lie beside them, and maps are no photos. Raises LinecadError where
    a name finds no photo, no photo has such a map, or camera, folder, options or means cannot be used.
    """
    if means.shared_files and means.scheduler is None:
        raise LinecadError("--shared-files says what a cluster sees; name the cluster with --scheduler")
    if means.workers is not None and means.scheduler is not None:
        raise LinecadError("--workers is for this machine; a cluster has the workers that were started in it")
    conversion = conversion.checked(maps_come=depth_maps)
    photos = tuple(find_photos(given, folder))
    maps: dict[Path, Path] = {}
    if depth_maps:
        photos = tuple(photos_alone(photos))
        maps = find_maps(photos)
    _make_folder(folder)
    if means.scheduler is not None:
        workers, memory = 0, round(CLUSTER_MEMORY * need_mb(photos))
        usual = usual_limits(photos, 1, conversion.options.solve.seconds)
    else:
        workers = means.workers or min(usual_workers(photos), len(photos))
        usual = usual_limits(photos, workers, conversion.options.solve.seconds)
        memory = usual.memory_mb
    limits = Limits(means.photo_limit_s or usual.seconds, means.memory_limit_mb or memory)
    return Plan(photos, folder.resolve(), suffixes, conversion, limits, maps), workers


def run_plan(plan: Plan, workers: int, means: Means, on_row: OnRow) -> Result:
    """Run a plan of `make_plan` on this machine or the cluster. Raises LinecadError as `run_batch` does."""
    return run_batch(plan, _starter(plan, workers, means), on_row)


def _starter(plan: Plan, workers: int, means: Means) -> Callable[[int], Executor]:
    if means.scheduler is None:
        return lambda lock: LocalExecutor(workers, plan.suffixes, (lock,))
    address, shared_files = means.scheduler, means.shared_files
    try:
        from linecad.batch.cluster import ClusterExecutor
    except ModuleNotFoundError as error:
        raise LinecadError(
            f"--scheduler needs Dask, and {error.name} is not installed; pip install 'linecad[cluster]'"
        ) from error
    return lambda _lock: ClusterExecutor(address, shared_files)


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{folder} cannot be a folder ({error.strerror}); choose another name") from error
