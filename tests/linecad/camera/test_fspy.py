"""Cameras out of fSpy projects: exact, and hostile files refused in one line."""

import json
import struct
from pathlib import Path

import numpy as np
import pytest

from exporters.formats import export
from linecad.camera.intrinsics import read_calibration
from linecad.errors import CameraError
from linecad.scene import Camera, Intersections, Lines, Scene, SolveReport

CAMERA = {
    "principalPoint": {"x": 0.1, "y": -0.05},
    "horizontalFieldOfView": 1.0,
    "relativeFocalLength": 1.830487721712452,
    "imageWidth": 1000,
    "imageHeight": 800,
}


def project(camera, version=1, magic=b"fspy", image=b"IMAGE", state=None):
    state = json.dumps({"cameraParameters": camera}).encode() if state is None else state
    return struct.pack("<4sIII", magic, version, len(state), len(image)) + state + image


def saved(folder, data):
    path = Path(folder) / "a.fspy"
    path.write_bytes(data)
    return path


def test_the_camera_counts_pixels_from_their_centres(tmp_path):
    found = read_calibration(saved(tmp_path, project(CAMERA)))
    assert (found.width, found.height, found.distortion) == (1000, 800, ())
    expected = [[915.243860856226, 0, 549.5], [0, 915.243860856226, 424.5], [0, 0, 1]]
    np.testing.assert_allclose(found.matrix, expected, rtol=1e-12)


def test_the_angle_alone_gives_the_focal_length(tmp_path):
    angle = {key: value for key, value in CAMERA.items() if key != "relativeFocalLength"}
    found = read_calibration(saved(tmp_path, project(angle)))
    assert found.matrix[0, 0] == pytest.approx(500 / np.tan(0.5), rel=1e-12)


def test_the_angle_of_a_tall_photo_is_that_of_its_height(tmp_path):
    tall = {**CAMERA, "imageWidth": 800, "imageHeight": 1000}
    tall.pop("relativeFocalLength")
    found = read_calibration(saved(tmp_path, project(tall)))
    assert found.matrix[0, 0] == pytest.approx(500 / np.tan(0.5), rel=1e-12)
    np.testing.assert_allclose(found.matrix[:2, 2], [400 + 50 - 0.5, 500 + 25 - 0.5])


@pytest.mark.parametrize("size", [(1600, 1067), (1067, 1600), (701, 700), (4000, 3000)])
def test_what_is_written_is_read_back_to_rounding(tmp_path, size):
    width, height = size
    matrix = [[1084.463893, 0, 805.9 / 1600 * width], [0, 1084.463893, 528.2 / 1067 * height], [0, 0, 1]]
    lines = Lines(
        id=[0], axis=[0], segment=[[[1, 2], [30, 40]]], ends=[[[0, 4, 0], [1, 4, 0]]], is_boundary=[False],
        component=[0], confidence=["weak"],
    )  # fmt: skip
    none = Intersections(lines=[], kind=[], pixel=[], real=[], in_tree=[], weight=[])
    camera = Camera(width, height, matrix, "file")
    rotation = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    report = SolveReport("x", "gain", "optimal", 0, 0, 0)
    scene = Scene("a.jpg", camera, rotation, lines, none, (), report)
    export(scene, tmp_path / "a.fspy", np.zeros((height, width, 3), np.uint8))
    found = read_calibration(tmp_path / "a.fspy")
    assert (found.width, found.height) == size
    np.testing.assert_allclose(found.matrix, matrix, rtol=1e-14, atol=1e-11)


def without(key):
    return {name: value for name, value in CAMERA.items() if name != key}


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "is no fSpy project"),
        (b"fsp", "is no fSpy project"),
        (b"fspy\x01\x00\x00\x00", "is no fSpy project"),
        (b"\x89PNG" + bytes(100), "is no fSpy project"),
        (b'{"width": 3}' + bytes(100), "is no fSpy project"),
        (project(CAMERA, version=2), "of version 2, but only 1"),
        (project(CAMERA, version=2**32 - 1), "of version 4294967295"),
        (project(CAMERA)[:-1], "is cut short"),
        (project(CAMERA)[:40], "is cut short"),
        (struct.pack("<4sIII", b"fspy", 1, 2**32 - 1, 0), "4295 MB, far too much"),
        (struct.pack("<4sIII", b"fspy", 1, 0, 2**32 - 1), "is cut short"),
        (project(CAMERA, state=b"\xff\xfe{}"), "not text in UTF-8"),
        (project(CAMERA, state=b""), "not JSON"),
        (project(CAMERA, state=b"[" * 100000), "nested too deeply"),
        (project(CAMERA, state=b"[]"), "the file is a list of 0, expected an object"),
        (project(CAMERA, state=b"{}"), "cameraParameters is missing"),
        (project(None), "holds no camera"),
        (project([]), "cameraParameters is a list of 0"),
        (project(without("principalPoint")), "cameraParameters.principalPoint is missing"),
        (project({**CAMERA, "principalPoint": {"x": "0", "y": 0}}), 'x is "0", expected a number'),
        (project({**CAMERA, "principalPoint": {"x": 9, "y": 0}}), "principal point"),
        (project({**CAMERA, "principalPoint": {"x": 1e300, "y": 0}}), "expected a finite number of at most"),
        (project(without("imageWidth")), "imageWidth is missing"),
        (project({**CAMERA, "imageWidth": 0}), "a whole number from 1"),
        (project({**CAMERA, "imageHeight": 1e9}), "a whole number from 1"),
        (project({**CAMERA, "relativeFocalLength": 0}), "fx"),
        (project({**CAMERA, "relativeFocalLength": -1}), "fx"),
        (project({**CAMERA, "relativeFocalLength": 1e5}), "fx"),
        (project({**without("relativeFocalLength"), "horizontalFieldOfView": 0}), "an angle between 0 and pi"),
        (project({**without("relativeFocalLength"), "horizontalFieldOfView": 4}), "an angle between 0 and pi"),
        (project(without("relativeFocalLength")).replace(b"1.0", b"NaN"), "NaN"),
    ],
)
def test_a_file_that_is_no_whole_project_is_refused_in_one_line(tmp_path, data, words):
    path = saved(tmp_path, data)
    with pytest.raises(CameraError) as caught:
        read_calibration(path)
    assert words in str(caught.value)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_missing_project_and_a_folder(tmp_path):
    with pytest.raises(CameraError, match="is missing"):
        read_calibration(tmp_path / "none.fspy")
    (tmp_path / "folder.fspy").mkdir()
    with pytest.raises(CameraError, match="is a folder"):
        read_calibration(tmp_path / "folder.fspy")
