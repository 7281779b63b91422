"""`linecad camera`: what it prints and writes, and what it refuses."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from linecad.cli.main import main

ROOT = Path(__file__).resolve().parents[3]
SAMPLES = ROOT / "samples"
ROOM = SAMPLES / "room.jpg"


def test_camera_prints_what_it_found(capsys):
    assert main(["camera", str(ROOM), "--quiet"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    names = [line[:19].strip() for line in out.splitlines()]
    assert names[:4] == ["photo", "quality", "focal length", "field of view"]


def test_camera_writes_all_its_files_and_says_how_good_it_is(folder, capsys):
    outputs = ["a.json", "a.fspy", "a.png"]
    assert main(["camera", str(ROOM), *(part for name in outputs for part in ("-o", name))]) == 0
    out, err = capsys.readouterr()
    assert out.splitlines()[0].startswith("camera ")
    assert err.splitlines()[-1] == "writing a.png"
    assert sorted(path.name for path in folder.iterdir()) == sorted(outputs)


@pytest.mark.thorough
def test_convert_with_the_written_camera_has_the_same_frame(folder, capsys):
    assert main(["camera", str(ROOM), "-o", "camera.json", "--quiet"]) == 0
    for name, more in (("a.json", []), ("b.json", ["--camera", "camera.json"])):
        assert main(["convert", str(ROOM), "-o", name, "--fast", "--quiet", *more]) == 0
        assert "camera " in capsys.readouterr().out
    first, second = (json.loads((folder / name).read_text()) for name in ("a.json", "b.json"))
    assert second["camera"]["K"] == first["camera"]["K"]
    turn = np.array(first["camera"]["R_cam_from_world"]).T @ second["camera"]["R_cam_from_world"]
    assert np.degrees(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1))) < 0.1
    assert set(first["certainty"]) == {"quality", "reason", "rotation_degrees", "focal", "principal_point", "k1"}


def test_camera_refuses_what_it_cannot_write_before_it_reads(fails):
    assert "a camera is written as" in fails("camera", "none.jpg", "-o", "a.step")
    assert "does not exist" in fails("camera", "none.jpg", "-o", "none/a.json")
    assert "named twice" in fails("camera", "none.jpg", "-o", "a.json", "-o", "a.json")
    assert "none.jpg" in fails("camera", "none.jpg", "-o", "a.json")


def test_camera_keeps_its_inputs(fails, folder):
    shutil.copy(ROOM, folder / "room.png")
    shutil.copy(SAMPLES / "room.json", folder)
    assert "is an input too" in fails("camera", "room.png", "-o", "room.png")
    assert "is an input too" in fails("camera", "room.png", "--camera", "room.json", "-o", "room.json")


def test_camera_takes_one_camera(fails):
    assert "not allowed with" in fails("camera", "a.jpg", "--camera", "a.json", "--focal", "900", code=2)


def test_camera_refuses_a_photo_without_lines(fails, folder):
    Image.new("RGB", (640, 480), "grey").save(folder / "grey.png")
    assert "0 straight segments found" in fails("camera", "grey.png", "-o", "a.json", "-o", "a.png")
