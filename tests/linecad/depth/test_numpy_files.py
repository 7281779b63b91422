"""Depth in .npz and .npy files: names, shapes, and what stands beside it."""

import numpy as np
import pytest
from depth_files import npy_bytes, npz_bytes, points_of

from linecad.depth.depth_map import Reading

FOCAL, CENTER = 50.0, (29.0, 21.0)  # px
K = np.array([[FOCAL, 0, CENTER[0]], [0, FOCAL, CENTER[1]], [0, 0, 1]])


@pytest.mark.parametrize("name", ["depth", "depth_map", "predicted_depth", "disparity", "arr_0", "anything"])
def test_names_of_depth(depth, read, name):
    found = read(npz_bytes(**{name: depth}))
    np.testing.assert_array_equal(found.values, depth)
    assert found.valid.all()
    assert found.kind == ("affine-inverse" if name == "disparity" else None)
    assert found.intrinsics is None
    assert found.normals is None


def test_small_arrays_beside_an_unknown_name_do_not_confuse(depth, read):
    found = read(npz_bytes(whatever=depth, K=K, scale=np.float32(2), text=np.array("metres")))
    np.testing.assert_array_equal(found.values, depth)
    assert found.kind == "z"  # there is a camera


def test_several_unknown_names_are_listed(depth, refuse, read):
    data = npz_bytes(depth0=depth, depth1=depth * 2)
    assert "holds depth0, depth1; say which array" in refuse(data)
    np.testing.assert_array_equal(read(data, reading=Reading(array="depth1")).values, depth * 2)
    assert "but no array depth2" in refuse(data, reading=Reading(array="depth2"))


@pytest.mark.parametrize("shape", [(1, 40, 60), (40, 60, 1), (1, 1, 40, 60)])
@pytest.mark.parametrize("to_bytes", [npy_bytes, lambda array: npz_bytes(depth=array)], ids=["npy", "npz"])
def test_axes_of_length_one_go(depth, read, shape, to_bytes):
    np.testing.assert_array_equal(read(to_bytes(depth.reshape(shape))).values, depth)


@pytest.mark.parametrize("kind", [np.float16, ">f4", np.float64, np.uint16, np.int32, ">u2"])
@pytest.mark.parametrize("order", ["C", "F"])
def test_types_of_numbers_and_orders_of_axes(depth, read, kind, order):
    array = np.asarray(depth * 100, kind, order=order)
    np.testing.assert_array_equal(read(npy_bytes(array)).values, array.astype(np.float32))


def test_depth_anything_3_of_several_photos(depth, read, refuse):
    views = np.stack([depth, depth + 1, depth + 2])
    matrices = np.stack([K, K * [[2], [2], [1]], K])
    data = npz_bytes(depth=views, conf=np.ones_like(views), intrinsics=matrices, extrinsics=np.zeros((3, 3, 4)))
    found = read(data, reading=Reading(view=1))
    np.testing.assert_array_equal(found.values, views[1])
    np.testing.assert_array_equal(found.intrinsics, matrices[1])
    assert found.kind == "z"
    for view in (None, 3, -1):
        assert "the depth of 3 photos; say which one, from 0 to 2" in refuse(data, reading=Reading(view=view))
    assert "photo 2 was asked for" in refuse(npz_bytes(depth=depth), reading=Reading(view=2))


def test_moge_depth_with_points_normals_mask_and_shares_of_a_camera(depth, read, every_normal):
    points = points_of(depth, FOCAL, CENTER)
    normal = np.zeros((*depth.shape, 3), np.float32)
    normal[..., 2] = -0.999
    normal[0] = 0
    mask = np.ones(depth.shape, bool)
    mask[5:9] = False
    shares = K / np.array([[60], [40], [1]])
    found = read(npz_bytes(depth=depth, points=points, normal=normal, mask=mask, intrinsics=shares))
    assert found.kind == "z"
    np.testing.assert_array_equal(found.valid, mask)
    np.testing.assert_array_equal(found.values, np.where(mask, depth, 0))
    np.testing.assert_allclose(found.intrinsics, K)
    normals = every_normal(found.normals)
    np.testing.assert_allclose(normals[1:, :, 2], -1)
    assert not normals[0].any()


def test_a_mask_in_numbers_is_left_alone(depth, read):
    assert read(npz_bytes(depth=depth, mask=np.zeros(depth.shape, np.float32))).valid.all()


@pytest.mark.parametrize("moved", [False, True])
def test_points_give_z_and_their_camera(depth, read, moved):
    points = points_of(depth, FOCAL, CENTER)
    points[3, 4] = np.nan
    points[:2] = 0
    array = np.moveaxis(points, 2, 0)[None] if moved else points
    found = read(npz_bytes(points=array))
    assert found.kind == "z"
    np.testing.assert_allclose(found.values[found.valid], depth[found.valid])
    assert not found.valid[3, 4]
    assert not found.valid[:2].any()
    np.testing.assert_allclose(found.intrinsics, K, atol=1e-3)


def test_points_of_another_camera_still_have_a_z(depth, read):
    points = points_of(depth, FOCAL, CENTER)
    points[..., 0] = -points[..., 0]
    assert read(npz_bytes(points=points)).intrinsics is None


def test_points_in_an_npy(depth, read, refuse):
    assert read(npy_bytes(points_of(depth, FOCAL, CENTER))).kind == "z"
    colours = np.random.default_rng(0).random((40, 60, 3))
    assert "colours or other triples" in refuse(npy_bytes(colours))


@pytest.mark.parametrize("array", [np.array(800.0), np.array([800.0], np.float32)])
def test_depth_pro_focal_length(depth, read, array):
    found = read(npz_bytes(depth=depth, focallength_px=array))
    np.testing.assert_array_equal(found.intrinsics, [[800, 0, 29.5], [0, 800, 19.5], [0, 0, 1]])
    assert found.kind == "z"


@pytest.mark.parametrize("matrix", [np.full((3, 3), np.nan), -K, K.T, np.zeros((3, 3)), np.eye(2)])
def test_what_is_no_camera_is_no_intrinsics(depth, read, matrix):
    assert read(npz_bytes(depth=depth, K=matrix)).intrinsics is None


@pytest.mark.parametrize("shape", [(60,), (), (2, 3, 40, 60, 5), (0, 60), (40, 0)])
def test_shapes_of_no_map(refuse, shape):
    assert refuse(npz_bytes(depth=np.ones(shape)), reading=Reading(view=0))


def test_pictures_in_arrays_are_refused(refuse):
    assert "8 bits a pixel" in refuse(npy_bytes(np.full((40, 60), 7, np.uint8)))
    assert "coloured picture" in refuse(npz_bytes(depth=np.full((40, 60, 3), 7, np.uint8)))


def test_no_arrays_of_numbers(refuse):
    assert "nothing that is made of numbers" in refuse(npz_bytes(name=np.array("x")))
