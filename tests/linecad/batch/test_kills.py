"""The batch of many kills (tests/benchmarks/batch_kills.py), short: nothing is lost, done twice or half written."""

import contextlib
import importlib.util
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
GONE, ZOMBIE, STOPPED = "", "Z", "T"  # states of a process
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="looks at processes through /proc")


@pytest.fixture(scope="module")
def kills():
    """The module of the benchmark."""
    specification = importlib.util.spec_from_file_location(
        "batch_kills", ROOT / "tests" / "benchmarks" / "batch_kills.py"
    )
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def photos(kills, tmp_path_factory):
    """Four small photos in a folder."""
    return kills.make_photos(tmp_path_factory.mktemp("kills") / "photos", 4)


@pytest.fixture(scope="module")
def calm(kills, photos, tmp_path_factory):
    """What a batch makes of the photos that nobody disturbs."""
    return kills.run_calm(photos, tmp_path_factory.mktemp("calm"))


def state(process):
    """The letter of the kernel for what a process does."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return GONE


def stop_a_worker(kills, parent, end):
    """Stop one of the processes that work on photos, and return when it has stopped before it was done."""
    while True:
        assert time.monotonic() < end, "no photo was begun"
        for worker in kills.family(parent)["worker"]:
            with contextlib.suppress(ProcessLookupError):  # it had just ended
                os.kill(worker, signal.SIGSTOP)
            while (now := state(worker)) not in (GONE, ZOMBIE, STOPPED):
                assert time.monotonic() < end, "it did not stop"
            if now == STOPPED:
                return
        time.sleep(0.001)


@pytest.mark.thorough
def test_after_random_kills_every_photo_is_done_once(kills, photos, calm, tmp_path):
    *_, killed = kills.run_rounds(photos, tmp_path, calm, random.Random(1), kills=3)
    assert killed.total() >= 3


@pytest.mark.thorough
def test_all_processes_die_with_the_one_that_gives_out_photos(kills, photos, tmp_path):
    batch = kills.start(photos[0].parent, tmp_path / "out")
    end = time.monotonic() + 60
    while not (family := kills.family(batch.pid))["worker"]:
        assert time.monotonic() < end, "no photo was begun"
    batch.kill()
    batch.wait()
    batch.stderr.close()
    others = [*family["fork server"], *family["worker"]]
    while any(state(process) not in (GONE, ZOMBIE) for process in others):  # who reaps them is not the batch's affair
        assert time.monotonic() < end, "processes are left"
        time.sleep(0.01)


@pytest.mark.thorough
def test_ctrl_c_ends_the_batch_in_one_line_and_leaves_it_ready_to_go_on(kills, photos, calm, tmp_path):
    output = tmp_path / "out"
    batch = kills.start(photos[0].parent, output)
    end = time.monotonic() + 60
    stop_a_worker(kills, batch.pid, end)  # so that the batch is not over before Ctrl-C on any machine
    while not kills.rows(output):
        assert time.monotonic() < end, "no photo was done"
        time.sleep(0.01)
    batch.send_signal(signal.SIGINT)
    errors = batch.communicate(timeout=60)[1].decode()
    assert batch.returncode == 1
    assert len(errors.splitlines()) == 1
    assert "interrupted" in errors
    assert (output / "index.html").is_file()
    again = kills.start(photos[0].parent, output)
    again.communicate(timeout=100)
    assert again.returncode == 0
    kills.check_done(output, photos, calm.contents)


@pytest.mark.thorough
def test_a_second_batch_in_the_folder_is_refused_in_one_line(kills, photos, tmp_path):
    batch = kills.start(photos[0].parent, tmp_path / "out")
    end = time.monotonic() + 60
    while not (tmp_path / "out" / "batch.jsonl").exists():
        assert time.monotonic() < end, "the batch did not begin"
        time.sleep(0.01)
    batch.send_signal(signal.SIGSTOP)  # it stays in the folder
    try:
        command = [sys.executable, "-m", "linecad", "batch", str(photos[0]), "-o", str(tmp_path / "out"), "--quiet"]
        other = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    finally:
        batch.send_signal(signal.SIGCONT)
        batch.kill()
        batch.communicate()
    assert other.returncode == 1
    assert f"another batch works in {tmp_path / 'out'} (process {batch.pid})" in other.stderr
    assert len(other.stderr.splitlines()) == 1
