"""OpenEXR files as MoGe writes them."""

import numpy as np
import pytest
from depth_files import exr_bytes, points_of

OpenEXR = pytest.importorskip("OpenEXR", reason="the extra `depth` is not installed")
FOCAL, CENTER = 50.0, (29.0, 21.0)


@pytest.mark.parametrize("channel", ["Y", "Z"])
def test_one_channel_of_depth(depth, read, tmp_path, channel):
    depth[:3] = np.inf
    found = read(exr_bytes(tmp_path, **{channel: depth}))
    np.testing.assert_array_equal(found.values[3:], depth[3:])
    assert not found.valid[:3].any()
    assert found.kind is None


def test_points_in_three_channels(depth, read, tmp_path):
    points = points_of(depth, FOCAL, CENTER)
    points[:3] = np.inf
    found = read(exr_bytes(tmp_path, R=points[..., 0], G=points[..., 1], B=points[..., 2]))
    np.testing.assert_allclose(found.values[3:], depth[3:])
    assert found.kind == "z"
    np.testing.assert_allclose(found.intrinsics, [[50, 0, 29], [0, 50, 21], [0, 0, 1]], atol=1e-3)


def test_depth_in_all_three_channels(depth, read, tmp_path):
    depth[0, 0] = np.nan
    found = read(exr_bytes(tmp_path, R=depth, G=depth, B=depth))
    np.testing.assert_array_equal(found.values[1:], depth[1:])
    assert found.kind is None


def test_colours_and_other_channels_are_refused(depth, refuse, tmp_path):
    rng = np.random.default_rng(0)
    red, green, blue = rng.random((3, 40, 60))
    assert "holds colours" in refuse(exr_bytes(tmp_path, R=red, G=green, B=blue))
    assert "has channels A, N.X" in refuse(exr_bytes(tmp_path, A=depth, **{"N.X": depth}))


def with_window(data, name, right, bottom):
    """The file with other last pixels in one of its windows."""
    at = data.index(name + b"\0box2i\0") + len(name) + len(b"\0box2i\0") + 4
    new = np.array([0, 0, right, bottom], "<i4").tobytes()
    return data[:at] + new + data[at + 16 :]


def test_headers_that_lie_about_the_size(depth, refuse, tmp_path):
    data = exr_bytes(tmp_path, Y=depth)
    huge = with_window(with_window(data, b"dataWindow", 199_999, 124_999), b"displayWindow", 199_999, 124_999)
    assert "200000 x 125000 px" in refuse(huge)
    assert "only a part" in refuse(with_window(data, b"displayWindow", 99, 99))
    larger = with_window(with_window(data, b"dataWindow", 69, 49), b"displayWindow", 69, 49)
    assert "damaged or incomplete" in refuse(larger)


def test_many_channels_are_not_decoded(refuse, tmp_path, monkeypatch, depth):
    monkeypatch.setattr("linecad.depth.exr.MOST_BYTES", 40 * 60 * 4 * 3)
    channels = {f"c{number}": depth for number in range(4)}
    assert "has 4 channels, too many" in refuse(exr_bytes(tmp_path, **channels))


def test_several_parts_are_refused(depth, refuse, tmp_path):
    parts = [OpenEXR.Part({"type": OpenEXR.scanlineimage}, {"Z": depth}, name) for name in ("one", "two")]
    with OpenEXR.File(parts) as file:
        file.write(str(tmp_path / "parts.exr"))
    assert "several pictures" in refuse((tmp_path / "parts.exr").read_bytes())


@pytest.mark.parametrize("share", [0.01, 0.3, 0.9])
def test_cut_off_files(depth, refuse, tmp_path, share):
    data = exr_bytes(tmp_path, Y=depth)
    assert refuse(data[: int(share * len(data))])
