"""What stands before walls and ground, sample by sample: plants, and things on the ground.

Cells follow lines, and no line is the outline of a hedge or a tractor. Both are told from walls and ground by their
colours: plants are green and full of edges that run along no axis, a thing on the ground has another colour than the
ground around it and reaches up to the wall behind it.
"""

from dataclasses import replace

import cv2
import numpy as np
import shapely
from numpy.typing import NDArray

from linecad.arrays import Bool, Float
from linecad.model.regions.filling import Filled
from linecad.model.regions.on_roofs import is_on_roof
from linecad.model.regions.partition import polygons_of
from linecad.model.regions.raster import SHADES, Raster, grab, traced

STRANGE = (2.0, 2.75, 3.5)  # spreads of the ground's colours, from which on it is not the ground; none fits all photos
KNOWN = 0.5  # share of what is found already, of a part that is not looked at again
USUAL = 1.5  # spreads, up to which it is the ground for sure
LEAST_SPREAD = np.array([6.0, 3.0, 3.0])  # CIE L*a*b* in bytes
LEAST_THING = 0.001  # of the photo
WIDEST = 0.4  # of the photo's width, of a thing; what is wider is a pavement or the shadow of a wall
COMPACT = 0.35  # share of its box, of a thing
GAP, GAP_OF_WHOLE = 5, 9  # samples, closed between parts of one thing on the ground, and up the wall
FOOT = 4  # samples between a thing and the wall that it reaches up to
ABOVE = 3  # heights of what is on the ground, up to which a thing is looked for
ROUNDS = 2  # of the cut about a thing
HOLE = 0.0005  # of the photo; a smaller gap among leaves is no view of the wall
LEAST_LAWN = 0.2  # share of all that grows together, on the ground
MOST_OF_WALL = 0.9  # of the samples of a wall, that its usual colours cover
WINDOW, ALIKE = 9, 0.8  # samples across, in which that share of what was called clutter has these colours
LEAST_SIDE, LEAST_OF_WALL = 9, 0.003  # samples; of the photo: a smaller piece may be anything of that colour
SMOOTH = 0.7  # samples, by which an outline may miss a thing


def with_hidden(filled: Filled, raster: Raster) -> Filled:
    """The regions with what plants and things on the ground hide of them; their outlines stay as they are."""
    labels = filled.labels
    shown = labels.label[labels.cell].reshape(raster.shape)
    ground = np.isin(shown, [k for k, surface in enumerate(labels.surfaces) if surface.kind == "ground"])
    before = find_things(raster.colour, ground, (shown < labels.sky) & ~ground) | hiding(
        raster.plants.reshape(raster.shape), ground
    )
    behind = shapely.difference(filled.clutter, shapely.union_all(outlines(_of_walls(filled, raster), raster.step)))
    clutter = shapely.union_all([part for part in polygons_of(behind) if not is_on_roof(part, filled.labels, raster)])
    return replace(filled, clutter=shapely.union_all([clutter, *outlines(before, raster.step)]))


def _of_walls(filled: Filled, raster: Raster) -> Bool:
    """Where (H, W) what was called clutter has the colours of the wall that it was filled in as: it is that wall."""
    labels = filled.labels
    label = labels.label[labels.cell]
    clutter = raster.inside(filled.clutter)
    found = np.zeros(raster.shape, bool)
    for number, surface in enumerate(labels.surfaces):
        own = label == number
        if surface.kind != "wall" or not (own & clutter).any() or not (own & ~clutter).any():
            continue
        count = np.bincount(raster.shade[own & ~clutter], minlength=SHADES)
        order = np.argsort(-count, kind="stable")
        usual = order[: int(np.searchsorted(np.cumsum(count[order]), MOST_OF_WALL * count.sum())) + 1]
        hidden = (own & clutter & ~raster.plants).reshape(raster.shape)
        alike = hidden & np.isin(raster.shade, usual).reshape(raster.shape)
        share = cv2.blur(alike.astype(np.float32), (WINDOW, WINDOW)) / np.maximum(
            cv2.blur(hidden.astype(np.float32), (WINDOW, WINDOW)), 1e-6
        )
        found |= hidden & (share > ALIKE)
    solid = cv2.morphologyEx(found.astype(np.uint8), cv2.MORPH_OPEN, np.ones((LEAST_SIDE, LEAST_SIDE), np.uint8))
    _, part, box, _ = cv2.connectedComponentsWithStats(solid, connectivity=4)
    large = box[:, cv2.CC_STAT_AREA] >= LEAST_OF_WALL * raster.size
    large[0] = False
    return np.asarray(large[part])


