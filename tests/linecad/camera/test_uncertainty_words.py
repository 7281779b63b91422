"""What standard errors and doubts come to in words, and a second frame in the photo."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linecad.camera import uncertainty as certainty
from linecad.camera.joint_fit import CENTER_X, CENTER_Y, FOCAL, PARAMETERS, TURNS, Fit, View
from linecad.camera.photo import Bend
from linecad.camera.uncertainty import Doubts, certainty_of, second_frame, whole_lines, widening
from linecad.geometry import central_camera, directions_to, rotation_about, vanishing_points
from linecad.line_graph import ManhattanFrame, Segments
from linecad.scene import Camera

ROOT = Path(__file__).resolve().parents[3]
WIDTH, HEIGHT, FOCAL_PX = 1200, 800, 1000.0
LEVEL = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # world to camera, looking along y
ROTATION = rotation_about(np.array([0.1, 0, 0])) @ LEVEL @ rotation_about(np.array([0, 0, 0.6]))
CAMERA = Camera(WIDTH, HEIGHT, central_camera(FOCAL_PX, WIDTH, HEIGHT), "vanishing points")
MANY = np.array([100, 120, 140])
NO_SEGMENTS = Segments(np.zeros((0, 2, 2)), np.zeros(0))


def along(rotation, counts, seed=0, length=80.0):
    """Segments (N, 2, 2) px along the axes of a world that the camera sees turned so."""
    rng = np.random.default_rng(seed)
    points = vanishing_points(CAMERA.matrix, rotation)[np.repeat(np.arange(3), counts)]
    middle = rng.uniform([0, 0], [WIDTH, HEIGHT], (len(points), 2))
    reach = length / 2 * directions_to(middle, points)
    return np.stack([middle - reach, middle + reach], axis=1)


def clutter(count, seed=1):
    """Segments (count, 2, 2) px in all directions."""
    rng = np.random.default_rng(seed)
    middle, angle = rng.uniform([0, 0], [WIDTH, HEIGHT], (count, 2)), rng.uniform(0, np.pi, count)
    reach = 40 * np.column_stack([np.cos(angle), np.sin(angle)])
    return np.stack([middle - reach, middle + reach], axis=1)


def segments(*ends):
    joined = np.concatenate(ends)
    return Segments(joined, np.full(len(joined), -1))


def judged(
    turn=0.2, focal=0.01, own_turn=0.1, source="vanishing points", lines=MANY, explained=0.9, rotation=ROTATION,
    raw=NO_SEGMENTS, doubts=None, bend=None,
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
    return certainty_of(camera, frame, fit, np.array(lines), raw, doubts or Doubts(), bend)


def test_what_speaks_against_nothing_is_good():
    found, notes = judged()
    assert found.quality == "good"
    assert found.reason == "360 whole lines agree, 90% of the segment length runs along the axes"
    assert notes == []


@pytest.mark.parametrize(
    ("quality", "words", "given"),
    [
        ("poor", "only 10% of the segment length", {"explained": 0.1}),
        ("poor", "the axes are known to 6 degrees only", {"turn": 6.0}),
        ("poor", "does not tell its focal length", {"focal": 0.5}),
        ("doubtful", "EXIF and the vanishing points contradict", {"doubts": Doubts(is_contradicted=True)}),
        ("doubtful", "bends straight lines by more than", {"doubts": Doubts(is_fisheye=True)}),
        ("doubtful", "may be cropped", {"doubts": Doubts(is_cropped=True)}),
        ("doubtful", "the focal length is assumed", {"source": "default"}),
        ("doubtful", "the focal length is known to 12% only", {"focal": 0.12}),
        ("poor", "few lines (3) run along one of them", {"lines": [3, 90, 90]}),
        ("doubtful", "few lines (15) run along one of the three axes", {"lines": [15, 90, 90]}),
        ("poor", "few lines (3) run along one of them", {"lines": [3, 2, 90], "source": "file"}),
        ("doubtful", "few lines (10) run along the second", {"lines": [10, 2, 90], "source": "file"}),
        ("doubtful", "only 42% of the segment length", {"explained": 0.42}),
        ("doubtful", "the axes are known to 2.0 degrees only", {"turn": 2.0}),
        ("doubtful", "the axes are not square", {"own_turn": 1.5}),
        ("doubtful", "another axis may be the upright one",
         {"rotation": rotation_about(np.array([0, 0, np.radians(44)])) @ LEVEL}),
        ("doubtful", "a second Manhattan frame explains almost as much",
         {"raw": segments(along(ROTATION, (50, 50, 50)),
                          along(ROTATION @ rotation_about(np.array([0, 0, 0.5])), (60, 60, 0))), "explained": 0.55}),
    ],
    ids=lambda value: value if isinstance(value, str) and " " in value else None,
)  # fmt: skip
def test_every_reason_is_said(quality, words, given):
    found, _ = judged(**given)
    assert found.quality == quality
    assert words in found.reason


@pytest.mark.parametrize("source", ["file", "focal option"])
def test_what_was_given_has_no_error_and_needs_fewer_lines(source):
    found, _ = judged(source=source, focal=0.9, lines=[0, certainty.ENOUGH_LINES, 100])
    assert found.quality == "good"
    assert found.focal is None
    assert found.center is None


def test_exif_needs_no_lines_for_its_focal_length():
    assert judged(source="exif", lines=[2, 90, 90])[0].quality == "good"


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
    assert widening(np.array([20, 20, 20])) == pytest.approx(np.sqrt(1 + certainty.FEW_LINES / 20))


def test_whole_lines_are_counted_by_axis():
    """Those that run to a vanishing point and are not too short."""
    ends = np.concatenate([along(ROTATION, (4, 7, 9)), along(ROTATION, (50, 50, 50), length=10.0)])
    points = vanishing_points(CAMERA.matrix, ROTATION)
    assert whole_lines(ends, points, WIDTH).tolist() == [4, 7, 9]
    turned = vanishing_points(CAMERA.matrix, rotation_about(np.array([0, 0, 0.1])) @ ROTATION)
    assert whole_lines(ends, turned, WIDTH).sum() < 10


@pytest.mark.parametrize("degrees", [15, 30, 45, 70])
def test_a_turned_house_is_a_second_frame(degrees):
    turned = ROTATION @ rotation_about(np.array([0, 0, np.radians(degrees)]))
    raw = segments(along(ROTATION, (60, 60, 80)), along(turned, (30, 30, 0), 2))
    turn, share = second_frame(raw, CAMERA, ManhattanFrame(ROTATION, 0.001, 0.75))
    assert np.degrees(turn) == pytest.approx(degrees, abs=1.0)
    assert 0.12 < share < 60 / 260 + 0.01  # near the horizon, lines of both frames look alike


def test_a_second_frame_is_told_with_its_turn_and_share():
    turned = ROTATION @ rotation_about(np.array([0, 0, np.radians(30)]))
    raw = segments(along(ROTATION, (60, 60, 80)), along(turned, (30, 30, 0), 2))
    found, notes = judged(raw=raw, explained=0.77)
    assert found.quality == "good"
    assert len(notes) == 1
    assert re.match(
        r"a second Manhattan frame, turned by (29|30|31) degrees about the upright, explains \d+%", notes[0]
    )
    assert "the first 77%" in notes[0]


@pytest.mark.parametrize("seed", range(3))
def test_clutter_is_no_second_frame(seed):
    raw = segments(along(ROTATION, (60, 60, 80)), clutter(120, seed))
    assert second_frame(raw, CAMERA, ManhattanFrame(ROTATION, 0.001, 0.6)) is None


def test_a_few_lines_are_no_second_frame():
    turned = ROTATION @ rotation_about(np.array([0, 0, np.radians(30)]))
    raw = segments(along(ROTATION, (60, 60, 80)), along(turned, (5, 5, 0), 2))
    assert second_frame(raw, CAMERA, ManhattanFrame(ROTATION, 0.001, 0.95)) is None


def test_a_photo_all_of_whose_segments_run_along_the_axes_has_no_second_frame():
    assert second_frame(segments(along(ROTATION, (60, 60, 80))), CAMERA, ManhattanFrame(ROTATION, 0.001, 1.0)) is None


@pytest.mark.parametrize(
    "row",
    [
        f"standard error of the focal length | above {100 * certainty.GOOD_FOCAL_ERROR:.0f} %, or the value is "
        f"assumed; above {100 * certainty.GOOD_FOCAL_ERROR_ALONE:.0f} % where the vanishing points alone tell it "
        f"| above {100 * certainty.POOR_FOCAL_ERROR:.0f} %",
        f"the largest of the three | above {np.degrees(certainty.GOOD_TURN):.0f} degree "
        f"| above {np.degrees(certainty.POOR_TURN):.0f} degrees",
        f"segment length that runs along the axes | below {100 * certainty.GOOD_SHARE:.0f} % "
        f"| below {100 * certainty.POOR_SHARE:.0f} %",
        f"where vanishing points tell the focal length | below {certainty.ENOUGH_LINES} ",
        f"whole lines along the second axis | below {certainty.ENOUGH_LINES_KNOWN} ",
        f"turns of the axes off a right angle | above {np.degrees(certainty.LARGEST_OWN_TURN):.0f} degree",
        f"roll | above {np.degrees(certainty.EVEN_ROLL):.0f} degrees",
        f"the root of 1 + {certainty.FEW_LINES:.0f} / n for n whole lines",
        f"if that is {100 * certainty.SECOND_FRAME_SHARE:.0f} % or more",
    ],
)
def test_the_page_about_the_camera_tells_the_limits(row):
    assert row in (ROOT / "docs" / "camera.md").read_text(encoding="utf-8")
