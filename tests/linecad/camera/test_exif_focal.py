"""The focal length from EXIF: each way to it, what two ways say together, and how far to trust them."""

import json
import math
import sys
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL.ExifTags import Base
from PIL.TiffImagePlugin import IFDRational

from linecad.camera.crop_history import find_crop_history
from linecad.camera.exif import Tags, read_tags
from linecad.camera.exif_focal import ExifFocal, find_exif_focal
from linecad.camera.photo import read_photo

LONG, SHORT = 4000, 3000
DIAGONAL = 5000.0  # px
FULL = 43.27  # mm


def tags(*, size: tuple[int, int] | None = (LONG, SHORT), **values: Any) -> Tags:
    nothing = {
        "length": 0.0,
        "equivalent": 0.0,
        "resolution": 0.0,
        "zoom": 1.0,
        "make": "",
        "model": "",
        "programs": "",
    }
    return Tags(sizes=(size,) if size else (), **(nothing | values))


def found(told: Tags, width: int = LONG, height: int = SHORT) -> tuple[ExifFocal | None, str]:
    focal, notes = find_exif_focal(told, find_crop_history(told, width, height), width, height)
    return focal, "; ".join(notes)


def focal_of(told: Tags, width: int = LONG, height: int = SHORT) -> ExifFocal:
    focal, _ = found(told, width, height)
    assert focal is not None
    return focal


def test_equivalent_is_by_the_diagonal_and_allows_for_rounding_and_lens() -> None:
    focal = focal_of(tags(equivalent=28.0))
    assert focal.focal == pytest.approx(28 / FULL * DIAGONAL)
    assert 0.5 / 28 < focal.relative_error < 0.05
    assert focal_of(tags(equivalent=14.0)).relative_error > focal.relative_error
    assert focal.origin == "EXIF's 35 mm equivalent (28 mm)"


def test_resized_photo_keeps_its_equivalent_and_scales_its_resolution() -> None:
    by_view, by_sensor = tags(equivalent=28.0), tags(length=6.0, resolution=500.0)
    assert focal_of(by_view, 1000, 750).focal == pytest.approx(28 / FULL * 1250)
    assert focal_of(by_sensor, 1000, 750).focal == pytest.approx(6 * 500 / 4)


def test_resolution_alone_is_trusted_less_than_confirmed() -> None:
    alone = focal_of(tags(length=6.0, resolution=500.0))
    both = focal_of(tags(length=6.0, resolution=500.0, equivalent=26.0))
    assert alone.focal == 3000
    assert alone.focal < both.focal < 26 / FULL * DIAGONAL
    assert both.relative_error < alone.relative_error
    assert both.origin == "EXIF's 35 mm equivalent (26 mm), confirmed by the sensor's resolution"


@pytest.mark.parametrize("told", [{"size": None}, {"programs": "GIMP 2.10"}])
def test_resolution_of_a_photo_that_was_perhaps_resized_is_hardly_trusted(told: dict[str, Any]) -> None:
    assert focal_of(tags(length=6.0, resolution=500.0, **told)).relative_error > 0.25


def test_equivalent_is_not_doubted_where_a_program_may_have_spoilt_the_resolution() -> None:
    told = {"size": (2000, 1500), "length": 6.0, "equivalent": 26.0, "programs": "GIMP 2.10"}
    focal, note = found(tags(resolution=500.0, **told), 2000, 1500)
    assert focal == focal_of(tags(**told), 2000, 1500)
    assert "aside" not in note


def test_resolution_of_another_size_is_set_aside_and_told() -> None:
    # A camera that stores half of its 4000 px a side, and writes the resolution of all of them.
    told = tags(size=(2000, 1500), length=6.0, equivalent=26.0, resolution=500.0)
    focal, note = found(told, 2000, 1500)
    assert focal is not None
    assert focal.focal == pytest.approx(26 / FULL * 2500)
    assert focal.relative_error > 0.1
    assert "the sensor's resolution would give 3000 px and is set aside" in note


