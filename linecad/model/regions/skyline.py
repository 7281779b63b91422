"""Where the sky ends, and plants: cells of the photo cut along outlines that no line of the scene follows.

Trees, domes and chimneys stand before the sky without a line along their outlines. A cell that shows both would be all
wall or all sky.
"""

from itertools import pairwise

import cv2
import numpy as np
import shapely

from linecad.arrays import Bool, Float
from linecad.model.regions import partition
from linecad.model.regions.heaven import Heaven
from linecad.model.regions.raster import Raster, traced

MARGIN = 1.5  # samples between what is sky for sure and its end
SPIRE = 3.5  # samples; what is nowhere wider than twice that does not reach into the sky: a vane, an antenna
LEAST_HOLE = 0.005  # of the photo; a smaller thing in the sky is no part of the scene
LEAST_PART = 0.0008  # of the photo, of a cell: less is not cut off
THIN = 2.5  # samples; what is nowhere wider than twice that is not cut off
STRAIGHT = 3.0  # samples, by which the outline may be straightened
ZIGZAG = 16.0  # samples; a shorter edge between two that turn against each other is left out
BUMP = 30.0  # samples; what reaches into the sky and has no longer side is left out with both its edges: a chimney
AT_CORNER = 5.0  # samples, within which the outline goes to a corner of a cell


def find_sky(heaven: Heaven, raster: Raster) -> shapely.Geometry:
    """The part of the photo that is sky for sure and up to where that ends, px."""
    if not heaven.is_sky:
        return shapely.Polygon()
    wide = shapely.buffer(sure_sky(heaven, raster, LEAST_HOLE), (MARGIN + SPIRE) * raster.step, quad_segs=4)
    narrow: shapely.Geometry = shapely.buffer(wide, -SPIRE * raster.step, quad_segs=4)
    return narrow


def sure_sky(heaven: Heaven, raster: Raster, least_hole: float = 0.0) -> shapely.Geometry:
    """The part of the photo that is sky for sure, px, without its rim and things before it of `least_hole` or more."""
    # A row more above and a column to either side: the sky goes on beyond the photo.
    mask = np.pad(heaven.seed.reshape(raster.shape), ((1, 0), (1, 1)), mode="edge")
    return _padded_shape(mask, raster.step, least_hole)


def find_plants(raster: Raster) -> shapely.Geometry:
    """The parts of the photo that trees, hedges and bushes cover, px."""
    mask = np.pad(raster.plants.reshape(raster.shape), 1, mode="edge")  # they go on beyond the photo
    return shapely.MultiPolygon(partition.polygons_of(_padded_shape(mask, raster.step, LEAST_HOLE)))


def _padded_shape(mask: Bool, step: float, least_hole: float) -> shapely.Geometry:
    """The shape, px of the photo, of a mask with a row more above and a column more to the left than the samples."""
    parts = [shapely.make_valid(part) for part in traced(mask, step, least_hole)]
    return shapely.transform(shapely.union_all(parts), lambda padded: padded - step)


def near_outline(sky: shapely.Geometry, raster: Raster) -> Bool:
    """Mask (H, W) of the samples in which a border may be that follows the outline."""
    image = np.zeros(raster.shape, np.uint8)
    for part in partition.polygons_of(sky):
        for ring in (part.exterior, *part.interiors):
            corners = np.rint(raster.samples_of(shapely.get_coordinates(ring))).astype(np.int32)
            cv2.polylines(image, [corners], True, 1, round(2 * STRAIGHT))
    return image > 0


def cut_at(
    cells: list[shapely.Polygon], sky: shapely.Geometry, raster: Raster, where: Bool | None = None
) -> list[shapely.Polygon]:
    """The cells, those that show much of the sky, or of plants, and much else cut along its outline.

    Only cells with samples of a mask (S,) `where` are cut, if one is given.
    """
    cut_here = cells
    if where is not None:
        own = partition.draw(cells, raster.shape, raster.step)[where]
        cut_here = [cells[number] for number in np.unique(own)]
    outlines = [outline for cell in cut_here for outline in _outlines_in(cell, sky, raster)]
    if not outlines:
        return cells
    sides = _sides_of(cells)
    tree = shapely.STRtree(shapely.linestrings(sides))
    bends = [_straight(_at_corners(outline, sides, tree, raster.step), sky, raster.step) for outline in outlines]
    cut = [shapely.LineString(bend) for bend in bends if len(bend) > 1]
    return partition.cells_between([*shapely.boundary(np.array(cells, object)), *cut])


