"""What became of a photo since it was taken: resized, cropped, or nobody can tell.

*Taken* is the photo as the camera stored it. The middle of a whole photo is where the optical axis meets it; that of a
cropped one may be anywhere.
"""

import math
from dataclasses import dataclass
from typing import Literal

from linecad.camera.exif import Tags

Crop = Literal["whole", "cropped", "unknown"]

# Longer over shorter side of what cameras and phones take: squares, 4:3, 3:2, 16:9, and screens of phones up to 21:9.
USUAL_ASPECTS = (1.0, 4 / 3, 3 / 2, 16 / 9, 18 / 9, 18.5 / 9, 19 / 9, 19.5 / 9, 20 / 9, 21 / 9)
USUAL_TOLERANCE = 0.0075  # relative; sensors of "3:2" have 3872 x 2592 px, films of "16:9" 1920 x 1088
ASPECT_TOLERANCE = 0.01  # relative; a photo whose aspect changed by less was scaled, not cut
SCALE_TOLERANCE = 0.002  # relative; below it a photo counts as not resized
# A crop keeps one side whole more often than not, and seldom less than this share of the side that it keeps most of.
KEPT_AT_LEAST = 0.7
CROPPED_BY_UNKNOWN = 0.15  # relative standard error of the whole's size where a crop left nothing to compare with
PERHAPS_CROPPED = 0.05  # the same where there may have been no crop at all

# Programs that cut photos and write the size of what they leave. Cameras and phones name their firmware instead.
EDITORS = (
    "ACDSee", "Affinity", "Aperture", "Capture NX", "Capture One", "Corel", "darktable", "digiKam", "DxO",
    "FastStone", "GIMP", "ImageMagick", "Instagram", "iPhoto", "IrfanView", "Lightroom", "Luminar", "NX Studio",
    "Paint", "Photo Editor", "Photos", "PhotoScape", "Photoshop", "Picasa", "PicsArt", "Pixelmator", "Polarr",
    "RawTherapee", "Skylum", "Snapseed", "ViewNX", "VSCO", "Windows Photo", "XnView",
)  # fmt: skip


@dataclass(frozen=True)
class CropHistory:
    """A photo as it was taken, and how it became what it is."""

    crop: Crop
    long: float  # px, longer side as taken
    short: float  # px
    scale: float  # px of this photo for one px as taken
    error: float  # relative standard error of `scale`, or of the size as taken
    is_as_taken: bool  # whether `long` and `short` are sure to be what the camera stored
    remark: str  # a clause on what was done; "" for a photo left alone


def usual_aspect(width: float, height: float) -> bool:
    """Whether cameras or phones take photos of these proportions, upright or not; sides in px."""
    aspect = max(width, height) / min(width, height)
    tolerance = USUAL_TOLERANCE + 1 / min(width, height)  # half a pixel more or less on both sides
    return any(abs(aspect / usual - 1) <= tolerance for usual in USUAL_ASPECTS)


def find_crop_history(tags: Tags, width: int, height: int, turned: bool = False) -> CropHistory:
    """What the sizes and programs in EXIF say of a photo that now has `width` x `height` px.

    `turned` says that the EXIF orientation swapped width and height.
    """
    long, short = max(width, height), min(width, height)
    usual = usual_aspect(long, short)
    if not tags.sizes:
        error = PERHAPS_CROPPED if usual else CROPPED_BY_UNKNOWN
        remark = "" if usual else f"no camera takes photos of {width} x {height} px, so this one may be cropped"
        return CropHistory("unknown", long, short, 1.0, error, False, remark)

    # A program that rewrites one of these pairs may leave another; what was taken is never smaller.
    taken = max(tags.sizes, key=lambda size: size[0] * size[1])
    size = f"{taken[0]:.0f} x {taken[1]:.0f} px"
    taken_long, taken_short = max(taken), min(taken)
    upright = taken[::-1] if turned else taken
    of_width, of_height = _scales(width, height, upright)
    if not _is_uniform(of_width, of_height, short):
        # Programs turn photos without turning these numbers.
        of_width, of_height = _scales(height, width, upright)
    if not _is_uniform(of_width, of_height, short):
        if max(width / upright[0], height / upright[1]) <= 1 + SCALE_TOLERANCE:
            of_width, of_height = _scales(width, height, upright)
        least = max(of_width, of_height)  # as if one side was kept whole
        reach = min(max(1 / least, 1.0), 1 / KEPT_AT_LEAST)
        scale, error = least * math.sqrt(reach), math.log(reach) / 2
        return CropHistory(
            "cropped", taken_long, taken_short, scale, error, True, f"the photo seems cropped (taken with {size})"
        )
    scale = math.sqrt(of_width * of_height)
    resized = abs(scale - 1) > SCALE_TOLERANCE
    remark = f"the photo was taken with {size} and resized" if resized else ""
    if not usual_aspect(taken_long, taken_short):
        remark = f"no camera takes photos of {size}, so this one seems cropped"
        return CropHistory("cropped", taken_long, taken_short, scale, CROPPED_BY_UNKNOWN, False, remark)
    editor = _editor(tags.programs)
    if editor:
        remark = "; ".join(filter(None, [remark, f"{editor} wrote the photo and may have cropped it"]))
        return CropHistory("unknown", taken_long, taken_short, scale, PERHAPS_CROPPED, False, remark)
    return CropHistory("whole", taken_long, taken_short, scale, 0.0, True, remark)


def _scales(width: int, height: int, taken: tuple[float, float]) -> tuple[float, float]:
    return width / taken[0], height / taken[1]


def _is_uniform(of_width: float, of_height: float, short: int) -> bool:
    """Whether scales along both sides differ by no more than rounding `short` px to whole ones explains."""
    return abs(of_width / of_height - 1) <= ASPECT_TOLERANCE + 1 / short


def _editor(programs: str) -> str:
    """The first editor that the text names, or ""."""
    return next((editor for editor in EDITORS if editor.lower() in programs.lower()), "")
