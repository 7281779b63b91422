"""A solved scene is kept wherever a folder takes files."""

from pathlib import Path

import pytest

import linecad
from linecad.errors import OutputError
from linecad.io.scene_file import read_scene, scene_to_json
from linecad.options import Options
from linecad.outputs import keep_scene
from solver.options import SolveOptions

ROOM = Path(__file__).resolve().parents[2] / "samples" / "room.jpg"


@pytest.fixture(scope="module")
def solved():
    return linecad.reconstruct(ROOM, options=Options(solve=SolveOptions(fast=True)))


@pytest.fixture
def here(tmp_path, monkeypatch):
    """The current folder, with the folder `ok` in it; `gone` is none."""
    (tmp_path / "ok").mkdir()
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("outputs", "kept"),
    [
        (["ok/a.dxf", "ok/a.json"], "ok/a.json"),
        (["gone/a.json", "ok/b.dxf"], "ok/b.json"),
        (["gone/a.dxf", "gone/b.stl", "ok/c.dxf"], "ok/c.json"),
        (["gone/a.json", "ok/taken.dxf"], "ok/taken.2.json"),
        (["gone/a.json", "ok/b.dxf", "ok/c.json"], "ok/c.json"),
        (["gone/a.dxf"], "a.json"),
        (["gone/taken.json"], "taken.2.json"),
    ],
)
def test_the_first_place_that_takes_the_scene_keeps_it(solved, here, outputs, kept):
    others = [here / "taken.json", here / "ok" / "taken.json"]
    for other in others:
        other.write_text("something else")
    assert keep_scene(solved, [Path(output) for output in outputs]) == Path(kept)
    assert scene_to_json(read_scene(kept)) == scene_to_json(solved)
    assert sorted(here.rglob("*.json")) == sorted([*others, here / kept])
    assert [other.read_text() for other in others] == ["something else"] * 2


@pytest.mark.usefixtures("bound_by_permissions")
def test_a_named_file_that_is_protected_has_one_beside_it(solved, here):
    protected = here / "ok" / "a.json"
    protected.write_text("mine")
    protected.chmod(0o400)
    assert keep_scene(solved, [Path("ok/a.json")]) == Path("ok/a.2.json")
    assert protected.read_text() == "mine"


@pytest.mark.usefixtures("bound_by_permissions")
def test_where_no_place_takes_it_the_first_one_is_told(solved, here):
    here.chmod(0o500)
    try:
        with pytest.raises(OutputError, match="the folder gone does not exist"):
            keep_scene(solved, [Path("gone/a.json"), Path("lost/b.dxf")])
    finally:
        here.chmod(0o700)
    assert list(here.rglob("*.json")) == []