@pytest.mark.parametrize("resolution", [100_000.0, 10.0])
def test_resolution_of_a_sensor_that_nobody_makes_is_ignored(resolution: float) -> None:
    assert found(tags(length=6.0, resolution=resolution)) == (None, "")


def test_equivalent_that_shrinking_made_absurd_is_ignored() -> None:
    # A program on an iPhone 8: 28 mm at full size.
    focal, note = found(tags(size=(640, 480), length=3.99, equivalent=177.0, make="Apple"), 640, 480)
    assert focal is None
    assert "a sensor of 0.98 mm and is ignored" in note


def test_absurd_equivalent_leaves_the_other_ways() -> None:
    assert focal_of(tags(length=8.0, resolution=500.0, equivalent=48388.0)).focal == 4000


def test_digital_zoom_multiplies_the_focal_length() -> None:
    assert focal_of(tags(length=6.0, resolution=500.0, zoom=2.0)).focal == 6000


@pytest.mark.parametrize("equivalent", [26.0, 52.0])
def test_sensor_tells_whether_the_equivalent_counts_the_zoom(equivalent: float) -> None:
    focal = focal_of(tags(length=6.0, resolution=500.0, zoom=2.0, equivalent=equivalent))
    assert focal.focal == pytest.approx(6000, rel=0.01)
    assert focal.relative_error < 0.05


def test_equivalent_of_apple_counts_the_zoom() -> None:
    assert focal_of(tags(length=4.0, equivalent=56.0, zoom=2.0, make="Apple")).focal == pytest.approx(
        56 / FULL * DIAGONAL
    )


def test_equivalent_that_may_count_the_zoom_lies_between_and_covers_both() -> None:
    focal, note = found(tags(length=4.0, equivalent=28.0, zoom=2.0))
    assert focal is not None
    without = 28 / FULL * DIAGONAL
    assert focal.focal == pytest.approx(without * math.sqrt(2))
    for truth in (without, 2 * without):
        assert abs(math.log(focal.focal / truth)) <= focal.relative_error
    assert "digital zoom of 2" in note


def test_equivalent_of_a_wide_photo_on_a_higher_sensor_covers_both_readings() -> None:
    # 16:9 on the sensor of a phone, 4:3: of the whole sensor, or of the photo alone.
    focal = focal_of(tags(size=(4000, 2250), length=4.25, equivalent=26.0), 4000, 2250)
    of_sensor, of_photo = 26 / FULL * 5000, 26 / FULL * math.hypot(4000, 2250)
    assert of_photo < focal.focal < of_sensor
    assert focal.relative_error > focal_of(tags(length=4.25, equivalent=26.0)).relative_error


def test_sensor_of_a_reflex_camera_is_3_to_2() -> None:
    focal = focal_of(tags(size=(6000, 4000), length=18.0, equivalent=27.0), 6000, 4000)
    assert focal.focal == pytest.approx(27 / FULL * math.hypot(6000, 4000))


def test_cropped_photo_is_trusted_less() -> None:
    told = tags(equivalent=28.0)
    assert focal_of(told, 3000, 1500).relative_error > focal_of(told).relative_error + 0.05


def test_focal_length_in_mm_alone_says_nothing() -> None:
    assert found(tags(length=18.0)) == (None, "")


def test_sensor_database() -> None:
    pytest.importorskip("lensfunpy", reason="the extra `lens` is not installed")
    canon = {"length": 18.0, "make": "Canon", "model": "Canon EOS 400D DIGITAL"}
    focal = focal_of(tags(size=(3888, 2592), **canon), 3888, 2592)
    # The sensor of that camera is 22.2 mm wide.
    assert focal.focal == pytest.approx(18 / 22.2 * 3888, rel=0.01)
    assert focal.relative_error < 0.035
    assert focal.origin == "EXIF's 18 mm and the sensor size of Canon EOS 400D DIGITAL"


