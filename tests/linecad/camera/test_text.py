"""A camera in words: what was estimated has its error, what was given says so."""

from pathlib import Path

import numpy as np
import pytest

from linecad.camera.horizontal_frames import HorizontalFrame, HorizontalFrames
from linecad.camera.intrinsics import Calibration
from linecad.camera.photo import Photo
from linecad.camera.report import Angle, CameraReport
from linecad.camera.text import facts, roll_words, summary, table, tilt_words
from linecad.line_graph import ManhattanFrame, Segments
from linecad.scene import Camera, Certainty

LEVEL = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
MATRIX = np.array([[1200.0, 0, 819.5], [0, 1200.0, 533.2], [0, 0, 1]])
ESTIMATED = Certainty(np.array([2e-3, 2e-3, 1e-3]), 12.3, (14.0, 9.4), 0.0031, "good", "three vanishing points are far")
GIVEN = Certainty(np.array([2e-3, 2e-3, 1e-3]), None, None, None, "good", "the camera is given")


def report(certainty, source, distortion=(), notes=()):
    camera = Camera(1600, 1067, MATRIX, source, distortion)
    return CameraReport(
        photo=Photo("a\nphoto.jpg", np.zeros((1, 1, 3), np.uint8), camera),
        camera=camera,
        taken=Calibration(1600, 1067, MATRIX, distortion),
        frames=HorizontalFrames(
            ManhattanFrame(LEVEL, 0.001, 0.9), (HorizontalFrame(0.0, 0.005, 0.9, 100.0),), np.full(4, 0.25)
        ),
        certainty=certainty,
        segments=Segments(np.array([[[0, 0], [30, 0]], [[0, 0], [0, 10]]]), np.array([0, -1])),
        notes=notes,
    )


def rows(found):
    """The table as a dictionary; the last of rows without a name is kept."""
    return {line[:19].strip(): line[19:] for line in table(found)}


def test_what_was_estimated_has_its_error():
    found = rows(report(ESTIMATED, "vanishing points", (-0.0213, 0.0, 0.0, 0.0)))
    assert found["focal length"] == "1200 ± 12 px (1.0%); 27.0 mm (35 mm equivalent)"
    assert found["principal point"] == "(820 ± 14, 533.2 ± 9.4) px"
    assert found["radial distortion"] == (
        "k1 = -0.0213 ± 0.0031, from the photo's own lines; removed from the photo before measuring"
    )
    assert found["camera from"] == "the vanishing points"
    assert found["quality"] == "good: three vanishing points are far"


def test_what_was_given_says_so():
    found = rows(report(GIVEN, "file", (-0.1, 0.0, 0.0, 0.0)))
    assert found["focal length"].startswith("1200.0 px, as given;")
    assert found["principal point"] == "(819.5, 533.2) px, as given"
    assert found["radial distortion"].startswith("k1 = -0.1000, as given")


@pytest.mark.parametrize("source", ["focal option", "exif", "vanishing points", "default"])
def test_a_principal_point_in_the_middle_is_assumed(source):
    assert rows(report(GIVEN, source))["principal point"].endswith("the middle of the photo, assumed")


def test_angles_have_their_error_and_direction():
    assert tilt_words(Angle(np.radians(4.23), np.radians(0.14))) == "4.2 ± 0.1 degrees up"
    assert tilt_words(Angle(np.radians(-4.23), np.radians(0.04))) == "4.23 ± 0.04 degrees down"
    assert roll_words(Angle(np.radians(0.3), 0.0)) == "0.30 ± 0 degrees clockwise"
    assert roll_words(Angle(np.radians(-30), np.radians(12.4))) == "30 ± 12 degrees counter-clockwise"


def test_vanishing_points_are_places_or_at_infinity():
    lines = table(report(GIVEN, "file"))
    start = next(number for number, line in enumerate(lines) if line.startswith("vanishing points"))
    x, y, z, rest = (line[19:] for line in lines[start : start + 4])
    assert x == "x  at infinity, its lines at 0.0 degrees to the photo's rows, 75% of the segment length"
    assert y == "y  (820, 533) px, 0% of the segment length"
    assert z == "z  at infinity, its lines at 90.0 degrees to the photo's rows, 0% of the segment length"
    assert rest == "none of them: 25%"


def test_notes_come_last_and_every_line_is_one():
    lines = table(report(GIVEN, "file", notes=("a warning", "another")))
    assert lines[-2:] == ["note: a warning", "note: another"]
    assert lines[0] == "photo              a photo.jpg, 1600 x 1067 px"
    assert all(len(line.splitlines()) == 1 for line in lines)


def test_the_summary_is_one_line_with_the_word_and_its_reason():
    assert summary(report(ESTIMATED, "exif").camera, ESTIMATED) == (
        "camera good: three vanishing points are far; focal length 1200 ± 12 px (exif)"
    )


def test_the_picture_is_told_errors_only_of_what_was_estimated():
    assert "principal point ± 14, ± 9.4 px" in facts(report(ESTIMATED, "vanishing points"))
    assert not any("principal point" in fact for fact in facts(report(GIVEN, "file")))


def test_the_page_explains_every_word():
    page = (Path(__file__).parents[3] / "docs" / "guide" / "camera.md").read_text(encoding="utf-8")
    for name in filter(None, rows(report(GIVEN, "file"))):
        assert f"`{name}`" in page
    for word in ("good", "doubtful", "poor"):
        assert f"`{word}`" in page
