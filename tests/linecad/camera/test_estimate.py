"""Camera and frame of made segments, and how sure they are."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.camera.estimate import calibrate, likely_fits, prior_of
from linecad.camera.exif_focal import ExifFocal
from linecad.camera.photo import Photo
from linecad.camera.vanishing_points import default_focal
from linecad.line_graph import Segments
from linecad.scene import Camera


def photo_of(made, camera=None, exif_focal=None, crop="whole"):
    """A photo of which only the size counts."""
    pixels = np.zeros((made.camera.height, made.camera.width, 3), np.uint8)
    return Photo("made.png", pixels, camera, (), exif_focal, crop)


def frontal():
    """Segments with x and z at infinity and y in the middle: any focal length explains them."""
    rng = np.random.default_rng(1)
    start = rng.uniform(200, 1000, (60, 2))
    along = np.where((np.arange(60) % 2 == 0)[:, None], [100.0, 0.0], [0.0, 100.0])
    ends = np.stack([start, start + along], axis=1) + rng.normal(0, 0.2, (60, 2, 2))
    return Segments(ends, np.full(60, -1))


def test_focal_length_of_exact_segments_is_almost_the_true_one(made):
    found = calibrate(photo_of(made), made.unlabelled)
    assert found.camera.focal == pytest.approx(made.camera.focal, rel=0.02)
    assert found.camera.source == "vanishing points"


@pytest.mark.parametrize("seed", range(3))
def test_focal_length_is_right_within_its_standard_error(made, seed):
    found = calibrate(photo_of(made), made.noisy(0.5, seed))
    off = abs(found.camera.focal - made.camera.focal)
    assert off < 3 * found.certainty.focal
    assert found.certainty.focal < 0.15 * made.camera.focal


def test_a_focal_length_that_the_photo_does_not_tell_is_assumed_and_said(made):
    found = calibrate(photo_of(made), frontal())
    assert found.camera.focal == default_focal(made.camera.width, made.camera.height)
    assert found.camera.source == "default"
    assert found.certainty.quality != "good"
    assert any("assumed (28 mm equivalent)" in note for note in found.notes)


@pytest.mark.parametrize("source", ["file", "focal option"])
def test_a_camera_that_was_given_stays_as_it_is(made, source):
    given = Camera(made.camera.width, made.camera.height, made.camera.matrix, source)
    found = calibrate(photo_of(made, given), made.noisy(0.5, 0))
    assert found.camera.matrix.tolist() == made.camera.matrix.tolist()
    assert found.camera.source == source
    assert found.certainty.focal is None
    assert found.certainty.center is None


def test_exif_tells_what_the_vanishing_points_do_not(made):
    exif_focal = ExifFocal(900.0, 0.03, "EXIF")
    found = calibrate(photo_of(made, exif_focal=exif_focal), frontal())
    assert found.camera.source == "exif"
    assert found.camera.focal == pytest.approx(900.0, rel=0.06)


def test_exif_and_vanishing_points_weigh_by_how_sure_they_are(made):
    segments = made.noisy(0.5, 1)
    alone = calibrate(photo_of(made), segments)
    exif_focal = ExifFocal(1.03 * alone.camera.focal, 0.03, "EXIF")
    both = calibrate(photo_of(made, exif_focal=exif_focal), segments)
    assert alone.camera.focal < both.camera.focal < exif_focal.focal
    assert both.certainty.focal < alone.certainty.focal


def test_exif_of_a_whole_photo_wins_a_contradiction_which_is_noted(made):
    exif_focal = ExifFocal(1.6 * made.camera.focal, 0.03, "EXIF")
    found = calibrate(photo_of(made, exif_focal=exif_focal), made.noisy(0.5, 0))
    assert found.certainty.quality == "doubtful"
    assert "contradict" in found.certainty.reason
    assert (found.camera.source, found.camera.focal) == ("exif", exif_focal.focal)
    assert any("EXIF says a focal length of" in note and "EXIF is believed" in note for note in found.notes)


def test_a_photo_that_may_be_cropped_is_not_called_good(made):
    found = calibrate(photo_of(made, crop="cropped"), made.noisy(0.5, 0))
    assert found.certainty.quality != "good"
    assert found.certainty.center[0] > calibrate(photo_of(made), made.noisy(0.5, 0)).certainty.center[0]


def test_a_focal_length_that_is_given_is_kept_in_the_search(made):
    """Each start of the search once kept its own."""
    prior = replace(prior_of(photo_of(made)), focal=1000.0, focal_error=0.0)
    ends = made.noisy(0.3, 0).ends
    fits = likely_fits(ends, made.camera.width, made.camera.height, prior)
    assert [fit.view.focal for fit in fits] == [1000.0]
