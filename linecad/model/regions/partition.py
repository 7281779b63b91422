"""The photo cut into cells along its lines, each drawn out until it meets a stronger one.

The strongest line is drawn first, from border to border; each that follows goes on at both ends until it meets one that
stands. So every cell is convex, its sides are lines of the scene or of the photo, and the outline of any union of cells
is straight where a line is.
"""

import cv2
import numpy as np
import shapely
from numpy.typing import NDArray

from linecad.arrays import Float, Int

MOST_LINES = 260
BESIDE = 5.0  # samples; a weaker line so near beside a stronger one, along half of itself, cuts nothing off
BESIDE_MEET = 12.0  # the same beside a line in which two surfaces meet
PARALLEL = 0.04  # sine of the angle between such lines
OVERSHOT = 2.0  # samples by which a line may cross another one before it is taken to end there
GRID = 1e-6  # px
BORDERS = 4  # of the photo, the first of its lines
FIXED_POINT = 8  # bits after the point where OpenCV draws polygons


def extended(segments: Float, width: int, height: int, step: float, meets: int = 0) -> tuple[Float, Int]:
    """Segments (N, 2, 2) px of a photo, the strongest first, each drawn out to those before it.

    The result is (M, 2, 2), the photo's four borders first, and the row of each in `segments` (M,), -1 for borders.
    `step` is the px of one sample; the first `meets` segments are where surfaces meet.
    """
    corners = np.array([[0, 0], [width, 0], [width, height], [0, height]]) - 0.5
    lines, own = np.empty((MOST_LINES + BORDERS, 2, 2)), np.empty((MOST_LINES + BORDERS, 2, 2))
    lines[:BORDERS] = own[:BORDERS] = np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)
    reach = np.zeros(MOST_LINES + BORDERS)  # px beside each of `own`, in which a weaker line cuts nothing off
    rows = np.full(MOST_LINES + BORDERS, -1)
    count = BORDERS
    for row, segment in enumerate(segments):
        if count == len(lines):
            break
        middle, along = (segment[0] + segment[1]) / 2, segment[1] - segment[0]
        half = float(np.linalg.norm(along)) / 2
        along = along / (2 * half)
        if row >= meets and _is_beside(own[BORDERS:count], reach[BORDERS:count], middle, along, half):
            continue
        place = _crossings(lines[:count], middle, along)
        after, before = place[place >= half - OVERSHOT * step], place[place <= OVERSHOT * step - half]
        if len(after) == 0 or len(before) == 0:
            continue  # it lies outside the photo
        lines[count] = middle + along * np.array([[before.max()], [after.min()]])
        own[count], rows[count] = segment, row
        reach[count] = (BESIDE_MEET if row < meets else BESIDE) * step
        count += 1
    return lines[:count], rows[:count]


def cut(lines: Float) -> list[shapely.Polygon]:
    """The cells that lines (M, 2, 2) cut out of the photo, px."""
    return cells_between(list(shapely.linestrings(lines)))


def polygons_of(shape: shapely.Geometry, least: float = 0.0) -> list[shapely.Polygon]:
    """The polygons of a shape that have an area of `least` px^2 or more."""
    return [part for part in shapely.get_parts(shape) if isinstance(part, shapely.Polygon) and part.area >= least]


def without_holes(shape: shapely.Polygon) -> list[shapely.Polygon]:
    """Polygons without holes that a polygon is made of: cut upright through the middle of each hole."""
    if not shape.interiors:
        return [shape]
    left, top, right, bottom = shape.bounds
    at = shapely.Polygon(shape.interiors[0]).centroid.x
    halves = (shapely.box(left, top, at, bottom), shapely.box(at, top, right, bottom))
    parts = [part for half in halves for part in polygons_of(shapely.intersection(shape, half))]
    return [piece for part in parts for piece in without_holes(part)]


def positive_part(corners: Float, value: Float) -> shapely.Polygon:
    """The part of a convex polygon (V, 2) where a linear value, (V,) at its corners, is not below 0.

    It ends straight, on the image line where the value is 0.
    """
    kept: list[Float] = []
    for number, here in enumerate(corners):
        following = (number + 1) % len(corners)
        kept += [here] if value[number] >= 0 else []
        if (value[number] >= 0) != (value[following] >= 0):
            share = value[number] / (value[number] - value[following])
            kept.append(here + share * (corners[following] - here))
    return shapely.Polygon(kept) if kept else shapely.Polygon()


def cells_between(lines: list[shapely.Geometry]) -> list[shapely.Polygon]:
    """The cells between lines, with corners on a grid of GRID px, so that neighbours have them in common exactly."""
    pieces = shapely.get_parts(shapely.union_all(lines, grid_size=GRID))
    return list(shapely.get_parts(shapely.polygonize(pieces)))


def draw(cells: list[shapely.Polygon], shape: tuple[int, int], step: float) -> Int:
    """The cell (H x W,) of each sample."""
    image = np.zeros(shape, np.int32)
    for number, cell in enumerate(cells):
        corners = (shapely.get_coordinates(cell.exterior) + 0.5) / step - 0.5
        cv2.fillPoly(image, [np.rint(corners * 2**FIXED_POINT).astype(np.int32)], number, shift=FIXED_POINT)
    drawn: NDArray[np.int64] = image.ravel().astype(np.int64)
    return drawn


def _is_beside(own: Float, reach: Float, middle: Float, along: Float, half: float) -> bool:
    """Whether a segment runs beside one of those before it (M, 2, 2), within the `reach` (M,) px of that."""
    if len(own) == 0:
        return False
    across = np.array([-along[1], along[0]])
    direction = own[:, 1] - own[:, 0]
    is_parallel = np.abs(direction @ across) < PARALLEL * np.hypot(direction[:, 0], direction[:, 1])
    own = own[is_parallel] - middle
    near = np.abs((own[:, 0] + own[:, 1]) @ across) < 2 * reach[is_parallel]
    if not near.any():
        return False
    start, end = (own[near] @ along).T
    overlap = np.minimum(np.maximum(start, end), half) - np.maximum(np.minimum(start, end), -half)
    return bool((overlap > half).any())


def _crossings(lines: Float, middle: Float, along: Float) -> Float:
    """Where an image line through `middle` (2,), of unit direction `along`, crosses lines (M, 2, 2): px from there."""
    start, direction = lines[:, 0] - middle, lines[:, 1] - lines[:, 0]
    turn = along[0] * direction[:, 1] - along[1] * direction[:, 0]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        place = (start[:, 0] * direction[:, 1] - start[:, 1] * direction[:, 0]) / turn
        share = (start[:, 0] * along[1] - start[:, 1] * along[0]) / turn
    on_line = np.isfinite(place) & (share >= -1e-9) & (share <= 1 + 1e-9)
    hits: Float = place[on_line]
    return hits
