"""EXIF tags as they come: units, sizes, zoom, and values that cannot be."""

import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL.ExifTags import Base
from PIL.TiffImagePlugin import IFDRational

from linecad.camera.exif import SIZE_TAGS, TEXT_TAGS, read_tags


def tags_of(**tags: Any) -> dict[int, Any]:
    return {int(Base[name]): value for name, value in tags.items()}


@pytest.mark.parametrize(("unit", "mm"), [(2, 25.4), (3, 10.0), (4, 1.0), (5, 0.001), (None, 25.4)])
def test_sensor_resolution_in_its_unit(unit: int | None, mm: float) -> None:
    exif = tags_of(FocalPlaneXResolution=IFDRational(40_000, 1) * mm)
    if unit is not None:
        exif[int(Base.FocalPlaneResolutionUnit)] = unit
    assert read_tags(exif).resolution == pytest.approx(40_000)


@pytest.mark.parametrize("unit", [0, 1, 6, "inch", float("nan")])
def test_resolution_in_no_unit_says_nothing(unit: Any) -> None:
    assert read_tags(tags_of(FocalPlaneXResolution=4000.0, FocalPlaneResolutionUnit=unit)).resolution == 0


def test_resolutions_along_x_and_y_are_averaged_and_may_not_contradict_each_other() -> None:
    canon = tags_of(FocalPlaneXResolution=5715.545, FocalPlaneYResolution=5808.403)
    assert read_tags(canon).resolution == pytest.approx(math.sqrt(5715.545 * 5808.403) / 25.4)
    assert read_tags(tags_of(FocalPlaneXResolution=900.0, FocalPlaneYResolution=450.0)).resolution == 0


def test_sizes_are_read_in_pairs() -> None:
    exif = tags_of(ExifImageWidth=600, ExifImageHeight=800, ImageWidth=400, RelatedImageWidth=0, RelatedImageLength=5)
    assert read_tags(exif).sizes == ((600, 800),)


@pytest.mark.parametrize(("told", "zoom"), [(0, 1), (1, 1), (0.5, 1), (IFDRational(3, 2), 1.5), (1e6, 1), ("x", 1)])
def test_digital_zoom(told: Any, zoom: float) -> None:
    assert read_tags(tags_of(DigitalZoomRatio=told)).zoom == zoom


def test_texts_are_freed_from_what_surrounds_them() -> None:
    tags = read_tags(tags_of(Make="Canon\0\0", Model=b" EOS 5D ", Software="one\ntwo", ProcessingSoftware="three"))
    assert (tags.make, tags.model, tags.programs) == ("Canon", "EOS 5D", "onetwo three")


NUMBERS = [
    Base.FocalLength,
    Base.FocalLengthIn35mmFilm,
    Base.FocalPlaneXResolution,
    Base.FocalPlaneYResolution,
    Base.FocalPlaneResolutionUnit,
    Base.DigitalZoomRatio,
    *(tag for pair in SIZE_TAGS for tag in pair),
]
anything = (
    st.none()
    | st.floats()
    | st.integers()
    | st.sampled_from([2, 28, 1e300, 5e-324, 10**400, 4000, 3000])
    | st.text(max_size=3)
    | st.binary(max_size=3)
    | st.lists(st.floats(), max_size=2)
    | st.dictionaries(st.integers(), st.integers(), max_size=1)
    | st.builds(IFDRational, st.integers(-9, 9), st.integers(-2, 9))
)


@settings(max_examples=settings.default.max_examples * 2, deadline=None)
@given(st.dictionaries(st.sampled_from([*NUMBERS, *TEXT_TAGS]).map(int), anything))
def test_whatever_stands_in_exif_becomes_positive_numbers_and_short_lines(exif: dict[int, Any]) -> None:
    tags = read_tags(exif)
    for number in (tags.length, tags.equivalent, tags.resolution):
        assert number == 0 or (math.isfinite(number) and number > 0)
    assert 1 <= tags.zoom <= 100
    assert all(1 <= min(size) <= max(size) < 1e6 for size in tags.sizes)
    assert all(text.isprintable() and len(text) < 300 for text in (tags.make, tags.model, tags.programs))
