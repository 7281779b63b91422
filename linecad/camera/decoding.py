"""An image file decoded into upright 8-bit RGB pixels, with what its EXIF data says.

Pillow reads the file; OpenCV reads the few kinds that Pillow does not know (TIFF with several floating-point
channels, Radiance HDR, colour PFM). Sizes are checked in the header, before anything is decoded.
"""

import re
import struct
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import ExifTags, Image, TiffImagePlugin, UnidentifiedImageError

from linecad.camera.colour_profile import in_srgb
from linecad.errors import PhotoError

Pixels = NDArray[np.uint8]

PIXEL_LIMIT = 200_000_000  # pixels
SMALLEST_SIDE = 64  # px
MOST_BYTES_A_PIXEL = 32  # four channels of doubles
MOST_BYTES_BESIDE = 2**24  # of a file, for what is not pixels
SERIES = ("GIF", "PNG", "TIFF", "WEBP")  # an MPO, by contrast, holds a photo and small companions of it
DRAWINGS = ("EPS", "WMF")  # Pillow would start another program to draw these
FULL_RANGE_16_BIT = 65535
FLOAT_WHITE_PERCENTILE = 99.9  # of floating-point pixels; a few lamps or sparks must not darken all the rest
GOOD_FORMATS = "JPEG, PNG, TIFF, WebP, BMP or GIF"
HEIC_BRANDS = (b"heic", b"heix", b"hevc", b"heim", b"heis", b"mif1", b"msf1")


@dataclass(frozen=True, eq=False)
class Decoded:
    """The content of an image file."""

    pixels: Pixels  # (H, W, 3) RGB, upright
    turned: bool  # the EXIF orientation swapped width and height
    exif: dict[int, Any]  # EXIF tags by number; empty when there are none or they are damaged
    notes: tuple[str, ...]  # what was decided while decoding


def decode_image(path: Path) -> Decoded:
    """Decode an image file; raises PhotoError when that is not possible or its size is out of bounds."""
    try:
        if not path.exists():
            raise PhotoError(f"{path} does not exist; check the name of the photo")
        if not path.is_file():
            raise PhotoError(f"{path} is {'a folder' if path.is_dir() else 'not a file'}; give one photo")
        with path.open("rb") as file, quiet_pillow():
            return _decode(file, path)
    except MemoryError as error:
        raise PhotoError(f"{path} does not fit into memory; scale it down first") from error
    except OSError as error:
        raise PhotoError(f"{path} cannot be read ({error.strerror or error}); check its permissions") from error


def _decode(file: BinaryIO, path: Path) -> Decoded:
    start = file.read(16)
    if not start:
        raise PhotoError(f"{path} is empty; copy the photo again")
    file.seek(0)
    try:
        image = Image.open(file)
    except Image.DecompressionBombError as error:
        raise _too_large(path) from error
    except UnidentifiedImageError as error:
        file.seek(0)
        size = _opencv_size(file, start)
        if size is None:
            raise PhotoError(_unknown_kind(path, start)) from error
        _check_size(*size, path)
        file.seek(0)
        most = size[0] * size[1] * MOST_BYTES_A_PIXEL + MOST_BYTES_BESIDE
        data = file.read(most + 1)
        if len(data) > most:
            raise PhotoError(
                f"{path} is far larger than its {size[0]} x {size[1]} px need; save it as JPEG or PNG"
            ) from error
        return _decode_with_opencv(data, path)
    except Exception as error:  # Pillow's plugins raise whatever their parsing trips over
        raise _damaged(path, error) from error

    _check_size(*image.size, path)
    if image.format in DRAWINGS or _is_raw_preview(image):
        kind = "a drawing" if image.format in DRAWINGS else "a raw file"
        raise PhotoError(f"{path} is {kind}, not a photo; convert it to JPEG or PNG first")
    is_tiff = image.format == "TIFF"
    # Loading a TIFF turns it upright and drops the tag; a PNG may keep its EXIF data behind the pixels.
    exif = _read_exif(image) if is_tiff else {}
    try:
        image.load()
        in_known_colours, colour_notes = in_srgb(image)
        pixels, notes = _to_rgb(in_known_colours)
        notes += colour_notes
        if image.format in SERIES and getattr(image, "is_animated", False):
            notes.append("the file holds several pictures, the first is used")
    except Image.DecompressionBombError as error:
        raise _too_large(path) from error
    except (MemoryError, PhotoError):
        raise
    except Exception as error:  # Pillow's decoders raise whatever their parsing trips over
        raise _damaged(path, error) from error
    if not is_tiff:
        exif = _read_exif(image)
    orientation = exif.get(ExifTags.Base.Orientation)
    if not is_tiff:
        pixels = _turn_upright(pixels, orientation)
    return Decoded(np.ascontiguousarray(pixels), orientation in (5, 6, 7, 8), exif, tuple(notes))