def find_things(colour: NDArray[np.uint8], ground: Bool, walls: Bool) -> Bool:
    """Where (H, W) a thing stands on the ground, by colours (H, W, 3) CIE L*a*b*, of ground and walls (H, W).

    What on the ground has a strange colour is where one starts; a cut about it tells how far it goes, up the wall too.
    """
    found = np.zeros(ground.shape, bool)
    if not ground.any():
        return found
    strange = _strangeness(colour, ground)
    reach = np.ones((2 * FOOT + 1, 2 * FOOT + 1), np.uint8)
    foot = cv2.dilate(walls.astype(np.uint8), reach) > 0
    for level in STRANGE:
        for start in _starts((strange > level) & ground, foot):
            if found[start].mean() < KNOWN:
                seen = _around(start)
                found[seen] |= _whole(colour[seen], start[seen], (strange < USUAL)[seen] & ground[seen])
    return found


def _starts(strange: Bool, foot: Bool) -> list[Bool]:
    """The compact parts (H, W) each of a strange part of the ground (H, W) that reach the foot (H, W) of a wall."""
    part = cv2.morphologyEx(strange.astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3), np.uint8))
    part = cv2.morphologyEx(part, cv2.MORPH_CLOSE, np.ones((GAP, GAP), np.uint8))
    count, part, box, _ = cv2.connectedComponentsWithStats(part, connectivity=8)
    starts = []
    for number in range(1, count):
        width, height, area = box[number, 2:].tolist()
        if LEAST_THING * strange.size <= area >= COMPACT * width * height and width <= WIDEST * strange.shape[1]:
            own = part == number
            starts += [own] if (own & foot).any() else []
    return starts


def _around(start: Bool) -> tuple[slice, slice]:
    """The piece of the photo in which the rest of a thing is that starts in a mask (H, W)."""
    left, top, width, height = cv2.boundingRect(start.astype(np.uint8))
    rows = slice(max(0, top - ABOVE * height), top + 2 * height)
    return rows, slice(max(0, left - width // 2), left + width + width // 2 + 1)


def _strangeness(colour: NDArray[np.uint8], ground: Bool) -> Float:
    """How many spreads (H, W) a colour is off those of the ground."""
    smooth = cv2.GaussianBlur(colour, (0, 0), 1.0).astype(np.float64)
    middle = np.median(smooth[ground], axis=0)
    spread = 1.4826 * np.median(np.abs(smooth[ground] - middle), axis=0) + LEAST_SPREAD
    strange: Float = np.sqrt((((smooth - middle) / spread) ** 2).mean(axis=2))
    return strange


def _whole(colour: NDArray[np.uint8], start: Bool, ground: Bool) -> Bool:
    """All (H, W) of a thing of which `start` (H, W) is a part, in a piece of the photo with some ground for sure."""
    rest = ground.copy()
    rest[0], rest[:, 0], rest[:, -1] = True, True, True
    thing = grab(colour, start, rest, ROUNDS).astype(np.uint8)
    thing = cv2.morphologyEx(thing, cv2.MORPH_OPEN, np.ones((3, 3), np.uint8)) | start.astype(np.uint8)
    _, part = cv2.connectedComponents(thing)
    whole = np.isin(part, part[start]).astype(np.uint8)
    gap = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (GAP_OF_WHOLE, GAP_OF_WHOLE))
    return np.asarray(cv2.morphologyEx(whole, cv2.MORPH_CLOSE, gap) > 0)


def hiding(plants: Bool, ground: Bool) -> Bool:
    """Where (H, W) plants hide walls, and the `ground` (H, W) at their foot: a lawn is the ground itself.

    So is what covers most of the ground and lies on it for a good part, whatever grows on it and up the walls.
    """
    count, part = cv2.connectedComponents(plants.astype(np.uint8), connectivity=8)
    on_ground = np.bincount(part[plants & ground], minlength=count)
    all_of_it = np.bincount(part[plants], minlength=count)
    covers = (2 * on_ground > ground.sum()) & (on_ground > LEAST_LAWN * all_of_it)
    is_lawn = (2 * on_ground > all_of_it) | covers
    hidden: Bool = plants & ~(ground & is_lawn[part])
    return hidden


def outlines(mask: Bool, step: float) -> list[shapely.Geometry]:
    """Polygons, px, around the parts of a mask (H, W) of samples of `step` px, with their larger holes."""
    return [
        shapely.make_valid(shapely.simplify(around.buffer(0), SMOOTH * step)) for around in traced(mask, step, HOLE)
    ]
