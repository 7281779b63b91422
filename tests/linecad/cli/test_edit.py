"""With which camera `linecad edit` begins."""

import shutil
from pathlib import Path

import pytest
from PIL import Image

from linecad.camera.refit import find_calibration
from linecad.cli.main import main
from linecad.io.scene_file import read_scene
from linecad.lines.segments import find_segments

ROOT = Path(__file__).resolve().parents[3]
SAMPLES = ROOT / "samples"
ROOM = SAMPLES / "room.jpg"
COURTYARD = SAMPLES / "courtyard.jpg"


@pytest.fixture
def edited(monkeypatch):
    """A function that gives the camera and the quality with which `linecad edit` would begin."""

    def begin(*arguments):
        seen = []
        monkeypatch.setattr("linecad.editing.run.edit", lambda photo, *_: seen.append(photo))
        assert main(["edit", *arguments, "--no-browser", "--quiet"]) == 0
        found = find_calibration(seen[0], find_segments(seen[0].grey))
        return found.camera, found.certainty

    return begin


@pytest.mark.parametrize(
    ("photo", "options", "source"),
    [
        (ROOM, [], "exif"),
        pytest.param(COURTYARD, [], "vanishing points", marks=pytest.mark.thorough),
        pytest.param(COURTYARD, ["--focal", "1040"], "focal option", marks=pytest.mark.thorough),
    ],
)
def test_the_page_of_a_scene_begins_with_the_camera_of_the_scene(folder, edited, photo, options, source):
    """It once forgot what EXIF had said, and by how much the photo had been straightened."""
    shutil.copy(photo, folder)
    assert main(["convert", photo.name, "-o", "scene.json", "--fast", "--quiet", *options]) == 0
    scene = read_scene(folder / "scene.json")
    camera, certainty = edited("scene.json")
    assert camera.source == scene.camera.source == source
    assert camera.matrix == pytest.approx(scene.camera.matrix)
    assert camera.distortion == pytest.approx(scene.camera.distortion)
    assert bool(camera.distortion) == (photo is COURTYARD)
    assert certainty.quality == scene.certainty.quality
    assert certainty.focal == pytest.approx(scene.certainty.focal)


@pytest.mark.thorough
def test_the_page_of_a_scene_takes_another_focal_length(folder, edited, scene_file):
    shutil.copy(scene_file, folder / "scene.json")
    camera, _ = edited("scene.json", "--photo", str(ROOM), "--focal", "950")
    assert (camera.source, camera.focal) == ("focal option", 950.0)


def test_the_page_of_a_scene_refuses_a_photo_of_another_size(fails, folder, scene_file):
    shutil.copy(scene_file, folder / "scene.json")
    Image.new("RGB", (400, 300)).save(folder / "other.png")
    assert "has 400 x 300 px, the scene's photo 1600 x 1067" in fails("edit", "scene.json", "--photo", "other.png")
