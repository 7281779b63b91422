"""Camera files good and bad, and distortion put on and taken off."""

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linecad.camera.intrinsics import Calibration, distort_points, read_calibration, undistort_photo, undistort_points
from linecad.errors import CameraError

K = [[800.0, 0.0, 320.0], [0.0, 800.0, 240.0], [0.0, 0.0, 1.0]]
BARREL = (-0.12, 0.02, 0.001, -0.0015, 0.003)


def write(folder: Path, **changes: Any) -> Path:
    """A camera file of a 640 x 480 photo with some entries changed; None removes an entry."""
    record = {"width": 640, "height": 480, "K": K} | changes
    path = folder / "camera.json"
    path.write_text(json.dumps({key: value for key, value in record.items() if value is not None}))
    return path


def refuse(path: Path) -> str:
    with pytest.raises(CameraError) as caught:
        read_calibration(path)
    message = str(caught.value)
    assert "\n" not in message
    assert path.name in message
    return message


def test_plain_camera_file(tmp_path: Path) -> None:
    calibration = read_calibration(write(tmp_path))
    assert (calibration.width, calibration.height) == (640, 480)
    assert calibration.matrix.tolist() == K
    assert calibration.is_pinhole


def test_keys_of_ground_truth_files_are_left_alone(tmp_path: Path) -> None:
    calibration = read_calibration(write(tmp_path, points=[[1.0] * 7] * 4000, columns=["u"], R_cam_from_world=K))
    assert calibration.matrix.tolist() == K


@pytest.mark.parametrize("count", [0, 4, 5, 8, 12, 14])
def test_opencvs_numbers_of_coefficients(tmp_path: Path, count: int) -> None:
    coefficients = [0.001] * count
    assert read_calibration(write(tmp_path, distortion=coefficients)).distortion == tuple(coefficients)


def test_one_row_of_coefficients_as_opencv_returns_it(tmp_path: Path) -> None:
    assert read_calibration(write(tmp_path, distortion=[list(BARREL)])).distortion == BARREL


@pytest.mark.parametrize("distortion", [[], [0.0] * 5, [[]]])
def test_no_distortion_in_other_words(tmp_path: Path, distortion: list[float]) -> None:
    assert read_calibration(write(tmp_path, distortion=distortion)).is_pinhole


def test_byte_order_mark_and_null_distortion(tmp_path: Path) -> None:
    path = tmp_path / "camera.json"
    path.write_text(json.dumps({"width": 640, "height": 480, "K": K, "distortion": None}), encoding="utf-8-sig")
    assert read_calibration(path).is_pinhole


def test_focal_lengths_that_agree_but_for_rounding_are_square(tmp_path: Path) -> None:
    almost = [[800.0, 0, 320], [0, 800.0000001, 240], [0, 0, 1]]
    assert read_calibration(write(tmp_path, K=almost)).is_pinhole
    assert not read_calibration(write(tmp_path, K=[[800, 0, 320], [0, 802, 240], [0, 0, 1]])).is_pinhole


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"width": None}, "width is missing"),
        ({"height": None}, "height is missing"),
        ({"K": None}, "K is missing"),
        ({"width": 0}, "width"),
        ({"width": 640.5}, "width"),
        ({"width": True}, "width"),
        ({"height": "480"}, "height"),
        ({"K": K[:2]}, "K"),
        ({"K": [800, 320, 240]}, "K"),
        ({"K": [[800.0, 0.0], [0.0, 800.0], [0.0, 0.0]]}, "K"),
        ({"K": [["800", 0, 320], [0, 800, 240], [0, 0, 1]]}, "K"),
        ({"K": [[float("nan"), 0, 320], [0, 800, 240], [0, 0, 1]]}, "NaN"),
        ({"K": [[float("inf"), 0, 320], [0, 800, 240], [0, 0, 1]]}, "Infinity"),
        ({"K": [[0, 0, 320], [0, 800, 240], [0, 0, 1]]}, "fx"),
        ({"K": [[800, 0, 320], [0, -800, 240], [0, 0, 1]]}, "fy"),
        ({"K": [[800, 2, 320], [0, 800, 240], [0, 0, 1]]}, "skew"),
        ({"K": [[800, 0, 0], [0, 800, 0], [320, 240, 1]]}, "order"),
        ({"K": [[800, 0, 320], [0, 800, 240], [0, 0, 2]]}, "order"),
        ({"K": [[63, 0, 320], [0, 63, 240], [0, 0, 1]]}, "fx .* 63 px"),
        ({"K": [[33000, 0, 320], [0, 33000, 240], [0, 0, 1]]}, "fx .* 33000 px"),
        ({"K": [[800, 0, 320], [0, 300, 240], [0, 0, 1]]}, "square"),
        ({"K": [[800, 0, 320], [0, 800, 2400], [0, 0, 1]]}, "principal point"),
        ({"K": [[800, 0, -700], [0, 800, 240], [0, 0, 1]]}, "principal point"),
        ({"distortion": [0.1, 0.2]}, "0, 4, 5, 8, 12, 14 coefficients"),
        ({"distortion": {"k1": 0.1}}, "list"),
        ({"distortion": [0.1, 0, 0, None]}, "number"),
        ({"distortion": [0.1, 0, 0, True]}, "number"),
    ],
)
def test_malformed_camera_files(tmp_path: Path, changes: dict[str, Any], says: str) -> None:
    path = write(tmp_path)
    record = json.loads(path.read_text()) | changes
    path.write_text(json.dumps({key: value for key, value in record.items() if value is not None}))
    with pytest.raises(CameraError, match=says):
        read_calibration(path)
    refuse(path)


