"""What is shown on the way."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from linecad.cli.main import main

ROOT = Path(__file__).resolve().parents[3]
posix = pytest.mark.skipif(os.name == "nt", reason="signals, links and limits as on POSIX")


@pytest.mark.usefixtures("folder")
def test_progress_goes_to_stderr_a_line_a_stage(scene_file, capsys):
    assert main(["export", str(scene_file), "-o", "a.stl", "-o", "b.json"]) == 0
    out, err = capsys.readouterr()
    assert out == ""
    assert err.splitlines() == ["reading the scene", "writing b.json", "writing a.stl"]  # the scene first


@pytest.mark.usefixtures("folder")
def test_quiet_says_nothing_and_verbose_the_times(scene_file, capsys):
    assert main(["export", str(scene_file), "-o", "a.stl", "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")
    assert main(["export", str(scene_file), "-o", "a.stl", "--verbose"]) == 0
    lines = capsys.readouterr().err.splitlines()
    assert [line.split(" s  ")[1] for line in lines] == ["reading the scene", "writing a.stl"]


@posix
def test_an_error_on_a_terminal_stands_on_a_line_of_its_own(folder):
    import pty

    (folder / "photo.png").write_bytes(b"")
    ours, theirs = pty.openpty()
    command = [sys.executable, "-m", "linecad", "convert", "photo.png", "-o", "a.json"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    ended = subprocess.run(command, cwd=folder, env=environment, stderr=theirs, timeout=60, check=False)
    os.close(theirs)
    shown = os.read(ours, 100_000).decode()
    os.close(ours)
    assert ended.returncode == 1
    assert "reading the photo ...\r\033[Klinecad: photo.png" in shown
