"""Vanishing-point lines: whole lines through each vanishing point, where the edge is on and where it is off.

The photo is sampled along the image lines through one vanishing point, a row a line; along each row the most likely
switching between on and off is found from the brightness steps across it, by dynamic programming in time linear in its
length (the idea of MCMLSD: Almazan, Tal, Qian and Elder, CVPR 2017). A detector of fragments asks each fragment to
stand out by itself; a faint line that stands out by its length alone is found here, for its direction is known.
"""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Bool, Float, Int, true_places
from linecad.geometry import vanishing_points
from linecad.line_graph import ManhattanFrame, Segments
from linecad.scene import Camera

SMALL_WIDTH = 640.0  # px; in photos of that width or less a line needs LEAST_EVIDENCE
WIDE = 1280.0  # px; towards that width the evidence asked for grows without limit: fragments are long enough there
FAR = 1e8  # px; a vanishing point further away is put there, which moves no line of a photo by as much as 0.1 px
NEAR = 5.0  # px; nearer to a vanishing point its lines cannot be told apart
SCHARR_UNIT = 32.0  # what Scharr's filter gives for one grey level per px
BLUR = 0.7  # px, standard deviation, before the derivative
ALONG = 5  # px along a row over which a step must be the largest of its neighbours across
SURROUNDINGS = 31  # px, side of the square whose mean gradient is the noise of a place
GRADIENT_CUT = 20.0  # grey levels per px; a stronger gradient counts as that much noise
LEAST_NOISE = 2.0  # grey levels per px
STEP = 1.0  # noises, the step across a line that is on
LARGEST_STEP = 3.0  # noises; a stronger one is no better evidence
START = 15.0  # nats that switching on costs: a gap of 30 px without any step parts a line
LEAST_EVIDENCE = 24.0  # nats for a line against nothing, in small photos (least_evidence)
ROWS = 1024  # rows sampled at a time: bounds the memory

Float32 = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class _PolarGrid:
    """Samples about one vanishing point: place (row, column) is vanishing + radius[column] * direction(angle[row])."""

    vanishing: Float  # (2,) px
    towards: Float  # (2,) unit vector of angle 0
    angle: Float  # (N,) rad
    radius: Float  # (S,) px, 1 apart

    def directions(self, angle: Float) -> Float:
        """Unit vectors (..., 2) away from the vanishing point."""
        across = np.array([-self.towards[1], self.towards[0]])
        directions: Float = np.cos(angle)[..., None] * self.towards + np.sin(angle)[..., None] * across
        return directions


def least_evidence(width: int) -> float:
    """Nats asked of a line in a photo of that width, px: 24 up to 640, 40 at 800, 72 at 960, infinite from 1280 on.

    Continuous in the width. In wide photos the fragments carry the graph, and what is found here beside them brought
    more false joins than true ones (docs/decisions/0015).
    """
    room = WIDE / width - 1
    return LEAST_EVIDENCE / min(room * SMALL_WIDTH / (WIDE - SMALL_WIDTH), 1.0) if room > 0 else np.inf


def find_vanishing_point_lines(
    grey: NDArray[np.uint8], camera: Camera, frame: ManhattanFrame, least: float | None = None
) -> Segments:
    """Segments of a grey photo (H, W) on lines through its vanishing points, labelled by their axis.

    Each has `least` nats of evidence; None: as many as lines to build on, so that photos of WIDE px or more have none.
    """
    least = least_evidence(grey.shape[1]) if least is None else least
    if np.isinf(least):
        return Segments.none()
    points = vanishing_points(camera.matrix, frame.axes)
    smooth = np.asarray(cv2.GaussianBlur(grey.astype(np.float32), (0, 0), BLUR), np.float32)
    gradient = _derivative(smooth, 1, 0), _derivative(smooth, 0, 1)
    size = np.minimum(np.hypot(*gradient), np.float32(GRADIENT_CUT))
    noise = np.maximum(cv2.boxFilter(size, -1, (SURROUNDINGS, SURROUNDINGS)), np.float32(LEAST_NOISE))
    ends, axes = [np.zeros((0, 2, 2))], [np.zeros(0, np.int64)]
    for axis in range(len(points)):
        grid = _grid_about(points[axis], grey.shape[1], grey.shape[0])
        for first in range(0, len(grid.angle), ROWS):
            rows = np.arange(first, min(first + ROWS, len(grid.angle)))
            found = _lines_of_rows(grid, rows, gradient, noise, least)
            ends.append(found)
            axes.append(np.full(len(found), axis))
    return Segments(np.concatenate(ends), np.concatenate(axes))


