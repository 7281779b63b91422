"""The same batch on a Dask cluster on loopback: a scheduler and two workers in processes of their own."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("distributed", reason="needs Dask: pip install 'linecad[cluster]'")

from linecad.batch.cluster import ClusterExecutor
from linecad.batch.record import NAME
from linecad.batch.run import run_batch
from linecad.cli.main import main
from linecad.errors import LinecadError

ROOT = Path(__file__).resolve().parents[3]
SECONDS = 100.0


class Cluster:
    """A scheduler and workers; what they say goes to files."""

    def __init__(self, folder):
        self.folder, self.processes = folder, []
        self.start("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--no-show")
        self.address = self.wait_for("scheduler", r"Scheduler at:\s+(tcp://\S+)")

    def start(self, kind, *options):
        command = [sys.executable, "-m", "distributed.cli.dask_" + kind, *options]
        log = (self.folder / f"{kind}{len(self.processes)}.log").open("wb")
        with log:
            process = subprocess.Popen(
                command, stdout=log, stderr=log, cwd=self.folder, env={**os.environ, "PYTHONPATH": str(ROOT)}
            )
        self.processes.append(process)
        return process

    def add_worker(self):
        number = len(self.processes)
        worker = self.start(
            "worker", self.address, "--nthreads", "1", "--no-nanny", "--no-dashboard", "--host", "127.0.0.1",
            "--local-directory", str(self.folder / f"space{number}"),
        )  # fmt: skip
        self.wait_for(f"worker{number}", r"(Registered to):")
        return worker

    def wait_for(self, name, pattern):
        path = self.folder / (name if name[-1].isdigit() else f"{name}0")
        path = path.with_suffix(".log")
        end = time.monotonic() + SECONDS
        while not (found := re.search(pattern, path.read_text())):
            assert time.monotonic() < end, path.read_text()
            time.sleep(0.05)
        return found[1]

    def close(self):
        for process in self.processes:
            process.kill()
            process.wait()


@pytest.fixture(scope="module")
def cluster(tmp_path_factory, thorough):
    cluster = Cluster(tmp_path_factory.mktemp("cluster"))
    try:
        cluster.workers = [cluster.add_worker() for _ in range(2 if thorough else 1)]
        yield cluster
    finally:
        cluster.close()


@pytest.mark.thorough
def test_photos_travel_as_bytes_and_results_are_those_of_convert(cluster, survey, output, tmp_path, thorough):
    photos = survey(3 if thorough else 1)
    camera = tmp_path / "camera.json"
    camera.write_text(json.dumps({"width": 320, "height": 213, "K": [[300, 0, 159.5], [0, 300, 106], [0, 0, 1]]}))
    command = ["batch", str(photos), "-o", str(output), "--scheduler", cluster.address, "--format", "json,obj"]
    assert main([*command, "--camera", str(camera), "--quiet"]) == 0
    rows = [json.loads(line) for line in (output / NAME).read_text().splitlines()]
    assert sorted(Path(row["photo"]).name for row in rows) == sorted(path.name for path in photos.iterdir())
    assert {row["status"] for row in rows} == {"done"}
    for photo in photos.iterdir():
        single = [tmp_path / f"{photo.stem}{suffix}" for suffix in (".json", ".obj")]
        options = [option for path in single for option in ("-o", str(path))]
        assert main(["convert", str(photo), *options, "--camera", str(camera), "--quiet"]) == 0
        for path in single:
            assert (output / path.name).read_bytes() == path.read_bytes(), path.suffix
        pictures = list(tmp_path.glob(f"{photo.stem}.obj.*/*"))
        assert pictures
        for picture in pictures:
            assert (output / picture.relative_to(tmp_path)).read_bytes() == picture.read_bytes()
    assert not list(output.rglob(".linecad-*"))


@pytest.mark.thorough
def test_maps_travel_with_what_lies_beside_them(cluster, survey, output):
    photos = survey(2)
    folder = photos / "p01"
    folder.mkdir()
    depth = np.random.default_rng(0).uniform(1, 9, (213, 320)).astype(np.float32)
    np.save(photos / "p00.depth.npy", depth)
    with (folder / "depth.exr").open("wb") as file:  # what a file holds tells what it is, not its name
        np.savez(file, depth=depth)
    (folder / "fov.json").write_text('{"fov_x": 56.1, "fov_y": 39.1}')
    command = ["batch", str(photos), "-o", str(output), "--scheduler", cluster.address, "--depth-maps"]
    assert main([*command, "--option", "depth-kind=z", "--focal", "300", "--quiet"]) == 0
    rows = {row["name"]: row for row in map(json.loads, (output / NAME).read_text().splitlines())}
    # A worker that lacks a part of what a photo is made with fails it: the hashes differ.
    assert {name: row["status"] for name, row in rows.items()} == {"p00": "done", "p01": "done"}
    assert [Path(rows[name]["depth"]).name for name in ("p00", "p01")] == ["p00.depth.npy", "depth.exr"]


@pytest.mark.thorough
def test_with_shared_files_a_worker_that_is_killed_costs_no_photo(cluster, survey, plan_of, output):
    plan = plan_of(sorted(survey(6).iterdir()))
    killed = []

    def kill_one(progress, _row):
        if progress.done == 1 and not killed:
            victim = cluster.workers[0]
            victim.send_signal(signal.SIGKILL)
            victim.wait()
            killed.append(victim)

    result = run_batch(plan, lambda _lock: ClusterExecutor(cluster.address, shared_files=True), kill_one)
    assert killed
    assert (result.progress.done, result.progress.failed) == (6, 0)
    rows = [json.loads(line) for line in (output / NAME).read_text().splitlines()]
    assert sorted(Path(row["photo"]).stem for row in rows) == [f"p{number:02d}" for number in range(6)]
    assert all(json.loads((output / f"p{number:02d}.json").read_bytes())["lines"] for number in range(6))


def test_a_photo_that_fails_there_is_a_row_here(cluster, plan_of, tmp_path):
    photo = tmp_path / "bad.jpg"
    photo.write_bytes(b"no photo")
    plan = plan_of([photo])
    result = run_batch(plan, lambda _lock: ClusterExecutor(cluster.address, False), lambda _progress, _row: None)
    assert result.rows[0].outcome.status == "failed"
    assert "is not an image that linecad can read" in result.rows[0].outcome.error


def test_workers_of_another_version_are_refused(cluster, monkeypatch):
    monkeypatch.setattr("linecad.batch.cluster.__version__", "9.9")
    with pytest.raises(LinecadError, match=r"has not linecad 9\.9"):
        ClusterExecutor(cluster.address, False)


def test_no_scheduler_is_an_error_in_one_line(monkeypatch):
    monkeypatch.setattr("linecad.batch.cluster.CONNECT_SECONDS", 0.5)
    with pytest.raises(LinecadError, match="no Dask scheduler answers at tcp://127"):
        ClusterExecutor("tcp://127.0.0.1:9", False)


def test_an_address_that_is_none(monkeypatch):
    monkeypatch.setattr("linecad.batch.cluster.CONNECT_SECONDS", 0.5)
    with pytest.raises(LinecadError, match="check its address"):
        ClusterExecutor("nonsense://?", False)
