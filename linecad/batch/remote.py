"""What a machine of a cluster does with a job: the same as this machine, by the executor of `local`."""

import os
import tempfile
import threading
from dataclasses import dataclass, replace
from pathlib import Path

from linecad import __version__
from linecad.batch.job import THUMBNAILS, Job, Outcome
from linecad.batch.local import LocalExecutor

PATIENCE = 60.0  # s between two looks at a job; its own limit ends it
_THREAD = threading.local()  # each thread of a worker of the cluster has an executor for one photo at a time


@dataclass(frozen=True)
class Parcel:
    """The files of a job, for machines that do not see the folders of the one that sends it."""

    photo: bytes
    camera: bytes | None
    depth: dict[str, bytes]  # by name, the depth map and the files beside it that are read with it


def version() -> str:
    """The linecad of the machine that this runs on."""
    return __version__


def work(job: Job, parcel: Parcel | None, version_asked: str) -> tuple[Outcome, dict[str, bytes]]:
    """Do a job; with a parcel in a folder of this machine, and the files that were made come back with the outcome."""
    if version_asked != __version__:
        return Outcome("failed", f"a machine of the cluster has linecad {__version__}, not {version_asked}"), {}
    if parcel is None:
        return _do(job), {}
    with tempfile.TemporaryDirectory(prefix="linecad-") as name:
        return _unpacked(job, parcel, Path(name))


def _unpacked(job: Job, parcel: Parcel, folder: Path) -> tuple[Outcome, dict[str, bytes]]:
    photo = folder / "photo" / job.photo.name  # scenes and pictures name the photo
    output, maps = folder / "made", folder / "depth"
    for place in (photo.parent, output / THUMBNAILS, maps):
        place.mkdir(parents=True)
    photo.write_bytes(parcel.photo)
    conversion = job.conversion
    if parcel.camera is not None:
        camera = folder / "camera.json"
        camera.write_bytes(parcel.camera)
        conversion = replace(conversion, camera=camera)
    if conversion.depth is not None:
        for file, data in parcel.depth.items():
            (maps / file).write_bytes(data)
        conversion = replace(conversion, depth=maps / conversion.depth.name)
    outcome = _do(replace(job, photo=photo, folder=output, conversion=conversion))
    files = {file: (output / file).read_bytes() for file in outcome.files}
    return outcome, files


def _do(job: Job) -> Outcome:
    executor = _executor(job.suffixes)
    executor.submit(0, job)
    while True:
        for _, outcome in executor.wait(PATIENCE):
            return outcome


def _executor(suffixes: tuple[str, ...]) -> LocalExecutor:
    """This thread's executor, with what these formats need loaded. It ends with the process of the worker."""
    known: tuple[int, tuple[str, ...], LocalExecutor] | None = getattr(_THREAD, "executor", None)
    if known is not None and known[:2] == (os.getpid(), suffixes):
        return known[2]
    if known is not None and known[0] == os.getpid():
        known[2].close()
    executor = LocalExecutor(1, suffixes)
    _THREAD.executor = (os.getpid(), suffixes, executor)
    return executor
