"""Camera files: what is written is read again as the same camera, whatever else stands there."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from scipy.spatial.transform import Rotation

from linecad.camera.camera_file import SUFFIXES, check_suffix, json_of, write_camera
from linecad.camera.intrinsics import read_calibration
from linecad.camera.report import find_camera
from linecad.errors import OutputError

ROOM = Path(__file__).resolve().parents[3] / "samples" / "room.jpg"
DISTORTED = {
    "width": 1600,
    "height": 1067,
    "K": [[1067.0, 0, 790.0], [0, 1080.0, 541.0], [0, 0, 1]],
    "distortion": [-0.08, 0.01, 0.0, 0.0],
}


@pytest.fixture(scope="module")
def room():
    return find_camera(ROOM)


@pytest.fixture(scope="module")
def distorted(tmp_path_factory):
    """The room through a lens with distortion and pixels that are not square."""
    path = tmp_path_factory.mktemp("given") / "camera.json"
    path.write_text(json.dumps(DISTORTED))
    return find_camera(ROOM, path)


def test_the_written_camera_is_read_again_with_the_same_frame(room, tmp_path):
    path = tmp_path / "camera.json"
    write_camera(room, path)
    again = find_camera(ROOM, path)
    np.testing.assert_array_equal(again.camera.matrix, room.camera.matrix)
    turn = Rotation.from_matrix(again.frame.rotation @ room.frame.rotation.T)
    assert np.degrees(turn.magnitude()) < 0.1
    assert again.camera.source == "file"


def test_a_camera_that_distorts_is_written_as_it_was_given(distorted, tmp_path):
    path = tmp_path / "camera.json"
    write_camera(distorted, path)
    document = json.loads(path.read_text())
    assert {key: document[key] for key in DISTORTED} == DISTORTED
    again = find_camera(ROOM, path)
    np.testing.assert_array_equal(again.frame.rotation, distorted.frame.rotation)
    np.testing.assert_array_equal(again.photo.pixels, distorted.photo.pixels)


def test_the_other_keys_tell_what_was_found(room):
    document = json.loads(json_of(room))
    assert document["source"] == room.camera.source
    np.testing.assert_array_equal(document["R_cam_from_world"], room.frame.rotation)
    assert document["certainty"]["quality"] == room.certainty.quality
    assert [point["axis"] for point in document["vanishing_points"]] == ["x", "y", "z"]
    assert document["vanishing_points"][1]["pixel"] == list(room.vanishing_points[1].pixel)
    np.testing.assert_array_equal(document["horizon"], room.horizon)
    assert document["notes"] == list(room.notes)


def test_a_name_that_is_not_unicode_is_written(room):
    strange = replace(room, photo=replace(room.photo, name="caf\udce9.jpg"))
    assert json.loads(json_of(strange))["photo"] == "caf?.jpg"


def test_an_fspy_project_is_read_again_as_the_same_camera(room, tmp_path):
    path = tmp_path / "camera.fspy"
    write_camera(room, path)
    again = read_calibration(path)
    assert (again.width, again.height) == (1600, 1067)
    np.testing.assert_allclose(again.matrix, room.camera.matrix, rtol=1e-12)


def test_the_picture_is_a_png_of_a_size_for_screens(room, tmp_path):
    write_camera(room, tmp_path / "camera.PNG")
    with Image.open(tmp_path / "camera.PNG") as picture:
        assert picture.format == "PNG"
        assert 1000 <= picture.width <= 2000


@pytest.mark.parametrize("name", ["camera.step", "camera", "camera.json.bak"])
def test_other_suffixes_are_refused(name, tmp_path):
    with pytest.raises(OutputError, match=r"a camera is written as \.json, \.fspy or \.png"):
        check_suffix(tmp_path / name)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_missing_folder_is_refused_and_nothing_left(room, tmp_path, suffix):
    with pytest.raises(OutputError, match="does not exist"):
        write_camera(room, tmp_path / "none" / f"camera{suffix}")
    assert list(tmp_path.iterdir()) == []
