"""What is above the lines of the scene: sky, with its clouds, up to where it ends, or a ceiling.

Smooth parts at the top of the photo of the sky's colours are the seed, and so are parts anywhere above the horizon that
are as light and blue as only a clear sky is: under a bridge, or beyond leaves. From there the sky is what looks more
like it than like the rest of the photo (GrabCut: Rother, Kolmogorov and Blake, SIGGRAPH 2004), as far as no line of the
scene is crossed but for wires. A small part that looks like what is smooth below it is plaster, and a part that goes on
below the horizon and ends there is a wall.
"""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.directions import UP
from linecad.model.regions.raster import Picture, Raster, grab

SMOOTH = 0.30  # gradient of the sky
LEAST_CEILING, LEAST_PIECE = 0.02, 0.002  # share of the photo
MOST_LINES = 0.02  # share of samples on lines inside the sky
BLUE, BRIGHT, BRIGHTER = 126, 232, 1.19  # of b*, of L*, and times that usual above the horizon: sky, not a ceiling
BELOW = 0.05  # of a smooth part above the horizon; what goes on farther below it is no sky
NOWHERE, ENDS, BACKGROUND = "nowhere", "ends", "background"
CLEAR, LIGHT = 120, 185  # of b* at most, and of L* at least: sky wherever it is; panes and roads as blue are darker
LEAST_CLEAR = 0.004  # of the photo
MOST_WITHIN, MOST_PANELS = 0.03, 1.5  # as MOST_LINES, gaps included; as MOST_ALIKE, of a clear sky
WARM = 129  # of b*; what is so or more, and not BRIGHT, is plaster where another part of the sky is less,
EVENING = 1.5  # and where it is no lighter than this times what is usual above the horizon
LAMPS = 8  # of b*; parts of an evening's sky differ by less, and walls more that lamps light from near and from far
DARKEST = 0.75  # times the lightness of its brightest part, of the sky
ROUNDS = 1  # of GrabCut; with more of them the sky leaks into what is as white
ALIKE = np.array([16, 3, 4])  # of L*, a* and b*, within which smooth parts look the same; half of it beside a wire
WIRE, LEAST_BEYOND = 4, 20  # samples across what may part the sky, and of a part beyond
MOST_PLASTER = 0.02  # of the photo; a larger part, and one that is BLUE, is never taken for plaster
MOST_ALIKE = 0.6  # samples that look like a part of the sky and are none, for each one of it


@dataclass(frozen=True, eq=False)
class Heaven:
    """What is above the lines: sky, a ceiling, or both, as under a bridge."""

    seed: Bool  # (S,) sky for sure: all of it but for a sample at its end
    is_sky: bool  # whether there is any
    is_ceiling: bool


def look_up(raster: Raster) -> Heaven:
    """Whether what is at the top of the photo is sky or ceiling, and how far it reaches."""
    pieces, smooth = _smooth_pieces(raster)
    goes_on = _below(raster)
    lights = _of_sky(pieces, raster)
    skies = [own for own in lights if goes_on(own) != ENDS]
    if lights and not skies:  # beside a white wall the sky is too dark to be one
        skies = _of_sky([own for own in pieces if goes_on(own) == NOWHERE], raster)
    at_top = np.any([np.zeros(raster.shape, bool), *pieces], axis=0)
    is_ceiling = not lights and bool(at_top.mean() > LEAST_CEILING)
    clear, smooth = _clear_pieces(smooth, raster)
    walls = [own for own in clear if goes_on(own) == ENDS]
    # Below a ceiling too: through a window, or under a bridge.
    skies = skies + [own for own in clear if goes_on(own) != ENDS]
    at_top = np.any([at_top, *walls], axis=0)
    if not skies:
        return Heaven(np.zeros(raster.size, bool), is_sky=False, is_ceiling=is_ceiling)
    sky = _grown(skies, at_top, smooth, raster)
    return Heaven(sky.ravel(), bool(sky.any()), is_ceiling)