@pytest.mark.parametrize(
    "distortion",
    [
        [-2.5, 0, 0, 0],  # the distorted radius shrinks again within the photo
        [0, 0, 0, 0, -12.0],
        [0, 0, 0, 0, 0, -4.5, 0, 0],  # a pole within the photo
        [0, 0, 2.0, 0],
        [1e300, 1e300, 0, 0],
        [0.1] * 12 + [1.5, 1e9],
    ],
)
def test_distortion_that_folds_over_is_refused(tmp_path: Path, distortion: list[float]) -> None:
    assert "folds" in refuse(write(tmp_path, distortion=distortion))


def test_distortion_that_folds_over_outside_the_photo_is_fine(tmp_path: Path) -> None:
    # 1 - 3 * 0.6 r^2 = 0 at r = 0.745; the corner of the photo is at r = 0.5
    assert read_calibration(write(tmp_path, distortion=[-0.6, 0, 0, 0])).distortion


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "JSON"),
        (b"not json", "JSON"),
        (b"[1, 2]", "object"),
        (b"null", "object"),
        (b"\xff\xd8\xff\xe0 a photo", "UTF-8"),
        (b"[" * 100_000, "nested"),
        (b'{"width": ' + b"9" * 5000 + b"}", "digits"),
    ],
)
def test_what_is_no_camera_file(tmp_path: Path, content: bytes, says: str) -> None:
    (tmp_path / "camera.json").write_bytes(content)
    assert says in refuse(tmp_path / "camera.json")


def test_missing_file_and_folder(tmp_path: Path) -> None:
    assert "missing" in refuse(tmp_path / "nothing.json")
    assert "folder" in refuse(tmp_path)


def test_file_of_many_megabytes_is_refused_unread(tmp_path: Path) -> None:
    path = write(tmp_path)
    with path.open("ab") as file:
        file.truncate(11_000_000)
    assert "11 MB" in refuse(path)


@pytest.mark.usefixtures("bound_by_permissions")
def test_unreadable_file(tmp_path: Path) -> None:
    path = write(tmp_path)
    path.chmod(0)
    assert "permissions" in refuse(path)


anything = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=12,
)
numbers = st.floats() | st.integers(-3000, 3000) | st.sampled_from([0, 1, 320, 800, 1e308, -1e-300])
matrices = st.lists(st.lists(numbers, min_size=3, max_size=3), min_size=3, max_size=3)
focals = st.floats(60, 40_000)
sane = st.builds(lambda fx, fy, x, y: [[fx, 0, x], [0, fy, y], [0, 0, 1]], focals, focals, numbers, numbers)


