"""The front door: names that load what they need when they are used, for users, type checkers and completion."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import linecad
from linecad.convert import Conversion
from linecad.corrections.edits import Corrections
from linecad.corrections.file import write_corrections
from linecad.errors import CorrectionsFileError
from linecad.io.scene_file import scene_to_json

ROOT = Path(__file__).resolve().parents[2]
ROOM = ROOT / "samples" / "room.jpg"
FAST = linecad.Options(solve=linecad.SolveOptions(fast=True))

SCRIPT = """
import linecad

options = linecad.Options(extension=60.0, solve=linecad.SolveOptions(fast=True))
try:
    scene: linecad.Scene = linecad.reconstruct("facade.jpg", camera="facade.json", options=options)
except linecad.LinecadError as error:
    raise SystemExit(str(error)) from error
focal: float = scene.camera.focal
linecad.export(scene, "facade.glb", photo="facade.jpg", tubes=True, texture_size=1024)
again: linecad.Scene = linecad.read_scene("facade.json")
"""


@pytest.fixture(scope="module")
def scene():
    return linecad.reconstruct(str(ROOM), options=FAST)


def test_what_is_named_is_what_the_library_has():
    from linecad.options import Options
    from linecad.scene import Scene

    assert (linecad.Options, linecad.Scene) == (Options, Scene)
    assert set(linecad.__all__) <= set(dir(linecad))
    for name in linecad.__all__:
        assert getattr(linecad, name) is not None


def test_a_name_that_is_not_there_is_an_attribute_error():
    with pytest.raises(AttributeError, match="'linecad' has no attribute 'reconstrut'"):
        _ = linecad.reconstrut


def test_importing_loads_nothing():
    script = (
        "import sys; before = set(sys.modules); import linecad; linecad.__version__; "
        "loaded = {name.split('.')[0] for name in set(sys.modules) - before}; "
        "print(loaded - sys.stdlib_module_names)"
    )
    ended = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True, timeout=60
    )
    assert ended.stdout == "{'linecad'}\n"


def test_a_reconstruction_loads_no_networkx():
    script = "import sys, linecad.convert; print('networkx' in sys.modules)"
    ended = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True, timeout=60
    )
    assert ended.stdout == "False\n"


@pytest.mark.parametrize("start", ["solver.solve", "exporters.formats", "linecad.scene"])
def test_every_package_may_be_the_first_one_loaded(start):
    script = f"import {start}; import linecad; linecad.reconstruct, linecad.export"
    subprocess.run([sys.executable, "-c", script], cwd=ROOT, check=True, timeout=60)


@pytest.mark.thorough
def test_a_script_of_a_user_passes_the_strict_type_checker(tmp_path):
    (tmp_path / "script.py").write_text(SCRIPT)
    (tmp_path / "wrong.py").write_text("import linecad\nlinecad.reconstruct(3)\nlinecad.reconstrut\n")
    command = [sys.executable, "-m", "mypy", "--config-file", str(ROOT / "pyproject.toml"), "--no-incremental"]
    ended = subprocess.run(
        [*command, str(tmp_path / "script.py"), str(tmp_path / "wrong.py")], cwd=ROOT, capture_output=True, text=True,
        check=False, timeout=500,
    )  # fmt: skip
    assert "script.py" not in ended.stdout
    assert "wrong.py:2: error" in ended.stdout
    assert ended.stdout.splitlines()[-1].startswith("Found ")


@pytest.mark.thorough
def test_the_script_of_the_readme_runs(tmp_path, monkeypatch, capsys):
    (script,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.DOTALL)
    for name, sample in (("facade.jpg", "room.jpg"), ("facade.camera.json", "room.json")):
        shutil.copy(ROOT / "samples" / sample, tmp_path / name)
    monkeypatch.chdir(tmp_path)
    given = "linecad.Options(extension=60.0"
    assert given in script
    exec(script.replace(given, f"{given}, solve=linecad.SolveOptions(fast=True)"), {})
    assert {path.name for path in tmp_path.iterdir()} >= {"facade.json", "facade.step"}
    assert "do not meet" in capsys.readouterr().out


def test_a_photo_becomes_files(scene, tmp_path):
    linecad.export(scene, tmp_path / "a.json")
    linecad.export(scene, str(tmp_path / "a.dxf"), version="R2018")
    assert (tmp_path / "a.json").read_text(encoding="utf-8") == scene_to_json(scene)
    assert scene_to_json(linecad.read_scene(tmp_path / "a.json")) == scene_to_json(scene)
    assert "AC1032" in (tmp_path / "a.dxf").read_text()[:400]


@pytest.mark.thorough
def test_the_camera_may_be_named_in_two_ways():
    given = linecad.reconstruct(ROOM, camera=ROOM.with_suffix(".json"), options=FAST)
    assert given.camera.source == "file"
    assert linecad.reconstruct(ROOM, focal=given.camera.focal, options=FAST).camera.source == "focal option"


def test_the_camera_is_not_named_in_both_ways():
    with pytest.raises(linecad.LinecadError, match="both a camera file and a focal length"):
        linecad.reconstruct(ROOM, ROOM.with_suffix(".json"), 900.0)


def test_corrections_are_those_of_the_photo(tmp_path):
    write_corrections(Corrections("room.jpg", 400, 300), tmp_path / "said.json")
    with pytest.raises(CorrectionsFileError, match="said"):
        linecad.reconstruct(ROOM, corrections=tmp_path / "said.json")
    with pytest.raises(CorrectionsFileError, match="none"):
        Conversion(corrections=tmp_path / "none.json").checked()


def test_a_format_that_shows_the_photo_takes_it(scene, tmp_path):
    with pytest.warns(UserWarning, match="the photo 'room.jpg' was not given; the faces have no textures"):
        linecad.export(scene, tmp_path / "plain.glb")
    linecad.export(scene, tmp_path / "textured.glb", photo=str(ROOM), texture_size=512)
    assert (tmp_path / "textured.glb").stat().st_size > (tmp_path / "plain.glb").stat().st_size
    with pytest.raises(linecad.LinecadError, match="textures were asked for, but the photo"):
        linecad.export(scene, tmp_path / "b.glb", textures=True)
    with pytest.raises(linecad.LinecadError, match="400 x 300 px"):
        linecad.export(scene, tmp_path / "b.glb", photo=other_photo(tmp_path))
    assert not (tmp_path / "b.glb").exists()


def other_photo(folder):
    from PIL import Image

    Image.new("RGB", (400, 300)).save(folder / "other.png")
    return folder / "other.png"


@pytest.mark.parametrize(
    ("name", "options", "words"),
    [
        ("a.doc", {}, "unknown suffix .doc"),
        ("none/a.step", {}, "does not exist"),
        ("a.json", {"tubes": True}, "no option 'tubes' for the scene file"),
        ("a.glb", {"texture_size": 3}, "option texture-size is '3', expected a whole number from 256 to 16384"),
        ("a.glb", {"tubes": "perhaps"}, "option tubes is 'perhaps', expected on or off"),
    ],
)
def test_what_cannot_be_written_is_told_in_one_line(scene, tmp_path, name, options, words):
    with pytest.raises(linecad.LinecadError, match=words):
        linecad.export(scene, tmp_path / name, **options)
    assert list(tmp_path.iterdir()) == []
