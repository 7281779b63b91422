"""Pictures: 16 bits and floating-point numbers are depth, all others are named and refused."""

import struct
import zlib

import numpy as np
import pytest
from depth_files import picture_bytes
from PIL import Image

from linecad.depth.depth_map import Reading
from linecad.depth.pictures import PNG_FACTOR

ASKED = "ask the network for its numbers"


@pytest.mark.parametrize("factor", [None, 1 / 1000, 1 / 5000])
@pytest.mark.parametrize("kind", ["PNG", "TIFF"])
def test_16_bits_and_their_factor(depth, read, factor, kind):
    steps = np.round(depth * 1000).astype(np.uint16)
    steps[0, :5] = 0
    found = read(picture_bytes(steps, kind), reading=Reading(factor=factor))
    np.testing.assert_allclose(found.values, steps * (factor or PNG_FACTOR), rtol=1e-6)
    np.testing.assert_array_equal(found.valid, steps > 0)
    assert found.kind is None


@pytest.mark.parametrize("compression", ["raw", "tiff_lzw", "tiff_adobe_deflate"])
def test_tiff_of_floats_has_no_factor(depth, read, compression):
    found = read(picture_bytes(depth, "TIFF", compression=compression), reading=Reading(factor=7.0))
    np.testing.assert_array_equal(found.values, depth)


def colours():
    return np.random.default_rng(0).integers(0, 250, (60, 130, 3)).astype(np.uint8)


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "TIFF", "WEBP", "BMP"])
def test_coloured_pictures_are_refused(refuse, kind):
    message = refuse(picture_bytes(colours(), kind))
    assert "is a coloured picture" in message
    assert ASKED in message


@pytest.mark.parametrize("mode", ["L", "RGB", "LA", "P"])
def test_8_bit_pictures_are_refused(refuse, mode):
    grey = np.asarray(Image.fromarray(colours()[..., 0]).convert("L"))
    message = refuse(picture_bytes(np.asarray(Image.fromarray(grey).convert("RGB")) if mode == "RGB" else grey))
    assert "only 8 bits" in message
    assert ASKED in message


def test_side_by_side_pictures_are_refused(refuse):
    """As Depth Anything writes them: the photo, 50 white columns, the coloured depth."""
    pair = colours().repeat(2, axis=1)
    pair[:, 105:155] = 255
    message = refuse(picture_bytes(pair))
    assert "side by side" in message
    assert ASKED in message


def test_a_white_border_is_no_gutter(refuse):
    framed = colours()
    framed[:, :20] = framed[:, -20:] = 255
    assert "coloured" in refuse(picture_bytes(framed))


def test_a_film_is_refused(refuse, depth, tmp_path):
    first, second = Image.fromarray(depth), Image.fromarray(depth + 1)
    first.save(tmp_path / "film.tif", save_all=True, append_images=[second])
    assert "several pictures" in refuse((tmp_path / "film.tif").read_bytes())


def test_a_png_that_claims_100_gigabytes(refuse):
    header = struct.pack(">IIBBBBB", 200_000, 250_000, 16, 0, 0, 0, 0)
    chunk = struct.pack(">I", 13) + b"IHDR" + header + struct.pack(">I", zlib.crc32(b"IHDR" + header))
    assert refuse(b"\x89PNG\r\n\x1a\n" + chunk + bytes(50))


@pytest.mark.parametrize("kind", ["PNG", "TIFF"])
def test_cut_off_pictures(refuse, kind):
    data = picture_bytes(np.random.default_rng(0).integers(1, 60_000, (40, 60)).astype(np.uint16), kind)
    for share in (0.02, 0.5, 0.9):
        assert refuse(data[: int(share * len(data))])