def _derivative(smooth: Float32, along_x: int, along_y: int) -> Float32:
    """Grey levels per px along one side of the photo."""
    scharr = cv2.Scharr(smooth, cv2.CV_32F, along_x, along_y)
    return np.asarray(scharr / SCHARR_UNIT, np.float32)


def _grid_about(vanishing: Float, width: int, height: int) -> _PolarGrid:
    """The rows that cover a photo, at most 1 px apart."""
    reach = max(float(np.linalg.norm(vanishing[:2])), 1.0)
    point = vanishing[:2] / (vanishing[2] if abs(vanishing[2]) * FAR > reach else reach / FAR)
    right, bottom = width - 1, height - 1
    to_corners = np.array([[0, 0], [right, 0], [right, bottom], [0, bottom]]) - point
    furthest = float(np.linalg.norm(to_corners, axis=1).max())
    outside = np.maximum(np.maximum(-point, point - (right, bottom)), 0)
    nearest = float(np.linalg.norm(outside))
    if nearest == 0:
        towards, low, high = np.array([1.0, 0.0]), -np.pi, np.pi
    else:
        middle = to_corners.mean(axis=0)
        towards = middle / np.linalg.norm(middle)
        angle = np.arctan2(towards[0] * to_corners[:, 1] - towards[1] * to_corners[:, 0], to_corners @ towards)
        low, high = float(angle.min()), float(angle.max())
    rows = int(np.ceil((high - low) * furthest)) + 1
    return _PolarGrid(point, towards, np.linspace(low, high, rows), np.arange(max(nearest, NEAR), furthest))


def _lines_of_rows(
    grid: _PolarGrid, rows: Int, gradient: tuple[Float32, Float32], noise: Float32, least: float
) -> Float:
    """Segments (M, 2, 2) on some neighbouring rows."""
    margin = 1  # a row on either side, with which steps are compared
    first, last = max(rows[0] - margin, 0), min(rows[-1] + margin, len(grid.angle) - 1)
    grid = _within_photo(grid, np.arange(first, last + 1), noise.shape)
    if not len(grid.radius):
        return np.zeros((0, 2, 2))
    step, step_noise, inside = _sample(grid, np.arange(first, last + 1), gradient, noise)
    strength = np.abs(cv2.blur(step, (ALONG, 1)))
    padded = np.pad(strength, ((1, 1), (0, 0)))
    is_peak = (strength >= padded[:-2]) & (strength >= padded[2:])
    vote = np.where(is_peak, np.clip(step / step_noise, -LARGEST_STEP, LARGEST_STEP), 0)
    own = slice(rows[0] - first, rows[0] - first + len(rows))
    # From dark to bright, then all rows again from bright to dark: one line keeps its sign.
    evidence = np.concatenate(
        [np.where(inside[own], STEP * sign * vote[own] - STEP**2 / 2, np.float32(-START)) for sign in (1, -1)]
    )
    row, start, end = _runs(evidence)
    enough = _sums(evidence, row, start, end) >= least
    row, start, end = row[enough] % len(rows), start[enough], end[enough]
    angle = grid.angle[rows[row]] + _between_rows(grid, step, row + own.start, start, end)
    away = grid.directions(angle)
    return grid.vanishing + grid.radius[np.stack([start, end], axis=1)][..., None] * away[:, None]


