"""Image files of every kind and every defect, made here and read back."""

import os
import struct
import subprocess
import sys
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image, ImageOps, TiffImagePlugin

from linecad.camera.decoding import PIXEL_LIMIT, decode_image
from linecad.errors import PhotoError

ROOT = Path(__file__).resolve().parents[3]
HEIGHT, WIDTH = 70, 90
ORIENTATION = 0x0112


def gradient(height: int = HEIGHT, width: int = WIDTH) -> np.ndarray:
    """A smooth colour picture in which no two corners look alike."""
    y, x = np.mgrid[0:height, 0:width]
    return np.stack([x * 255 // width, y * 255 // height, 255 - x * 255 // width], axis=-1).astype(np.uint8)


def refuse(path: Path) -> str:
    with pytest.raises(PhotoError) as caught:
        decode_image(path)
    message = str(caught.value)
    assert "\n" not in message
    assert path.name in message
    return message


@pytest.mark.parametrize("suffix", ["png", "bmp", "tif", "ppm", "tga"])
def test_lossless_kinds_keep_every_pixel(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"photo.{suffix}"
    Image.fromarray(gradient()).save(path)
    np.testing.assert_array_equal(decode_image(path).pixels, gradient())


@pytest.mark.parametrize("suffix", ["jpg", "webp", "jp2", "avif"])
def test_lossy_kinds_stay_close(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"photo.{suffix}"
    Image.fromarray(gradient()).save(path, quality=95)
    assert np.abs(decode_image(path).pixels.astype(int) - gradient()).mean() < 3


def test_gif_gives_its_first_frame_and_says_so(tmp_path: Path) -> None:
    first, second = (Image.fromarray(np.full((HEIGHT, WIDTH), level, np.uint8)) for level in (40, 200))
    first.save(tmp_path / "film.gif", save_all=True, append_images=[second])
    decoded = decode_image(tmp_path / "film.gif")
    assert (decoded.pixels == 40).all()
    assert any("several pictures" in note for note in decoded.notes)


@pytest.mark.parametrize("mode", ["1", "L", "P", "LA", "CMYK", "YCbCr"])
def test_other_colour_models_become_rgb(tmp_path: Path, mode: str) -> None:
    path = tmp_path / f"photo.{'jpg' if mode in ('CMYK', 'YCbCr') else 'png'}"
    picture = Image.fromarray(np.full((HEIGHT, WIDTH, 3), 255, np.uint8)).convert(mode)
    picture.save(path)
    pixels = decode_image(path).pixels
    assert pixels.shape == (HEIGHT, WIDTH, 3)
    assert pixels.min() >= 253


def test_cmyk_jpeg_keeps_its_colours(tmp_path: Path) -> None:
    red = Image.new("RGB", (WIDTH, HEIGHT), (220, 30, 40))
    red.convert("CMYK").save(tmp_path / "print.jpg", quality=95)
    np.testing.assert_allclose(decode_image(tmp_path / "print.jpg").pixels[5, 5], (220, 30, 40), atol=8)


def test_transparency_is_laid_on_white_and_noted(tmp_path: Path) -> None:
    rgba = np.dstack([np.zeros((HEIGHT, WIDTH, 3), np.uint8), np.full((HEIGHT, WIDTH), 255, np.uint8)])
    rgba[:, :40, 3] = 0
    rgba[:, 40:50, 3] = 128
    Image.fromarray(rgba).save(tmp_path / "cut.png")
    decoded = decode_image(tmp_path / "cut.png")
    assert decoded.pixels[0, [0, 45, 80], 0].tolist() == [255, 127, 0]
    assert any("transparent" in note for note in decoded.notes)


def test_opaque_alpha_needs_no_note(tmp_path: Path) -> None:
    rgba = np.dstack([gradient(), np.full((HEIGHT, WIDTH), 255, np.uint8)])
    Image.fromarray(rgba).save(tmp_path / "full.png")
    decoded = decode_image(tmp_path / "full.png")
    np.testing.assert_array_equal(decoded.pixels, gradient())
    assert decoded.notes == ()


def test_transparent_palette_entry_is_white(tmp_path: Path) -> None:
    picture = Image.fromarray(np.zeros((HEIGHT, WIDTH), np.uint8)).convert("P")
    picture.save(tmp_path / "hole.gif", transparency=0)
    assert (decode_image(tmp_path / "hole.gif").pixels == 255).all()


@pytest.mark.parametrize("suffix", ["png", "tif"])
@pytest.mark.parametrize("channels", [1, 3])
def test_16_bit_is_scaled_by_its_full_range(tmp_path: Path, suffix: str, channels: int) -> None:
    shape = (HEIGHT, WIDTH) if channels == 1 else (HEIGHT, WIDTH, 3)
    values = np.linspace(0, 65535, int(np.prod(shape))).astype(np.uint16).reshape(shape)
    cv2.imwrite(str(tmp_path / f"deep.{suffix}"), values)
    pixels = decode_image(tmp_path / f"deep.{suffix}").pixels
    expected = values[..., None] if channels == 1 else values[..., ::-1]
    assert np.abs(pixels - expected / 257).max() <= 1


@pytest.mark.parametrize("suffix", ["tif", "pfm"])
@pytest.mark.parametrize("channels", [1, 3])
def test_floats_from_0_to_1_fill_8_bit(tmp_path: Path, suffix: str, channels: int) -> None:
    shape = (HEIGHT, WIDTH) if channels == 1 else (HEIGHT, WIDTH, 3)
    values = np.linspace(0, 1, int(np.prod(shape)), dtype=np.float32).reshape(shape)
    cv2.imwrite(str(tmp_path / f"float.{suffix}"), values)
    pixels = decode_image(tmp_path / f"float.{suffix}").pixels
    expected = values[..., None] if channels == 1 else values[..., ::-1]
    assert np.abs(pixels - expected * 255).max() <= 0.51


def test_radiance_hdr_is_read_and_its_scaling_noted(tmp_path: Path) -> None:
    values = np.linspace(0, 9, HEIGHT * WIDTH * 3, dtype=np.float32).reshape(HEIGHT, WIDTH, 3)
    cv2.imwrite(str(tmp_path / "lamp.hdr"), values)
    decoded = decode_image(tmp_path / "lamp.hdr")
    assert decoded.pixels.max() == 255
    assert any("scaled to 8 bit" in note for note in decoded.notes)


def test_floats_that_are_not_numbers_are_refused(tmp_path: Path) -> None:
    values = np.full((HEIGHT, WIDTH), np.nan, np.float32)
    Image.fromarray(values).save(tmp_path / "nan.tif")
    with pytest.raises(PhotoError, match="not numbers"):
        decode_image(tmp_path / "nan.tif")


@pytest.mark.parametrize("suffix", ["jpg", "png", "tif", "webp"])
@pytest.mark.parametrize("orientation", range(1, 9))
def test_exif_orientation_is_applied(tmp_path: Path, suffix: str, orientation: int) -> None:
    path = tmp_path / f"turned.{suffix}"
    exif = Image.Exif()
    exif[ORIENTATION] = orientation
    stored = Image.fromarray(gradient())
    if suffix == "tif":
        stored.save(path, tiffinfo={ORIENTATION: orientation})
    else:
        stored.save(path, exif=exif, **({"lossless": True} if suffix == "webp" else {"quality": 95}))
    stored.getexif()[ORIENTATION] = orientation
    expected = np.asarray(ImageOps.exif_transpose(stored)).astype(int)
    decoded = decode_image(path)
    assert decoded.turned is (orientation >= 5)
    assert decoded.pixels.shape == expected.shape
    assert np.abs(decoded.pixels - expected).mean() < 3


@pytest.mark.parametrize("orientation", [0, 9, 65535])
def test_senseless_orientation_is_left_alone(tmp_path: Path, orientation: int) -> None:
    exif = Image.Exif()
    exif[ORIENTATION] = orientation
    Image.fromarray(gradient()).save(tmp_path / "odd.png", exif=exif)
    np.testing.assert_array_equal(decode_image(tmp_path / "odd.png").pixels, gradient())


def test_damaged_exif_does_not_matter(tmp_path: Path) -> None:
    Image.fromarray(gradient()).save(tmp_path / "odd.png", exif=b"Exif\0\0MM\0*\0\0\0\x08\xff\xff garbage")
    np.testing.assert_array_equal(decode_image(tmp_path / "odd.png").pixels, gradient())


def test_non_ascii_path(tmp_path: Path) -> None:
    folder = tmp_path / "größe 写真"
    folder.mkdir()
    Image.fromarray(gradient()).save(folder / "façade №1.png")
    np.testing.assert_array_equal(decode_image(folder / "façade №1.png").pixels, gradient())


@pytest.mark.parametrize("suffix", ["jpg", "png", "tif", "webp", "bmp", "gif"])
@pytest.mark.parametrize("share", [0.3, 0.6, 0.95])
def test_truncated_file_is_refused(tmp_path: Path, suffix: str, share: float) -> None:
    whole = tmp_path / f"whole.{suffix}"
    noise = np.random.default_rng(1).integers(0, 256, (HEIGHT, WIDTH, 3), dtype=np.uint8)
    Image.fromarray(noise).save(whole)
    data = whole.read_bytes()
    cut = tmp_path / f"cut.{suffix}"
    cut.write_bytes(data[: int(len(data) * share)])
    assert "copy it again" in refuse(cut) or "start is damaged" in refuse(cut)


def test_truncated_float_tiff_is_refused(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "whole.tif"), np.random.default_rng(1).random((HEIGHT, WIDTH, 3), np.float32))
    data = (tmp_path / "whole.tif").read_bytes()
    (tmp_path / "cut.tif").write_bytes(data[: len(data) // 2])
    refuse(tmp_path / "cut.tif")


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "empty"),
        (b"Dear all,\nthe photo follows tomorrow.\n" * 9, "not an image"),
        (b"\0\0\0\x18ftypheic\0\0\0\0mif1heic" + bytes(300), "HEIC"),
        (b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 200 200\n%%EndComments\n", "drawing"),
        (b"II*\0\x08\0\0\0\xff\xff", "not an image"),
        (b"#?RADIANCE\n\n-Y 80 +X 90\n", "damaged"),
        (b"PF\n90 80\n-1.0\n", "cannot be decoded|damaged"),
    ],
)
def test_what_is_no_photo_is_refused(tmp_path: Path, content: bytes, says: str) -> None:
    (tmp_path / "photo.jpg").write_bytes(content)
    with pytest.raises(PhotoError, match=says):
        decode_image(tmp_path / "photo.jpg")
    refuse(tmp_path / "photo.jpg")


def test_folder_and_missing_file_are_refused(tmp_path: Path) -> None:
    assert "folder" in refuse(tmp_path)
    assert "does not exist" in refuse(tmp_path / "nothing.jpg")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
def test_pipe_is_refused_without_waiting_for_it(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.jpg")
    assert "not a file" in refuse(tmp_path / "pipe.jpg")


@pytest.mark.usefixtures("bound_by_permissions")
def test_unreadable_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "secret.png"
    Image.fromarray(gradient()).save(path)
    path.chmod(0)
    assert "permissions" in refuse(path)


def test_failing_disk_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "photo.png"
    Image.fromarray(gradient()).save(path)

    def fail(*_: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", fail)
    assert "Permission denied" in refuse(path)


def png_header(width: int, height: int) -> bytes:
    """A PNG that promises a size and holds hardly any pixels."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"\0" * 9)) + chunk(b"IEND", b"")
    )


@pytest.mark.parametrize("size", [(20_001, 10_000), (2_000_000_000, 2), (100_000, 100_000)])
def test_more_than_200_megapixels_are_refused_before_decoding(tmp_path: Path, size: tuple[int, int]) -> None:
    (tmp_path / "bomb.png").write_bytes(png_header(*size))
    assert "megapixels" in refuse(tmp_path / "bomb.png")


def test_exactly_200_megapixels_pass_the_size_check(tmp_path: Path) -> None:
    (tmp_path / "large.png").write_bytes(png_header(20_000, 10_000))
    assert "damaged" in refuse(tmp_path / "large.png")  # its pixels are missing


def test_huge_float_tiff_is_refused_before_decoding(tmp_path: Path) -> None:
    directory = TiffImagePlugin.ImageFileDirectory_v2()
    # Three floating-point channels, which only OpenCV reads
    for tag, value in ((256, 50_000), (257, 50_000), (258, (32, 32, 32)), (262, 2), (277, 3), (339, (3, 3, 3))):
        directory[tag] = value
    with (tmp_path / "bomb.tif").open("wb") as file:
        directory.save(file)
    assert "megapixels" in refuse(tmp_path / "bomb.tif")


def test_pillows_own_limit_is_put_back(tmp_path: Path) -> None:
    before = Image.MAX_IMAGE_PIXELS
    (tmp_path / "bomb.png").write_bytes(png_header(20_001, 10_000))
    refuse(tmp_path / "bomb.png")
    assert before == Image.MAX_IMAGE_PIXELS


@pytest.mark.parametrize("size", [(63, 500), (500, 63), (1, 1)])
def test_smaller_than_64_px_is_refused(tmp_path: Path, size: tuple[int, int]) -> None:
    Image.new("RGB", size).save(tmp_path / "tiny.png")
    assert f"{size[0]} x {size[1]} px" in refuse(tmp_path / "tiny.png")


def test_64_px_are_enough(tmp_path: Path) -> None:
    Image.new("RGB", (64, 64)).save(tmp_path / "small.png")
    assert decode_image(tmp_path / "small.png").pixels.shape == (64, 64, 3)


def test_thumbnail_of_a_raw_file_is_not_taken_for_the_photo(tmp_path: Path) -> None:
    Image.fromarray(gradient()).save(tmp_path / "raw.tif", tiffinfo={254: 1})
    assert "raw file" in refuse(tmp_path / "raw.tif")


def test_a_header_that_deceives_takes_no_memory(tmp_path: Path) -> None:
    """Found by hand while fuzzing: OpenCV believes the size behind the empty line, linecad looked at another."""
    path = tmp_path / "photo.hdr"
    lying = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nX=\n-Y 64 +X 64\n\n-Y 15000 +X 15000\n" + bytes(1000)
    path.write_bytes(lying)
    program = (
        "import sys; from pathlib import Path; from linecad.camera.decoding import decode_image\n"
        "try: decode_image(Path(sys.argv[1]))\n"
        "except Exception as error: print(type(error).__name__, error)"
    )
    command = [sys.executable, "-c", program, str(path)]  # OpenCV reads its limit when it is loaded
    said = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert said.startswith("PhotoError")
    assert "cannot be decoded" in said


def test_the_limit_of_opencv_is_ours() -> None:
    assert os.environ["OPENCV_IO_MAX_IMAGE_PIXELS"] == str(PIXEL_LIMIT)


def test_a_file_far_larger_than_its_pixels_is_not_read_whole(tmp_path: Path) -> None:
    path = tmp_path / "photo.pfm"
    with path.open("wb") as file:
        file.write(b"PF\n64 64\n-1.0\n" + bytes(64 * 64 * 12))
        file.truncate(10**10)  # a hole, which takes no room on the disk
    with pytest.raises(PhotoError, match="far larger than its 64 x 64 px need"):
        decode_image(path)
