"""Photos with a camera file, a focal length, EXIF data or nothing, and the notes about each."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from PIL.ExifTags import IFD, Base
from PIL.TiffImagePlugin import IFDRational

from linecad.camera.photo import Photo, read_photo, read_photo_of
from linecad.errors import CameraError, PhotoError
from linecad.scene import Camera

WIDTH, HEIGHT = 120, 80
DIAGONAL = float(np.hypot(WIDTH, HEIGHT))


def picture(width: int = WIDTH, height: int = HEIGHT) -> np.ndarray:
    y, x = np.mgrid[0:height, 0:width]
    return np.stack([x * 2 % 256, y * 3 % 256, (x + y) % 256], axis=-1).astype(np.uint8)


def save(folder: Path, *, size: tuple[int, int] = (WIDTH, HEIGHT), orientation: int = 1, **tags: Any) -> Path:
    """A PNG with EXIF tags given by name."""
    exif = Image.Exif()
    exif[Base.Orientation] = orientation
    exif.get_ifd(IFD.Exif).update({int(Base[name]): value for name, value in tags.items()})
    path = folder / "photo.png"
    Image.fromarray(picture(*size)).save(path, exif=exif)
    return path


def camera_file(folder: Path, width: int = WIDTH, height: int = HEIGHT, **changes: Any) -> Path:
    record = {"width": width, "height": height, "K": [[150, 0, 61], [0, 150, 37], [0, 0, 1]]} | changes
    path = folder / "camera.json"
    path.write_text(json.dumps(record))
    return path


def test_photo_without_any_camera(tmp_path: Path) -> None:
    Image.fromarray(picture()).save(tmp_path / "plain.png")
    photo = read_photo(tmp_path / "plain.png")
    assert photo.camera is None
    assert photo.notes == ()
    assert (photo.name, photo.width, photo.height) == ("plain.png", WIDTH, HEIGHT)


def test_pixels_are_read_only_and_grey_is_luminance(tmp_path: Path) -> None:
    Image.new("RGB", (WIDTH, HEIGHT), (200, 100, 50)).save(tmp_path / "plain.png")
    photo = read_photo(tmp_path / "plain.png")
    for array in (photo.pixels, photo.grey):
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 1
    assert photo.grey.shape == (HEIGHT, WIDTH)
    assert photo.grey[0, 0] == round(0.299 * 200 + 0.587 * 100 + 0.114 * 50)


@pytest.mark.parametrize(
    "pixels", [np.zeros((80, 90), np.uint8), np.zeros((80, 90, 3)), np.zeros((80, 90, 4), np.uint8)]
)
def test_record_refuses_other_shapes(pixels: np.ndarray) -> None:
    with pytest.raises(ValueError, match=r"Photo\.pixels"):
        Photo("odd", pixels, None)


def test_camera_file_comes_first_and_leaves_pixels_alone(tmp_path: Path) -> None:
    photo = read_photo(save(tmp_path, FocalLengthIn35mmFilm=50), camera_file(tmp_path))
    assert photo.camera is not None
    assert photo.camera.source == "file"
    assert photo.camera.matrix.tolist() == [[150, 0, 61], [0, 150, 37], [0, 0, 1]]
    np.testing.assert_array_equal(photo.pixels, picture())
    assert photo.notes == ()


def test_distortion_is_removed_and_recorded(tmp_path: Path) -> None:
    photo = read_photo(save(tmp_path), camera_file(tmp_path, distortion=[-0.1, 0.01, 0, 0]))
    assert photo.camera is not None
    assert photo.camera.distortion == (-0.1, 0.01, 0, 0)
    assert not photo.camera.is_resampled
    assert photo.pixels.shape == (HEIGHT, WIDTH, 3)
    assert not np.array_equal(photo.pixels, picture())
    assert photo.notes == ("lens distortion removed, as the camera file says",)


def test_pixels_are_made_square(tmp_path: Path) -> None:
    photo = read_photo(save(tmp_path), camera_file(tmp_path, K=[[150, 0, 61], [0, 165, 37], [0, 0, 1]]))
    assert photo.camera is not None
    assert photo.camera.matrix.tolist() == [[150, 0, 61], [0, 150, 37], [0, 0, 1]]
    assert "pixels made square" in photo.notes[0]
    assert photo.camera.is_resampled
    # Row 37 stays, and what lay 33 rows below it now lies 30 rows below it.
    np.testing.assert_array_equal(photo.pixels[37], picture()[37])
    np.testing.assert_allclose(photo.pixels[67, 5:115].astype(int), picture()[70, 5:115], atol=1)


def test_pincushion_says_how_much_lies_outside(tmp_path: Path) -> None:
    photo = read_photo(save(tmp_path), camera_file(tmp_path, distortion=[0.3, 0, 0, 0]))
    assert any("lies outside the photo as taken" in note for note in photo.notes)


def test_distortion_that_leaves_little_of_the_photo_is_refused(tmp_path: Path) -> None:
    with pytest.raises(CameraError, match="outside"):
        read_photo(save(tmp_path), camera_file(tmp_path, distortion=[200, 0, 0, 0]))


def test_focal_option(tmp_path: Path) -> None:
    photo = read_photo(save(tmp_path, FocalLengthIn35mmFilm=50), focal=140.0)
    assert photo.camera is not None
    assert photo.camera.source == "focal option"
    assert photo.camera.matrix.tolist() == [[140, 0, 59.5], [0, 140, 39.5], [0, 0, 1]]


@pytest.mark.parametrize("focal", [0.0, -5.0, float("nan"), float("inf"), 11.0, 6001.0])
def test_absurd_focal_option_is_refused(tmp_path: Path, focal: float) -> None:
    with pytest.raises(CameraError, match="focal length is"):
        read_photo(save(tmp_path), focal=focal)


def test_two_cameras_are_one_too_many(tmp_path: Path) -> None:
    with pytest.raises(CameraError, match="give one"):
        read_photo(save(tmp_path), camera_file(tmp_path), focal=100.0)


def test_camera_file_of_another_size_names_both(tmp_path: Path) -> None:
    with pytest.raises(CameraError, match=r"240 x 160 px.*120 x 80 px"):
        read_photo(save(tmp_path), camera_file(tmp_path, 240, 160))


def test_camera_file_of_a_turned_photo(tmp_path: Path) -> None:
    turned = save(tmp_path, orientation=6)
    with pytest.raises(CameraError, match=r"120 x 80 px.*80 x 120 px because its EXIF orientation"):
        read_photo(turned, camera_file(tmp_path))
    photo = read_photo(turned, camera_file(tmp_path, HEIGHT, WIDTH))
    assert any("turned by its EXIF orientation" in note for note in photo.notes)


def test_camera_file_on_its_side_without_exif(tmp_path: Path) -> None:
    with pytest.raises(CameraError, match="lies on its side"):
        read_photo(save(tmp_path), camera_file(tmp_path, HEIGHT, WIDTH))


def test_malformed_camera_file_is_reported_before_the_photo_is_decoded(tmp_path: Path) -> None:
    (tmp_path / "camera.json").write_text("{}")
    with pytest.raises(CameraError, match="width is missing"):
        read_photo(tmp_path / "no photo.png", tmp_path / "camera.json")
    with pytest.raises(PhotoError, match="does not exist"):
        read_photo(tmp_path / "no photo.png")


def exif_focal(path: Path) -> float:
    photo = read_photo(path)
    assert photo.camera is not None
    assert photo.camera.source == "exif"
    assert photo.camera.matrix[:2, 2].tolist() == [(photo.width - 1) / 2, (photo.height - 1) / 2]
    return photo.camera.focal


@pytest.mark.parametrize("orientation", [1, 3, 6, 8])
def test_35_mm_equivalent_is_by_the_diagonal_however_the_photo_is_turned(tmp_path: Path, orientation: int) -> None:
    focal = exif_focal(save(tmp_path, orientation=orientation, FocalLengthIn35mmFilm=28))
    assert focal == pytest.approx(28 / 43.27 * DIAGONAL)


def test_exif_focal_length_stands_beside_the_camera_and_is_noted(tmp_path: Path) -> None:
    photo = read_photo(save(tmp_path, FocalLengthIn35mmFilm=28, ExifImageWidth=WIDTH, ExifImageHeight=HEIGHT))
    assert photo.camera is not None
    assert photo.exif_focal is not None
    assert photo.camera.focal == photo.exif_focal.focal
    assert photo.crop == "whole"
    assert photo.notes == (f"focal length from {photo.exif_focal.origin}, standard error about 4%",)


def test_resized_photo_says_so(tmp_path: Path) -> None:
    path = save(tmp_path, FocalLengthIn35mmFilm=28, ExifImageWidth=WIDTH * 10, ExifImageHeight=HEIGHT * 10)
    assert exif_focal(path) == pytest.approx(28 / 43.27 * DIAGONAL)
    assert read_photo(path).notes[1] == "the photo was taken with 1200 x 800 px and resized"


def test_cropped_photo_keeps_the_focal_length_of_the_whole_and_says_so(tmp_path: Path) -> None:
    path = save(tmp_path, size=(80, 80), FocalLengthIn35mmFilm=28, ExifImageWidth=WIDTH, ExifImageHeight=HEIGHT)
    assert exif_focal(path) == pytest.approx(28 / 43.27 * DIAGONAL)
    assert read_photo(path).crop == "cropped"
    assert "principal point" in read_photo(path).notes[1]


def test_cropped_photo_of_unknown_focal_length_says_so_too(tmp_path: Path) -> None:
    path = save(tmp_path, size=(80, 80), ExifImageWidth=WIDTH, ExifImageHeight=HEIGHT)
    for photo in (read_photo(path), read_photo(path, focal=100.0)):
        assert photo.crop == "cropped"
        assert photo.exif_focal is None
        assert len(photo.notes) == 1


def test_size_of_the_larger_original_stands_in_a_part_of_its_own(tmp_path: Path) -> None:
    exif = Image.Exif()
    exif.get_ifd(IFD.Exif)[IFD.Interop] = {int(Base.RelatedImageWidth): 200, int(Base.RelatedImageLength): 80}
    Image.fromarray(picture()).save(tmp_path / "photo.jpg", exif=exif)
    assert read_photo(tmp_path / "photo.jpg").crop == "cropped"


def test_camera_file_leaves_the_crop_history_known(tmp_path: Path) -> None:
    path = save(tmp_path, ExifImageWidth=WIDTH, ExifImageHeight=HEIGHT)
    assert read_photo(path, camera_file(tmp_path)).crop == "whole"


@pytest.mark.parametrize(
    "tags",
    [
        {"FocalLengthIn35mmFilm": 0},
        {"FocalLength": 4.5},
        {"FocalPlaneXResolution": 9000.0},
        {"FocalLength": 4.5, "FocalPlaneXResolution": 40.0, "FocalPlaneResolutionUnit": 1},
        {"FocalLength": 4.5, "FocalPlaneXResolution": 900.0, "FocalPlaneYResolution": 450.0},
        {"FocalLength": IFDRational(0, 0), "FocalPlaneXResolution": 900.0},
    ],
)
def test_exif_that_does_not_say_the_focal_length(tmp_path: Path, tags: dict[str, Any]) -> None:
    photo = read_photo(save(tmp_path, **tags))
    assert (photo.camera, photo.exif_focal) == (None, None)
    assert photo.notes == ()


def test_absurd_exif_focal_length_is_ignored_with_a_note(tmp_path: Path) -> None:
    photo = read_photo(save(tmp_path, FocalLengthIn35mmFilm=60_000))
    assert photo.camera is None
    assert "does not suit" in photo.notes[0]


def test_alpha_note_reaches_the_photo(tmp_path: Path) -> None:
    Image.new("RGBA", (WIDTH, HEIGHT), (0, 0, 0, 9)).save(tmp_path / "glass.png")
    assert any("transparent" in note for note in read_photo(tmp_path / "glass.png", focal=100.0).notes)


@pytest.mark.parametrize(
    ("name", "notes"),
    [
        ("castle/0003", ("pixels made square, as the camera file says",)),
        ("south_building/img000055", ()),
        ("york_urban/P1020177", ()),
    ],
)
def test_ground_truth_files_serve_as_camera_files(photographs: Path, name: str, notes: tuple[str, ...]) -> None:
    photo = read_photo(photographs / f"{name}.jpg", photographs / f"{name}.json")
    truth = json.loads((photographs / f"{name}.json").read_text())
    assert photo.camera is not None
    assert photo.camera.focal == truth["K"][0][0]
    assert photo.notes == notes


def scene_camera(width: int = WIDTH, height: int = HEIGHT, distortion: tuple[float, ...] = (-0.1, 0, 0, 0)) -> Camera:
    """As a scene has it whose photo was straightened by its own lines."""
    matrix = np.array([[150.0, 0, 61], [0, 150, 37], [0, 0, 1]])
    return Camera(width, height, matrix, "vanishing points", distortion)


def test_a_photo_read_again_for_its_scene_has_the_camera_of_the_scene(tmp_path: Path) -> None:
    camera = scene_camera()
    again = read_photo_of(save(tmp_path, FocalLengthIn35mmFilm=50), camera)
    told = read_photo(save(tmp_path), camera_file(tmp_path, distortion=[-0.1, 0, 0, 0]))
    np.testing.assert_array_equal(again.pixels, told.pixels)
    assert again.camera is camera
    assert again.notes == ("lens distortion removed, as in the scene",)


def test_a_turned_photo_read_again_is_no_warning(tmp_path: Path) -> None:
    again = read_photo_of(save(tmp_path, orientation=6), scene_camera(HEIGHT, WIDTH))
    assert again.pixels.shape == (WIDTH, HEIGHT, 3)
    assert not any("turned" in note for note in again.notes)


def test_a_photo_of_another_size_is_not_that_of_the_scene(tmp_path: Path) -> None:
    with pytest.raises(CameraError, match=r"the scene is for 240 x 160 px.*120 x 80 px"):
        read_photo_of(save(tmp_path), scene_camera(240, 160))


def test_distortion_of_a_scene_that_nobody_can_undo_is_refused(tmp_path: Path) -> None:
    with pytest.raises(CameraError, match="3 coefficients"):
        read_photo_of(save(tmp_path), scene_camera(distortion=(0.1, 0.2, 0.3)))
