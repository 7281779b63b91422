"""Photos that a lens bent, straightened by their own lines, and photos that are left as they are."""

import json
from dataclasses import replace

import cv2
import numpy as np
import pytest
from PIL import Image

from linecad.camera import distortion as straightening
from linecad.camera.camera_file import write_camera
from linecad.camera.distortion import find_bend, open_photo, straighten
from linecad.camera.estimate import calibrate
from linecad.camera.photo import Bend, Photo, read_photo, read_photo_of
from linecad.camera.report import find_camera
from linecad.lines.segments import find_segments
from linecad.scene import Camera

RADIAL = {"barrel": -0.05, "pincushion": 0.03}  # at half the diagonal
SIZE = (1600, 1200)
CENTER = np.array([799.5, 599.5])
HALF = 1000.0  # px


def bent(image, radial):
    """A photo (H, W) as a lens shows it that moves points at half the diagonal out by this share."""
    y, x = np.mgrid[0 : SIZE[1], 0 : SIZE[0]]
    off = np.stack([x, y], axis=-1) - CENTER
    straight = np.linspace(0, 2, 4001)
    taken = straight * (1 + radial * straight**2)
    reach = int(taken.argmax()) + 1  # further out, a barrel folds the picture over
    distance = np.maximum(np.linalg.norm(off, axis=-1) / HALF, 1e-9)
    before = np.interp(distance, taken[:reach], straight[:reach], right=10.0)
    places = (CENTER + off * (before / distance)[..., None]).astype(np.float32)
    return cv2.remap(image, places, None, cv2.INTER_CUBIC, borderMode=cv2.BORDER_CONSTANT, borderValue=235)


def on_file(folder, name, image):
    path = folder / f"{name}.png"
    Image.fromarray(image).convert("RGB").save(path)
    return path


@pytest.fixture(scope="module")
def folder(tmp_path_factory, made):
    """Drawings of the made scene: straight.png, barrel.png, pincushion.png, fisheye.png."""
    folder = tmp_path_factory.mktemp("bent")
    image = made.image()
    on_file(folder, "straight", image)
    on_file(folder, "fisheye", bent(image, -0.3))
    for name, radial in RADIAL.items():
        on_file(folder, name, bent(image, radial))
    return folder


@pytest.fixture(scope="module")
def barrel(folder):
    """The photo with barrel distortion, straightened."""
    return open_photo(folder / "barrel.png")


@pytest.mark.parametrize("name", RADIAL)
def test_the_bend_is_found_within_its_standard_error(folder, name):
    bend = find_bend(read_photo(folder / f"{name}.png"))
    assert abs(bend.radial - RADIAL[name]) < 3 * bend.radial_error
    assert bend.radial_error < 0.01
    assert np.linalg.norm(CENTER - bend.center) < 3 * np.hypot(bend.center_error, bend.center_error)


def test_lines_are_straight_again(made, barrel):
    """Points on true lines, taken through the lens and back, lie within half a pixel of a line."""
    share = np.linspace(0, 1, 15)[:, None]
    worst = 0.0
    for start, end in made.pixels:
        points = start + share * (end - start)
        taken = CENTER + (points - CENTER) * (1 + RADIAL["barrel"] * ((points - CENTER) ** 2).sum(1)[:, None] / HALF**2)
        back = taken
        for _ in range(20):
            squared = ((back - barrel.bend.center) ** 2).sum(1)[:, None] / HALF**2
            back = barrel.bend.center + (taken - barrel.bend.center) / (1 + barrel.bend.radial * squared)
        across = np.array([start[1] - end[1], end[0] - start[0]]) / np.linalg.norm(end - start)
        off = (back - back[0]) @ across
        off = off - share[:, 0] * off[-1]
        worst = max(worst, np.abs(off).max())
    assert worst < 0.5


def test_pixels_are_those_of_the_photo_without_its_lens(made, barrel):
    """Most of them: edges lie within some tenths of a pixel, and neighbours differ by 40 grey levels at least."""
    image = made.image()
    off, unstraightened = (
        np.abs(grey.astype(int) - image) > 30 for grey in (barrel.grey, bent(image, RADIAL["barrel"]))
    )
    assert off.mean() < 0.1 * unstraightened.mean()