def _within_photo(grid: _PolarGrid, rows: Int, shape: tuple[int, ...]) -> _PolarGrid:
    """The grid without the columns that none of the rows has in a photo of that `shape`, (H, W).

    ALONG columns more are kept at both ends, so that what lies in the photo has the neighbours that it had.
    """
    away = grid.directions(grid.angle[rows])
    away = np.where(away == 0, np.finfo(float).tiny, away)  # meets the sides beside it at infinity
    corners = np.array([[0, 0], [shape[1] - 1, shape[0] - 1]])
    with np.errstate(over="ignore"):
        sides = (corners[:, None] - grid.vanishing) / away
    enter, leave = sides.min(axis=0).max(axis=1), sides.max(axis=0).min(axis=1)
    meets = enter <= leave
    if not meets.any():
        return replace(grid, radius=grid.radius[:0])
    reach = enter[meets].min() - ALONG, leave[meets].max() + ALONG
    return replace(grid, radius=grid.radius[slice(*np.searchsorted(grid.radius, reach))])


def _sample(
    grid: _PolarGrid, rows: Int, gradient: tuple[Float32, Float32], noise: Float32
) -> tuple[Float32, Float32, Bool]:
    """Brightness step across each row, its noise, and whether the place lies in the photo; all (N, S)."""
    away = grid.directions(grid.angle[rows])
    x = (grid.vanishing[0] + away[:, :1] * grid.radius).astype(np.float32)
    y = (grid.vanishing[1] + away[:, 1:] * grid.radius).astype(np.float32)
    height, width = noise.shape
    inside: Bool = (x >= 0) & (x <= width - 1) & (y >= 0) & (y <= height - 1)
    along_x = cv2.remap(gradient[0], x, y, cv2.INTER_LINEAR)
    along_y = cv2.remap(gradient[1], x, y, cv2.INTER_LINEAR)
    normal = np.stack([-away[:, 1:], away[:, :1]]).astype(np.float32)
    step: Float32 = along_x * normal[0] + along_y * normal[1]
    at_place = np.asarray(cv2.remap(noise, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE), np.float32)
    return step, at_place, inside


def _runs(evidence: Float32) -> tuple[Int, Int, Int]:
    """Row, first and last column of each stretch that is on in the likeliest course of each row (N, S).

    Viterbi's recursion over the states off and on: being on earns the evidence of a place, switching on costs START.
    """
    rows, columns = evidence.shape
    by_column = cv2.transpose(evidence)
    off, on = np.zeros(rows, np.float32), np.full(rows, -np.inf, np.float32)
    stayed_on, switched_off = np.zeros((columns, rows), bool), np.zeros((columns, rows), bool)
    for column in range(columns):
        starting = off - np.float32(START)
        np.greater(on, off, out=switched_off[column])
        np.greater_equal(on, starting, out=stayed_on[column])
        np.maximum(off, on, out=off)
        np.maximum(starting, on, out=on)
        on += by_column[column]
    state = on > off
    is_on = np.zeros((columns + 2, rows), bool)
    for column in range(columns - 1, -1, -1):
        is_on[column + 1] = state
        state = np.where(state, stayed_on[column], switched_off[column])
    start, row = true_places(is_on[1:] & ~is_on[:-1])
    end, same = true_places(is_on[:-1] & ~is_on[1:])
    by_row, ends_by_row = np.argsort(row, kind="stable"), np.argsort(same, kind="stable")
    return row[by_row], start[by_row], end[ends_by_row] - 1


def _sums(values: Float32, row: Int, start: Int, end: Int) -> Float:
    """The sum (M,) of values (N, S) over each stretch, from its first column to its last one."""
    if not len(row):
        return np.zeros(0)
    length = end - start + 1
    first = np.cumsum(length) - length
    column = np.arange(length.sum()) + np.repeat(start - first, length)
    return np.asarray(np.add.reduceat(values[np.repeat(row, length), column].astype(np.float64), first))


def _between_rows(grid: _PolarGrid, step: Float32, row: Int, start: Int, end: Int) -> Float:
    """Angle, rad, from a row to the peak of the mean step of a line among it and its neighbours, by a parabola."""
    width = grid.angle[1] - grid.angle[0]
    last = len(step) - 1
    before, here, after = (np.abs(_sums(step, np.clip(row + off, 0, last), start, end)) for off in (-1, 0, 1))
    bend = before - 2 * here + after
    shift = np.where(bend < 0, (before - after) / np.where(bend < 0, 2 * bend, 1), 0)
    angle: Float = width * np.clip(shift, -0.5, 0.5)
    return angle