def test_sensor_database_outvotes_the_resolution_of_another_size() -> None:
    pytest.importorskip("lensfunpy", reason="the extra `lens` is not installed")
    told = tags(
        size=(1944, 1296),
        length=18.0,
        resolution=3888 / 22.2,
        make="Canon",
        model="Canon EOS 400D DIGITAL",
    )
    focal, note = found(told, 1944, 1296)
    assert focal is not None
    assert focal.focal == pytest.approx(18 / 22.2 * 1944, rel=0.01)
    assert "set aside" in note


def test_camera_unknown_to_the_database_says_nothing() -> None:
    pytest.importorskip("lensfunpy", reason="the extra `lens` is not installed")
    assert found(tags(length=18.0, make="Nobody", model="None")) == (None, "")


def test_without_the_database_a_note_says_what_would_help(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "linecad.camera.sensors", None)
    told = {"length": 18.0, "make": "Canon", "model": "Canon EOS 400D DIGITAL"}
    assert "linecad[lens]" in found(tags(**told))[1]
    assert "linecad[lens]" not in found(tags(equivalent=29.0, **told))[1]


amounts = st.just(0.0) | st.floats(1e-3, 1e5) | st.floats(5e-324, 1e308)
sizes = st.none() | st.tuples(st.integers(64, 9000), st.integers(64, 9000))
said_tags = st.builds(
    tags,
    size=sizes,
    length=amounts,
    equivalent=amounts,
    resolution=amounts,
    zoom=st.just(1.0) | st.floats(1.01, 100),
    make=st.sampled_from(["", "Apple", "Canon"]) | st.text(max_size=4),
    model=st.sampled_from(["", "iPhone XS", "Canon EOS 5D"]) | st.text(max_size=4),
    programs=st.sampled_from(["", "GIMP"]),
)


@settings(max_examples=settings.default.max_examples * 3, deadline=None)
@given(said_tags, st.integers(64, 9000), st.integers(64, 9000))
def test_any_tags_give_a_sensible_focal_length_or_none(told: Tags, width: int, height: int) -> None:
    focal, note = found(told, width, height)
    assert "\n" not in note
    if focal is not None:
        assert 0.1 * max(width, height) <= focal.focal * (1 + 1e-9)
        assert focal.focal * (1 - 1e-9) <= 50 * max(width, height)
        assert 0.03 <= focal.relative_error < 3


values = (
    st.floats() | st.integers(-1, 9000) | st.text(max_size=3) | st.builds(IFDRational, st.integers(), st.integers())
)
tag_numbers = st.sampled_from(
    [
        Base.FocalLength,
        Base.FocalLengthIn35mmFilm,
        Base.FocalPlaneXResolution,
        Base.FocalPlaneResolutionUnit,
        Base.DigitalZoomRatio,
        Base.ExifImageWidth,
        Base.ExifImageHeight,
        Base.Make,
        Base.Model,
    ]
).map(int)


@settings(max_examples=settings.default.max_examples * 2, deadline=None)
@given(st.dictionaries(tag_numbers, values), st.booleans())
def test_any_exif_gives_a_sensible_focal_length_or_none(exif: dict[int, Any], turned: bool) -> None:
    told = read_tags(exif)
    focal, notes = find_exif_focal(told, find_crop_history(told, 120, 80, turned), 120, 80)
    assert focal is None or 12 * (1 - 1e-9) <= focal.focal <= 6000 * (1 + 1e-9)
    assert focal is None or notes


def test_a_length_that_rounds_to_no_px_is_no_fault() -> None:
    told = tags(length=5e-324, equivalent=5e-324, zoom=22.0, make="Canon", model="Canon EOS 5D")
    focal, _ = found(told, 64, 64)
    assert focal is None or focal.focal > 0


def test_focal_length_of_york_urban_is_within_two_standard_errors(photographs: Path) -> None:
    photos = sorted((photographs / "york_urban").glob("*.jpg"))
    assert photos
    for path in photos[::10]:  # one camera at one focal length took them all
        photo = read_photo(path)
        assert photo.exif_focal is not None
        assert photo.crop == "whole"
        truth = json.loads(path.with_suffix(".json").read_text())["K"][0][0]
        assert abs(math.log(photo.exif_focal.focal / truth)) < 2 * photo.exif_focal.relative_error
