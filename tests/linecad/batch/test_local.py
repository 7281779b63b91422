"""Photos in processes of their own: their limits, their deaths, and what they leave."""

import contextlib
import dataclasses
import os
import signal
import struct
import subprocess
import sys
import time
import zlib
from pathlib import Path

import pytest

from linecad.batch.local import LocalExecutor
from linecad.cli.main import main
from linecad.convert import Conversion
from linecad.errors import LinecadError

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="looks at processes through /proc")


@pytest.fixture(scope="module")
def executor():
    """An executor of two processes, the same for all tests: what one does to it must not harm the next."""
    executor = LocalExecutor(2, (".json",))
    yield executor
    executor.close()


def outcomes(executor, count, seconds=300.0):
    """The outcomes of so many jobs, by ticket."""
    found = {}
    end = time.monotonic() + seconds
    while len(found) < count:
        assert time.monotonic() < end, f"only {sorted(found)} ended"
        found.update(executor.wait(1.0))
    return found


def children_of(process):
    """The processes that a process has forked."""
    listed = subprocess.run(["ps", "-o", "pid=", "--ppid", str(process)], capture_output=True, text=True, check=False)
    return [int(word) for word in listed.stdout.split()]


def fork_server(executor):
    return executor._process.pid


def wait_until(is_so, seconds=300.0):
    end = time.monotonic() + seconds
    while not is_so():
        assert time.monotonic() < end, "it never came so far"
        time.sleep(0.01)


def slow_photo(path):
    """A photo with so many edges that it keeps its process busy for ten seconds and more, and then takes 2 GiB."""
    import cv2
    import numpy as np

    shades = np.random.default_rng(0).integers(0, 255, (150, 200), np.uint8)
    cv2.imwrite(str(path), cv2.resize(shades, (4000, 3000), interpolation=cv2.INTER_NEAREST))
    return path


@pytest.fixture(scope="module")
def slow(tmp_path_factory):
    return slow_photo(tmp_path_factory.mktemp("slow") / "slow.png")


@pytest.fixture
def slow_job(job_of):
    """The same as `job_of`, with a focal length that suits the slow photo."""
    return lambda photo, **limits: job_of(photo, conversion=Conversion(focal=4000.0), **limits)


def test_photos_are_converted_and_told_of(executor, survey, job_of, output):
    photos = sorted(survey(3).iterdir())
    for ticket, photo in enumerate(photos):
        executor.submit(ticket, job_of(photo))
    found = outcomes(executor, 3)
    for ticket, photo in enumerate(photos):
        outcome = found[ticket]
        assert outcome.status == "done", outcome
        assert outcome.figures.lines > 20
        assert outcome.files.keys() == {f"{photo.stem}.json", f"thumbnails/{photo.stem}.jpg"}
        assert all((output / file).stat().st_size == size for file, size in outcome.files.items())
        assert outcome.cpu_seconds > 0.05
        assert 50 < outcome.memory_mb < 1500


@pytest.mark.thorough
def test_a_photo_makes_the_same_files_as_convert(executor, survey, job_of, output, tmp_path):
    suffixes = (".json", ".dxf", ".glb", ".obj", ".png")
    photo = sorted(survey(1).iterdir())[0]
    executor.submit(0, job_of(photo, suffixes))
    assert outcomes(executor, 1)[0].status == "done"
    single = [tmp_path / f"{photo.stem}{suffix}" for suffix in suffixes]
    options = [option for path in single for option in ("-o", str(path))]
    assert main(["convert", str(photo), *options, "--focal", "300", "--time-limit", "30", "--quiet"]) == 0
    for path in single:
        assert (output / path.name).read_bytes() == path.read_bytes(), path.suffix


def test_a_photo_that_cannot_be_read_is_an_outcome(executor, job_of, tmp_path):
    photo = tmp_path / "bad.jpg"
    photo.write_bytes(b"no photo")
    executor.submit(0, job_of(photo))
    outcome = outcomes(executor, 1)[0]
    assert outcome.status == "failed"
    assert "is not an image that linecad can read" in outcome.error


def test_a_photo_that_was_changed_on_the_way_is_an_outcome(executor, survey, job_of):
    photo = sorted(survey(1).iterdir())[0]
    executor.submit(0, dataclasses.replace(job_of(photo), sha256="0" * 64))
    assert "was changed" in outcomes(executor, 1)[0].error


