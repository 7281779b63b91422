"""Files told apart, files beside the depth, and one line for whatever is wrong."""

import builtins
import json
import subprocess
import sys

import numpy as np
import pytest
from depth_files import npy_bytes, npz_bytes

from linecad.depth import read as reading
from linecad.depth.depth_map import Reading
from linecad.depth.read import read_depth_map
from linecad.errors import DepthMapError


def test_names_do_not_matter_contents_do(depth, read):
    found = read(npz_bytes(depth=depth), "photo.jpg")
    np.testing.assert_array_equal(found.values, depth)
    assert found.name == "photo.jpg"


def test_missing_folder_empty_and_unknown(tmp_path, refuse):
    for path, words in ((tmp_path / "none.npz", "does not exist"), (tmp_path, "is a folder")):
        with pytest.raises(DepthMapError, match=words):
            read_depth_map(path)
    assert "is empty" in refuse(b"")
    for data in (b"x", b"solid", json.dumps({"depth": 1}).encode(), bytes(1000)):
        assert "not a depth map" in refuse(data)


@pytest.mark.usefixtures("bound_by_permissions")
def test_a_file_without_permission(tmp_path, depth):
    path = tmp_path / "map.npy"
    path.write_bytes(npy_bytes(depth))
    path.chmod(0)
    with pytest.raises(DepthMapError, match=r"cannot be read \(Permission denied\)"):
        read_depth_map(path)


def test_a_file_of_gigabytes_is_not_opened(tmp_path):
    path = tmp_path / "map.npy"
    with path.open("wb") as file:
        file.truncate(10**10)  # a hole, which takes no room on the disk
    with pytest.raises(DepthMapError, match=r"10\.0 GB"):
        read_depth_map(path)


@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
def test_no_depth_at_all(refuse, value):
    assert "holds no depth" in refuse(npy_bytes(np.full((40, 60), value)))


@pytest.mark.parametrize(
    ("start", "library"), [(b"\x76\x2f\x31\x01", "OpenEXR"), (b"\0\0\0\x18ftypheic", "pillow_heif")]
)
def test_a_missing_library_is_named_in_one_line(refuse, monkeypatch, start, library):
    real = builtins.__import__

    def without(name, *others):
        if name == library:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        return real(name, *others)

    monkeypatch.setattr(builtins, "__import__", without)
    for module in ("linecad.depth.exr", "linecad.depth.heic"):
        monkeypatch.delitem(sys.modules, module, raising=False)
    message = refuse(start + bytes(100))
    assert library in message
    assert "pip install 'linecad[depth]'" in message


def test_only_their_own_files_load_the_libraries_of_the_extra():
    modules = "linecad.depth.read, linecad.depth.to_photo"
    code = f"import sys, {modules}; assert not {{'OpenEXR', 'pillow_heif'}} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_no_memory_is_one_line(refuse, monkeypatch, depth):
    def full(*_):
        raise MemoryError

    monkeypatch.setattr(reading, "valid_depths", full)
    assert "does not fit into memory" in refuse(npy_bytes(depth))


def test_moges_fields_of_view_beside_the_depth(depth, read, tmp_path):
    (tmp_path / "fov.json").write_text('{"fov_x": 90.0, "fov_y": 73.74}')
    found = read(npy_bytes(depth), "depth.npy")
    np.testing.assert_allclose(found.intrinsics[[0, 1], [0, 1]], [30, 26.667], rtol=1e-4)
    matrix = np.array([[40.0, 0, 30], [0, 40, 20], [0, 0, 1]])
    np.testing.assert_array_equal(read(npz_bytes(depth=depth, K=matrix), "depth.npz").intrinsics, matrix)
    assert read(npy_bytes(depth), "map.npy").intrinsics is None


@pytest.mark.parametrize("text", ["", "{}", "[1]", '{"fov_x": 0, "fov_y": 60}', '{"fov_x": 180, "fov_y": 60}', "\xff"])
def test_fields_of_view_that_are_none(depth, read, tmp_path, text):
    (tmp_path / "fov.json").write_bytes(text.encode("latin-1"))
    with pytest.raises(DepthMapError, match=r"fov\.json"):
        read(npy_bytes(depth), "depth.npy")


def test_what_the_file_does_not_tell_has_a_default(depth, read):
    assert read(npy_bytes(depth), reading=Reading()).kind is None


FOUND = {  # of the real files that are no part of the project: array, kind, size, smallest and largest depth
    "moge2_house_indoor": (None, "z", (280, 187), 0.8812, 4.4680),
    "unidepth2_city": (None, None, (720, 1280), 15.6024, 96.640),
    "midas_small_room": (None, "affine-inverse", (384, 384), 41.0032, 1021.918),
    "dpt_beit_site": (None, "affine-inverse", (999, 667), 0.0, 8425.403),
    "eth3d_relief_da_metric": ("depth1", None, (720, 480), 0.7430, 11.8012),
    "depthlab_kitchen": ("depth_depthlab", None, (512, 336), 1.5820, 4.5333),
}


@pytest.mark.parametrize("folder", FOUND)
def test_real_files(photographs, folder, every_normal):
    path = photographs / "depthpairs" / folder / "depth.npz"
    if not path.is_file():
        pytest.skip("these photographs have no depth beside them")
    array, kind, size, low, high = FOUND[folder]
    found = read_depth_map(path, Reading(array=array))
    assert found.kind == kind
    assert (found.width, found.height) == size
    assert found.values[found.valid].min() == pytest.approx(low, abs=1e-4)
    assert found.values.max() == pytest.approx(high, rel=1e-4)
    assert found.valid.mean() > 0.99
    if folder == "moge2_house_indoor":
        np.testing.assert_allclose(found.intrinsics[[0, 1, 0, 1], [0, 1, 2, 2]], [139.1, 139.1, 140, 93.5], rtol=1e-3)
        np.testing.assert_allclose(np.linalg.norm(every_normal(found.normals), axis=2), 1, rtol=1e-5)
    if array is not None:
        with pytest.raises(DepthMapError, match="say which array"):
            read_depth_map(path)
