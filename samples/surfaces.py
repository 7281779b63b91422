"""Procedural textures: plaster, brick, stone, paving, boards, tiles, glass, and the sky.

Every texture is a function of plane coordinates in metres. Patterns fade where a pixel is larger than they are.
"""

import numpy as np
from numpy.typing import NDArray

from modelling import Float, Hits, Surface

TILE = 1024  # samples along each side of the noise tile
NOISE_SEED = 20180907


def linear(colour: str) -> Float:
    """sRGB "#rrggbb" to linear RGB (3,)."""
    values = np.array([int(colour[index : index + 2], 16) for index in (1, 3, 5)]) / 255
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def _noise_tile() -> NDArray[np.float32]:
    """A periodic tile of cloudy noise, mean 0, about -1 to 1."""
    rng = np.random.default_rng(NOISE_SEED)
    frequency = np.hypot(np.fft.fftfreq(TILE)[:, None], np.fft.rfftfreq(TILE)[None]) * TILE
    spectrum = np.fft.rfft2(rng.standard_normal((TILE, TILE))) / np.maximum(frequency, 3.0) ** 1.25
    spectrum[0, 0] = 0
    tile = np.fft.irfft2(spectrum, s=(TILE, TILE))
    return np.asarray(tile / (2.5 * tile.std()), np.float32)


_TILE = _noise_tile()


def noise(u: Float, v: Float, size: float, shift: int = 0) -> Float:
    """Cloudy noise at plane points; one period is `size` metres."""
    columns = np.floor(u * (TILE / size)).astype(np.int64) + 331 * shift
    rows = np.floor(v * (TILE / size)).astype(np.int64) + 577 * shift
    return _TILE[rows % TILE, columns % TILE].astype(np.float64)


def scatter(first: Float, second: Float, seed: int) -> Float:
    """A number from 0 to 1 for each pair of whole numbers."""
    mixed = first.astype(np.int64) * 73856093 ^ second.astype(np.int64) * 19349663 ^ seed * 83492791
    mixed = (mixed ^ (mixed >> 13)) * 1274126177 & 0x7FFFFFFF
    mixed = (mixed ^ (mixed >> 16)) * 668265263 & 0x7FFFFFFF
    return (mixed & 0xFFFF) / 65535.0


def visible(feature: float, footprint: Float) -> Float:
    """How much of a pattern of that size (m) is left at pixels of that size (m): 1 near, 0 far."""
    return np.clip(1.6 - footprint / feature, 0, 1)


def _coloured(base: Float, brightness: Float) -> Float:
    return np.clip(base * brightness[:, None], 0, 1)


def plaster(colour: str, seed: int, rough: float = 0.06, stain: float = 0.07) -> Surface:
    """Rendered wall: fine grain and large stains."""
    base = linear(colour)

    def albedo(hits: Hits) -> Float:
        grain = rough * noise(hits.u, hits.v, 2.0, seed) * visible(0.01, hits.footprint)
        stains = stain * noise(hits.u, hits.v, 23.0, seed + 1) + 0.03 * noise(hits.u * 4, hits.v, 9.0, seed + 2)
        return _coloured(base, 1 + grain + stains)

    return Surface(albedo)


def plain(colour: str, seed: int = 0, grain: float = 0.03, mirror: float = 0.0) -> Surface:
    """Paint, metal or plain stone."""
    base = linear(colour)

    def albedo(hits: Hits) -> Float:
        return _coloured(base, 1 + grain * noise(hits.u, hits.v, 1.3, seed) + grain * noise(hits.u, hits.v, 9.0, seed))

    return Surface(albedo, mirror=mirror)