@settings(max_examples=settings.default.max_examples * 3)
@given(
    content=st.binary(max_size=60)
    | anything.map(lambda value: json.dumps(value).encode())
    | st.fixed_dictionaries(
        {
            "width": anything | st.just(640),
            "height": anything | st.just(480),
            "K": anything | matrices | sane,
        },
        optional={
            "distortion": anything
            | st.sampled_from([4, 5, 8, 12, 14]).flatmap(lambda n: st.lists(numbers, min_size=n, max_size=n))
        },
    ).map(lambda value: json.dumps(value).encode())
)
def test_garbage_gives_a_camera_or_one_line(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    path = tmp_path_factory.getbasetemp() / "garbage.json"
    path.write_bytes(content)
    try:
        calibration = read_calibration(path)
    except CameraError as error:
        assert "\n" not in str(error)  # noqa: PT017 - both outcomes are fine, so pytest.raises does not fit
    else:
        assert np.isfinite(calibration.square_matrix).all()


coefficient = st.floats(-0.05, 0.05)


@settings(max_examples=settings.default.max_examples * 3 // 5)
@given(
    st.tuples(coefficient, coefficient, st.floats(-0.01, 0.01), st.floats(-0.01, 0.01), coefficient),
    st.floats(0.8, 1.25),
)
def test_points_return_from_distortion(distortion: tuple[float, ...], stretch: float) -> None:
    matrix = np.array([[800.0, 0, 330], [0, 800 * stretch, 250], [0, 0, 1]])
    calibration = Calibration(640, 480, matrix, distortion)
    points = np.random.default_rng(3).uniform((0, 0), (639, 479), (50, 2))
    taken = distort_points(points, matrix, distortion, calibration.square_matrix)
    back = undistort_points(taken, matrix, distortion, calibration.square_matrix)
    np.testing.assert_allclose(back, points, atol=1e-6)


def test_points_without_distortion_move_only_with_the_matrix() -> None:
    new = np.array([[800.0, 0, 320], [0, 800, 240], [0, 0, 1]])
    old = np.array([[800.0, 0, 320], [0, 820, 240], [0, 0, 1]])
    np.testing.assert_allclose(undistort_points(np.array([[320.0, 240 + 82]]), old, (), new), [[320, 240 + 80]])
    assert undistort_points(np.zeros((0, 2)), old, (), new).shape == (0, 2)


def test_point_that_no_ray_reaches_is_nan() -> None:
    # With k1 = -0.6 no distorted radius exceeds 0.497, 398 px; the second point lies at 500 px.
    matrix = np.array(K)
    points = np.array([[420.0, 240], [820.0, 240]])
    straight = undistort_points(points, matrix, (-0.6, 0.0, 0.0, 0.0), matrix)
    assert np.isfinite(straight[0]).all()
    assert np.isnan(straight[1]).all()


DARK, BRIGHT, BLUR = 40, 215, 1.2  # grey levels on both sides of an edge; px


@pytest.mark.parametrize("fy", [pytest.param(400.0, marks=pytest.mark.thorough), 408.0])
def test_bent_line_becomes_straight_to_a_twentieth_of_a_pixel(fy: float) -> None:
    matrix = np.array([[400.0, 0, 159], [0, fy, 118], [0, 0, 1]])
    calibration = Calibration(320, 240, matrix, BARREL)
    slope, start, columns = 0.07, 30.0, np.arange(10, 310)
    # The photo as taken, bright where its undistorted place lies below a slanted straight line
    grid = np.stack(np.meshgrid(np.arange(320.0), np.arange(240.0)), axis=-1).reshape(-1, 2)
    straight = undistort_points(grid, matrix, BARREL, calibration.square_matrix)
    below = (straight[:, 1] - start - slope * straight[:, 0]).reshape(240, 320)
    levels = DARK + (BRIGHT - DARK) / (1 + np.exp(-np.clip(below / BLUR, -50, 50)))
    taken = np.repeat(np.round(levels).astype(np.uint8)[..., None], 3, axis=2)

    def edge(pixels: np.ndarray) -> np.ndarray:
        """Row, to a fraction of a pixel, at which each column goes from dark to bright."""
        share = (pixels[5:100, columns, 0].astype(float) - DARK) / (BRIGHT - DARK)
        return 99.5 - share.sum(axis=0)

    undistorted, _ = undistort_photo(taken, calibration)
    assert np.abs(edge(undistorted) - (start + slope * columns)).max() < 0.05
    assert np.abs(edge(taken) - (start + slope * columns)).max() > 1  # what is left of distortion would be seen


def test_opencvs_own_undistortion_agrees() -> None:
    pixels = np.random.default_rng(5).integers(0, 256, (480, 640, 3), dtype=np.uint8)
    smooth = np.asarray(cv2.GaussianBlur(pixels, (0, 0), 3), np.uint8)
    matrix = np.array(K)
    ours, _ = undistort_photo(smooth, Calibration(640, 480, matrix, BARREL))
    theirs = cv2.undistort(smooth, matrix, np.array(BARREL))
    assert np.abs(ours.astype(int) - theirs)[20:-20, 20:-20].max() <= 3


def test_photo_too_long_for_the_resampling() -> None:
    matrix = np.array([[30000.0, 0, 16500], [0, 30000, 1], [0, 0, 1]])
    with pytest.raises(CameraError, match="32766 px"):
        undistort_photo(np.zeros((2, 33000, 3), np.uint8), Calibration(33000, 2, matrix, BARREL))
