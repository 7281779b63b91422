"""The command line as a whole: wrong usage, help, exit codes."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from linecad import __version__
from linecad.cli.main import main

ROOT = Path(__file__).resolve().parents[3]
SAMPLES = ROOT / "samples"
ROOM = SAMPLES / "room.jpg"


def run_as_module(arguments, folder, **more):
    """`python -m linecad` in a process of its own, started in `folder`."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "linecad", *map(str, arguments)]
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=100, check=False, **more
    )


@pytest.mark.parametrize(
    ("outputs", "words"),
    [
        ([], "no output was named"),
        (["a.doc"], "unknown suffix .doc"),
        (["scene"], "no suffix"),
        (["a.json", "a.doc"], "unknown suffix .doc"),
        (["missing/a.json"], "does not exist"),
        (["a.json", "./a.json"], "named twice"),
        (["a.json", "."], "suffix"),
        (["folder.step"], "is a folder"),
    ],
)
@pytest.mark.parametrize("command", ["convert", "export"])
def test_outputs_that_cannot_be(fails, folder, scene_file, command, outputs, words):
    (folder / "folder.step").mkdir()
    options = [word for output in outputs for word in ("-o", output)]
    assert words in fails(command, ROOM if command == "convert" else scene_file, *options)


def test_a_number_that_the_solver_cannot_use(fails):
    assert "time_limit_s is 1e+300" in fails("convert", ROOM, "-o", "a.json", "--time-limit", "1e300")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--focal", "abc"], "'abc' is not a number"),
        (["--focal", "0"], "0 is not a positive number"),
        (["--focal", "nan"], "nan is not a number of zero or more"),
        (["--focal=-5"], "-5 is not a number of zero or more"),
        (["--time-limit", "inf"], "inf is not a number of zero or more"),
        (["--focal", "900", "--camera", "room.json"], "not allowed with"),
        (["--verbose"], "not allowed with"),  # together with --quiet
        (["--unknown"], "--unknown"),
        (["second.jpg"], "second.jpg"),
    ],
)
def test_wrong_usage_is_exit_code_2(fails, options, words):
    assert words in fails("convert", ROOM, "-o", "a.json", *options, code=2)


@pytest.mark.parametrize("arguments", [[], ["invent"], ["convert"]])
def test_commands_that_say_too_little(fails, arguments):
    assert "--help" in fails(*arguments, code=2)


@pytest.mark.parametrize(
    ("output", "option", "words"),
    [
        ("a.glb", "tubes", "no value; write it like KEY=VALUE"),
        ("a.glb", "tubes=perhaps", "option tubes is 'perhaps', expected on or off"),
        ("a.dxf", "version=R12", "option version is 'R12', expected R2010 or R2018"),
        ("a.glb", "tube=on", "no option 'tube' for .glb, which has tubes"),
        ("a.step", "tubes=on", "no option 'tubes' for .step"),
        ("a.png", "tubes=on", "for .png, which has ids"),
        ("a.json", "tubes=on", "no option 'tubes' for the scene file, which has no options"),
    ],
)
@pytest.mark.parametrize("command", ["convert", "export"])
def test_a_bad_option_is_refused_before_the_work(fails, scene_file, command, output, option, words):
    source = ROOM if command == "convert" else scene_file
    assert words in fails(command, source, "-o", output, "--option", option)


def test_version_and_help(folder):
    version = run_as_module(["--version"], folder)
    assert (version.returncode, version.stdout, version.stderr) == (0, f"linecad {__version__}\n", "")
    usage = run_as_module(["--help"], folder)
    assert (usage.returncode, usage.stderr) == (0, "")
    assert "convert" in usage.stdout
    assert "export" in usage.stdout


COMMANDS = ["convert", "camera", "batch", "edit", "evaluate", "export", "options", "dataset"]


@pytest.fixture
def help_of(capsys, monkeypatch):
    """A function that gives the help of a command on a terminal of 80 columns."""

    def show(command):
        monkeypatch.setenv("COLUMNS", "80")
        with pytest.raises(SystemExit, match="0"):
            main([command, "--help"])
        return capsys.readouterr().out

    return show


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_an_example(help_of, command):
    assert "\nexample: linecad " in help_of(command)


def test_the_help_of_convert_fits_one_screen(help_of):
    text = help_of("convert")
    assert len(text.splitlines()) <= 40
    flags = set(re.findall(r"--[a-z-]+", text.split("options:")[1].split("example:")[0])) - {"--formats"}
    assert flags == {
        "--help", "--output", "--camera", "--focal", "--corrections", "--depth", "--scale", "--camera-height",
        "--confidence", "--detail", "--groups", "--main", "--fast", "--time-limit", "--option", "--quiet", "--verbose",
    }  # fmt: skip


@pytest.mark.parametrize("name", ["solver", "exporters"])
def test_a_file_that_hides_a_package_is_named(folder, name):
    (folder / f"{name}.py").write_text("raise RuntimeError('never to be run')\n")
    ended = run_as_module(["convert", ROOM, "-o", "a.json"], folder)
    assert ended.returncode == 1
    assert len(ended.stderr.splitlines()) == 1
    assert str((folder / f"{name}.py").resolve()) in ended.stderr
    assert [path.name for path in folder.iterdir() if path.name != "__pycache__"] == [f"{name}.py"]


def test_a_broken_pipe_that_is_not_the_outputs_is_not_hidden(monkeypatch):
    def broken(_parsed):
        raise BrokenPipeError

    monkeypatch.setattr("linecad.cli.options.run", broken)
    with pytest.raises(BrokenPipeError):
        main(["options"])
