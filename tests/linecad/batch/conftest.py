"""Photos for batches: small ones that convert in half a second, and an executor that needs no process."""

import hashlib
from pathlib import Path

import cv2
import pytest

from linecad.batch.job import THUMBNAILS, Figures, Job, Limits, Outcome
from linecad.batch.record import options_hash
from linecad.batch.run import Plan
from linecad.convert import Conversion
from linecad.options import Options
from solver.options import SolveOptions

SAMPLES = Path(__file__).resolve().parents[3] / "samples"
WIDTH = 320  # px


@pytest.fixture(scope="session")
def small_photo(tmp_path_factory):
    """A sample photo scaled down, as a file."""
    path = tmp_path_factory.mktemp("photo") / "room.png"
    photo = cv2.imread(str(SAMPLES / "room.jpg"))
    height = WIDTH * photo.shape[0] // photo.shape[1]
    cv2.imwrite(str(path), cv2.resize(photo, (WIDTH, height), interpolation=cv2.INTER_AREA))
    return path


@pytest.fixture
def survey(tmp_path, small_photo):
    """A function that makes a folder of so many photos, all alike to look at, none the same bytes."""

    def make(count):
        folder = tmp_path / "survey"
        folder.mkdir(exist_ok=True)
        for number in range(count):
            (folder / f"p{number:02d}.png").write_bytes(small_photo.read_bytes() + bytes([number]))
        return folder

    return make


@pytest.fixture
def output(tmp_path):
    """The output folder."""
    folder = tmp_path / "out"
    folder.mkdir()
    return folder


@pytest.fixture
def conversion():
    """A quick conversion."""
    return Conversion(focal=300.0, options=Options(solve=SolveOptions(time_limit_s=30.0)))


@pytest.fixture
def plan_of(output, conversion):
    """A function that makes a plan of photos with scene files alone."""

    def make(photos, **changes):
        plan = {
            "photos": tuple(photos), "folder": output, "suffixes": (".json",), "conversion": conversion,
            "limits": Limits(100.0, 2048),
        }  # fmt: skip
        return Plan(**{**plan, **changes})

    return make


@pytest.fixture
def job_of(output, conversion):
    """A function that makes a job of a photo, as a batch does."""

    def make(photo, suffixes=(".json",), seconds=100.0, memory_mb=2048, conversion=conversion):
        (output / THUMBNAILS).mkdir(exist_ok=True)
        digest, options = hashlib.sha256(photo.read_bytes()).hexdigest(), options_hash(conversion, suffixes)
        return Job(photo, digest, photo.stem, output, suffixes, conversion, Limits(seconds, memory_mb), options)

    return make


class FakeExecutor:
    """Answers at once: done, with a file that holds the photo's hash, or what `answers` has for a name."""

    capacity = 2

    def __init__(self, answers=None):
        self.answers = answers or {}
        self.taken = []
        self.jobs = []
        self.ended = []
        self.is_closed = False

    def submit(self, ticket, job):
        self.taken.append(job.photo.name)
        self.jobs.append(job)
        answer = self.answers.get(job.photo.name)
        if isinstance(answer, list):
            answer = answer.pop(0) if answer else None
        if answer is None:
            files = {f"{job.name}.json": job.sha256, f"{THUMBNAILS}/{job.name}.jpg": "picture"}
            for name, text in files.items():
                (job.folder / name).write_text(text)
            figures = Figures(20, 30, 25, 4, 5, 0.0, "optimal", ("a note",))
            answer = Outcome("done", "", 2.0, 1.0, 200.0, figures, {name: len(text) for name, text in files.items()})
        self.ended.append((ticket, answer))

    def wait(self, _seconds):
        ended, self.ended = self.ended, []
        return ended

    def close(self):
        self.is_closed = True


@pytest.fixture
def fake():
    """The class of executors that need no process."""
    return FakeExecutor
