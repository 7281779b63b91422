"""How deep panes stand behind their wall, by where the photo shows them on it.

The camera is the origin, so that what is behind a wall by a share r of its distance shows on it nearer to the foot of
the perpendicular: at u / (1 + r). The jamb beyond hides nothing and the one on this side hides a strip of the pane. All
panes of equal windows move by one r, each by its own u, while what is painted on the wall, or stands in it, stays. So
windows of about one size are laid over each other, and over their mirror images, as if their panes stood at r; where
their frames and bars fall onto each other best, there they are. A pane *before* the wall is no window, so that the best
such place tells how well chance does.

The sides of a hole were found at one of several edges, of wall, reveal, frame and glass, so that they may be elsewhere
by a few steps, by the same in all windows of a size.
"""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.model.openings.raster import Raster

FEWEST, MOST = 2, 8  # windows laid over each other
DEEPEST, STEPS = 0.03, 40  # of the wall's distance, and the depths that are tried up to it
SHIFTS = np.array([-0.09, -0.04, 0.0, 0.04, 0.09])  # of a width: how much larger the hole may be at a side
POINTS = 48  # across a pane
MIDDLE = 0.15  # of a window's height, above and below which it is not looked at
LEAST_COLUMNS, LEAST_ROWS = 10, 4  # of a window
BESIDE = 2.5  # columns beside the sides of a hole, whose edges are not the pane's
FAINT = 0.3  # grey levels a column, below which a window shows no pattern
SEEN = 0.4  # of a pane that at least two of the layers show
EDGES, END, MOVED = 1.5, 1.2, 0.03  # worth of edges at jambs, of one where the reveal ends, cost of a shift by 0.1
SIZE = 0.9, 0.75  # ratio of heights and widths, from which windows are of about one size
BETTER = 0.4  # of the worth, than any place before the wall
LEAST_EDGE, LEAST_FIT = 0.4, 0.5  # of the jambs' edges, of the patterns
FROM, UP_TO = 0.03, 0.2  # of a pane's width: how far it is moved, where that tells a depth


@dataclass(frozen=True, eq=False)
class _Strip:
    """A window and what is beside it, column by column."""

    near: float  # the side nearer to the foot of the perpendicular
    far: float
    step: float  # from column to column
    at: Float  # (C,) ascending
    change: Float  # (C,) of lightness, grey levels a column
    edge: Float  # (C,) share of rows with an upright edge


def depth_ratios(raster: Raster, box: Float) -> Float:
    """How far behind the wall the panes of holes (N, 4), u0, u1, v0, v1, are, (N,) of its distance; NaN: not told."""
    ratio = np.full(len(box), np.nan)
    for alike in _of_one_size(box):
        strips = [strip for strip in (_strip(raster, each) for each in box[alike][:MOST]) if strip is not None]
        if len(strips) >= FEWEST:
            ratio[alike] = _depth_ratio(strips)
    return ratio


def _of_one_size(box: Float) -> list[Int]:
    """Rows of boxes (N, 4) of about one height and width, the tallest first."""
    wide, tall = box[:, 1] - box[:, 0], box[:, 3] - box[:, 2]
    left: Int = np.argsort(-tall, kind="stable")
    groups = []
    while len(left):
        one = left[0]
        alike = (tall[left] >= SIZE[0] * tall[one]) & (np.abs(np.log(wide[left] / wide[one])) <= -np.log(SIZE[1]))
        groups.append(left[alike])
        left = left[~alike]
    return groups


def _strip(raster: Raster, box: Float) -> _Strip | None:
    """A window (4,) of the wall; None where the foot of the perpendicular is in it, or it is too small."""
    u0, u1, v0, v1 = box.tolist()
    if u0 * u1 <= 0:
        return None
    first, last = np.searchsorted(raster.u, [u0, u1])
    start, end = np.searchsorted(raster.u, [u0 - (u1 - u0) / 2, u1 + (u1 - u0) / 2])
    low, high = np.searchsorted(raster.v, [v0 + MIDDLE * (v1 - v0), v1 - MIDDLE * (v1 - v0)])
    if last - first < LEAST_COLUMNS or high - low < LEAST_ROWS:
        return None
    lightness = raster.colours[low:high, start:end, 0].mean(axis=0)
    edge = raster.upright[low:high, start:end].mean(axis=0)
    beside = np.maximum(np.pad(edge, (1, 0))[:-1], np.pad(edge, (0, 1))[1:])
    near, far = (u0, u1) if u0 > 0 else (u1, u0)
    step = (u1 - u0) / int(last - first)
    return _Strip(near, far, step, raster.u[start:end], np.gradient(lightness), np.maximum(edge, 0.7 * beside))


