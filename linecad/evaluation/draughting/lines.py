"""Lines that a drawing has too many of, and ends that it leaves open.

Lengths are shares of the depth at the place; lines of different components, whose scales are their own, do not meet.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from linecad.arrays import Bool, Float, Int
from linecad.directions import MAIN, across, components, count_of
from linecad.evaluation.draughting.shapes import Shape
from linecad.geometry import project, ring_sides
from linecad.scene import Scene

NEAR = 0.01  # an end that misses a line by less was meant to meet it
TIGHT = 0.0025  # between parallel lines that the eye takes for one thick line
COLLINEAR = 0.001  # between pieces of one line
MEETS = 1e-4  # an end that is so near is on the line
ON_OUTLINE = 1e-3  # and so near, on the outline of a face
LEAST_OVERLAP = 0.5  # of the shorter of two parallel lines
BORDER = 0.005  # of the photo's width; a line may end where the photo does
SMALLEST_DEPTH = 1e-9  # in the scene's unit
CHUNK = 256  # ends compared with everything at a time, which bounds the memory


@dataclass(frozen=True)
class LineCounts:
    """Counts over all lines of a scene."""

    lines: int
    details: int  # of them, those on the layer of details
    too_many: int  # pieces that a longer line could be: collinear, and touching
    parallel_pairs: int  # beside each other within TIGHT over half of the shorter, neither a detail
    ends: int
    missing: int  # ends that miss a line of another axis by less than NEAR
    in_air: int  # ends at no line, no outline of a face in the photo, and not at the photo's border


def count_lines(scene: Scene, shapes: list[Shape], is_detail: Bool) -> LineCounts:
    """What a draughtsman would strike out or close; `is_detail` (N,) tells what is drawn on a layer of its own."""
    count = len(scene.lines)
    if count == 0:
        return LineCounts(0, 0, 0, 0, 0, 0, 0)
    depth = np.maximum(scene.lines.ends @ scene.rotation[2], SMALLEST_DEPTH)  # (N, 2)
    pairs = _parallel(scene, depth.mean(axis=1), ~is_detail)
    links = coo_array((np.ones(len(pairs.collinear)), pairs.collinear.T), (count, count))
    groups = connected_components(links, directed=False)[0]
    gap = _gaps(scene) / depth
    missing = (gap >= MEETS) & (gap < NEAR)
    free: Bool = np.array(gap >= NEAR, np.bool_)
    free[free] = ~_at_border(scene, scene.lines.ends[free])
    if shapes and free.any():
        free[free] = ~_at_outlines(scene, scene.lines.ends[free], depth[free], shapes)
    return LineCounts(
        lines=count,
        details=int(is_detail.sum()),
        too_many=count - groups,
        parallel_pairs=pairs.tight,
        ends=2 * count,
        missing=int(missing.sum()),
        in_air=int(free.sum()),
    )


@dataclass(frozen=True, eq=False)
class _Pairs:
    tight: int
    collinear: Int  # (P, 2) rows of lines


def _parallel(scene: Scene, depth: Float, drawn: Bool) -> _Pairs:
    lines = scene.lines
    tight, found = 0, [np.zeros((0, 2), np.int64)]
    ends = components(lines.ends, scene.turns)
    for axis in range(count_of(scene.turns)):
        rows = np.flatnonzero(lines.axis == axis)
        place = ends[rows][:, :, np.sort(across(np.array(axis)))].mean(axis=1)
        low, high = ends[rows, :, axis].min(axis=1), ends[rows, :, axis].max(axis=1)
        nearer = np.minimum(depth[rows][:, None], depth[rows][None])
        apart = np.linalg.norm(place[:, None] - place[None], axis=2) / nearer
        overlap = np.minimum(high[:, None], high[None]) - np.maximum(low[:, None], low[None])
        shorter = np.minimum((high - low)[:, None], (high - low)[None])
        once = np.triu(lines.component[rows][:, None] == lines.component[rows][None], 1)
        both = drawn[rows][:, None] & drawn[rows][None]
        tight += int((once & both & (apart < TIGHT) & (overlap > LEAST_OVERLAP * shorter)).sum())
        found.append(rows[np.argwhere(once & (apart < COLLINEAR) & (overlap > -NEAR * nearer))])
    return _Pairs(tight, np.concatenate(found))


def _gaps(scene: Scene) -> Float:
    """(N, 2) from each end to the nearest line of another axis in its component; infinite where there is none."""
    lines = scene.lines
    low, high = lines.ends.min(axis=1), lines.ends.max(axis=1)  # (N, 3)
    gaps = np.full((len(lines), 2), np.inf)
    for component in np.unique(lines.component).tolist():
        own = lines.component == component
        for axis in range(count_of(scene.turns)):
            rows, others = np.flatnonzero(own & (lines.axis == axis)), np.flatnonzero(own & (lines.axis != axis))
            slanted = others[lines.axis[others] >= MAIN]
            others = others[lines.axis[others] < MAIN]
            for start in range(0, len(rows) if len(others) else 0, CHUNK):
                some = rows[start : start + CHUNK]
                ends = lines.ends[some][:, :, None]  # (R, 2, 1, 3)
                foot = np.clip(ends, low[others], high[others])  # a line along an axis is a box without width
                gaps[some] = np.linalg.norm(ends - foot, axis=3).min(axis=2)
            if len(rows) and len(slanted):
                away = distances(lines.ends[rows].reshape(-1, 3), lines.ends[slanted])
                gaps[rows] = np.minimum(gaps[rows], away.reshape(-1, 2))
    return gaps


def _at_border(scene: Scene, points: Float) -> Bool:
    """Which points (M, 3) the photo shows at its border or beyond; those behind the camera it cannot show."""
    before = points @ scene.rotation[2] > SMALLEST_DEPTH
    pixels = np.full((len(points), 2), -np.inf)
    pixels[before] = project(points[before], scene.camera.matrix, scene.rotation)
    margin = BORDER * scene.camera.width
    inner = np.array([scene.camera.width, scene.camera.height]) - 1 - margin
    beyond: Bool = np.asarray(((pixels < margin) | (pixels > inner)).any(axis=1))
    return beyond


def _at_outlines(scene: Scene, points: Float, depth: Float, shapes: list[Shape]) -> Bool:
    """Which points (M, 3) lie on an outline: in space, or in the photo on one of what is not behind them.

    Behind a nearer face, or behind what hides a part of a face, nobody sees where a line ends.
    """
    hidden = ring_sides(ring for shape in shapes for ring in shape.face.hidden)
    edges = np.concatenate([*(shape.edges for shape in shapes), hidden])
    found: Bool = np.array(distances(points, edges) < ON_OUTLINE * depth, np.bool_)
    before = ((edges @ scene.rotation[2]) > SMALLEST_DEPTH).all(axis=1)
    seen = project(edges[before], scene.camera.matrix, scene.rotation)
    nearness = 1 / (edges[before] @ scene.rotation[2])  # in a photo it is linear along an edge
    ask = np.flatnonzero(~found & (points @ scene.rotation[2] > SMALLEST_DEPTH))
    pixels = project(points[ask], scene.camera.matrix, scene.rotation)
    start, along = seen[:, 0], seen[:, 1] - seen[:, 0]
    square = np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
    for row, pixel, own in zip(ask.tolist(), pixels, depth[ask].tolist(), strict=True):
        share = np.clip(((pixel - start) * along).sum(axis=1) / square, 0.0, 1.0)
        off = np.linalg.norm(pixel - start - share[:, None] * along, axis=1)
        at = nearness[:, 0] + share * (nearness[:, 1] - nearness[:, 0])
        found[row] = bool(((off < ON_OUTLINE * scene.camera.focal) & (at * own * (1 + NEAR) >= 1)).any())
    return found


def distances(points: Float, segments: Float) -> Float:
    """From each point (M, 3) to the nearest of segments (S, 2, 3)."""
    start, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    square = np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
    found = np.empty(len(points))
    for first in range(0, len(points), CHUNK):
        away = points[first : first + CHUNK, None] - start
        share = np.clip((away * along).sum(axis=2) / square, 0.0, 1.0)
        found[first : first + CHUNK] = np.linalg.norm(away - share[..., None] * along, axis=2).min(axis=1)
    return found
