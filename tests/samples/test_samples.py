"""The sample photos: complete, small, and in agreement with their own ground truth."""

import io
import json
import subprocess
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from PIL.ExifTags import IFD, Base

from linecad.camera.photo import Photo, read_photo

SAMPLES = Path(__file__).resolve().parents[2] / "samples"
NAMES = ("street", "courtyard", "room")
each = pytest.mark.parametrize("name", NAMES)


def truth_of(name: str) -> dict[str, Any]:
    truth: dict[str, Any] = json.loads((SAMPLES / f"{name}.truth.json").read_text(encoding="utf-8"))
    return truth


def photo_of(name: str) -> Photo:
    return read_photo(SAMPLES / f"{name}.jpg", SAMPLES / f"{name}.json")


def project(points: np.ndarray, K: np.ndarray) -> np.ndarray:
    image = points @ K.T
    return image[..., :2] / image[..., 2:]


@each
def test_files_are_small(name: str) -> None:
    assert (SAMPLES / f"{name}.jpg").stat().st_size < 500_000
    assert (SAMPLES / f"{name}.truth.json").stat().st_size < 200_000


@each
def test_photo_opens_with_its_camera_file(name: str) -> None:
    photo, truth = photo_of(name), truth_of(name)
    assert photo.camera is not None
    assert (photo.width, photo.height) == (truth["width"], truth["height"]) == (1600, 1067)
    np.testing.assert_allclose(photo.camera.matrix, truth["K"])


@each
def test_true_lines_project_to_their_pixels(name: str) -> None:
    truth = truth_of(name)
    K = np.array(truth["K"])
    ends = np.array([[line["P_cam"], line["Q_cam"]] for line in truth["lines"]])
    pixels = np.array([[line["p"], line["q"]] for line in truth["lines"]])
    assert np.abs(project(ends, K) - pixels).max() < 0.5
    assert np.linalg.norm(pixels[:, 1] - pixels[:, 0], axis=1).min() >= 9.9
    assert pixels.min() >= -0.5
    assert (pixels.max(axis=(0, 1)) <= (1599.5, 1066.5)).all()


@each
def test_true_lines_run_along_the_axis_of_their_label(name: str) -> None:
    truth = truth_of(name)
    R = np.array(truth["R_cam_from_manhattan"])
    ends = np.array([[line["P_cam"], line["Q_cam"]] for line in truth["lines"]])
    axis = R[:, [line["label"] for line in truth["lines"]]].T
    along = ends[:, 1] - ends[:, 0]
    off = np.linalg.norm(np.cross(along, axis), axis=1)
    assert off.max() < 2e-4  # m; coordinates are rounded to 0.1 mm
    assert {line["label"] for line in truth["lines"]} == {0, 1, 2}


@each
def test_axes_are_named_as_the_scene_file_promises(name: str) -> None:
    R = np.array(truth_of(name)["R_cam_from_manhattan"])
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-6)
    assert np.linalg.det(R) > 0
    assert R[0, 0] > 0  # x points right
    assert R[2, 1] > 0  # y points away
    assert R[1, 2] < 0  # z points up, camera y points down
    assert abs(R[2, 0]) < abs(R[2, 1])  # x is the one closer to the image plane
    assert np.abs(R[2]).min() > 0.05  # all three vanishing points are finite


@each
def test_true_points_project_to_their_pixels_and_lie_on_lines_where_promised(name: str) -> None:
    truth = truth_of(name)
    points = np.array(truth["points"])
    assert len(points) >= 300
    assert np.abs(project(points[:, 2:], np.array(truth["K"])) - points[:, :2]).max() < 0.5
    ends = np.array([[line["P_cam"], line["Q_cam"]] for line in truth["lines"]])
    along = ends[:, 1] - ends[:, 0]
    for point in points[truth["on_line"], 2:]:
        share = np.clip(((point - ends[:, 0]) * along).sum(axis=1) / (along**2).sum(axis=1), 0, 1)
        assert np.linalg.norm(ends[:, 0] + share[:, None] * along - point, axis=1).min() < 5e-4  # m