def _depth_ratio(strips: list[_Strip]) -> float:
    """The share of the wall's distance by which the panes of equal windows are behind it; NaN where nothing tells."""
    ratio = np.linspace(-DEEPEST, DEEPEST, 2 * STEPS + 1)
    moved = np.array([(near, far) for near in SHIFTS for far in SHIFTS])  # (K, 2)
    layers = [_layer(strip, moved, ratio) for strip in strips]
    fit = _fit(np.stack([change for change, _, _ in layers]), np.stack([seen for _, seen, _ in layers]))
    edges = np.mean([edges for _, _, edges in layers], axis=0)  # (K, R, 3)
    worth = fit + EDGES * edges[..., :2].sum(axis=2) + END * edges[..., 2]
    worth -= MOVED * ((moved / 0.1) ** 2).sum(axis=1)[:, None]
    behind = np.where(ratio > 0, worth, -np.inf)
    hole, place = np.unravel_index(int(behind.argmax()), behind.shape)
    apart = [abs(strip.far + strip.near) / 2 / abs(strip.far - strip.near) * ratio[place] for strip in strips]
    is_told = (
        place < len(ratio) - 1
        and worth[hole, place] >= worth[:, ratio < 0].max() + BETTER
        and edges[hole, place, :2].min() >= LEAST_EDGE
        and fit[hole, place] >= LEAST_FIT
        and FROM <= float(np.median(apart)) <= UP_TO
    )
    return float(ratio[place]) if is_told else float("nan")


def _layer(strip: _Strip, moved: Float, ratio: Float) -> tuple[Float, Bool, Float]:
    """What a window shows on panes at depths (R,) behind holes that are larger by (K, 2) widths on each side.

    The pattern (K, R, POINTS) of the pane from the near side to the far one, which of it is not hidden, and the edges
    (K, R, 3) at the near side, at the far one and where the far reveal ends.
    """
    wide = strip.far - strip.near
    near = strip.near - moved[:, 0] * wide
    far = strip.far + moved[:, 1] * wide
    across = (np.arange(POINTS) + 0.5) / POINTS
    on_wall = (near[:, None, None] + across * (far - near)[:, None, None]) / (1 + ratio[:, None])
    way = np.sign(wide)
    beside = BESIDE * strip.step
    seen = (way * (on_wall - near[:, None, None]) > beside) & (way * (far[:, None, None] - on_wall) > beside)
    change = way * np.interp(on_wall, strip.at, strip.change) * seen
    size = np.sqrt((change**2).sum(axis=2) / np.maximum(seen.sum(axis=2), 1))[..., None]
    seen &= size > FAINT
    pattern = np.where(seen, change / np.maximum(size, FAINT), 0.0)
    end = far[:, None] / (1 + ratio)
    is_apart = np.abs(end - far[:, None]) > beside
    edges = np.stack(
        [
            np.broadcast_to(np.interp(near, strip.at, strip.edge)[:, None], end.shape),
            np.broadcast_to(np.interp(far, strip.at, strip.edge)[:, None], end.shape),
            np.where(is_apart, np.interp(end, strip.at, strip.edge), 0.0),
        ],
        axis=2,
    )
    return pattern, seen, edges


def _fit(pattern: Float, seen: Bool) -> Float:
    """How well patterns (N, K, R, POINTS) and their mirror images agree, (K, R): the mean product of two of them."""
    pattern = np.concatenate([pattern, -pattern[..., ::-1]])
    count = np.concatenate([seen, seen[..., ::-1]]).sum(axis=0)
    products = pattern.sum(axis=0) ** 2 - (pattern**2).sum(axis=0)
    pairs = count * (count - 1)
    is_shown = (count >= 2).mean(axis=2) >= SEEN
    found: Float = np.where(is_shown, products.sum(axis=2) / np.maximum(pairs.sum(axis=2), 1), -1.0)
    return found
