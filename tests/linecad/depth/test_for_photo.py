"""What a user says of a map reaches its reading, or is refused."""

import numpy as np
import pytest

from linecad.camera.intrinsics import Calibration
from linecad.camera.photo import Photo
from linecad.depth.for_photo import check_depth_options, open_depth_map
from linecad.depth.read import check_depth_file, files_of_map
from linecad.errors import DepthMapError, OptionError
from linecad.options import DEPTH_KINDS, Options, read_options
from solver.options import SolveOptions


@pytest.fixture
def photo():
    return Photo("photo.jpg", np.zeros((80, 120, 3), np.uint8), None)


@pytest.fixture
def saved(tmp_path):
    """A function that writes arrays into an .npz."""

    def save(**arrays):
        np.savez(tmp_path / "map.npz", **arrays)
        return tmp_path / "map.npz"

    return save


@pytest.mark.parametrize("kind", DEPTH_KINDS)
def test_a_chosen_kind_outweighs_the_file(saved, photo, depth, kind):
    path = saved(depth=depth, intrinsics=np.array([[50.0, 0, 30], [0, 50, 20], [0, 0, 1]]))
    assert open_depth_map(path, photo, Options()).kind == "z"
    found = open_depth_map(path, photo, read_options([f"depth-kind={kind}"]))
    assert found.kind == kind
    assert found.values.shape == (80, 120)
    assert found.intrinsics[0, 0] == 100


def test_array_and_view_choose(saved, photo, depth):
    path = saved(depth=depth, other=np.stack([depth, 2 * depth]))
    chosen = open_depth_map(path, photo, read_options(["depth-array=other", "depth-view=1"]))
    np.testing.assert_array_equal(chosen.values, 2 * open_depth_map(path, photo, Options()).values)


def test_the_factor_is_that_of_the_picture(tmp_path, photo):
    from PIL import Image

    Image.fromarray(np.arange(1, 2401, dtype=np.uint16).reshape(40, 60)).save(tmp_path / "map.png")
    found = [open_depth_map(tmp_path / "map.png", photo, options) for options in
             (Options(), read_options(["depth-factor=0.001"]))]  # fmt: skip
    assert [each.values.max() for each in found] == pytest.approx([2400 / 256, 2.4])


def test_a_map_of_the_straightened_photo_is_not_moved(saved, depth):
    bent = Calibration(120, 80, np.array([[100.0, 0, 59.5], [0, 100, 39.5], [0, 0, 1]]), (0.5, 0.0, 0.0, 0.0))
    photo = Photo("photo.jpg", np.zeros((80, 120, 3), np.uint8), None, undistortion=bent)
    path = saved(depth=depth)
    assert not open_depth_map(path, photo, Options()).valid.all()
    assert open_depth_map(path, photo, read_options(["depth-undistorted=on"])).valid.all()


@pytest.mark.parametrize(
    "options", [Options(solve=SolveOptions(fast=True)), Options(over_bodies=False), Options(joins="stable")]
)
def test_a_program_that_looks_at_no_map_is_given_none(options):
    check_depth_options(options, is_given=False)
    with pytest.raises(OptionError, match="only formulation=bodies looks at a depth map"):
        check_depth_options(options, is_given=True)


@pytest.mark.parametrize(
    "text", ["depth-kind=z", "depth-array=depth", "depth-view=0", "depth-factor=0.1", "depth-undistorted=on"]
)
def test_options_of_a_map_need_one(text):
    options = read_options([text])
    assert options.uses_bodies
    check_depth_options(options, is_given=True)
    with pytest.raises(OptionError, match=f"option {text.partition('=')[0]} tells of a depth map, and none is given"):
        check_depth_options(options, is_given=False)


def test_a_file_is_checked_by_its_start(tmp_path, saved, depth):
    path = saved(depth=depth)
    check_depth_file(path)
    path.write_bytes(path.read_bytes()[:100])  # the reading finds out
    check_depth_file(path)
    path.write_bytes(b"")
    with pytest.raises(DepthMapError, match="is empty"):
        check_depth_file(path)
    with pytest.raises(DepthMapError, match="is a folder"):
        check_depth_file(tmp_path)


def test_files_that_are_read_with_a_map(tmp_path):
    for name in ("depth.exr", "fov.json", "house.exr", "mask.png"):
        (tmp_path / name).write_bytes(b"1")
    assert files_of_map(tmp_path / "depth.exr") == [tmp_path / "depth.exr", tmp_path / "fov.json"]
    (tmp_path / "normal.png").write_bytes(b"1")
    assert len(files_of_map(tmp_path / "depth.exr")) == 3
    assert files_of_map(tmp_path / "house.exr") == [tmp_path / "house.exr"]
