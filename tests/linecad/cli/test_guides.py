"""The guides of FreeCAD, Blender and USD followed to the letter: every command and option in them, in their order.

What only their programs can run, `.ci/clients.sh` runs in them.
"""

import re
import shlex
import shutil
from itertools import pairwise
from pathlib import Path

import pytest

from exporters.addons.write import ADDONS
from exporters.formats import FORMATS
from linecad.cli.main import main

ROOT = Path(__file__).resolve().parents[3]
GUIDES = ROOT / "docs" / "guide"
SAMPLES = ROOT / "samples"
PROGRAM = {"freecad": ".step", "blender": ".glb", "usd": ".usdz"}  # guide: the format that it is about
COMMAND = re.compile(r"^(linecad .+)$|`(linecad [^`]+)`", re.MULTILINE)
FLAG = re.compile(r"`(--[a-z][^`]*)`")
BLANKS = {"U,V:U2,V2=METRES", "METRES", "P"}  # what a reader fills in


def text_of(guide):
    return (GUIDES / f"{guide}.md").read_text(encoding="utf-8")


def commands_in(guide):
    return [shlex.split(first or second)[1:] for first, second in COMMAND.findall(text_of(guide))]


def outputs_of(command):
    if command[0] == "addon":
        return [Path(ADDONS[command[1]].file)]
    return [Path(name) for flag, name in pairwise(command) if flag == "-o"]


def as_given(command):
    """A command with nothing said but its results; the add-ons are there at once."""
    return command if command[0] == "addon" else [*command, "--quiet"]


@pytest.fixture(params=PROGRAM)
def guide(request):
    return request.param


@pytest.fixture
def reader(tmp_path, monkeypatch):
    """A folder with what a reader of a guide has: the samples, and one of them as the photo of the guide."""
    shutil.copytree(SAMPLES, tmp_path / "samples", ignore=shutil.ignore_patterns("*.py"))
    shutil.copy(SAMPLES / "courtyard.jpg", tmp_path / "facade.jpg")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def followed(guide, reader, capsys):
    """The guide, once its first command was followed."""
    first = next(command for command in commands_in(guide) if "facade.jpg" in command)
    assert main([*first, "--quiet"]) == 0
    capsys.readouterr()
    return guide, reader


def test_the_first_command_makes_what_it_says_with_a_scale(followed):
    """It ended after all the work with nothing written."""
    guide, folder = followed
    assert (folder / f"facade{PROGRAM[guide]}").stat().st_size > 100_000
    assert (
        '"metres_per_unit": 0.' in (folder / "facade.json").read_text()
        or '"metres_per_unit": 1.' in (folder / "facade.json").read_text()
    )


@pytest.mark.thorough
def test_every_command_of_a_guide_does_what_it_says(followed):
    guide, _ = followed
    for command in commands_in(guide):
        made = outputs_of(command)
        assert made, f"{command} writes nothing"
        before = {path: path.stat().st_mtime_ns for path in made if path.exists()}
        assert main(as_given(command)) == 0, command
        assert all(path.stat().st_mtime_ns > before.get(path, 0) for path in made)


def test_every_option_of_a_guide_is_one_of_the_format_that_it_is_about(followed, capsys):
    guide, _ = followed
    seen = set()
    for flags in FLAG.findall(text_of(guide)):
        words = shlex.split(flags)
        if len(words) == 1 or words[1] in BLANKS or words[0] == "--scale":
            continue  # named, not given
        suffixes = [PROGRAM[guide], *(suffix for suffix in FORMATS if suffix != PROGRAM[guide])]
        for suffix in suffixes:  # an option may be of the other formats that the guide speaks of
            if main(["export", "facade.json", *words, "-o", f"option{suffix}", "--quiet"]) == 0:
                seen.add(flags)
                break
        else:
            pytest.fail(f"{guide}.md: {flags}: {capsys.readouterr().err}")
    assert len(seen) >= 3


def test_every_line_of_python_in_the_guide_of_usd_runs(reader):
    assert main(["export", str(scene_of(reader)), "-o", "facade.usdz", "--quiet"]) == 0
    blocks = re.findall(r"```python\n(.+?)```", text_of("usd"), re.DOTALL)
    assert len(blocks) == 2
    scope = {}
    for block in blocks:
        exec(compile(block, "usd.md", "exec"), scope)
    stage = scope["stage"]
    assert stage.GetDefaultPrim().GetVariantSet("content").GetVariantSelection() == "wireframe"
    assert stage.GetPrimAtPath("/City/Facade/PhotoCamera")


def scene_of(folder):
    assert main(["convert", "facade.jpg", "-o", "facade.json", "--quiet"]) == 0
    return folder / "facade.json"
