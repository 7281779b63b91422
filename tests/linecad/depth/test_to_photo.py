"""Maps laid onto photos: sizes, shapes, undistortion."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.camera.intrinsics import Calibration, distort_points, undistort_photo
from linecad.camera.photo import Photo, read_photo
from linecad.depth.depth_map import DepthMap
from linecad.depth.normals import Normals
from linecad.depth.to_photo import map_to_photo
from linecad.errors import DepthMapError

sides = st.integers(16, 90)


def photo_of(width, height, undistortion=None):
    return Photo("photo.jpg", np.zeros((height, width, 3), np.uint8), None, undistortion=undistortion)


def map_of(values, **others):
    return DepthMap("map.npz", values, values > 0, "z", **others)


@given(sides, sides, sides, sides)
def test_every_pixel_has_the_number_of_the_place_it_lies_in(width, height, own_width, own_height):
    y, x = np.mgrid[:own_height, :own_width]
    depth = map_of(1 + x + 1000.0 * y)
    try:
        found = map_to_photo(depth, photo_of(width, height))
    except DepthMapError:  # only a map on its side
        assert own_width / own_height == pytest.approx(height / width, rel=0.03)
        return
    assert found.values.shape == (height, width)
    row, column = np.divmod(found.values.astype(int) - 1, 1000)
    place_x, place_y = (np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height
    assert np.abs((column + 0.5) / own_width - place_x).max() <= 0.5 / own_width + 1e-9
    assert np.abs((row + 0.5) / own_height - place_y[:, None]).max() <= 0.5 / own_height + 1e-9


def test_the_same_size_changes_nothing(depth, every_normal):
    normals = np.random.default_rng(1).normal(size=(*depth.shape, 3))
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    depth[:4] = 0
    given = map_of(depth, intrinsics=np.diag([70.0, 70, 1]), normals=Normals(normals))
    found = map_to_photo(given, photo_of(60, 40))
    for one, other in (
        (found.values, given.values),
        (found.valid, given.valid),
        (found.intrinsics, given.intrinsics),
        (every_normal(found.normals), every_normal(given.normals)),
    ):
        np.testing.assert_array_equal(one, other)
    assert (found.name, found.kind) == ("map.npz", "z")


def test_no_depth_between_near_and_far_is_made_up(depth):
    for size in ((61, 41), (600, 400), (35, 90), (25, 20)):
        assert set(np.unique(map_to_photo(map_of(depth), photo_of(*size)).values)) <= set(np.unique(depth))


def test_the_camera_of_the_map_grows_with_it(depth):
    matrix = np.array([[50.0, 0, 29.5], [0, 50, 19.5], [0, 0, 1]])  # its center in the middle
    found = map_to_photo(map_of(depth, intrinsics=matrix), photo_of(300, 80))
    np.testing.assert_allclose(found.intrinsics, [[250, 0, 149.5], [0, 100, 39.5], [0, 0, 1]])


def test_a_map_on_its_side_is_refused_and_a_square_one_is_not(depth):
    with pytest.raises(DepthMapError, match=r"60 x 40 px, photo\.jpg 400 x 600: one of them lies on its side"):
        map_to_photo(map_of(depth), photo_of(400, 600))
    square = map_of(np.ones((50, 50)))
    assert map_to_photo(square, photo_of(400, 600)).values.shape == (600, 400)


BARREL = Calibration(300, 200, np.array([[240.0, 0, 149.5], [0, 240, 99.5], [0, 0, 1]]), (-0.3, 0.05, 0.001, -0.002))
PINCUSHION = Calibration(300, 200, np.array([[240.0, 0, 140], [0, 250, 99.5], [0, 0, 1]]), (0.3, 0.0, 0.0, 0.0))


def taken_places(calibration):
    y, x = np.mgrid[: calibration.height, : calibration.width]
    grid = np.stack([x, y], axis=-1).reshape(-1, 2).astype(float)
    places = distort_points(grid, calibration.matrix, calibration.distortion, calibration.square_matrix)
    return places.reshape(calibration.height, calibration.width, 2)


@pytest.mark.parametrize("calibration", [BARREL, PINCUSHION], ids=["barrel", "pincushion"])
@pytest.mark.parametrize("size", [(300, 200), (150, 50)])
def test_a_map_goes_where_the_undistorted_pixels_went(calibration, size, every_normal):
    y, x = np.mgrid[: size[1], : size[0]]
    vectors = np.stack([x, y, np.full(x.shape, -300.0)], axis=-1)
    vectors /= np.linalg.norm(vectors, axis=2, keepdims=True)
    depth = map_of(1 + x + 1000.0 * y, normals=Normals(vectors))
    found = map_to_photo(depth, photo_of(300, 200, calibration))
    places = taken_places(calibration)
    inside = ((places >= -0.5) & (places < [299.5, 199.5])).all(axis=2)
    np.testing.assert_array_equal(found.valid, inside)
    assert inside.any()
    assert inside.all() == (calibration is BARREL)
    row, column = np.divmod(found.values.astype(int) - 1, 1000)
    middle = (np.stack([column, row], axis=-1) + 0.5) * [300 / size[0], 200 / size[1]] - 0.5
    reach = np.array([150 / size[0], 100 / size[1]]) + 1e-3
    assert (np.abs(middle - places) <= reach)[inside].all()
    normals = every_normal(found.normals)
    np.testing.assert_allclose(normals[inside], vectors[row[inside], column[inside]])
    assert not normals[~inside].any()


def test_the_map_and_the_photo_agree_after_the_undistortion():
    """A photo whose grey is its own depth is undistorted as photos are; both then show the same."""
    y, x = np.mgrid[:200, :300]
    grey = (40 + x * 0.3 + y * 0.5).astype(np.uint8)
    straight, _ = undistort_photo(np.repeat(grey[..., None], 3, axis=2), BARREL)
    found = map_to_photo(map_of(grey.astype(float)), photo_of(300, 200, BARREL))
    off = np.abs(found.values - straight[..., 0])[found.valid]
    assert off.max() <= 2


def test_a_map_of_the_undistorted_photo_stays(depth):
    found = map_to_photo(map_of(depth), photo_of(300, 200, BARREL), is_of_undistorted=True)
    np.testing.assert_array_equal(found.values, map_to_photo(map_of(depth), photo_of(300, 200)).values)


def test_a_read_photo_tells_how_it_was_straightened(tmp_path):
    import json

    from PIL import Image

    Image.fromarray(np.zeros((80, 120, 3), np.uint8)).save(tmp_path / "photo.png")
    record = {"width": 120, "height": 80, "K": [[150, 0, 61], [0, 150, 37], [0, 0, 1]]}
    camera = tmp_path / "camera.json"
    for more, moves in (({}, False), ({"distortion": [-0.1, 0, 0, 0]}, True)):
        camera.write_text(json.dumps(record | more))
        undistortion = read_photo(tmp_path / "photo.png", camera).undistortion
        assert (undistortion is not None) == moves
    assert undistortion.distortion == (-0.1, 0, 0, 0)
