"""`linecad edit` as it is used: a process with an address, requests, kill -9, Ctrl-C, and a solver beside it."""

import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import httpx2
import pytest

from linecad.cli.main import main
from linecad.editing.guard import HOST
from linecad.io.locks import alone

ROOT = Path(__file__).resolve().parents[3]
SAMPLES = ROOT / "samples"
posix = pytest.mark.skipif(os.name == "nt", reason="signals as on POSIX")
LONG_S = 60.0  # on a machine that does much else


class Served:
    """A running `linecad edit` and a client of it."""

    def __init__(self, folder, *options):
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        command = [sys.executable, "-m", "linecad", "edit", "room.jpg", "--camera", "room.json", "--no-browser"]
        self.process = subprocess.Popen(
            [*command, "--time-limit", "10", *options], cwd=folder, env=environment, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        )  # fmt: skip
        self.address = self.process.stdout.readline().strip()
        base, _, token = self.address.partition("#")
        self.client = httpx2.Client(base_url=f"{base}api/", headers={"X-Linecad-Token": token}, timeout=LONG_S)

    def state(self):
        return self.client.get("state").json()

    def post(self, path, **body):
        """The answer; where the server itself found out something in between, one tries again."""
        end = time.monotonic() + LONG_S
        while True:
            version = self.client.get("progress").json()["version"]
            answer = self.client.post(path, json={"base_version": version, **body})
            if answer.status_code != 409 or time.monotonic() > end:
                break
        assert answer.status_code == 200, answer.text
        return answer.json()

    def until(self, holds):
        """The first answer about the progress that holds."""
        end = time.monotonic() + LONG_S
        while time.monotonic() < end:
            progress = self.client.get("progress").json()
            if holds(progress):
                return progress
            time.sleep(0.05)
        raise TimeoutError

    def children(self):
        listing = subprocess.run(
            ["ps", "-o", "pid=", "--ppid", str(self.process.pid)], capture_output=True, text=True, check=True
        )
        return [int(word) for word in listing.stdout.split()]

    def end(self, number=signal.SIGINT):
        self.process.send_signal(number)
        out, err = self.process.communicate(timeout=LONG_S)
        self.client.close()
        return self.process.returncode, out, err


@pytest.fixture
def folder(tmp_path):
    for name in ("room.jpg", "room.json"):
        shutil.copy(SAMPLES / name, tmp_path)
    return tmp_path


@pytest.fixture
def serve(folder):
    """A function that starts the server; all that are left over end with the test."""
    running = []

    def start(*options):
        running.append(Served(folder, *options))
        return running[-1]

    yield start
    for served in running:
        served.client.close()
        if served.process.poll() is None:
            served.process.kill()
            served.process.communicate()


def is_gone(pid):
    end = time.monotonic() + LONG_S
    while time.monotonic() < end:
        listing = subprocess.run(["ps", "-o", "stat=", "-p", str(pid)], capture_output=True, text=True, check=False)
        if listing.stdout.strip() in ("", "Z"):
            return True
        time.sleep(0.1)
    return False


@pytest.mark.thorough
@posix
def test_kill_9_loses_nothing_that_was_saved_and_leaves_no_process(serve, folder):
    first = serve()
    assert re.fullmatch(re.escape(f"http://{HOST}:") + r"\d+/#[\w-]{40,}", first.address)
    children = first.children()
    assert children
    states = [first.state()]
    for number in range(6):
        states.append(first.post("edit", edit={"op": "delete", "line": states[0]["lines"][3 * number]["id"]}))
    states.append(first.post("undo"))
    first.until(lambda progress: progress["saved"])  # never longer than a second
    first.end(signal.SIGKILL)
    assert all(is_gone(child) for child in children)

    again = serve()
    state = again.state()
    assert [line["id"] for line in state["lines"]] == [line["id"] for line in states[-1]["lines"]]
    assert (state["undo"], state["redo"]) == (5, 1)
    assert len(again.post("redo")["lines"]) == len(states[-2]["lines"])
    again.until(lambda progress: progress["saved"])

    code, out, err = again.end()
    assert (code, out) == (0, "")
    assert "Traceback" not in err
    saved = json.loads((folder / "room.jpg.corrections.json").read_text())
    assert len(saved["edits"]) == 6
    assert sorted(path.name for path in folder.iterdir()) == ["room.jpg", "room.jpg.corrections.json", "room.json"]


@posix
@pytest.mark.thorough
def test_it_solves_at_the_start_and_stop_keeps_the_best(serve, folder):
    served = serve("--option", "formulation=paper", "-o", "said.json", "--labels", "room.labels.json")
    served.until(lambda progress: progress["solve"]["objective"] is not None)
    served.post("stop")
    done = served.until(lambda progress: progress["solve"]["state"] == "idle")
    assert done["solve"]["status"] in ("interrupted", "optimal")
    state = served.state()
    assert any(line["ends"] for line in state["lines"])
    crossing = next(one for one in state["crossings"] if one["real"])["id"]
    served.post("edit", edit={"op": "label", "crossing": crossing, "value": "fake"})
    served.post("solve")
    served.post("stop")
    served.until(lambda progress: progress["solve"]["state"] == "idle" and progress["saved"])
    assert not next(one for one in served.state()["crossings"] if one["id"] == crossing)["real"]
    served.end(signal.SIGTERM)
    labels = json.loads((folder / "room.labels.json").read_text())
    assert [(one["label"], labels["photo"], labels["camera"]) for one in labels["crossings"]] == [
        ("fake", "room.jpg", "room.json")
    ]


