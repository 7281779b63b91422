"""The camera fitted again to the lines that meet in space: when, and that what meets nothing has no say then."""

import numpy as np
import pytest

from linecad.camera.estimate import calibrate
from linecad.camera.exif_focal import ExifFocal
from linecad.camera.photo import Photo
from linecad.camera.refit import _lies_on, find_calibration
from linecad.scene import Camera

AGAIN = "fitting the camera again to the lines that meet in space"


def photo_of(made, camera=None, exif_focal=None):
    pixels = np.zeros((made.camera.height, made.camera.width, 3), np.uint8)
    return Photo("made.png", pixels, camera, (), exif_focal, "whole")


def test_a_camera_from_vanishing_points_alone_is_fitted_again_to_lines_that_meet(made, monkeypatch):
    chosen = []

    def again(_photo, _raw, first, segments):
        chosen.append(segments)
        return first

    monkeypatch.setattr("linecad.camera.refit.calibrate_again", again)
    raw = made.noisy(0.3)
    # Pieces of a cable along x, far above both boxes: they meet nothing.
    cable = np.array([[[40.0 + 70 * k, 20.0 + 3 * k], [90.0 + 70 * k, 22.0 + 3 * k]] for k in range(12)])
    stages = []
    find_calibration(photo_of(made), raw.joined(type(raw)(cable, np.full(len(cable), -1))), stages.append)
    assert stages == [AGAIN]
    assert len(chosen[0]) > len(raw) / 2
    assert chosen[0].ends.mean(axis=1)[:, 1].min() > cable[..., 1].max()


def test_the_second_fit_is_as_near_the_truth(made):
    found = find_calibration(photo_of(made), made.noisy(0.3))
    assert found.camera.source == "vanishing points"
    assert found.camera.focal == pytest.approx(made.camera.focal, rel=0.03)


@pytest.mark.parametrize("source", ["file", "exif"])
def test_a_camera_that_is_known_is_fitted_once(made, source):
    given = Camera(made.camera.width, made.camera.height, made.camera.matrix, "file")
    exif_focal = ExifFocal(made.camera.focal, 0.03, "EXIF")
    photo = photo_of(made, given) if source == "file" else photo_of(made, exif_focal=exif_focal)
    stages = []
    found = find_calibration(photo, made.noisy(0.3), stages.append)
    assert stages == []
    assert found.camera.matrix.tolist() == calibrate(photo, made.noisy(0.3)).camera.matrix.tolist()


def test_a_piece_lies_on_a_line_when_its_middle_does():
    line = np.array([[[0.0, 0.0], [100.0, 0.0]]])
    middles = np.array([[50.0, 2.9], [50.0, 3.1], [102.9, 0.0], [103.1, 0.0], [-2.9, 0.0], [-3.1, 0.0]])
    pieces = middles[:, None] + np.array([[-40.0, -30.0], [40.0, 30.0]])
    assert _lies_on(pieces, line, 3.0).tolist() == [True, False, True, False, True, False]
