"""The pixels of a photo are in sRGB, whatever profile it was written with."""

import io

import numpy as np
import pytest
from PIL import Image, ImageCms

from linecad.camera.colour_profile import in_srgb
from linecad.camera.decoding import decode_image


def srgb():
    return ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()


def swapped():
    """An sRGB profile whose red and green are exchanged: a photo in it has them the other way round."""
    data = bytearray(srgb())
    tags = {bytes(data[at : at + 4]): at for at in range(132, 132 + 12 * int.from_bytes(data[128:132], "big"), 12)}
    red, green = tags[b"rXYZ"], tags[b"gXYZ"]
    data[red + 4 : red + 12], data[green + 4 : green + 12] = data[green + 4 : green + 12], data[red + 4 : red + 12]
    at = int.from_bytes(data[tags[b"desc"] + 4 : tags[b"desc"] + 8], "big")
    name = data.index("sRGB".encode("utf-16-be"), at)
    data[name : name + 8] = "mine".encode("utf-16-be")
    return bytes(data)


@pytest.fixture
def picture():
    return Image.new("RGB", (64, 64), (220, 30, 60))


def loaded(picture, profile):
    file = io.BytesIO()
    picture.save(file, "PNG", icc_profile=profile)
    return Image.open(file)


def test_pixels_of_another_profile_are_converted(picture):
    found, notes = in_srgb(loaded(picture, swapped()))
    assert notes == []
    assert np.abs(np.asarray(found, int) - (30, 220, 60)).max() <= 3


@pytest.mark.parametrize("profile", [None, srgb()])
def test_pixels_in_srgb_stay_the_same(picture, profile):
    image = loaded(picture, profile)
    found, notes = in_srgb(image)
    assert found is image
    assert notes == []


def test_a_damaged_profile_is_told_and_the_photo_is_read(picture, tmp_path):
    picture.save(tmp_path / "a.png", icc_profile=b"no profile at all")
    decoded = decode_image(tmp_path / "a.png")
    assert (decoded.pixels == (220, 30, 60)).all()
    (note,) = decoded.notes
    assert note.startswith("the photo's colour profile cannot be used (")
    assert note.endswith("its colours are taken for sRGB")


def test_a_photo_is_decoded_in_srgb(picture, tmp_path):
    picture.save(tmp_path / "a.png", icc_profile=swapped())
    assert np.abs(decode_image(tmp_path / "a.png").pixels.astype(int) - (30, 220, 60)).max() <= 3


@pytest.mark.parametrize("mode", ["RGBA", "P"])
def test_transparent_pixels_and_palettes_are_converted_too(picture, mode):
    """They kept the numbers of their profile, without a word."""
    found, notes = in_srgb(loaded(picture.quantize(2) if mode == "P" else picture.convert(mode), swapped()))
    assert notes == []
    assert np.abs(np.asarray(found.convert("RGB"), int) - (30, 220, 60)).max() <= 3
    assert found.mode == ("RGBA" if mode == "RGBA" else "RGB")


def test_grey_pictures_stay_as_they_are():
    image = Image.new("L", (64, 64), 90)
    image.info["icc_profile"] = srgb()
    assert in_srgb(image) == (image, [])
