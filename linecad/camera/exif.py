"""What EXIF says of a photo and its camera, freed from values that cannot be: every number positive, every text short.

EXIF comes from anywhere: zero denominators, NaN, texts where numbers belong, numbers where texts belong. Whatever is
no such value counts as missing.
"""

import math
from dataclasses import dataclass
from typing import Any

from PIL.ExifTags import Base

MM_PER_RESOLUTION_UNIT = {2: 25.4, 3: 10.0, 4: 1.0, 5: 0.001}  # inch, cm, mm, um; 1 is "none" and tells nothing
INCH = 2  # the unit where FocalPlaneResolutionUnit is missing, says the standard
SIDE_RANGE = (16.0, 200_000.0)  # px, sides of a photo as EXIF tells them; what lies outside is damage
RATIO_RANGE = (0.9, 1.1)  # of sensor resolutions along y and x; beyond it they contradict each other
SMALLEST_ZOOM = 1.01  # of DigitalZoomRatio; 0 and 1 say that there was none
LARGEST_ZOOM = 100.0
LONGEST_TEXT = 100  # characters
TEXT_TAGS = (Base.Make, Base.Model, Base.Software, Base.ProcessingSoftware)
SIZE_TAGS = (
    (Base.ExifImageWidth, Base.ExifImageHeight),
    (Base.ImageWidth, Base.ImageLength),
    (Base.RelatedImageWidth, Base.RelatedImageLength),
)


@dataclass(frozen=True)
class Tags:
    """What EXIF says; 0 and "" where it says nothing."""

    sizes: tuple[tuple[float, float], ...]  # px, width and height as stored, wherever EXIF tells both
    length: float  # mm, focal length of the lens
    equivalent: float  # mm, focal length that gives the same view on 35 mm film
    resolution: float  # px per mm on the sensor, of the photo as taken
    zoom: float  # digital, 1 when there was none
    make: str
    model: str
    programs: str  # what wrote the file


def read_tags(exif: dict[int, Any]) -> Tags:
    """The tags that tell of size and focal length, among EXIF tags by their numbers; raises nothing."""
    texts = [_text(exif.get(tag)) for tag in TEXT_TAGS]
    zoom = _positive(exif.get(Base.DigitalZoomRatio))
    sizes = [(_positive(exif.get(width)), _positive(exif.get(height))) for width, height in SIZE_TAGS]
    return Tags(
        sizes=tuple(size for size in sizes if SIDE_RANGE[0] <= min(size) and max(size) <= SIDE_RANGE[1]),
        length=_positive(exif.get(Base.FocalLength)),
        equivalent=_positive(exif.get(Base.FocalLengthIn35mmFilm)),
        resolution=_resolution(exif),
        zoom=zoom if SMALLEST_ZOOM < zoom <= LARGEST_ZOOM else 1.0,
        make=texts[0],
        model=texts[1],
        programs=" ".join(filter(None, texts[2:])),
    )


def _resolution(exif: dict[int, Any]) -> float:
    """Resolution of the sensor, px per mm; 0 when EXIF does not say or contradicts itself.

    Some cameras of Canon tell x and y two per cent apart though their pixels are square, so the mean is taken.
    """
    unit = MM_PER_RESOLUTION_UNIT.get(int(_positive(exif.get(Base.FocalPlaneResolutionUnit, INCH))), 0.0)
    along_x = _positive(exif.get(Base.FocalPlaneXResolution))
    along_y = _positive(exif.get(Base.FocalPlaneYResolution)) or along_x
    if not (unit and along_x) or not RATIO_RANGE[0] <= along_y / along_x <= RATIO_RANGE[1]:
        return 0.0
    return _positive(math.sqrt(along_x) * math.sqrt(along_y) / unit)


def _positive(value: Any) -> float:
    """A positive finite number; 0 for anything else (EXIF itself writes 0 for "unknown")."""
    try:
        number = float(value)
    except (TypeError, ValueError, ZeroDivisionError, OverflowError):
        return 0.0
    return number if math.isfinite(number) and number > 0 else 0.0


def _text(value: Any) -> str:
    """A text without what surrounds it, short and printable; "" for anything else."""
    if isinstance(value, bytes):
        value = value.decode("latin-1")
    if not isinstance(value, str):
        return ""
    printable = "".join(character for character in value[:LONGEST_TEXT] if character.isprintable())
    return printable.strip()