@posix
@pytest.mark.thorough
def test_a_solver_that_dies_is_said_so_and_started_again(serve):
    served = serve()
    (child,) = [pid for pid in served.children() if b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes()]
    served.until(lambda progress: progress["solve"]["state"] == "idle")
    served.post("solve")
    os.kill(child, signal.SIGKILL)
    done = served.until(lambda progress: progress["solve"]["state"] == "idle")
    if done["solve"]["error"] is not None:  # else it had answered before
        assert done["solve"]["error"] == "the solver's process ended unexpectedly; solve again"
    served.post("solve")
    done = served.until(lambda progress: progress["solve"]["state"] == "idle")
    assert done["solve"]["error"] is None
    assert done["solve"]["status"] in ("optimal", "time limit")


class TestRefusals:
    @pytest.fixture
    def fails(self, folder, monkeypatch, capsys):
        """The one line with which the command ends, before it serves anything."""
        monkeypatch.chdir(folder)

        def run(*arguments):
            code = main(["edit", *arguments, "--no-browser", "--quiet"])
            out, err = capsys.readouterr()
            assert (code, out) == (1, "")
            assert err.count("\n") == 1
            return err

        return run

    def test_a_port_in_use(self, fails):
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            taken.listen()
            port = taken.getsockname()[1]
            assert f"port {port} cannot be used: Address already in use" in fails("room.jpg", "--port", str(port))

    def test_corrections_of_another_photo(self, fails, folder):
        head = {"format": "linecad-corrections", "version": 1, "photo": "other.jpg", "width": 9, "height": 9}
        (folder / "room.jpg.corrections.json").write_text(json.dumps({**head, "edits": []}))
        assert "is for a photo of 9 x 9 px (other.jpg)" in fails("room.jpg")

    def test_corrections_that_would_overwrite_the_photo_or_its_calibration(self, fails, folder):
        before = (folder / "room.json").read_bytes()
        assert "is an input too" in fails("room.jpg", "-o", "room.jpg")
        assert "is an input too" in fails("room.jpg", "--camera", "room.json", "-o", "room.json")
        assert (folder / "room.json").read_bytes() == before

    def test_a_fast_fit_that_cannot_keep_to_what_is_said(self, fails, folder):
        """The page once took corrections and then refused to solve."""
        assert "a fast fit cannot; leave out --fast" in fails("room.jpg", "--fast")
        assert not (folder / "room.jpg.corrections.json").exists()

    def test_labels_that_would_not_lie_beside_the_photo(self, fails, folder):
        (folder / "sub").mkdir()
        assert "must lie beside room.jpg" in fails("room.jpg", "--labels", "sub/room.labels.json")

    def test_a_scene_without_its_photo(self, fails, folder):
        camera = json.loads((folder / "room.json").read_text())
        turn, numbers = [[1, 0, 0], [0, 0, -1], [0, 1, 0]], ["objective", "bound", "gap"]
        scene = {
            "format": "linecad-scene", "version": 1, "photo": "far.jpg", "lines": [], "intersections": [], "planes": [],
            "camera": {**camera, "source": "file", "R_cam_from_world": turn},
            "solve": {**dict.fromkeys(["solver", "formulation", "status"], ""), **dict.fromkeys(numbers, 0)},
        }  # fmt: skip
        (folder / "far.json").write_text(json.dumps(scene))
        assert "far.jpg is not there" in fails("far.json")

    def test_a_missing_library_is_named_with_the_extra(self, folder):
        script = (
            "import sys; sys.modules['uvicorn'] = None\n"
            "from linecad.cli.main import main\nsys.exit(main(['edit', 'room.jpg', '--no-browser', '--quiet']))"
        )
        ended = subprocess.run(
            [sys.executable, "-c", script], cwd=folder, env={**os.environ, "PYTHONPATH": str(ROOT)},
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert ended.returncode == 1
        assert ended.stderr == (
            "linecad: the page needs the library uvicorn; install it with: pip install 'linecad[editor]'\n"
        )


@posix
@pytest.mark.parametrize("name", ["room.jpg.corrections.json", "room.labels.json"])
def test_a_second_page_on_one_file_is_refused_in_one_line(folder, capsys, name):
    """It once began with the same corrections, and the last change on either page was all that was kept."""
    command = ["edit", str(folder / "room.jpg"), "--focal", "900", "--labels", str(folder / "room.labels.json")]
    with alone(folder / f".{name}.lock", "", ""):
        assert main([*command, "--no-browser", "--quiet"]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"linecad: another linecad edit writes {folder / name} (process {os.getpid()}); ")
    assert sorted(path.name for path in folder.iterdir()) == ["room.jpg", "room.json"]
