"""One job done in this process, and the answer to everything that can go wrong in it."""

import hashlib
import math
import traceback
from pathlib import Path

from exporters.formats import SCENE_FILE
from linecad.batch.job import Figures, Job, Outcome
from linecad.batch.record import options_hash
from linecad.batch.thumbnail import write_thumbnail
from linecad.camera.photo import Photo
from linecad.errors import InputError, LinecadError, OutputError, PhotoError, UnwrittenError
from linecad.outputs import write_outputs
from linecad.scene import Scene

OUT_OF_MEMORY = ("std::bad_alloc", "Insufficient memory")  # as OpenCV says it, from C++ and from its own allocator


def do(job: Job) -> Outcome:
    """Convert the photo of a job. Never raises: a photo that breaks something is a row, not the end of the batch."""
    try:
        return _do(job)
    except LinecadError as error:
        return Outcome("failed", str(error))
    except Exception as error:
        if isinstance(error, MemoryError) or any(words in str(error) for words in OUT_OF_MEMORY):
            return Outcome("memory limit", f"more than {job.limits.memory_mb} MiB were needed; raise --memory-limit")
        return Outcome("failed", _unexpected(error))


def photo_hash(path: Path) -> str:
    """SHA-256 of a photo's bytes as 64 hexadecimal digits; PhotoError when it cannot be read."""
    try:
        if not path.is_file():  # a pipe would never end
            raise PhotoError(f"{path} is {'not a file' if path.exists() else 'no longer there'}; give photos")
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise PhotoError(f"{path} cannot be read ({error.strerror}); check its permissions") from error


def _do(job: Job) -> Outcome:
    if photo_hash(job.photo) != job.sha256:
        raise PhotoError(f"{job.photo} was changed while the batch was running; run it again")
    if options_hash(job.conversion, job.suffixes) != job.options:
        given = [str(path) for path in (job.conversion.camera, job.conversion.depth) if path is not None]
        raise InputError(f"{' or '.join(given)} was changed while the batch was running; run it again")
    photo = job.conversion.read(job.photo)
    try:
        scene = job.conversion.reconstruct(photo, None, lambda _stage: None)
    except LinecadError as error:
        _write_thumbnail(job, photo, None)
        return Outcome("failed", str(error), files=_sizes(job, [job.thumbnail]))
    try:
        wanted = job.conversion.wanted.of(scene)
    except LinecadError as error:
        return _kept(job, photo, scene, error)
    try:
        write_outputs(wanted, photo.pixels, job.outputs, job.conversion.values)
    except UnwrittenError as error:
        return _without(job, photo, wanted, error)
    _write_thumbnail(job, photo, wanted)
    return Outcome("done", figures=_figures(wanted), files=_sizes(job, job.made()))


def _kept(job: Job, photo: Photo, scene: Scene, error: LinecadError) -> Outcome:
    """What was wanted of a scene is not in it: its file, if the batch makes one, holds all of it."""
    files = [path for path in job.outputs if path.suffix == SCENE_FILE]
    write_outputs(scene, photo.pixels, files, {})
    _write_thumbnail(job, photo, scene)
    return Outcome("failed", f"{error}{_told('whole scene', files)}", files=_sizes(job, [*files, job.thumbnail]))


def _without(job: Job, photo: Photo, scene: Scene, error: UnwrittenError) -> Outcome:
    """Some outputs cannot be written: the others are there, the scene file among them if the batch makes one."""
    files = job.made(error.unwritten)
    try:
        _write_thumbnail(job, photo, scene)
    except OutputError:  # a disk that is full takes no picture either, and `error` says so
        files.remove(job.thumbnail)
    kept = [path for path in job.outputs if path.suffix == SCENE_FILE and path in files]
    return Outcome("failed", f"{error}{_told('scene', kept)}", files=_sizes(job, files))


def _told(what: str, files: list[Path]) -> str:
    """Where the scene of a photo that failed is kept, if it is."""
    return f"; the {what} is kept in {files[0].name}, for linecad export" if files else ""


def _write_thumbnail(job: Job, photo: Photo, scene: Scene | None) -> None:
    write_thumbnail(job.thumbnail, photo.pixels, scene)


def _sizes(job: Job, files: list[Path]) -> dict[str, int]:
    return {file.relative_to(job.folder).as_posix(): file.stat().st_size for file in files}


def _figures(scene: Scene) -> Figures:
    gap = scene.solve.gap
    return Figures(
        lines=len(scene.lines),
        crossings=len(scene.intersections),
        real=int(scene.intersections.real.sum()),
        planes=len(scene.planes),
        faces=sum(len(plane.faces) for plane in scene.planes),
        gap=float(gap) if math.isfinite(gap) else None,
        solver=scene.solve.status,
        notes=scene.remarks,
        camera=None if scene.certainty is None else scene.certainty.quality,
    )


def _unexpected(error: Exception) -> str:
    """An error that no user can act on, in one line, with the place in our code that a report needs."""
    frames = traceback.extract_tb(error.__traceback__)
    place = f" at {Path(frames[-1].filename).name}:{frames[-1].lineno}" if frames else ""
    text = " ".join(str(error).split())
    return f"linecad broke on this photo ({type(error).__name__}{place}: {text}); please report it"
