"""Patterns of walls, roads and leaves as tiles that repeat without a seam, and skies: linear RGB, ready to render."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from linecad.dataset.modelling import Material, Pattern

Image = NDArray[np.float32]

FINE, COARSE = 1024, 512  # texels along a side of a tile
DARKEST, BRIGHTEST = 0.01, 0.92  # reflectances; nothing is quite black or white
SKY_HEIGHT = 256  # texels from the zenith to the nadir


@dataclass(frozen=True)
class Courses:
    """Equal blocks in courses with joints between them; lengths in m."""

    tile: float  # side of the tile; a whole number of blocks, and of pairs of courses
    length: float
    height: float
    joint: float
    spread: float  # of the tone from block to block
    bond: float  # by which share of a block every second course is shifted
    joint_tone: float  # of the joints, relative to the blocks


COURSES: dict[Pattern, Courses] = {
    "brick": Courses(2.0, 0.25, 1 / 13, 0.011, 0.14, 0.5, 1.5),
    "panel": Courses(3.0, 1.5, 0.75, 0.018, 0.03, 0.0, 0.4),
    "ashlar": Courses(3.2, 0.8, 0.4, 0.02, 0.06, 0.5, 0.5),
    "slabs": Courses(3.0, 0.5, 0.5, 0.008, 0.05, 0.5, 0.65),
    "tiles": Courses(2.4, 0.2, 0.3, 0.018, 0.10, 0.5, 0.6),
}
# Side of the tile in m, large stains and fine grain, for patterns without courses.
CLOUDS: dict[Pattern, tuple[float, float, float]] = {
    "plain": (4.0, 0.06, 0.035),
    "asphalt": (4.0, 0.10, 0.14),
    "glass": (4.0, 0.20, 0.02),
    "paint": (2.0, 0.01, 0.01),
    "leaves": (1.0, 0.12, 0.05),
}


def texture(material: Material) -> tuple[Image, float]:
    """The tile (N, N, 3) of a material and its side, m."""
    tone, side = _tone(material.pattern)
    return np.clip(linear(material.colour) * tone, DARKEST, BRIGHTEST).astype(np.float32), side


@cache
def _tone(pattern: Pattern) -> tuple[Image, float]:
    """Reflectance (N, N, 1) of a pattern relative to its colour, and the side of the tile, m."""
    rng = np.random.default_rng([ord(letter) for letter in pattern])
    if pattern in CLOUDS:
        side, stains, grain = CLOUDS[pattern]
        count = FINE if pattern == "asphalt" else COARSE
        tone = 1 + stains * clouds(rng, count, 1.4) + grain * rng.normal(0, 1, (count, count))
        return tone.astype(np.float32)[..., None], side
    courses = COURSES[pattern]
    return _blocks(courses, rng)[..., None], courses.tile


def _blocks(courses: Courses, rng: Generator) -> Image:
    columns, rows = round(courses.tile / courses.length), round(courses.tile / courses.height)
    place = np.arange(FINE) / FINE
    row = np.floor(place * rows).astype(int)[:, None]
    along = place[None] * columns + courses.bond * (row % 2)
    column = np.floor(along).astype(int) % columns
    across = np.minimum(along % 1, 1 - along % 1) * courses.length
    upward = place * rows % 1
    up = (np.minimum(upward, 1 - upward) * courses.height)[:, None]
    rough = 0.06 * courses.joint * clouds(rng, FINE, 0.8)
    joint = np.clip((courses.joint / 2 - np.minimum(across, up) + rough) / 0.003 + 0.5, 0, 1)
    tone = rng.normal(1, courses.spread, (rows, columns))[row, column]
    tone *= 1 + 0.06 * clouds(rng, FINE, 1.0) + 0.03 * rng.normal(0, 1, (FINE, FINE))
    return np.asarray(tone * (1 - joint) + courses.joint_tone * joint, np.float32)


def clouds(rng: Generator, count: int, slope: float) -> NDArray[np.float64]:
    """Noise (count, count) of mean 0 and deviation 1 that repeats, its amplitudes falling with frequency^slope."""
    frequency = np.hypot(np.fft.fftfreq(count)[:, None], np.fft.rfftfreq(count)[None]) * count
    frequency[0, 0] = np.inf
    spectrum = np.fft.rfft2(rng.normal(0, 1, (count, count))) / frequency**slope
    noise = np.fft.irfft2(spectrum, (count, count))
    return np.asarray(noise / noise.std(), np.float64)


def linear(colour: tuple[float, float, float]) -> Image:
    """Linear RGB (3,) of an sRGB colour, both from 0 to 1."""
    value = np.array(colour)
    return np.asarray(np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4), np.float32)


def sky(rng: Generator) -> Image:
    """Radiance (H, 2 H, 3) of a sky by direction: zenith in the first row, nadir in the last; clouds at will."""
    count = 2 * SKY_HEIGHT
    height = np.sin((0.5 - (np.arange(SKY_HEIGHT) + 0.5) / SKY_HEIGHT) * np.pi)[:, None, None]
    above = np.clip(height, 0, 1)
    blue = np.array([0.95, 1.0, 1.06]) + (np.array([0.28, 0.48, 0.95]) - [0.95, 1.0, 1.06]) * above**0.5
    amount = rng.uniform(-0.6, 0.8)
    share = np.clip(0.8 * clouds(rng, count, 1.6)[:SKY_HEIGHT, :, None] + amount, 0, 1) * np.clip(5 * above, 0, 1)
    free = blue * (1 - share) + np.array([1.35, 1.35, 1.38]) * share
    ground = np.array([0.24, 0.23, 0.21])
    return np.asarray(np.where(height > 0, free, ground), np.float32)