def _outlines_in(cell: shapely.Polygon, sky: shapely.Geometry, raster: Raster) -> list[Float]:
    """The outlines (V, 2) px of the sky that cut off large parts of a cell, each from side to side of it."""
    if not shapely.intersects(cell, sky) or shapely.contains(sky, cell):
        return []
    parts = [
        part for part in partition.polygons_of(shapely.intersection(cell, sky))
        if _is_large(part, sky, raster) and _is_large(shapely.difference(cell, part), sky, raster)
    ]  # fmt: skip
    if not parts:
        return []
    across = shapely.intersection(shapely.boundary(sky), cell)
    lines = [line for line in shapely.get_parts(across) if isinstance(line, shapely.LineString)]
    merged = shapely.get_parts(shapely.line_merge(shapely.MultiLineString(lines)))
    around = [line for line in merged if any(shapely.dwithin(line, part, partition.GRID) for part in parts)]
    return [shapely.get_coordinates(line) for line in around if not line.is_closed]


def _is_large(part: shapely.Geometry, sky: shapely.Geometry, raster: Raster) -> bool:
    """Whether a part of a cell is worth a cell of its own: more than a rim along the outline of the sky.

    A strip that runs up into the sky is as thin as a rim, but has a short piece of the outline.
    """
    least, thin = LEAST_PART * raster.size * raster.step**2, THIN * raster.step
    # A part exactly twice as wide as a rim shrinks to a polygon without area, which shapely warns about when it grows.
    wide = shapely.set_precision(shapely.buffer(part, -thin, join_style="mitre"), partition.GRID)
    if shapely.buffer(wide, thin, join_style="mitre").area >= least:
        return True
    outline = shapely.intersection(shapely.boundary(sky), part).length
    return bool(part.area >= least and part.area >= 2 * thin * outline)


def _sides_of(cells: list[shapely.Polygon]) -> Float:
    """The sides (N, 2, 2) px of cells; as cells have the corners of their neighbours, from corner to corner of any."""
    rings = shapely.get_parts(shapely.boundary(np.array(cells, object)))
    return np.array([pair for ring in rings for pair in pairwise(shapely.get_coordinates(ring))])


def _at_corners(outline: Float, sides: Float, tree: shapely.STRtree, step: float) -> Float:
    """An outline (V, 2) px whose ends, which lie on sides (N, 2, 2), go to the ends of these where they are near."""
    moved = outline.copy()
    for end in (0, -1):
        side = sides[tree.nearest(shapely.Point(outline[end]))]
        off = np.linalg.norm(side - outline[end], axis=1)
        if off.min() < AT_CORNER * step:
            moved[end] = side[off.argmin()]
    return moved


def _straight(outline: Float, sky: shapely.Geometry, step: float) -> Float:
    """An outline (V, 2) px with few corners and without steps, and without what reaches a little into the sky.

    Or into the plants, if it is theirs.
    """
    corners = shapely.get_coordinates(shapely.simplify(shapely.LineString(outline), STRAIGHT * step))
    while True:
        edges = np.diff(corners, axis=0)
        length = np.linalg.norm(edges, axis=1)
        turn = np.sign(edges[:-1, 0] * edges[1:, 1] - edges[:-1, 1] * edges[1:, 0])
        steps = [k for k in range(1, len(edges) - 1) if turn[k - 1] * turn[k] < 0]
        bumps = [k for k in steps if k + 2 in steps and k + 1 not in steps and _is_bump(corners[k : k + 4], sky, step)]
        short = [k for k in steps if length[k] < ZIGZAG * step]
        if bumps:
            k = min(bumps, key=lambda each: length[each] + length[each + 2])
            corners = np.concatenate([corners[: k + 1], corners[k + 3 :]])
        elif short:
            k = min(short, key=lambda each: length[each])
            corners = np.concatenate([corners[:k], [(corners[k] + corners[k + 1]) / 2], corners[k + 2 :]])
        else:
            straight: Float = corners[:1] if np.array_equal(corners[0], corners[-1]) else corners
            return straight


def _is_bump(corners: Float, sky: shapely.Geometry, step: float) -> bool:
    """Whether what four corners (4, 2) px of an outline bound reaches into the sky, and is small."""
    sides = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    return bool(sides.max() < BUMP * step) and not shapely.contains_xy(sky, *corners.mean(axis=0))
