"""How good a camera is called: one word, and the weightiest reason."""

from pathlib import Path

import numpy as np
import pytest

from linecad.camera import quality, uncertainty
from linecad.camera.photo import Bend
from linecad.camera.quality import ENOUGH_LINES, Findings, Fitted, Other, quality_of
from linecad.geometry import rotation_about
from linecad.line_graph import ManhattanFrame

ROOT = Path(__file__).resolve().parents[3]
LEVEL = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # world to camera, looking along y
TURNED = rotation_about(np.array([0, 0, np.radians(44)])) @ LEVEL
MANY = (100, 120, 140)


def judged(turn=0.2, own_turn=0.1, lines=MANY, explained=0.9, rotation=LEVEL, **others):
    """Word and reason; angles in degrees."""
    values = {"source": "vanishing points", "focal_error": 0.01, "bend": None, "second_share": 0.0} | others
    return quality_of(
        Fitted(
            turn_error=np.radians(turn),
            axes_off=np.radians(own_turn),
            lines=np.array(lines),
            frame=ManhattanFrame(rotation, 0.001, explained),
            **{"findings": Findings(), **values},
        )
    )


def test_what_nothing_speaks_against_is_good():
    assert judged() == ("good", "360 whole lines agree, 90% of the segment length runs along the axes")


@pytest.mark.parametrize(
    ("word", "words", "given"),
    [
        ("poor", "only 10% of the segment length", {"explained": 0.1}),
        ("poor", "the axes are known to 6 degrees only", {"turn": 6.0}),
        ("poor", "does not tell its focal length", {"focal_error": 0.5}),
        ("doubtful", "EXIF and the vanishing points contradict", {"findings": Findings(is_contradicted=True)}),
        ("doubtful", "bends straight lines by more than", {"findings": Findings(is_fisheye=True)}),
        ("doubtful", "may be cropped", {"findings": Findings(is_cropped=True)}),
        ("doubtful", "another camera explains", {"findings": Findings(other=Other(0.3, 0.1))}),
        ("doubtful", "the focal length is assumed", {"source": "default"}),
        ("doubtful", "the focal length is known to 12% only", {"focal_error": 0.12}),
        ("poor", "few lines (3) run along one of them", {"lines": (3, 90, 90), "turn": 6.0}),
        ("doubtful", "few lines (15) run along one of the three axes", {"lines": (15, 90, 90)}),
        ("poor", "few lines (3) run along one of them",
         {"lines": (3, 2, 90), "source": "file", "focal_error": None, "turn": 6.0}),
        ("doubtful", "few lines (10) run along the second",
         {"lines": (10, 2, 90), "source": "file", "focal_error": None}),
        ("doubtful", "few lines (90) run along the three axes together", {"lines": (30, 30, 30)}),
        ("doubtful", "only 42% of the segment length", {"explained": 0.42}),
        ("doubtful", "one coefficient describes it only roughly", {"bend": Bend(-0.13, 0.002, (0.0, 0.0), 5.0)}),
        ("doubtful", "the axes are known to 2.0 degrees only", {"turn": 2.0}),
        ("doubtful", "the axes are not square: they lie 1.5 degrees off", {"own_turn": 1.5}),
        ("doubtful", "another axis may be the upright one", {"rotation": TURNED}),
        ("doubtful", "a second Manhattan frame explains almost as much", {"explained": 0.55, "second_share": 0.3}),
    ],
    ids=lambda value: value if isinstance(value, str) and " " in value else None,
)  # fmt: skip
def test_every_reason_is_given(word, words, given):
    found, reason = judged(**given)
    assert found == word
    assert words in reason


@pytest.mark.parametrize("source", ["file", "focal option"])
def test_a_camera_that_was_given_needs_fewer_lines(source):
    assert judged(source=source, focal_error=None, lines=(0, ENOUGH_LINES, 100))[0] == "good"


def test_exif_needs_no_lines_for_its_focal_length():
    assert judged(source="exif", lines=(2, 90, 90))[0] == "good"


def test_vanishing_points_alone_need_a_smaller_error_than_exif():
    assert judged(focal_error=0.04)[0] == "doubtful"
    assert judged(focal_error=0.04, source="exif")[0] == "good"


@pytest.mark.parametrize(("radial", "word"), [(-0.02, "good"), (-0.13, "doubtful"), (0.13, "doubtful")])
def test_a_strong_bend_is_not_called_good(radial, word):
    assert judged(bend=Bend(radial, 0.002, (799.5, 599.5), 5.0))[0] == word


@pytest.mark.parametrize(
    "row",
    [
        f"standard error of the focal length | above {100 * quality.GOOD_FOCAL_ERROR:.0f} %, or the value is "
        f"assumed; above {100 * quality.GOOD_FOCAL_ERROR_ALONE:.0f} % from vanishing points alone "
        f"| above {100 * quality.POOR_FOCAL_ERROR:.0f} %",
        f"the largest of the three | above {np.degrees(quality.GOOD_TURN):.0f} degree "
        f"| above {np.degrees(quality.POOR_TURN):.0f} degrees",
        f"segment length that runs along the axes | below {100 * quality.GOOD_SHARE:.0f} % "
        f"| below {100 * quality.POOR_SHARE:.0f} %",
        f"if the focal length comes from vanishing points | below {quality.ENOUGH_LINES} ",
        f"whole lines along all three together, likewise | below {quality.ENOUGH_TOGETHER} ",
        f"whole lines along the second axis | below {quality.ENOUGH_LINES_KNOWN} ",
        f"turns of the axes off a right angle | above {np.degrees(quality.LARGEST_OWN_TURN):.0f} degree",
        f"roll | above {np.degrees(quality.EVEN_ROLL):.0f} degrees",
        f"the root of 1 + {uncertainty.FEW_LINES:.0f} / n for n whole lines",
        f"bend at the corners that was taken out | above {100 * quality.STRONG_BEND:.0f} %",
    ],
)
def test_the_page_about_the_camera_tells_the_limits(row):
    assert row in (ROOT / "docs" / "guide" / "camera.md").read_text(encoding="utf-8")
