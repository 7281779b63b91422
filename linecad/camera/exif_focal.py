"""The focal length from EXIF, in px of the photo, and how far to trust it.

There are up to three ways to it, and each starts from what the maker engraved on the lens, so that this one error is
common to all: the 35 mm equivalent, the focal length with the sensor's resolution, the focal length with the sensor's
size from a database. What they add to it is independent; ways that agree are averaged, one that contradicts is told.
"""

import math
from dataclasses import dataclass

from linecad.camera.crop_history import ASPECT_TOLERANCE, CropHistory, usual_aspect
from linecad.camera.exif import Tags
from linecad.camera.intrinsics import FOCAL_RANGE
from linecad.geometry import DIAGONAL_35MM

# Relative standard errors. What is engraved is nominal and for infinity: the real focal lengths that the lensfun
# database knows of five lenses lie 0.2 to 4.9 % beside it (root mean square over their zoom settings), the camera of
# York Urban 4.1 %; the root mean square of these six is 3.0 %.
LENS = 0.03
ROUNDING = math.sqrt(1 / 12)  # mm, of the 35 mm equivalent, a whole number
EQUIVALENT = 0.02  # by the diagonal, says CIPA DCG-001; makers who compare widths tell 4 % more of a sensor of 4:3
RESOLUTION = 0.03  # Canon's EOS 5D Mark II tells a sensor 3.5 % too wide and 1.8 % too high
DATABASE = 0.01  # crop factors of one sensor in different models
OTHER_ASPECT = 0.03  # more with a database where photo and sensor have other proportions: some use more of the lens
UNCONFIRMED = 0.05  # more where resolution stands alone: makers who store a smaller photo may leave it as it was
SIZE_UNKNOWN = 0.3  # the same where a program may have resized the photo and rewritten its size
CONTRADICTED = 0.1  # more where two ways contradict each other

CONTRADICTION = 3.0  # standard errors of the difference between two ways
SENSOR_DIAGONALS = (3.0, 70.0)  # mm, from cheap phones to medium format; what implies another one is wrong
# mm, diagonals of sensors that are 4:3: phones and compacts, Four Thirds, medium format; others are 3:2 (1 inch, APS-C,
# 35 mm)
FOUR_BY_THREE = ((0.0, 14.5), (18.0, 24.0), (48.0, math.inf))
RESOLUTION_NAME = "the sensor's resolution"
ZOOM_IS_COUNTED = ("Apple",)  # makers whose 35 mm equivalent grows with the digital zoom; of others nothing is known


@dataclass(frozen=True)
class ExifFocal:
    """What EXIF says of the focal length, and how far to trust it."""

    focal: float  # px, of this photo
    relative_error: float  # standard error over focal length
    origin: str  # where it stands, in words that fit after "focal length from"


@dataclass(frozen=True)
class _Way:
    """One way to the focal length."""

    focal: float  # px, of the photo as taken
    error: float  # relative standard error besides that of the lens
    origin: str  # as in ExifFocal
    name: str  # the same in short


def find_exif_focal(
    tags: Tags, history: CropHistory, width: int, height: int
) -> tuple[ExifFocal | None, tuple[str, ...]]:
    """The focal length of a photo of `width` x `height` px and notes; None where EXIF does not tell it."""
    ways, remarks = _ways(tags, history)
    least, most = (factor * max(width, height) for factor in FOCAL_RANGE)
    usable = [way for way in ways if least <= way.focal * history.scale <= most]
    if not usable:
        if ways:
            focal = ways[0].focal * history.scale
            return None, (
                f"focal length from EXIF ({focal:.4g} px) does not suit {width} x {height} px and is ignored",
            )
        return None, tuple(remarks)

    ways, aside = _that_agree(usable)
    weights = [way.error**-2 for way in ways]
    first = ways[0].focal
    mean = sum(weight * math.log(way.focal / first) for weight, way in zip(weights, ways, strict=True)) / sum(weights)
    if not history.is_as_taken:  # no wonder then that a resolution does not fit, and nothing against the others
        aside = [way for way in aside if way.name != RESOLUTION_NAME]
    alone = 0.0
    if [way.name for way in ways] == [RESOLUTION_NAME]:
        alone = UNCONFIRMED if history.is_as_taken else SIZE_UNKNOWN
    contradicted = CONTRADICTED if aside else 0.0
    error = math.hypot(LENS, sum(weights) ** -0.5, history.error, alone, contradicted)
    others = " and ".join(way.name for way in ways[1:])
    origin = ways[0].origin + (f", confirmed by {others}" if others else "")
    found = ExifFocal(first * math.exp(mean) * history.scale, error, origin)
    remarks += [f"{way.name} would give {way.focal * history.scale:.0f} px and is set aside" for way in aside]
    return found, ("; ".join([f"focal length from {origin}, standard error about {error:.0%}", *remarks]),)