@contextmanager
def quiet_pillow() -> Iterator[None]:
    """Pillow with our limit on pixels instead of its own, and without warnings about odd metadata."""
    before = Image.MAX_IMAGE_PIXELS
    Image.MAX_IMAGE_PIXELS = PIXEL_LIMIT // 2  # Pillow warns above its limit and raises above twice as many
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        Image.MAX_IMAGE_PIXELS = before


def _check_size(width: int, height: int, path: Path) -> None:
    if width * height > PIXEL_LIMIT:
        raise _too_large(path)
    if min(width, height) < SMALLEST_SIDE:
        raise PhotoError(
            f"{path} has {width} x {height} px, too small to find lines in; "
            f"give a photo of at least {SMALLEST_SIDE} px on each side"
        )


def _too_large(path: Path) -> PhotoError:
    return PhotoError(f"{path} has more than {PIXEL_LIMIT // 1_000_000} megapixels; scale it down first")


def _damaged(path: Path, error: Exception) -> PhotoError:
    reason = " ".join(str(error).split()) or type(error).__name__
    return PhotoError(f"{path} is damaged or incomplete ({reason}); copy it again or save it as JPEG or PNG")


def _unknown_kind(path: Path, start: bytes) -> str:
    if start[4:8] == b"ftyp" and start[8:12] in HEIC_BRANDS:
        return f"{path} is a HEIC photo, which this installation cannot read; convert it to JPEG"
    return f"{path} is not an image that linecad can read, or its start is damaged; give {GOOD_FORMATS}"


def _is_raw_preview(image: Image.Image) -> bool:
    """Whether the first picture is the thumbnail of a raw file (DNG, NEF and others are TIFF on the outside)."""
    tags = getattr(image, "tag_v2", {})
    new_subfile_type, dng_version = 254, 50706
    kind = tags.get(new_subfile_type, 0)
    return dng_version in tags or (isinstance(kind, int) and kind & 1 == 1)


def _read_exif(image: Image.Image) -> dict[int, Any]:
    """The EXIF tags of the picture, of its camera part and of the part that tells the size of a larger original."""
    try:
        exif = image.getexif()
        # The camera part first: only after it Pillow knows where the last part stands.
        camera = exif.get_ifd(ExifTags.IFD.Exif)
        return {**exif.get_ifd(ExifTags.IFD.Interop), **exif, **camera}
    except Exception:  # damaged metadata fails in many ways and is no reason to refuse the picture
        return {}


def _to_rgb(image: Image.Image) -> tuple[Pixels, list[str]]:
    """The loaded image as (H, W, 3) 8-bit RGB, and notes."""
    if image.mode.startswith(("I", "F")):
        grey, notes = _to_8_bit(np.asarray(image))
        return np.repeat(grey[..., None], 3, axis=2), notes
    if image.has_transparency_data:
        rgba = image.convert("RGBA")
        return _on_white(np.asarray(rgba))
    return np.array(image if image.mode == "RGB" else image.convert("RGB")), []


