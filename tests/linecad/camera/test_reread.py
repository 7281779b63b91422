"""The photo of a scene, read again: straightened as it was, or refused."""

import json
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from linecad.camera.photo import read_photo
from linecad.camera.reread import find_beside, reread_photo
from linecad.errors import CameraError, PhotoError

WIDTH, HEIGHT = 120, 90


@pytest.fixture
def photo(tmp_path):
    pixels = np.random.default_rng(3).integers(0, 255, (HEIGHT, WIDTH, 3), np.uint8)
    Image.fromarray(pixels).save(tmp_path / "a.png")
    return tmp_path / "a.png"


def camera_file(folder, fy=150.0, **more):
    path = folder / "camera.json"
    path.write_text(json.dumps({"width": WIDTH, "height": HEIGHT, "K": [[150, 0, 61], [0, fy, 37], [0, 0, 1]], **more}))
    return path


BENT = {"distortion": [-0.1, 0.01, 0, 0]}


@pytest.mark.parametrize(
    "more",
    [{"fy": 165.0}, BENT, {"fy": 165.0, **BENT}, {"fy": 150.000001, **BENT}],
    ids=["not square", "bent", "both", "nearly square and bent"],
)
def test_what_a_camera_file_straightened_does_not_need_it_again(photo, tmp_path, more):
    """A scene with fx and fy apart lost its textures at export unless the camera file was given again."""
    file = camera_file(tmp_path, **more)
    first = read_photo(photo, file)
    for given in (None, file):
        again = reread_photo(photo, "a.png", first.camera, given)
        np.testing.assert_array_equal(again.pixels, first.pixels)
        assert again.camera.taken_fy == more.get("fy")


def test_scenes_of_earlier_versions_need_the_camera_file_where_pixels_were_not_square(photo, tmp_path):
    file = camera_file(tmp_path, fy=165.0)
    former = replace(read_photo(photo, file).camera, taken_fy=None)
    with pytest.raises(CameraError, match=r"a\.png was straightened by its calibration; give that with --camera"):
        reread_photo(photo, "a.png", former)
    np.testing.assert_array_equal(reread_photo(photo, "a.png", former, file).pixels, read_photo(photo, file).pixels)


def test_pixels_that_stayed_need_no_camera_file(photo, tmp_path):
    first = read_photo(photo, camera_file(tmp_path))
    np.testing.assert_array_equal(reread_photo(photo, "a.png", first.camera).pixels, first.pixels)


def test_another_calibration_is_refused(photo, tmp_path):
    first = read_photo(photo, camera_file(tmp_path))
    with pytest.raises(CameraError, match="not the calibration that the scene was made with"):
        reread_photo(photo, "a.png", first.camera, camera_file(tmp_path, fy=165.0, distortion=[-0.1, 0.01, 0, 0]))


def test_a_photo_of_another_size_is_refused(photo, tmp_path):
    first = read_photo(photo, camera_file(tmp_path))
    Image.new("RGB", (100, 90)).save(photo)
    with pytest.raises(PhotoError, match="has 100 x 90 px, the scene's photo 120 x 90"):
        reread_photo(photo, "a.png", first.camera)


def test_only_the_name_of_a_photo_counts(photo, tmp_path):
    (tmp_path / "inside").mkdir()
    assert find_beside("elsewhere/a.png", tmp_path / "scene.json") == photo
    assert find_beside("../a.png", tmp_path / "inside" / "scene.json") is None