def blocks(
    colour: str,
    joint: str,
    size: tuple[float, float],
    seed: int,
    gap: float = 0.01,
    bond: float = 0.5,
    spread: float = 0.16,
    swap: bool = False,
) -> Surface:
    """Courses of equal blocks (m, along and up) with joints: bricks, ashlar, slabs, tiles, boards.

    `bond` shifts every second course by that share of a block; `swap` lets the courses run along the second axis.
    """
    base, mortar = linear(colour), linear(joint)

    def albedo(hits: Hits) -> Float:
        u, v = (hits.v, hits.u) if swap else (hits.u, hits.v)
        row = np.floor(v / size[1])
        shifted = u / size[0] + bond * (row % 2)
        column = np.floor(shifted)
        across, upward = (shifted - column) * size[0], v - row * size[1]
        in_joint = (across < gap) | (upward < gap)
        tone = 1 + spread * (scatter(column, row, seed) - 0.5) * 2 * visible(size[1], hits.footprint)
        tone += 0.09 * noise(hits.u, hits.v, 1.7, seed) * visible(0.008, hits.footprint)
        tone += 0.06 * noise(hits.u, hits.v, 19.0, seed + 3)
        colours = base * tone[:, None]
        share = (in_joint * visible(4 * gap, hits.footprint))[:, None]
        return np.clip(colours * (1 - share) + mortar * share, 0, 1)

    return Surface(albedo)


def boards(colour: str, width: float, seed: int, along_second: bool, length: float = 1.9) -> Surface:
    """Floor boards with grain along them."""
    base, joint = linear(colour), 0.45 * linear(colour)

    def albedo(hits: Hits) -> Float:
        along, across = (hits.v, hits.u) if along_second else (hits.u, hits.v)
        lane = np.floor(across / width)
        shifted = along / length + scatter(lane, lane, seed + 5)
        piece = np.floor(shifted)
        in_joint = (across - lane * width < 0.004) | ((shifted - piece) * length < 0.003)
        tone = 1 + 0.3 * (scatter(lane, piece, seed) - 0.5)
        tone += 0.16 * noise(across * 9 + 7 * lane, along * 0.7, 2.0, seed) * visible(0.015, hits.footprint)
        share = (in_joint * visible(0.012, hits.footprint))[:, None]
        return np.clip(base * tone[:, None] * (1 - share) + joint * share, 0, 1)

    return Surface(albedo)


def ground(colour: str, seed: int) -> Surface:
    """Asphalt or gravel: speckles and patches."""
    base = linear(colour)

    def albedo(hits: Hits) -> Float:
        speckles = 0.22 * noise(hits.u, hits.v, 0.9, seed) * visible(0.012, hits.footprint)
        return _coloured(base, 1 + speckles + 0.13 * noise(hits.u, hits.v, 11.0, seed + 1))

    return Surface(albedo)


def glass(seed: int, curtain: bool = True) -> Surface:
    """A window pane seen from outside: dark, mirrors the sky, some with a curtain behind it."""
    dark, cloth = linear("#1c2227"), linear("#77756c")

    def albedo(hits: Hits) -> Float:
        folds = 0.5 + 0.5 * np.sin(hits.u * 31 + 3 * noise(hits.u, hits.v, 7.0, seed))
        tone = (0.78 + 0.22 * folds)[:, None]
        share = 0.5 if curtain else 0.0
        return dark * (1 - share) + cloth * tone * share

    return Surface(albedo, mirror=0.42)


def sky(rays: Float) -> Float:
    """Radiance (N, 3) of the sky in world directions (N, 3), with light clouds; grey below the horizon."""
    unit = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    height = np.clip(unit[:, 2], 0, 1)
    blue = linear("#d9e4ee") + (linear("#5f93cf") - linear("#d9e4ee")) * (height[:, None] ** 0.55)
    scale = 1 / (height + 0.25)
    x, y = unit[:, 0] * scale, unit[:, 1] * scale
    # The mean of shifted copies keeps the billows and loses the crumbs.
    clouds = sum(noise(x + 0.03 * shift, y - 0.05 * shift, 4.5, 4) for shift in range(5)) / 5
    share = np.clip(1.5 * clouds + 0.1, 0, 0.75)[:, None] * np.clip(3 * height, 0, 1)[:, None]
    return np.where(unit[:, 2:] > 0, blue * (1 - share) + linear("#f4f5f6") * share, linear("#d9e4ee"))


def surroundings(rays: Float) -> Float:
    """Radiance (N, 3) that window panes mirror: the sky over a soft skyline of houses."""
    height = rays[:, 2] / np.linalg.norm(rays, axis=1)
    share: Float = np.clip((height + 0.15) / 0.75, 0, 1)[:, None]
    return linear("#5f5a52") * (1 - share) + sky(rays) * share