def _to_8_bit(values: NDArray[Any]) -> tuple[Pixels, list[str]]:
    """Scale samples to 0..255: 16 bits by their full range, floats by 0..1, anything else by the range it uses."""
    if values.dtype == np.uint8:
        return values, []
    if not np.isfinite(values).all():
        raise PhotoError("the photo holds pixels that are not numbers (NaN or infinite); save it as 8 or 16 bit")
    low, high = float(values.min()), float(values.max())
    if values.dtype.kind == "f":
        if low < 0 or high > 1:
            high = float(np.percentile(values, FLOAT_WHITE_PERCENTILE))
            return _stretch(values, low, high), [f"floating-point pixels from {low:.4g} to {high:.4g} scaled to 8 bit"]
        return _stretch(values, 0.0, 1.0), []
    if low >= 0 and high <= FULL_RANGE_16_BIT and values.dtype != np.int8:
        return _stretch(values, 0.0, FULL_RANGE_16_BIT), []
    return _stretch(values, low, high), [f"pixels from {low:.0f} to {high:.0f} scaled to 8 bit"]


def _stretch(values: NDArray[Any], low: float, high: float) -> Pixels:
    scale = 255 / (high - low) if high > low else 0.0
    scaled: Pixels = np.clip((values.astype(np.float32) - low) * scale + 0.5, 0, 255).astype(np.uint8)
    return scaled


def _on_white(rgba: Pixels) -> tuple[Pixels, list[str]]:
    """Pixels (H, W, 4) laid on white paper."""
    colour, alpha = rgba[..., :3], rgba[..., 3:].astype(np.uint32)
    if alpha.min() == 255:
        return colour.copy(), []
    blended = (colour * alpha + 255 * (255 - alpha) + 127) // 255
    return blended.astype(np.uint8), ["the photo has transparent parts, shown on white"]


def _turn_upright(pixels: Pixels, orientation: Any) -> Pixels:
    """Apply the EXIF orientation 1 to 8; any other value leaves the picture as it is stored."""
    swapped = pixels.transpose(1, 0, 2)
    upright = {
        2: pixels[:, ::-1],
        3: pixels[::-1, ::-1],
        4: pixels[::-1],
        5: swapped,
        6: swapped[:, ::-1],
        7: swapped[::-1, ::-1],
        8: swapped[::-1],
    }
    return upright[orientation] if orientation in range(2, 9) else pixels


def _opencv_size(file: BinaryIO, start: bytes) -> tuple[int, int] | None:
    """Width and height in the header of a file that OpenCV reads and Pillow does not; None for any other file."""
    try:
        if start[:4] in (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"):
            header = file.read(8 if b"*" in start[:4] else 16)
            directory = TiffImagePlugin.ImageFileDirectory_v2(header)
            file.seek(directory.next)
            directory.load(file)
            return int(directory[TiffImagePlugin.IMAGEWIDTH]), int(directory[TiffImagePlugin.IMAGELENGTH])
        text = file.read(4096)
    except (KeyError, TypeError, ValueError, SyntaxError, EOFError, struct.error):
        return None
    if start.startswith((b"#?RADIANCE", b"#?RGBE")):
        match = re.search(rb"\n-Y (\d{1,9}) \+X (\d{1,9})\n", text)
        return (int(match[2]), int(match[1])) if match else None
    match = re.match(rb"PF\s(\d{1,9})\s(\d{1,9})\s", text)
    return (int(match[1]), int(match[2])) if match else None


def _decode_with_opencv(data: bytes, path: Path) -> Decoded:
    level = cv2.utils.logging.getLogLevel()
    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    try:
        values = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error as error:
        raise PhotoError(f"{path} cannot be decoded; save it as JPEG or PNG") from error
    finally:
        cv2.utils.logging.setLogLevel(level)
    if values is None:
        raise PhotoError(f"{path} is damaged, incomplete or of an unknown kind; save it as JPEG or PNG")
    samples, notes = _to_8_bit(values)
    if samples.ndim == 2:
        return Decoded(np.repeat(samples[..., None], 3, axis=2), False, {}, tuple(notes))
    if samples.shape[2] == 4:
        pixels, more = _on_white(samples[..., [2, 1, 0, 3]])
        return Decoded(pixels, False, {}, (*notes, *more))
    return Decoded(np.ascontiguousarray(samples[..., 2::-1]), False, {}, tuple(notes))