def _smooth_pieces(raster: Raster) -> tuple[list[Bool], Bool]:
    """The smooth parts (H, W) that are open to the top of the photo, and all that is smooth (H, W) and not open to it.

    All above the horizon and without their rims. Of the open ones small ones are left out, and those that lines cross.
    """
    smooth = ((raster.gradient < SMOOTH) & _is_up(raster)).reshape(raster.shape).astype(np.uint8)
    _, piece = cv2.connectedComponents(cv2.erode(smooth, np.ones((3, 3), np.uint8)), connectivity=4)
    on_line = _on_lines(raster)
    pieces = []
    for number in np.unique(piece[0][piece[0] > 0]).tolist():
        own = piece == number
        inside = cv2.erode(own.astype(np.uint8), np.ones((5, 5), np.uint8)) > 0
        if own.sum() >= LEAST_PIECE * raster.size and inside.any() and on_line[inside].mean() <= MOST_LINES:
            pieces.append(own)
    return pieces, np.asarray((piece > 0) & ~np.isin(piece, piece[0]))


def _clear_pieces(smooth: Bool, raster: Raster) -> tuple[list[Bool], Bool]:
    """The parts (H, W) of what is `smooth` (H, W) that show a clear sky; and what is left of it.

    No line runs through them or lies in a gap within, as windows do in a blue wall, and little else that is smooth
    looks the same, as the other panels of such a wall do. The largest is asked first.
    """
    count, piece = cv2.connectedComponents(smooth.astype(np.uint8), connectivity=4)
    area, on_line = np.bincount(piece.ravel(), minlength=count), _on_lines(raster)
    clear, left = [], smooth
    for number in (np.argsort(-area[1:], kind="stable") + 1).tolist():
        if area[number] < LEAST_CLEAR * raster.size:
            break
        own = piece == number
        middle = np.median(raster.colour[own], axis=0)
        if middle[2] > CLEAR or middle[0] < LIGHT or on_line[_filled(own)].mean() > MOST_WITHIN:
            continue
        others = raster.colour[left & ~own].astype(np.float64)
        if _samples_like(middle, others) <= MOST_PANELS * own.sum():
            clear.append(own)
            left = left & ~own
    return clear, left


def _below(raster: Raster) -> Callable[[Bool], str]:
    """How a smooth part (H, W) goes on below the horizon: as a wall, which ENDS there, and no sky does.

    What goes on down to the photo's border is a plain BACKGROUND; the sky goes on NOWHERE.
    """
    smooth = (raster.gradient < SMOOTH).reshape(raster.shape).astype(np.uint8)
    _, piece = cv2.connectedComponents(cv2.erode(smooth, np.ones((3, 3), np.uint8)), connectivity=4)
    below = ~_is_up(raster).reshape(raster.shape)

    def goes_on(own: Bool) -> str:
        whole = np.isin(piece, np.unique(piece[own]))
        if (whole & below).sum() <= BELOW * own.sum():
            return NOWHERE
        return BACKGROUND if whole[-1].any() else ENDS

    return goes_on