@each
def test_true_lines_are_seen_in_the_photo(name: str) -> None:
    """Brightness changes more across the listed edges than across the same edges moved aside."""
    truth = truth_of(name)
    grey = photo_of(name).grey.astype(float)
    ends = np.array([[line["p"], line["q"]] for line in truth["lines"]])
    along = ends[:, 1] - ends[:, 0]
    length = np.linalg.norm(along, axis=1, keepdims=True)
    ends, along = ends[length[:, 0] > 40], (along / length)[length[:, 0] > 40]
    normal = np.column_stack([-along[:, 1], along[:, 0]])

    def contrast(shift: float) -> float:
        share = np.linspace(0.1, 0.9, 30)[:, None, None]
        line = ends[:, 0] * (1 - share) + ends[:, 1] * share + shift * normal
        sides = []
        for side in (-1.5, 1.5):
            x, y = np.round(line + side * normal).astype(int).transpose(2, 0, 1)
            sides.append(grey[np.clip(y, 0, 1066), np.clip(x, 0, 1599)])
        return float(np.median(np.abs((sides[1] - sides[0]).mean(axis=0))))

    assert contrast(0.0) > 4 * contrast(7.0)


def test_room_has_the_focal_length_in_its_exif_data() -> None:
    with Image.open(SAMPLES / "room.jpg") as image:
        assert image.getexif().get_ifd(IFD.Exif)[Base.FocalLengthIn35mmFilm] == 24
    photo = read_photo(SAMPLES / "room.jpg")
    assert photo.camera is not None
    assert photo.camera.source == "exif"
    np.testing.assert_allclose(photo.camera.matrix, truth_of("room")["K"], atol=1e-3)


@pytest.mark.parametrize("name", ["street", "courtyard"])
def test_the_others_do_not_give_their_focal_length_away(name: str) -> None:
    assert read_photo(SAMPLES / f"{name}.jpg").camera is None


def test_courtyard_is_distorted() -> None:
    photo = photo_of("courtyard")
    assert photo.camera is not None
    assert len(photo.camera.distortion) == 4
    assert photo.notes == ("lens distortion removed, as the camera file says",)


# The light of the room is found in a fifth of the time that the others take.
everyday = pytest.mark.parametrize(
    "name", ["room", *(pytest.param(name, marks=pytest.mark.thorough) for name in NAMES if name != "room")]
)


def make_small(folder: Path, name: str) -> dict[str, bytes]:
    """The files of a run for one scene at 160 px."""
    command = [sys.executable, str(SAMPLES / "make_samples.py"), "--width", "160", "--output", str(folder), name]
    subprocess.run(command, check=True, capture_output=True, timeout=120)
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], dict[str, bytes]]:
    """A function that gives the small files of a scene, made once."""
    return cache(lambda name: make_small(tmp_path_factory.mktemp("small"), name))


@everyday
@pytest.mark.thorough
def test_making_them_twice_gives_the_same_bytes(
    small: Callable[[str], dict[str, bytes]], tmp_path: Path, name: str
) -> None:
    made = small(name)
    assert set(made) == {f"{name}{suffix}" for suffix in (".jpg", ".json", ".truth.json")}
    assert make_small(tmp_path, name) == made


@everyday
def test_script_shows_the_scene_of_the_photo_beside_it(small: Callable[[str], dict[str, bytes]], name: str) -> None:
    with Image.open(io.BytesIO(small(name)[f"{name}.jpg"])) as made, Image.open(SAMPLES / f"{name}.jpg") as kept:
        shrunk = np.asarray(kept.resize(made.size, Image.Resampling.BOX), float)
        assert np.abs(np.asarray(made, float) - shrunk).mean() < 12  # grey levels; two of the scenes differ by over 40
