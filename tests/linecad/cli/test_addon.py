"""`linecad addon`: one file, and what to do with it."""

import sysconfig
import zipfile
from pathlib import Path

import pytest

from exporters.addons.write import ADDONS
from linecad import __version__
from linecad.cli.addon import PROGRAMS
from linecad.cli.main import main


def test_every_add_on_can_be_asked_for():
    assert list(PROGRAMS) == list(ADDONS)


@pytest.mark.parametrize(("program", "file"), [("blender", "linecad-blender.zip"), ("freecad", "linecad.FCMacro")])
def test_it_is_written_here_or_into_a_folder_or_as_it_is_called(folder, capsys, program, file):
    (folder / "in").mkdir()
    for options, path in (([], file), (["-o", "in"], f"in/{file}"), (["-o", "other"], "other")):
        assert main(["addon", program, *options]) == 0
        out = capsys.readouterr().out
        assert out.startswith(f"{Path(path)} is written; in {'Blender' if program == 'blender' else 'FreeCAD'}: ")
        assert out.count("\n") == 1
    assert len({(folder / path).read_bytes() for path in (file, f"in/{file}", "other")}) == 1


def test_it_has_the_version_and_the_path_of_the_command(folder):
    assert main(["addon", "blender"]) == 0
    with zipfile.ZipFile(folder / "linecad-blender.zip") as archive:
        code = archive.read("linecad/__init__.py").decode()
        manifest = archive.read("linecad/blender_manifest.toml").decode()
    assert f'version = "{__version__}"' in manifest
    own = Path(sysconfig.get_path("scripts")) / "linecad"
    assert f"WRITTEN_BY = {str(own) if own.is_file() else ''!r}" in code


def test_a_folder_that_is_not_there_is_named(folder, capsys):
    assert main(["addon", "blender", "-o", "none/a.zip"]) == 1
    assert capsys.readouterr().err == "linecad: the folder none does not exist; make it first\n"
    assert list(folder.iterdir()) == []
