"""What the photo says for and against a rectangle being an opening, in numbers."""

import cv2
import numpy as np

from linecad.arrays import Float, Int
from linecad.model.openings.raster import Raster
from linecad.model.openings.rectangles import Edges

RING = 0.2  # of the shorter side: width of the wall around a rectangle that is compared with it
LEAST_RING = 3  # columns or rows
STRIP = 2  # columns or rows beside a side that are compared across it
PLAIN = 0.4  # mean step below which a rectangle is hardly told from what is around it
OPEN = 1.6  # cover of the four sides in sum, below which hardly any is seen
LEVELS = 25.0  # grey levels; differences are counted in these, most of a facade's are a few
NAMES = (
    "uprights", "weaker upright", "weaker level", "levels", "beyond uprights", "beyond levels",
    "contrast", "darker", "rough inside", "rough around", "weakest step", "steps", "edges inside", "edges around",
    "slender", "flat", "plain", "open", "columns", "rows",
)  # fmt: skip


class Sums:
    """Sums over any box of a raster, in constant time."""

    def __init__(self, raster: Raster) -> None:
        inside = raster.inside.astype(np.uint8)
        colours = raster.colours * inside[..., None]
        edges = (raster.upright | raster.level).view(np.uint8)
        squares = cv2.multiply(colours[..., 0], colours[..., 0], dtype=cv2.CV_32F)
        channels = [
            *cv2.split(colours.astype(np.float32)),
            squares,
            edges.astype(np.float32),
            inside.astype(np.float32),
        ]
        # Side by side, so that a corner is one look into memory.
        self._total: Float = np.asarray(cv2.integral(cv2.merge(channels), sdepth=cv2.CV_64F))

    def of(self, left: Int, right: Int, low: Int, high: Int) -> Float:
        """Sums (N, 6) over columns left to right and rows low to high, the ends not among them."""
        rows, columns = self._total.shape[0] - 1, self._total.shape[1] - 1
        left, right = left.clip(0, columns), right.clip(0, columns)
        low, high = low.clip(0, rows), high.clip(0, rows)
        found: Float = (
            self._total[high, right] - self._total[low, right] - self._total[high, left] + self._total[low, left]
        )
        return found


def measure(box: Int, edges: Edges, sums: Sums, raster: Raster) -> Float:
    """The evidence (N, F) about boxes (N, 4) by columns and rows, in the order of NAMES."""
    left, right, low, high = box.T
    cover, beyond = edges.cover(box), edges.beyond(box)
    ring = np.maximum((RING * np.minimum(right - left, high - low)).astype(np.int64), LEAST_RING)
    inner = sums.of(left + 1, right, low + 1, high)
    outer = sums.of(left - ring, right + ring + 1, low - ring, high + ring + 1) - sums.of(
        left - 1, right + 2, low - 1, high + 2
    )
    rough_inside, edges_inside = _texture(inner)
    rough_around, edges_around = _texture(outer)
    brighter_around = _difference(outer, inner)
    across = []
    for side in range(4):
        beside = []
        for shift in (-STRIP - 1, 1):
            place = [left, right, low, high]
            if side < 2:
                place[0], place[1] = box[:, side] + shift, box[:, side] + shift + STRIP
            else:
                place[2], place[3] = box[:, side] + shift, box[:, side] + shift + STRIP
            beside.append(sums.of(*place))
        across.append(np.linalg.norm(_difference(*beside), axis=1))
    steps = np.minimum(np.column_stack(across), 2.0)
    slender = np.log((raster.v[high] - raster.v[low]) / (raster.u[right] - raster.u[left]))
    return np.column_stack(
        [
            cover[:, 0] + cover[:, 1],
            np.minimum(cover[:, 0], cover[:, 1]),
            np.minimum(cover[:, 2], cover[:, 3]),
            cover[:, 2] + cover[:, 3],
            beyond[:, :2].mean(axis=1),
            beyond[:, 2:].mean(axis=1),
            np.minimum(np.linalg.norm(brighter_around, axis=1), 3.0),
            brighter_around[:, 0].clip(-3, 3),
            rough_inside,
            rough_around,
            steps.min(axis=1),
            steps.mean(axis=1),
            edges_inside,
            edges_around,
            np.maximum(slender, 0),
            np.maximum(-slender, 0),
            np.maximum(PLAIN - steps.mean(axis=1), 0),
            np.maximum(OPEN - cover.sum(axis=1), 0),
            np.log(right - left),
            np.log(high - low),
        ]
    )


def _means(sums: Float) -> Float:
    """Sums (N, 6) over their numbers of points."""
    return np.asarray(sums / np.maximum(sums[:, 5:], 1.0))


def _difference(one: Float, other: Float) -> Float:
    """By how much the first of sums (N, 6) is of more colour in the mean (N, 3), in LEVELS; 0 beside the photo."""
    seen = (one[:, 5] > 0) & (other[:, 5] > 0)
    return np.asarray((_means(one) - _means(other))[:, :3] * seen[:, None] / LEVELS)


def _texture(sums: Float) -> tuple[Float, Float]:
    """Of sums (N, 6): the spread of lightness (N,) in LEVELS, the share of edges (N,)."""
    mean = _means(sums)
    return np.sqrt(np.maximum(mean[:, 3] - mean[:, 0] ** 2, 0.0)) / LEVELS, mean[:, 4]