def _filled(part: Bool) -> Bool:
    """A part (H, W) with what lies within it."""
    outlines, _ = cv2.findContours(part.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    return np.asarray(cv2.drawContours(np.zeros(part.shape, np.uint8), outlines, -1, 1, cv2.FILLED) > 0)


def _is_up(raster: Raster) -> Bool:
    """(S,) above the horizon."""
    return np.asarray(raster.rays[:, UP] > 0)


def _on_lines(raster: Raster) -> Bool:
    """(H, W) on any line of the scene."""
    return raster.marked(np.ones(len(raster.at), bool)).reshape(raster.shape)


def _of_sky(pieces: list[Bool], raster: Raster) -> list[Bool]:
    """Those smooth parts that have colours of the sky."""
    if not pieces:
        return []
    colours = [np.median(raster.colour[own], axis=0) for own in pieces]
    brightest = max(light for light, _, _ in colours)
    rest = _is_up(raster).reshape(raster.shape) & ~np.any(pieces, axis=0)
    usual = float(np.median(raster.colour[rest][:, 0])) if rest.any() else 0.0
    light_enough = [
        (own, light, blue) for own, (light, _, blue) in zip(pieces, colours, strict=True)
        if light >= DARKEST * brightest and (blue < BLUE or light >= BRIGHT or light > BRIGHTER * usual)
    ]  # fmt: skip
    is_evening = min((blue for _, _, blue in light_enough), default=WARM) >= WARM
    found = [
        (own, blue) for own, light, blue in light_enough
        if blue < WARM or light >= BRIGHT or (is_evening and light > EVENING * usual)
    ]  # fmt: skip
    if is_evening and found and np.ptp([blue for _, blue in found]) > LAMPS:
        return []
    return [own for own, _ in found]


def _grown(skies: list[Bool], at_top: Bool, below: Bool, raster: Raster) -> Bool:
    """The sky (H, W) about those of its smooth parts that do not look like smooth parts `below` (H, W) of the photo.

    What else is smooth `at_top` (H, W) is none.
    """
    while skies:
        seed = np.any(skies, axis=0)
        sky = _like(seed, at_top & ~seed, raster)
        others = raster.colour[below & ~sky].astype(np.float64)
        left = [own for own in skies if not _is_plaster(raster.colour[own], others, raster.size)]
        if len(left) == len(skies):
            return np.asarray(seed | (cv2.erode(sky.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0))
        skies = left
    return np.zeros(raster.shape, bool)


def _is_plaster(own: Picture, others: Float, size: int) -> bool:
    """Whether the colours (M, 3) of a small part are found again among others (N, 3), by the `size` of the photo."""
    middle = np.median(own, axis=0)
    if len(own) > MOST_PLASTER * size or middle[2] < BLUE:
        return False
    return _samples_like(middle, others) > MOST_ALIKE * len(own)


def _samples_like(middle: Float, others: Float) -> int:
    """How many of other colours (N, 3) look like the middle one (3,) of a part."""
    return int((np.abs(others - middle) < ALIKE).all(axis=1).sum())


def _like(seed: Bool, is_none: Bool, raster: Raster) -> Bool:
    """What is connected with a seed (H, W) of the sky, no line but wires between, and more like it than like the rest.

    Some is known to be no sky (H, W).
    """
    if seed.all():
        return seed
    is_rest = _on_lines(raster) | ~_is_up(raster).reshape(raster.shape) | is_none
    picture = np.asarray(cv2.cvtColor(raster.colour, cv2.COLOR_Lab2BGR), np.uint8)
    sky = grab(picture, seed, is_rest, ROUNDS)
    count, part = cv2.connectedComponents(sky.astype(np.uint8), connectivity=4)
    return _beyond_wires(np.isin(part, np.unique(part[seed])), part.astype(np.int64), count, raster)


def _beyond_wires(sky: Bool, part: Int, count: int, raster: Raster) -> Bool:
    """A sky (H, W) with those other parts (H, W), of `count`, that look the same on both sides of what is between."""
    area, colour = np.bincount(part.ravel(), minlength=count), raster.colour.astype(np.float64)
    near = np.ones((2 * WIRE + 3, 2 * WIRE + 3), np.uint8)
    free = set(np.flatnonzero(area >= LEAST_BEYOND).tolist()) - {0, *np.unique(part[sky]).tolist()}
    while True:
        beside = cv2.dilate(sky.astype(np.uint8), near) > 0
        found = []
        for number in sorted(free & set(np.unique(part[beside & ~sky]).tolist())):
            own = part == number
            rim = sky & (cv2.dilate((own & beside).astype(np.uint8), near) > 0)
            off = np.median(colour[own & beside], axis=0) - np.median(colour[rim], axis=0)
            if (np.abs(off) < ALIKE / 2).all():
                found.append(number)
        if not found:
            return sky
        free -= set(found)
        sky = sky | np.isin(part, found)
