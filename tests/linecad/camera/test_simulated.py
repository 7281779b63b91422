"""The camera of simulated photos that pass through the real detector, and what is done to such photos."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from camera_verdicts import Verdict, area_below, finite_points, judge, turn_between
from numpy.testing import assert_allclose
from simulated import SUPER, Canvas, bent, cropped, draw_canvas, draw_shot, enlarged, finished, turned
from simulated_kinds import PLAIN, simulated_photo

from linecad.camera.photo import read_photo
from linecad.geometry import rotation_about
from linecad.scene import Camera

SEED = 3
SCENES = (1, 4, 6)  # a street, a courtyard: all three vanishing points are finite, nothing is left to a prior
each_scene = pytest.mark.parametrize(
    "scene", [SCENES[-1], *(pytest.param(scene, marks=pytest.mark.thorough) for scene in SCENES[:-1])]
)
POINT = np.array([[0.31, -0.22, 1.0]])


def canvas_with_a_dot(width: int = 400, height: int = 300) -> Canvas:
    """A black picture in which a soft white dot shows POINT."""
    matrix = np.array([[330.0, 0.0, 205.0], [0.0, 330.0, 148.0], [0.0, 0.0, 1.0]])
    canvas = Canvas(np.zeros((height, width, 3), np.uint8), matrix, rotation_about(np.array([0.05, -0.1, 0.02])))
    x, y = canvas.project(POINT)[0]
    across, down = np.meshgrid(np.arange(width) - x, np.arange(height) - y)
    dot = 255 * np.exp(-(across**2 + down**2) / (2 * 4.0**2))
    return replace(canvas, pixels=np.repeat(dot[..., None], 3, axis=2).round().astype(np.uint8))


def dot_of(pixels: np.ndarray) -> np.ndarray:
    """The middle (2,) of what is bright."""
    bright = pixels[..., 0].astype(float)
    y, x = np.mgrid[: bright.shape[0], : bright.shape[1]]
    return np.array([(x * bright).sum(), (y * bright).sum()]) / bright.sum()


@pytest.mark.parametrize(
    "changed",
    [
        lambda canvas: bent(canvas, -0.3),
        lambda canvas: bent(canvas, 0.1),
        lambda canvas: cropped(canvas, 60, 10, 300, 200),
        lambda canvas: turned(canvas, 1),
        lambda canvas: turned(canvas, 2),
        lambda canvas: turned(canvas, 3),
        lambda canvas: turned(cropped(bent(canvas, -0.2), 60, 10, 300, 200), 1),
    ],
    ids=["barrel", "pincushion", "cropped", "clockwise", "upside down", "anticlockwise", "all"],
)
def test_a_point_goes_where_its_new_camera_sees_it(changed) -> None:
    canvas = changed(canvas_with_a_dot())
    assert_allclose(dot_of(canvas.pixels), canvas.project(POINT)[0], atol=0.15)


def test_a_photo_shows_a_point_where_its_reduced_camera_sees_it() -> None:
    canvas = canvas_with_a_dot()
    data, matrix = finished(canvas, np.random.default_rng(0))
    assert len(data) > 1000
    reduced = replace(canvas, matrix=matrix).project(POINT)
    assert_allclose(SUPER * reduced + (SUPER - 1) / 2, canvas.project(POINT))
    assert_allclose(enlarged(matrix, SUPER), canvas.matrix)


def test_a_lens_that_folds_the_picture_is_refused() -> None:
    with pytest.raises(ValueError, match="folds"):
        bent(canvas_with_a_dot(), -1.0)


def test_the_turn_between_frames_is_in_the_camera_and_knows_no_names() -> None:
    true = rotation_about(np.array([0.4, -1.1, 0.3]))
    turn = np.array([0.01, -0.02, 0.015])
    found = (rotation_about(turn) @ true)[:, [2, 0, 1]] * (1, -1, -1)
    assert_allclose(turn_between(found, true), turn, atol=1e-12)


def test_a_level_camera_that_looks_at_a_corner_has_two_finite_vanishing_points() -> None:
    matrix = np.array([[800.0, 0.0, 399.5], [0.0, 800.0, 299.5], [0.0, 0.0, 1.0]])
    upright = rotation_about(np.array([np.pi / 2, 0, 0]))
    corner = upright @ rotation_about(np.array([0, 0, np.pi / 4]))
    assert finite_points(matrix, corner, 800, 600) == 2
    assert finite_points(matrix, upright, 800, 600) == 1
    assert finite_points(matrix, rotation_about(np.array([0.5, 0, 0])) @ corner, 800, 600) == 3


def test_the_area_below_the_error_curve() -> None:
    assert area_below(np.array([0.0, 1.0, 5.0, np.inf]), 2.0) == pytest.approx((1 + 0.5) / 4)


def verdict(turn: float, focal: float, sigmas: float, quality: str, error: str | None = None) -> Verdict:
    return Verdict("a", "plain", 3, error, np.radians(turn), focal, {"rotation": (sigmas,), "focal": (sigmas,)},
                   0.01, quality)  # fmt: skip


def test_what_is_called_silently_wrong() -> None:
    assert verdict(0.5, 0.2, 3.5, "good").is_silently_wrong
    assert verdict(2.0, 0.01, 3.5, "good").is_silently_wrong
    assert not verdict(2.0, 0.2, 2.9, "good").is_silently_wrong
    assert not verdict(0.5, 0.01, 9.0, "good").is_silently_wrong
    assert not verdict(2.0, 0.2, 9.0, "doubtful").is_silently_wrong
    assert not verdict(np.nan, np.nan, np.nan, "good", "no frame").is_silently_wrong


def test_what_is_called_recovered() -> None:
    assert verdict(0.5, 0.01, 9.0, "good").is_recovered
    assert verdict(3.0, 0.2, 1.5, "good").is_recovered
    assert not verdict(0.5, 0.2, 2.5, "good").is_recovered
    assert not verdict(3.0, 0.01, 2.5, "good").is_recovered
    assert not verdict(np.nan, np.nan, 0.0, "", "no frame").is_recovered


@pytest.mark.thorough
def test_the_same_seed_gives_the_same_photo() -> None:
    first, again = (draw_canvas(draw_shot(5, 9), np.random.default_rng(2)) for _ in range(2))
    assert (first.pixels == again.pixels).all()
    assert (first.matrix == again.matrix).all()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("simulated")


@each_scene
def test_the_frame_of_a_simulated_photo_with_known_camera(folder: Path, scene: int) -> None:
    made = simulated_photo(folder, SEED, scene, PLAIN)
    photo = replace(read_photo(made.path), camera=Camera(*made.size, made.matrix, "file"))
    found = judge(made.name, made.kind, photo, made.matrix, made.rotation)
    assert found.error is None
    assert np.degrees(found.turn) < 2.0


@each_scene
def test_camera_and_frame_of_a_simulated_photo(folder: Path, scene: int) -> None:
    made = simulated_photo(folder, SEED, scene, PLAIN)
    found = judge(made.name, made.kind, read_photo(made.path), made.matrix, made.rotation)
    assert found.error is None
    assert abs(found.focal) < 0.05
    assert np.degrees(found.turn) < 2.0 or found.quality != "good"
