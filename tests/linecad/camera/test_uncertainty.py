"""Standard errors of a camera and its frame, and what is said of further frames."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.camera.horizontal_frames import HorizontalFrame, HorizontalFrames
from linecad.camera.joint_fit import CENTER_X, CENTER_Y, FOCAL, PARAMETERS, TURNS, Fit, View
from linecad.camera.photo import Bend
from linecad.camera.quality import Findings, Other
from linecad.camera.uncertainty import (
    FEW_LINES,
    OTHER_GAIN,
    certainty_of,
    other_camera,
    whole_lines,
    widening,
)
from linecad.geometry import central_camera, directions_to, rotation_about, vanishing_points
from linecad.line_graph import ManhattanFrame
from linecad.scene import Camera

SIXTY = np.array([60, 60, 60])
WIDTH, HEIGHT, FOCAL_PX = 1200, 800, 1000.0
LEVEL = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # world to camera, looking along y
ROTATION = rotation_about(np.array([0.1, 0, 0])) @ LEVEL @ rotation_about(np.array([0, 0, 0.6]))
CAMERA = Camera(WIDTH, HEIGHT, central_camera(FOCAL_PX, WIDTH, HEIGHT), "vanishing points")
MANY = np.array([100, 120, 140])


def along(rotation, counts, seed=0, length=80.0):
    """Segments (N, 2, 2) px along the axes of a world that the camera sees turned so."""
    rng = np.random.default_rng(seed)
    points = vanishing_points(CAMERA.matrix, rotation)[np.repeat(np.arange(3), counts)]
    middle = rng.uniform([0, 0], [WIDTH, HEIGHT], (len(points), 2))
    reach = length / 2 * directions_to(middle, points)
    return np.stack([middle - reach, middle + reach], axis=1)


def frames_of(main, others=()):
    """A main frame and others."""
    shares = np.full(4 + 2 * len(others), 1 / (4 + 2 * len(others)))
    return HorizontalFrames(main, (HorizontalFrame(0.0, 0.005, 0.6, 100.0), *others), shares)


def judged(
    turn=0.2, focal=0.01, own_turn=0.1, source="vanishing points", lines=MANY, explained=0.9, rotation=ROTATION,
    others=(), findings=None, bend=None,
):  # fmt: skip
    """Certainty and notes for a standard error of the turns, degrees, and of the focal length, relative."""
    error = np.zeros(PARAMETERS)
    error[TURNS], error[FOCAL], error[CENTER_X], error[CENTER_Y] = (
        np.radians([turn / 2, turn, turn / 4]),
        focal,
        0.01,
        0.02,
    )
    view = View(rotation.T, FOCAL_PX, CAMERA.matrix[:2, 2])
    fit = Fit(view, np.diag(error**2), 0.0, np.full(4, 0.25), view.axes, np.radians(own_turn), np.zeros((4, 0)))
    frame = ManhattanFrame(rotation, 0.001, explained)
    camera = replace(CAMERA, source=source)
    return certainty_of(camera, frames_of(frame, others), fit, np.array(lines), findings or Findings(), bend)


def fit_of(focal=900.0, turn=0.0, posterior=0.0):
    """A sure fit whose axes are turned by `turn` rad about the first of them."""
    covariance = np.diag([1e-6, 1e-6, 1e-6, 1e-4, 1e-6, 1e-6, 0.0])
    assert len(covariance) == PARAMETERS
    axes = rotation_about(np.array([turn, 0.0, 0.0]))
    view = View(axes, focal, np.array([799.5, 599.5]))
    return Fit(view, covariance, posterior, np.full(4, 0.25), axes, 0.004, np.zeros((4, 0)))


def certainty(lines=SIXTY, source="vanishing points", findings=None, fit=None, bend=None):
    """The certainty of a frame that explains nearly everything."""
    fit = fit or fit_of()
    camera = Camera(1600, 1200, fit.view.matrix, source)
    frame = ManhattanFrame(np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]]), 0.001, 0.9)
    return certainty_of(camera, frames_of(frame), fit, np.asarray(lines), findings or Findings(), bend)[0]


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


def test_k1_is_no_surer_than_the_focal_length_allows():
    bend = Bend(-0.05, 0.001, (799.5, 599.5), 5.0)
    k1 = bend.radial * (900 / 1000) ** 2
    assert certainty(bend=bend).radial > abs(k1) * 2 * 0.01
    assert certainty(bend=bend, source="focal option").radial == pytest.approx(0.001 * 0.9**2)


def test_another_camera_that_does_as_well_is_within_two_standard_errors():
    found = certainty(findings=Findings(other=Other(0.3, 0.1)))
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


@pytest.mark.parametrize("source", ["file", "focal option"])
def test_what_was_given_has_no_error(source):
    found, _ = judged(source=source, focal=0.9)
    assert found.focal is None
    assert found.center is None


def test_errors_are_in_the_units_of_the_scene():
    found, _ = judged(turn=0.4, focal=0.02, bend=Bend(-0.05, 0.002, (600.0, 400.0), 5.0))
    assert np.degrees(found.rotation) == pytest.approx([0.2, 0.4, 0.1])
    assert found.focal == pytest.approx(20.0)
    assert found.center == pytest.approx((12.0, 24.0))
    scale = FOCAL_PX**2 / (600**2 + 400**2)  # k1 grows with the square of the focal length, and errs twice as much
    assert found.radial == pytest.approx(scale * np.hypot(0.002, 0.05 * 2 * 0.02))


def test_a_distortion_that_was_not_fitted_has_no_error():
    assert judged()[0].radial is None


def test_errors_are_wider_for_few_lines():
    factors = [widening(np.array([count, 10_000, 10_000])) for count in (0, 1, 10, 100, 10_000)]
    assert factors == sorted(factors, reverse=True)
    assert factors[-1] == pytest.approx(1.0, abs=0.01)
    assert widening(np.array([20, 20, 20])) == pytest.approx(np.sqrt(1 + FEW_LINES / 20))


def test_whole_lines_are_counted_by_axis():
    """Those that run to a vanishing point and are not too short."""
    ends = np.concatenate([along(ROTATION, (4, 7, 9)), along(ROTATION, (50, 50, 50), length=10.0)])
    points = vanishing_points(CAMERA.matrix, ROTATION)
    assert whole_lines(ends, points, WIDTH).tolist() == [4, 7, 9]
    turned = vanishing_points(CAMERA.matrix, rotation_about(np.array([0, 0, 0.1])) @ ROTATION)
    assert whole_lines(ends, turned, WIDTH).sum() < 10


def test_further_frames_are_told_with_turn_error_and_share():
    others = (HorizontalFrame(np.radians(-12.34), np.radians(0.4), 0.2, 50.0), HorizontalFrame(0.5, 0.007, 0.1, 40.0))
    found, notes = judged(others=others, explained=0.77)
    assert found.quality == "good"
    assert notes == [
        "3 horizontal frames: 60% of the segment length runs level along the first; turned by -12.3 ± 0.4 degrees "
        "about the upright (20% of the segment length), turned by 28.6 ± 0.4 degrees about the upright (10% of the "
        "segment length)"
    ]


@pytest.mark.parametrize(
    ("shares", "end"),
    [
        ((0.2,), "length)"),
        ((0.03,), "; lines of the others are left out"),
        ((0.2, 0.03), "; lines of 1 of them, seen on little of the photo or not well, are left out"),
    ],
)
def test_frames_whose_lines_are_left_out_are_told(shares, end):
    others = tuple(HorizontalFrame(0.3 + n, 0.007, share, 50.0) for n, share in enumerate(shares))
    (note,) = judged(others=others, explained=0.77)[1]
    assert note.endswith(end)


def test_a_second_frame_that_explains_much_is_a_doubt():
    found, _ = judged(others=(HorizontalFrame(0.5, 0.007, 0.5, 40.0),), explained=0.9)
    assert (found.quality, found.reason) == ("doubtful", "a second Manhattan frame explains almost as much")


def test_one_frame_needs_no_note():
    assert judged()[1] == []
