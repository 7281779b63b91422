"""How far a segment runs along others in the image: exact intervals, no sampling."""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.geometry import segment_coordinates

TINY = 1e-12


@dataclass(frozen=True, eq=False)
class Overlaps:
    """The stretches of one segment that run along pieces of other lines."""

    piece: Int  # (M,) which piece
    start: Float  # (M,) px from the segment's first end
    end: Float  # (M,) px, larger than start
    distance: Float  # (M,) px between the two, in the middle of the stretch


def find_overlaps(segment: Float, pieces: Float, reach: float, angle: float) -> Overlaps:
    """Where a segment (2, 2) px is within `reach` px of pieces (V, 2, 2) px that run within `angle` rad of it.

    A point of the segment counts when its foot lies on the piece itself, not past its ends.
    """
    length = float(np.linalg.norm(segment[1] - segment[0]))
    along = (segment[1] - segment[0]) / max(length, TINY)
    piece_length = np.linalg.norm(pieces[:, 1] - pieces[:, 0], axis=1)
    unit = (pieces[:, 1] - pieces[:, 0]) / np.maximum(piece_length, TINY)[:, None]
    slope = unit[:, 0] * along[1] - unit[:, 1] * along[0]  # px of distance per px along the segment
    near = np.flatnonzero((np.abs(slope) <= np.sin(angle)) & (piece_length > TINY))
    unit, slope = unit[near], slope[near]
    position, offset = segment_coordinates(segment[0], pieces[near])
    # |offset + t slope| <= reach, and 0 <= position + t unit along <= length of the piece, both over t from 0 to length
    low, high = _between(offset, slope, -reach, reach)
    first, last = _between(position, unit @ along, 0.0, piece_length[near])
    start = np.maximum(np.maximum(low, first), 0.0)
    end = np.minimum(np.minimum(high, last), length)
    found = np.flatnonzero(end - start > TINY)
    start, end = start[found], end[found]
    return Overlaps(near[found], start, end, np.abs(offset[found] + (start + end) / 2 * slope[found]))


def _between(value: Float, rate: Float, low: float, high: float | Float) -> tuple[Float, Float]:
    """The interval of t in which low <= value + t rate <= high; an empty one has its end before its start."""
    steady = np.abs(rate) < TINY
    safe = np.where(steady, 1.0, rate)
    one, other = (low - value) / safe, (high - value) / safe
    inside = (value >= low) & (value <= high)
    start = np.where(steady, np.where(inside, -np.inf, np.inf), np.minimum(one, other))
    end = np.where(steady, np.where(inside, np.inf, -np.inf), np.maximum(one, other))
    return start, end


def union_length(start: Float, end: Float, chosen: Bool | None = None) -> float:
    """Length of the union of intervals (M,), or of the chosen ones."""
    if chosen is not None:
        start, end = start[chosen], end[chosen]
    total, reached = 0.0, -np.inf
    for index in np.argsort(start, kind="stable").tolist():
        total += max(0.0, float(end[index]) - max(reached, float(start[index])))
        reached = max(reached, float(end[index]))
    return total
