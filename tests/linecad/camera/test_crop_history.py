"""Photos that are whole, resized, turned, cropped, or of which nobody can tell."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.camera.crop_history import find_crop_history, usual_aspect
from linecad.camera.exif import Tags

NOTHING = Tags((), 0.0, 0.0, 0.0, 1.0, "", "", "")


def taken(*sizes: tuple[int, int], programs: str = "") -> Tags:
    return replace(NOTHING, sizes=sizes, programs=programs)


@pytest.mark.parametrize(
    "size",
    [
        (3872, 2592),
        (4288, 2848),
        (751, 563),
        (640, 427),
        (3000, 4000),
        (1920, 1088),
        (4000, 1800),
        (3024, 3024),
        (90, 60),
    ],
)
def test_aspects_of_cameras_and_phones(size: tuple[int, int]) -> None:
    assert usual_aspect(*size)


@pytest.mark.parametrize("size", [(868, 600), (2500, 2000), (3000, 1000), (1000, 700), (3000, 2100)])
def test_aspects_that_no_camera_takes(size: tuple[int, int]) -> None:
    assert not usual_aspect(*size)


@pytest.mark.parametrize("size", [(4000, 3000), (1024, 768), (768, 1024), (751, 563), (8000, 6000)])
def test_photo_that_was_only_scaled_or_turned_is_whole(size: tuple[int, int]) -> None:
    history = find_crop_history(taken((4000, 3000)), *size)
    assert history.crop == "whole"
    assert history.scale == pytest.approx(max(size) / 4000, rel=1e-3)
    assert history.error == 0


def test_photo_without_a_size_in_exif_is_unknown_and_more_so_with_an_odd_aspect() -> None:
    usual, odd = find_crop_history(NOTHING, 640, 480), find_crop_history(NOTHING, 640, 450)
    assert (usual.crop, odd.crop) == ("unknown", "unknown")
    assert 0 < usual.error < odd.error
    assert "cropped" in odd.remark


def test_photo_of_another_aspect_than_taken_is_cropped() -> None:
    history = find_crop_history(taken((4000, 3000)), 4000, 2000)
    assert (history.crop, history.scale, history.error) == ("cropped", 1.0, 0.0)
    assert "4000 x 3000 px" in history.remark


@pytest.mark.parametrize(("turned", "stored"), [(False, (4000, 3000)), (True, (3000, 4000))])
def test_upright_crop_of_a_lying_photo_keeps_its_height(turned: bool, stored: tuple[int, int]) -> None:
    history = find_crop_history(taken(stored), 2000, 3000, turned)
    assert (history.crop, history.scale, history.error) == ("cropped", 1.0, 0.0)


def test_crop_of_a_photo_that_a_program_turned_keeps_its_height() -> None:
    history = find_crop_history(taken((4000, 3000)), 2000, 4000)
    assert (history.crop, history.scale, history.error) == ("cropped", 1.0, 0.0)


def test_scale_of_a_crop_on_both_sides_is_between_its_extremes() -> None:
    history = find_crop_history(taken((4000, 3000)), 3200, 1600)
    assert 0.8 < history.scale < 1
    assert history.scale * (1 - history.error) <= 0.81
    assert history.scale * (1 + history.error) >= 0.99


def test_crop_for_the_web_was_resized() -> None:
    history = find_crop_history(taken((4000, 3000)), 800, 400)
    assert 0.2 <= history.scale <= 0.2 / 0.7


def test_crop_whose_size_was_rewritten_is_known_by_its_aspect() -> None:
    history = find_crop_history(taken((3000, 2100)), 3000, 2100)
    assert history.crop == "cropped"
    assert history.error > 0
    assert not history.is_as_taken


def test_crop_is_known_where_a_program_left_one_of_two_sizes() -> None:
    assert find_crop_history(taken((3000, 2000), (4000, 3000)), 3000, 2000).crop == "cropped"


@pytest.mark.parametrize("program", ["Adobe Photoshop Lightroom 6.0", "GIMP 2.10.8", "Google Photos"])
def test_editor_may_have_cropped_to_a_usual_aspect(program: str) -> None:
    history = find_crop_history(taken((3000, 2000), programs=program), 3000, 2000)
    assert history.crop == "unknown"
    assert "may have cropped" in history.remark


@pytest.mark.parametrize("firmware", ["12.0", "Ver.1.02", "G950FXXU1AQL5", "HDR+ 1.0.199571065zdh"])
def test_firmware_is_no_editor(firmware: str) -> None:
    assert find_crop_history(taken((3000, 2000), programs=firmware), 3000, 2000).crop == "whole"


sides = st.integers(64, 20_000)


@given(st.lists(st.tuples(sides, sides), max_size=3), sides, sides, st.booleans())
def test_history_of_any_sizes_is_finite(sizes: list[tuple[int, int]], width: int, height: int, turned: bool) -> None:
    history = find_crop_history(taken(*sizes), width, height, turned)
    assert 0 < history.scale < 1000
    assert 0 <= history.error < 0.2
    assert history.long >= history.short >= 64
    assert history.crop != "whole" or history.remark == "" or "resized" in history.remark
