"""Each add-on is one file that holds all it needs, the same bytes every time."""

import ast
import io
import sys
import tomllib
import zipfile
from collections import Counter

import pytest

from exporters.addons.write import ADDONS, joined, write_addon
from linecad import __version__
from linecad.errors import OutputError

ENTRIES = {"blender": "blender.panel", "freecad": "freecad.dialog"}
THEIRS = {"blender": {"bpy", "bmesh", "numpy"}, "freecad": {"FreeCAD", "FreeCADGui", "ImportGui", "Part", "PySide"}}


def text_of(program):
    """The code as its program gets it."""
    data = ADDONS[program].build("1.20.3", "the command")
    if program == "freecad":
        return data.decode()
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        return archive.read("linecad/__init__.py").decode()


@pytest.mark.parametrize("program", ADDONS)
def test_it_needs_nothing_but_its_program_and_the_standard_library(program):
    names = set()
    for node in ast.walk(ast.parse(text_of(program))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names.add(node.module.split(".")[0])
    assert names - sys.stdlib_module_names == THEIRS[program]


@pytest.mark.parametrize("program", ADDONS)
def test_no_name_of_one_module_takes_the_place_of_anothers(program):
    names = Counter()
    for node in ast.parse(joined(ENTRIES[program])).body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            names[node.name] += 1
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            names.update(target.id for target in targets)
    assert {name for name, count in names.items() if count > 1} == set()
    assert {"Request", "Running", "read_scene_file", "import_model"} <= names.keys()


@pytest.mark.parametrize("program", ADDONS)
def test_it_starts_by_saying_what_it_is_and_knows_the_command_that_wrote_it(program):
    tree = ast.parse(text_of(program))
    assert ast.get_docstring(tree).startswith("linecad in ")
    values = {
        node.targets[0].id: node.value.value
        for node in tree.body
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant)
    }
    assert values["WRITTEN_BY"] == "the command"


def test_blender_reads_the_version_from_both_of_its_files():
    with zipfile.ZipFile(io.BytesIO(ADDONS["blender"].build("1.20.3", ""))) as archive:
        assert sorted(archive.namelist()) == ["linecad/__init__.py", "linecad/blender_manifest.toml"]
        manifest = tomllib.loads(archive.read("linecad/blender_manifest.toml").decode())
    assert (manifest["id"], manifest["version"], manifest["type"]) == ("linecad", "1.20.3", "add-on")
    assert len(manifest["tagline"]) <= 64
    assert all(len(reason) <= 64 for reason in manifest["permissions"].values())
    # As Blender finds it, which does not run the file: from its line to the next empty one.
    lines = text_of("blender").splitlines()
    first = next(number for number, line in enumerate(lines) if line.startswith("bl_info"))
    head = "\n".join(lines[first : lines.index("", first)])
    assert ast.literal_eval(head.removeprefix("bl_info = "))["version"] == (1, 20, 3)


@pytest.mark.parametrize("program", ADDONS)
def test_the_same_add_on_has_the_same_bytes(program, tmp_path):
    for name in ("a", "b"):
        write_addon(program, tmp_path / name, __version__, "")
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_a_place_that_cannot_be_written_is_refused(tmp_path):
    with pytest.raises(OutputError, match="make it first"):
        write_addon("freecad", tmp_path / "none" / "a.FCMacro", __version__, "")
