"""Rows and columns: openings of one facade share sizes, sills, heads and jambs.

Each rectangle is supported by the others that stand in its row or its column and are of its size; and where rows and
columns, or equal distances in a row, say that there should be one more, it is proposed.
"""

import numpy as np

from linecad.arrays import Bool, Float, Int, true_places
from linecad.model.openings.raster import Raster

SAME = 0.08  # of a rectangle's side, by which those of one row or column may differ
SAME_POINTS = 2.0  # or so many columns or rows of the raster
DOUBLE = 0.5  # intersection over union, from which two rectangles mean the same opening
MOST = 300  # rectangles that are compared
SEEDS = 60  # rectangles from which others are proposed
LEAST_SIDE = 4  # columns or rows of those that are proposed


def distinct(box: Int, value: Float, double: float = DOUBLE, most: int = MOST) -> Int:
    """The best of each group of rectangles (N, 4) that mean the same, best first."""
    order = np.argsort(-value, kind="stable")[: 10 * most]
    left = np.ascontiguousarray(box[order].T)
    left = np.vstack([left, (left[1] - left[0]) * (left[3] - left[2])])
    kept: list[int] = []
    while len(order) and len(kept) < most:
        kept.append(int(order[0]))
        u0, u1, v0, v1, area = left
        wide = np.minimum(u1[0], u1) - np.maximum(u0[0], u0)
        tall = np.minimum(v1[0], v1) - np.maximum(v0[0], v0)
        shared = np.maximum(wide, 0) * np.maximum(tall, 0)
        apart = np.flatnonzero(shared < double * (area[0] + area - shared))
        order, left = order[apart], left.take(apart, axis=1)  # a third of the time of an index
    return np.array(kept, np.int64)


def support(box: Int, raster: Raster, others: Int, other_value: Float) -> Float:
    """How much rows and columns support rectangles (N, 4): (N, 2), log of 1 + the sum of probabilities of others."""
    same_row, same_column = mates(box, others, raster)
    sure = 1 / (1 + np.exp(-other_value))
    return np.log1p(np.column_stack([same_row @ sure, same_column @ sure]))


def mates(box: Int, others: Int, raster: Raster) -> tuple[Bool, Bool]:
    """Which of others (M, 4) stand in the row, or the column, of boxes (N, 4) and are of their size."""
    one, other = _in_plane(box, raster), _in_plane(others, raster)
    step_v = raster.v[1] - raster.v[0]
    # Columns are not even: how wide one is where each box stands.
    step_u = (one[:, 1] - one[:, 0]) / (box[:, 1] - box[:, 0])
    wide, tall = one[:, 1] - one[:, 0], one[:, 3] - one[:, 2]
    reach_u = np.maximum(SAME * wide, SAME_POINTS * step_u)[:, None]
    reach_v = np.maximum(SAME * tall, SAME_POINTS * step_v)[:, None]
    off = np.abs(one[:, None] - other[None])
    other_wide, other_tall = other[:, 1] - other[:, 0], other[:, 3] - other[:, 2]
    other_step = other_wide / (others[:, 1] - others[:, 0])
    same_width = np.abs(wide[:, None] - other_wide) <= np.maximum(reach_u, SAME_POINTS * other_step)
    same_height = np.abs(tall[:, None] - other_tall) <= reach_v
    apart_u = (one[:, None, 0] >= other[None, :, 1]) | (other[None, :, 0] >= one[:, None, 1])
    apart_v = (one[:, None, 2] >= other[None, :, 3]) | (other[None, :, 2] >= one[:, None, 3])
    same_row: Bool = np.all(off[..., 2:] <= reach_v[..., None], axis=2) & same_width & apart_u
    same_column: Bool = np.all(off[..., :2] <= reach_u[..., None], axis=2) & same_height & apart_v
    return same_row, same_column


def _in_plane(box: Int, raster: Raster) -> Float:
    return np.column_stack([raster.u[box[:, :2]], raster.v[box[:, 2:]]])


def propose(box: Int, raster: Raster) -> Int:
    """Rectangles (M, 4) that the rows and columns of others (N, 4), best first, ask for."""
    seeds = box[:SEEDS]
    if len(seeds) < 2:
        return np.zeros((0, 4), np.int64)
    flat = _in_plane(seeds, raster)
    same_row, same_column = mates(seeds, seeds, raster)
    found = []
    # The columns of one meet the rows of another that is about as wide.
    wide, tall = flat[:, 1] - flat[:, 0], flat[:, 3] - flat[:, 2]
    alike = (np.abs(np.subtract.outer(wide, wide)) <= 0.15 * wide[:, None]) & (
        np.abs(np.subtract.outer(tall, tall)) <= 0.6 * tall[:, None]
    )
    has_mate = np.any(same_row | same_column, axis=1)
    a, b = true_places(alike & has_mate[:, None] & has_mate & ~np.eye(len(seeds), dtype=bool))
    found.append(np.column_stack([seeds[a, :2], seeds[b, 2:]]))
    # The distance between two of a row, once more on either side and half-way.
    a, b = true_places(same_row)
    shift = flat[b, 0] - flat[a, 0]
    for times in (-1.0, 0.5, 2.0):
        start = flat[a, 0] + times * shift
        moved = np.column_stack([start, start + wide[a]])
        inside = (moved[:, 0] > raster.u[0]) & (moved[:, 1] < raster.u[-1])
        columns = np.rint(np.interp(moved[inside], raster.u, np.arange(len(raster.u)))).astype(np.int64)
        found.append(np.column_stack([columns, seeds[a[inside], 2:]]))
    a, b = true_places(same_column)
    shift_v = seeds[b, 2] - seeds[a, 2]
    for times in (-1.0, 0.5, 2.0):
        start_v = np.rint(seeds[a, 2] + times * shift_v).astype(np.int64)
        end_v = start_v + seeds[a, 3] - seeds[a, 2]
        inside = (start_v >= 0) & (end_v < len(raster.v))
        found.append(np.column_stack([seeds[a, :2], start_v, end_v])[inside])
    return large_ones(np.concatenate(found))


def new_ones(box: Int, known: Int) -> Int:
    """Those of rectangles (N, 4) that are not among others (M, 4), each once, sorted."""
    every, first = np.unique(np.concatenate([known, box]), axis=0, return_index=True)
    return np.asarray(every[first >= len(known)], np.int64)


def large_ones(box: Int) -> Int:
    """Those of rectangles (N, 4) that have LEAST_SIDE columns and rows, each once, sorted."""
    every = np.unique(box, axis=0)
    size = np.column_stack([every[:, 1] - every[:, 0], every[:, 3] - every[:, 2]])
    return np.asarray(every[(size >= LEAST_SIDE).all(axis=1)], np.int64)
