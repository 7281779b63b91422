"""Standard errors and words of a camera and its frame."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.camera.estimate import calibrate
from linecad.camera.exif_focal import FocalHint
from linecad.camera.joint_fit import CENTER_X, CENTER_Y, FOCAL, PARAMETERS, TURNS, Fit, View
from linecad.camera.photo import Bend, Photo
from linecad.camera.uncertainty import OTHER_GAIN, Doubts, Other, certainty_of, other_camera
from linecad.geometry import rotation_about
from linecad.line_graph import ManhattanFrame, Segments
from linecad.scene import Camera

MANY = np.array([60, 60, 60])


def fit_of(focal=900.0, turn=0.0, posterior=0.0):
    """A sure fit whose axes are turned by `turn` rad about the first of them."""
    covariance = np.diag([1e-6, 1e-6, 1e-6, 1e-4, 1e-6, 1e-6, 0.0])
    assert len(covariance) == PARAMETERS
    axes = rotation_about(np.array([turn, 0.0, 0.0]))
    view = View(axes, focal, np.array([799.5, 599.5]))
    return Fit(view, covariance, posterior, np.full(4, 0.25), axes, 0.004, np.zeros((4, 0)))


def certainty(lines=MANY, source="vanishing points", doubts=None, fit=None, bend=None):
    """The certainty of a frame that explains nearly everything."""
    fit = fit or fit_of()
    camera = Camera(1600, 1200, fit.view.matrix, source)
    frame = ManhattanFrame(np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]]), 0.001, 0.9)
    raw = Segments(np.array([[[0.0, 0.0], [100.0, 0.0]]] * 12), np.full(12, -1))
    return certainty_of(camera, frame, fit, np.asarray(lines), raw, doubts or Doubts(), bend)[0]


def test_many_lines_along_each_axis_are_good():
    found = certainty()
    assert found.quality == "good"
    assert found.focal == pytest.approx(9.0, rel=0.01)


def test_an_axis_of_three_lines_may_be_wrong_by_much():
    found = certainty([60, 60, 3])
    assert found.quality == "poor"
    assert found.focal > 0.2 * 900
    assert found.rotation.min() > np.radians(5)


def test_with_a_given_camera_two_axes_are_enough():
    assert certainty([60, 60, 0], "file").quality == "good"
    assert certainty([60, 60, 0], "exif").quality == "good"
    assert certainty([60, 3, 0], "file").quality == "poor"


@pytest.mark.parametrize(("radial", "word"), [(-0.02, "good"), (-0.13, "doubtful"), (0.13, "doubtful")])
def test_a_strong_bend_is_not_called_good(radial, word):
    found = certainty(bend=Bend(radial, 0.002, (799.5, 599.5), 5.0))
    assert found.quality == word
    assert found.radial is not None


def test_k1_is_no_surer_than_the_focal_length_allows():
    bend = Bend(-0.05, 0.001, (799.5, 599.5), 5.0)
    k1 = bend.radial * (900 / 1000) ** 2
    assert certainty(bend=bend).radial > abs(k1) * 2 * 0.01
    assert certainty(bend=bend, source="focal option").radial == pytest.approx(0.001 * 0.9**2)


def test_vanishing_points_alone_need_a_smaller_error_than_exif():
    fit = fit_of()
    fit.covariance[FOCAL, FOCAL] = 0.04**2
    assert certainty(fit=fit).quality == "doubtful"
    assert certainty(fit=fit, source="exif").quality == "good"


def test_few_lines_in_all_are_said():
    found = certainty([30, 30, 30])
    assert found.quality == "doubtful"
    assert "(90)" in found.reason


def test_another_camera_that_does_as_well_is_within_two_standard_errors():
    found = certainty(doubts=Doubts(other=Other(0.3, 0.1)))
    assert found.quality == "doubtful"
    assert "another camera" in found.reason
    assert 2 * found.focal > 0.3 * 900
    assert 2 * found.rotation.min() > 0.1


@pytest.mark.parametrize(
    ("focal", "turn", "worse", "expected"),
    [
        (1200.0, 0.0, 0.5, True),
        (900.0, 0.2, 0.5, True),
        (930.0, 0.01, 0.5, False),
        (900.0, np.pi / 2, 0.5, False),
        (1200.0, 0.2, 1.5, False),
    ],
    ids=["other focal length", "other frame", "the same", "only other names", "much worse"],
)
def test_another_camera_is_far_away_and_nearly_as_likely(focal, turn, worse, expected):
    segments = 500
    best = fit_of()
    other = fit_of(focal, turn, -worse * OTHER_GAIN * segments)
    found = other_camera(best, [best, other], segments)
    assert (found is not None) == expected
    if found is not None:
        assert found.focal == pytest.approx(abs(np.log(focal / 900)))
        assert found.turn == pytest.approx(turn, abs=1e-6)


def test_principal_point_is_as_sure_as_the_fit_says():
    fit = fit_of()
    fit.covariance[CENTER_X, CENTER_X], fit.covariance[CENTER_Y, CENTER_Y] = 1e-4, 4e-4
    assert certainty(fit=fit).center == pytest.approx((16.0, 32.0))
    assert fit.covariance[FOCAL, FOCAL] == 1e-4
    assert np.diag(fit.covariance)[TURNS].max() == 1e-6


@pytest.fixture
def photo(made):
    return Photo("made.png", np.zeros((made.camera.height, made.camera.width, 3), np.uint8), None, (), None, "whole")


def test_exif_of_a_whole_photo_wins_a_contradiction(made, photo):
    hint = FocalHint(1.6 * made.camera.focal, 0.03, "EXIF")
    found = calibrate(replace(photo, hint=hint), made.noisy(0.3, 0))
    assert found.camera.source == "exif"
    assert found.camera.focal == hint.focal
    assert found.certainty.quality != "good"
    assert any("EXIF is believed" in note for note in found.notes)
