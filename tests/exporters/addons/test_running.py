"""The command in a process of its own: its words, its stages, its end. A small script stands in for linecad."""

import os
import sys
import time
from pathlib import Path

import pytest

from exporters.addons import running
from exporters.addons.running import AddonError, Request, Running, environment_for, failure, find_command
from linecad.cli.main import main


@pytest.fixture
def photo(tmp_path):
    path = tmp_path / "a house.jpg"
    path.write_bytes(b"photo")
    return path


def command(text, folder=None):
    return Running([sys.executable, "-c", text], folder)


def until(holds):
    """Wait for what must come; the test's own timeout ends what never does."""
    while not holds():
        time.sleep(0.01)


def test_all_that_is_asked_is_in_the_words(photo):
    request = Request(photo, Path("c.json"), Path("d.npz"), " 12=3.5 ", 0.0, True, False, ("tubes=on",))
    assert request.words_to_convert((".json", ".glb")) == [
        "convert", str(photo), "--camera", "c.json", "--depth", "d.npz", "--scale=12=3.5", "--fast",
        "--option", "tubes=on", "-o", str(photo.parent / "a house.jpg.linecad" / "a house.json"),
        "-o", str(photo.parent / "a house.jpg.linecad" / "a house.glb"),
    ]  # fmt: skip
    assert request.words_to_edit() == ["edit", str(photo), "--camera", "c.json", "--depth", "d.npz"]


def test_what_the_page_corrected_goes_along(photo):
    request = Request(photo, camera_height=1.6, is_corrected=True)
    with pytest.raises(AddonError, match="correct the photo on the page first"):
        request.words_to_convert(())
    request.corrections.write_text("{}")
    words = request.words_to_convert(())
    assert words[2:] == ["--camera-height", "1.6", "--corrections", f"{photo}.corrections.json"]


def test_the_command_takes_the_words(photo, capsys):
    request = Request(photo, None, None, "1,2:3,4=5", 0.0, False, True, ("tubes=on",))
    request.corrections.write_text("{}")
    request.folder.mkdir()
    assert main(request.words_to_convert((".json", ".glb", ".step", ".fspy"))) == 1
    assert "corrections.json" in capsys.readouterr().err  # which is the first thing that it looks into


@pytest.mark.parametrize(
    ("change", "words"),
    [({"scale": "12=3", "camera_height": 1.0}, "both given"), ({"photo": Path("none.jpg")}, "choose a photo")],
)
def test_what_cannot_be_asked_is_refused(photo, change, words):
    with pytest.raises(AddonError, match=words):
        Request(**{"photo": photo, **change}).words_to_convert(())


@pytest.fixture
def programs(tmp_path, monkeypatch):
    """Make a program in a folder; none of them is on PATH."""
    monkeypatch.setenv("PATH", str(tmp_path / "path"))

    def make(folder):
        path = tmp_path / folder / "linecad"
        path.parent.mkdir()
        path.write_text("#!/bin/sh\n")
        path.chmod(0o755)
        return str(path)

    return make


def test_the_chosen_command_comes_first_then_path_then_the_one_that_wrote_the_file(programs, monkeypatch):
    with pytest.raises(AddonError, match="linecad was not found; install it"):
        find_command("")
    writer = programs("writer")
    monkeypatch.setattr(running, "WRITTEN_BY", writer)
    assert find_command("") == writer
    on_path = programs("path")
    assert find_command("") == on_path
    chosen = programs("chosen")
    assert find_command(chosen) == chosen
    with pytest.raises(AddonError, match="is no command"):
        find_command(str(Path(chosen).parent))


