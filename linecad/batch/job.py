"""A job, its outcome, and what an executor of jobs can do: what passes between the parts of a batch."""

from collections.abc import Collection
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, Protocol, get_args

from exporters.beside import Beside
from exporters.formats import FORMATS
from linecad.convert import Conversion
from linecad.depth.read import files_of_map
from linecad.scene import Quality

# done; failed: an error, or a fault of linecad; time limit, memory limit: of the photo; killed: its process died.
Status = Literal["done", "failed", "time limit", "memory limit", "killed"]
STATUSES: tuple[Status, ...] = get_args(Status)

THUMBNAILS = "thumbnails"  # folder in the output folder


@dataclass(frozen=True)
class Limits:
    """What the process of one photo may take."""

    seconds: float  # from its start; the time limit of the solver is another one, in the conversion
    memory_mb: int  # MiB of writable memory, the libraries included


@dataclass(frozen=True)
class Job:
    """One photo to convert. Picklable: it travels to the process, or the machine, that works on it."""

    photo: Path
    sha256: str  # of the photo's bytes
    name: str  # without suffix, of the files made of it
    folder: Path  # where they go
    suffixes: tuple[str, ...]
    conversion: Conversion  # with the photo's own depth map, if it has one
    limits: Limits
    options: str  # hash of everything else that decides what is made of it (linecad.batch.record.options_hash)

    @property
    def inputs(self) -> list[Path]:
        """The files of this one photo that are read."""
        depth = self.conversion.depth
        return [self.photo, *([] if depth is None else files_of_map(depth))]

    @property
    def outputs(self) -> list[Path]:
        """The files of the photo's scene."""
        return [self.folder / f"{self.name}{suffix}" for suffix in self.suffixes]

    @property
    def places(self) -> list[Path]:
        """Every file and folder that the job may make or change."""
        beside = [place for path, row in self._exports() for place in row.places(path)]
        return [*beside, *self.outputs, self.thumbnail]

    def made(self, unwritten: Collection[Path] = ()) -> list[Path]:
        """All files of the photo that are there: what others refer to comes first.

        Outputs that are `unwritten` are not among them, whatever an earlier batch left there and beside them.
        """
        beside = [file for path, row in self._exports() if path not in unwritten for file in row.found(path)]
        return [*beside, *(path for path in self.outputs if path not in unwritten), self.thumbnail]

    def may_make(self, file: str) -> bool:
        """Whether a file, relative to the folder, is one that this job may make."""
        path = self.folder / file
        return path in (*self.outputs, self.thumbnail) or any(row.allows(out, path) for out, row in self._exports())

    def _exports(self) -> list[tuple[Path, Beside]]:
        """The outputs beside which other files may lie, with what may: not the scene file."""
        return [
            (path, FORMATS[suffix].beside)
            for path, suffix in zip(self.outputs, self.suffixes, strict=True)
            if suffix in FORMATS
        ]

    @property
    def thumbnail(self) -> Path:
        """The small picture for the page: the photo, and beside it its lines if there are any."""
        return self.folder / THUMBNAILS / f"{self.name}.jpg"


@dataclass(frozen=True)
class Figures:
    """The figures of a scene that the record keeps."""

    lines: int
    crossings: int
    real: int  # of the crossings
    planes: int
    faces: int
    gap: float | None  # of the solver, relative; None where it proved no bound
    solver: str  # its status
    notes: tuple[str, ...] = ()
    camera: Quality | None = None  # how sure the camera is; None in records that do not tell


@dataclass(frozen=True)
class Outcome:
    """What came of a job."""

    status: Status
    error: str = ""  # one line; empty when done
    seconds: float = 0.0  # wall clock, of the process
    cpu_seconds: float = 0.0
    memory_mb: float = 0.0  # MiB, the most that the process had resident
    figures: Figures | None = None  # where there is a scene
    files: dict[str, int] = field(default_factory=dict)  # made files, relative to the folder: size in bytes
    is_lost: bool = False  # killed together with its executor, through no fault of the photo


class Executor(Protocol):
    """Works on several jobs at a time. A job that it took has exactly one outcome, whatever happens to its process."""

    @property
    def capacity(self) -> int:
        """How many jobs may be with the executor at a time."""

    def submit(self, ticket: int, job: Job) -> None:
        """Take a job; `ticket` names it in the answer."""

    def wait(self, seconds: float) -> list[tuple[int, Outcome]]:
        """Jobs that have ended, after at most `seconds`; soon, when there is one."""

    def close(self) -> None:
        """End at once; what is being worked on has no outcome."""