def test_a_photo_without_lines_has_a_picture_all_the_same(executor, job_of, tmp_path, output):
    import cv2
    import numpy as np

    photo = tmp_path / "grey.png"
    cv2.imwrite(str(photo), np.full((300, 400), 128, np.uint8))
    executor.submit(0, job_of(photo))
    outcome = outcomes(executor, 1)[0]
    assert outcome.status == "failed"
    assert outcome.figures is None
    assert (output / "thumbnails" / "grey.jpg").stat().st_size == outcome.files["thumbnails/grey.jpg"]


def test_the_time_limit_ends_a_photo_and_no_other(executor, slow, slow_job, survey, job_of):
    executor.submit(0, slow_job(slow, seconds=0.1))
    executor.submit(1, job_of(sorted(survey(1).iterdir())[0]))
    found = outcomes(executor, 2)
    assert found[0].status == "time limit"
    assert "--photo-limit" in found[0].error
    assert found[1].status == "done"


@pytest.mark.thorough
def test_the_memory_limit_ends_a_photo_and_no_other(executor, slow, slow_job, survey, job_of):
    executor.submit(0, slow_job(slow, memory_mb=400))
    executor.submit(1, job_of(sorted(survey(1).iterdir())[0]))
    found = outcomes(executor, 2)
    assert found[0].status == "memory limit"
    assert "--memory-limit" in found[0].error
    assert found[0].memory_mb < 450
    assert found[1].status == "done"


def test_a_killed_process_is_an_outcome_and_harms_no_other(executor, slow, slow_job, survey, job_of):
    executor.submit(0, slow_job(slow))
    wait_until(lambda: children_of(fork_server(executor)))
    victim = children_of(fork_server(executor))[0]
    executor.submit(1, job_of(sorted(survey(1).iterdir())[0]))
    os.kill(victim, signal.SIGKILL)
    found = outcomes(executor, 2)
    assert found[0].status == "killed"
    assert not found[0].is_lost
    assert "SIGKILL" in found[0].error
    assert found[1].status == "done"


@pytest.mark.thorough
def test_when_the_fork_server_dies_its_photos_are_lost_and_the_next_one_starts_another(
    executor, slow, slow_job, survey, job_of
):
    executor.submit(0, slow_job(slow))
    wait_until(lambda: children_of(fork_server(executor)))
    orphan = children_of(fork_server(executor))[0]
    os.kill(fork_server(executor), signal.SIGKILL)
    assert outcomes(executor, 1)[0].is_lost
    wait_until(lambda: not is_running(orphan))
    executor.submit(1, job_of(sorted(survey(1).iterdir())[0]))
    assert outcomes(executor, 1)[1].status == "done"


def is_running(process):
    try:
        return Path(f"/proc/{process}/stat").read_text(encoding="ascii").rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def test_all_processes_are_gone_after_close(slow, slow_job):
    executor = LocalExecutor(2, (".json",))
    executor.submit(0, slow_job(slow))
    parent = fork_server(executor)
    wait_until(lambda: children_of(parent))
    child = children_of(parent)[0]
    executor.close()
    assert not is_running(parent)
    assert not is_running(child)


def test_one_thread_a_process(executor, slow, slow_job):
    executor.submit(0, slow_job(slow, seconds=2.0))
    wait_until(lambda: children_of(fork_server(executor)))
    threads, found, seen = Path(f"/proc/{children_of(fork_server(executor))[0]}/task"), [], set()
    while not found:
        with contextlib.suppress(FileNotFoundError, ProcessLookupError):  # it has just ended
            seen.add(len(list(threads.iterdir())))
        found = executor.wait(0.02)
    assert found[0][1].status == "time limit"
    assert seen - {0} == {1}


def test_a_process_that_cannot_start_says_why(monkeypatch):
    monkeypatch.setattr("linecad.batch.local.FORMATS", {".json": type("Row", (), {"module": "no_such_module"})})
    with pytest.raises(LinecadError, match="no_such_module"):
        LocalExecutor(1, (".json",))


def test_a_photo_that_claims_to_be_huge_is_refused_at_once(executor, job_of, tmp_path):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", 200_000, 200_000, 8, 2, 0, 0, 0)
    photo = tmp_path / "huge.png"
    photo.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IEND", b""))
    executor.submit(0, job_of(photo))
    outcome = outcomes(executor, 1)[0]
    assert "200 megapixels" in outcome.error
    assert outcome.memory_mb < 1000  # its pixels would take 120 GB