def test_the_other_programs_python_is_kept_out_of_the_environment():
    folders = [f"{os.sep}image{os.sep}lib", f"{os.sep}own"]
    given = {
        "PYTHONHOME": "a", "PYTHONPATH": "b", "HOME": "c", "APPDIR": f"{os.sep}image",
        "LD_LIBRARY_PATH": os.pathsep.join(folders),
    }  # fmt: skip
    wanted = {"HOME": "c", "APPDIR": given["APPDIR"], "LD_LIBRARY_PATH": folders[1], "PYTHONIOENCODING": "utf-8"}
    assert environment_for(given) == wanted
    assert environment_for({"LD_LIBRARY_PATH": "x"})["LD_LIBRARY_PATH"] == "x"


def test_stages_are_shown_as_they_come(tmp_path):
    gate = tmp_path / "gate"
    text = (
        "import pathlib, sys, time\n"
        "print('finding façades', file=sys.stderr, flush=True)\n"
        "print('linecad: a note', file=sys.stderr, flush=True)\n"
        f"while not pathlib.Path({str(gate)!r}).exists(): time.sleep(0.01)\n"
        "print('12 lines'); print('note: one')"
    )
    at_work = command(text, tmp_path / "out")
    until(lambda: at_work.stage.startswith("finding façades ("))
    assert not at_work.is_done
    gate.touch()
    at_work.wait()
    assert at_work.is_done
    assert at_work.result() == ["12 lines", "note: one"]
    assert (tmp_path / "out").is_dir()


def test_much_output_does_not_stop_it():
    at_work = command("import sys\nfor n in range(20000): print('line', n); print('stage', n, file=sys.stderr)")
    at_work.wait()
    assert len(at_work.result()) == 20000


def test_a_failure_is_told_in_its_own_line():
    at_work = command(
        "import sys; print('reading', file=sys.stderr); sys.exit('linecad: no lines; take another photo')"
    )
    at_work.wait()
    assert at_work.problem == "no lines; take another photo"
    with pytest.raises(AddonError, match=r"^no lines; take another photo$"):
        at_work.result()


@pytest.mark.parametrize(
    ("lines", "told"),
    [
        ([], "linecad ended with -9 and gave no reason"),
        (["linecad convert: argument --scale: bad"], "argument --scale: bad"),
        (["Traceback", "ValueError: bad"], "ValueError: bad"),
        (["linecadabra: bad"], "linecadabra: bad"),
    ],
)
def test_a_failure_is_one_line_without_the_name(lines, told):
    assert failure(-9, lines) == told


def test_what_cannot_be_started_is_refused(tmp_path):
    with pytest.raises(AddonError, match="linecad was not started"):
        Running([str(tmp_path / "nothing")])


@pytest.mark.skipif(sys.platform == "win32", reason="there a job object ends what the command started")
def test_it_ends_with_all_that_it_started_and_leaves_nothing_half_written(tmp_path, monkeypatch):
    monkeypatch.setattr(running, "PATIENCE", 0.1)
    out = tmp_path / "out"
    out.mkdir()
    (out / "a.json").write_text("before")
    child = (
        "import signal, time; signal.signal(signal.SIGTERM, signal.SIG_IGN); "
        "print('ready', flush=True); time.sleep(999)"
    )
    text = (
        "import pathlib, subprocess, sys, time\n"
        f"inner = subprocess.Popen([sys.executable, '-c', {child!r}], stdout=subprocess.PIPE)\n"
        "inner.stdout.readline()\n"
        f"pathlib.Path({str(out / '.linecad-x.json')!r}).touch()\n"
        "print(f'child {inner.pid}', file=sys.stderr, flush=True)\n"
        "time.sleep(999)"
    )
    at_work = command(text, out)
    until(lambda: at_work.stage.startswith("child"))
    inner = int(at_work.stage.split()[1])
    at_work.end()
    assert at_work.is_done
    until(lambda: not is_alive(inner))
    assert [path.name for path in out.iterdir()] == ["a.json"]
    assert at_work.problem == ""
    with pytest.raises(AddonError, match="cancelled"):
        at_work.result()


def is_alive(process):
    """Whether a process runs; one that nobody has waited for yet does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False