def _ways(tags: Tags, history: CropHistory) -> tuple[list[_Way], list[str]]:
    """The ways that there are, the most trusted first where they contradict each other; and remarks on them.

    The 35 mm equivalent comes first, since resolution is often that of another size and a database does not know
    which of a phone's cameras took the photo.
    """
    if not tags.length:
        return ([_equivalent(tags, history, 0.0, 1.0, 0.0)], []) if tags.equivalent else ([], [])
    remarks = []
    from_sensor = []
    crop, remark = _crop_factor(tags)
    if crop:
        from_sensor.append(_with_database(tags, history, crop))
    if tags.resolution and _is_sensor(math.hypot(history.long, history.short) / tags.resolution):
        from_sensor.append(_with_resolution(tags))
    if not tags.equivalent:
        return from_sensor, [] if from_sensor or not remark else [remark]

    implied = DIAGONAL_35MM * tags.length / tags.equivalent
    if not any(_is_sensor(implied * zoom) for zoom in {1.0, tags.zoom}):
        # Programs on iPhones have written equivalents that grow as the photo gets smaller: 177 mm for 640 x 480 px.
        remarks.append(
            f"the 35 mm equivalent of {tags.equivalent:g} mm would mean a sensor of {implied:.2g} mm and is ignored"
        )
        return from_sensor, remarks
    counted, spread = 1.0, 0.0
    if tags.zoom > 1 and tags.make not in ZOOM_IS_COUNTED:
        if from_sensor:
            without = _equivalent(tags, history, implied, 1.0, 0.0).focal
            known = from_sensor[0].focal > 0 and without > 0  # lengths of next to nothing are rounded to 0 px
            beside = abs(math.log(from_sensor[0].focal / without)) if known else 0.0
            counted = min((1.0, tags.zoom), key=lambda zoom: abs(beside - math.log(zoom)))
        else:
            counted, spread = math.sqrt(tags.zoom), math.log(tags.zoom) / 2
            remarks.append(f"whether it counts the digital zoom of {tags.zoom:g} is not known")
    diagonal = DIAGONAL_35MM / crop if crop else implied
    return [_equivalent(tags, history, diagonal, counted, spread), *from_sensor], remarks


def _equivalent(tags: Tags, history: CropHistory, diagonal: float, zoom: float, spread: float) -> _Way:
    """By the 35 mm equivalent, on a sensor of a `diagonal` in mm (0: not known).

    Where a camera stored other proportions than those of its sensor, most makers tell the equivalent of the whole
    sensor and some that of the photo; the truth is taken to be either. A program that cropped left it as it was.
    """
    sensor = _sensor_in_px(history, diagonal)
    photo = math.hypot(history.long, history.short) if usual_aspect(history.long, history.short) else sensor
    focal = tags.equivalent * zoom / DIAGONAL_35MM * math.sqrt(photo) * math.sqrt(sensor)
    error = math.hypot(EQUIVALENT, ROUNDING / max(tags.equivalent, 1.0), spread, math.log(sensor / photo) / 2)
    return _Way(focal, error, f"EXIF's 35 mm equivalent ({tags.equivalent:g} mm)", "the 35 mm equivalent")


def _with_database(tags: Tags, history: CropHistory, crop: float) -> _Way:
    photo, sensor = math.hypot(history.long, history.short), _sensor_in_px(history, DIAGONAL_35MM / crop)
    error = math.hypot(DATABASE, OTHER_ASPECT if sensor > photo * (1 + ASPECT_TOLERANCE) else 0.0)
    origin = f"EXIF's {tags.length:g} mm and the sensor size of {tags.model}"
    return _Way(tags.length * tags.zoom * crop / DIAGONAL_35MM * sensor, error, origin, "the sensor's size")


def _with_resolution(tags: Tags) -> _Way:
    origin = f"EXIF's {tags.length:g} mm and the sensor's resolution"
    return _Way(tags.length * tags.zoom * tags.resolution, RESOLUTION, origin, RESOLUTION_NAME)


def _crop_factor(tags: Tags) -> tuple[float | None, str]:
    """The crop factor of the camera; and what to install to know it."""
    if not (tags.make and tags.model):
        return None, ""
    try:
        from linecad.camera.sensors import find_crop_factor
    except ImportError:
        return None, f"EXIF tells {tags.length:g} mm, but not of what sensor; pip install 'linecad[lens]' may know it"
    return find_crop_factor(tags.make, tags.model), ""


def _is_sensor(diagonal: float) -> bool:
    """Whether there are sensors of that diagonal, mm."""
    return SENSOR_DIAGONALS[0] <= diagonal <= SENSOR_DIAGONALS[1]


def _sensor_in_px(history: CropHistory, diagonal: float) -> float:
    """Diagonal, in px of the photo as taken, of the whole sensor, whose own is `diagonal` in mm (0: not known)."""
    aspect = history.long / history.short
    if diagonal:
        is_four_by_three = any(low <= diagonal < high for low, high in FOUR_BY_THREE)
        of_sensor = 4 / 3 if is_four_by_three else 3 / 2
    else:
        of_sensor = 3 / 2 if abs(aspect / (3 / 2) - 1) <= ASPECT_TOLERANCE else 4 / 3
    if abs(aspect / of_sensor - 1) <= ASPECT_TOLERANCE + 1 / history.short:
        return math.hypot(history.long, history.short)
    # One side of the sensor is kept whole.
    long, short = max(history.long, history.short * of_sensor), max(history.short, history.long / of_sensor)
    return math.hypot(long, short)


def _that_agree(ways: list[_Way]) -> tuple[list[_Way], list[_Way]]:
    """The most ways that agree, of equally many those with the most trusted; and the others."""

    def agree(one: _Way, other: _Way) -> bool:
        return abs(math.log(one.focal / other.focal)) <= CONTRADICTION * math.hypot(one.error, other.error)

    groups = [[other for other in ways if agree(one, other)] for one in ways]
    best = max(groups, key=len)
    return best, [way for way in ways if way not in best]