def test_what_was_done_is_said(barrel):
    assert "bent by a barrel distortion" in barrel.notes[-1]
    assert barrel.camera is None


def test_a_straight_photo_is_left_as_it_is(folder):
    photo = read_photo(folder / "straight.png")
    assert straighten(photo) is photo


@pytest.mark.parametrize(
    ("radial", "error", "is_straightened"),
    [
        (0.006, 0.0005, False),
        (0.012, 0.0005, True),
        (0.03, 0.008, False),
        (-0.03, 0.007, True),
        (-0.19, 0.001, True),
        (-0.21, 0.001, False),
        (0.24, 0.001, True),
        (0.26, 0.001, False),
    ],
    ids=["too little", "enough", "not sure", "sure", "wide", "fisheye", "large", "too large"],
)
def test_what_is_worth_straightening(monkeypatch, radial, error, is_straightened):
    bend = Bend(radial, error, (99.5, 74.5), 1.0)
    monkeypatch.setattr(straightening, "find_bend", lambda _: bend)
    photo = Photo("made.png", np.random.default_rng(0).integers(0, 255, (150, 200, 3), np.uint8), None)
    found = straighten(photo)
    assert (found.bend is bend) == is_straightened
    assert np.shares_memory(found.pixels, photo.pixels) != is_straightened


def test_a_photo_without_segments_is_left_as_it_is(tmp_path):
    photo = read_photo(on_file(tmp_path, "flat", np.full((300, 400), 128, np.uint8)))
    assert find_bend(photo) is None
    assert straighten(photo) is photo


def test_a_photo_with_a_camera_file_is_left_to_it(folder):
    photo = read_photo(folder / "barrel.png")
    photo = replace(photo, camera=Camera(*SIZE, np.array([[900.0, 0, 799.5], [0, 900, 599.5], [0, 0, 1]]), "file"))
    assert straighten(photo) is photo


def test_a_given_focal_length_stays_and_the_principal_point_is_the_middle_of_the_bend(folder):
    photo = open_photo(folder / "barrel.png", focal=900.0)
    assert photo.camera.source == "focal option"
    assert photo.camera.focal == 900.0
    assert tuple(photo.camera.matrix[:2, 2]) == photo.bend.center
    assert (photo.pixels != read_photo(folder / "barrel.png").pixels).any()


def test_a_fisheye_is_left_as_it_is_with_a_word(folder):
    photo = read_photo(folder / "fisheye.png")
    found = straighten(photo)
    assert np.shares_memory(found.pixels, photo.pixels)
    assert found.bend is None
    assert found.is_fisheye
    assert calibrate(found, find_segments(found.grey)).certainty.quality != "good"
    assert "too much for one coefficient" in found.notes[-1]
    assert "--camera" in found.notes[-1]


def test_the_camera_file_of_a_bent_photo_gives_the_same_photo_again(folder, barrel, tmp_path):
    report = find_camera(folder / "barrel.png")
    write_camera(report, tmp_path / "camera.json")
    again = open_photo(folder / "barrel.png", tmp_path / "camera.json")
    np.testing.assert_array_equal(again.camera.matrix, report.camera.matrix)
    assert again.camera.distortion == report.camera.distortion
    assert np.abs(again.pixels.astype(int) - barrel.pixels).max() <= 1
    k1 = json.loads((tmp_path / "camera.json").read_text(encoding="utf-8"))["distortion"][0]
    assert abs(k1 / (report.camera.focal / HALF) ** 2 - RADIAL["barrel"]) < 3 * barrel.bend.radial_error


def test_the_camera_of_a_scene_gives_the_same_photo_again(folder, barrel):
    camera = find_camera(folder / "barrel.png").camera
    again = read_photo_of(folder / "barrel.png", camera)
    np.testing.assert_array_equal(again.camera.matrix, camera.matrix)
    assert np.abs(again.pixels.astype(int) - barrel.pixels).max() <= 1
