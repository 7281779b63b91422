"""The grain of a wall or a floor goes on behind what hides part of it: bricks, boards, pavers, gravel.

Grain is what a texture varies by about its colours. It is taken from a square of the same face that is in plain view
and shows nothing but grain, and laid over the hidden part again and again, each time mirrored at the edge that it
shares with the one before, so that no seam is seen. Windows, signs and other single things never get into it.
"""

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from linecad.arrays import Bool, Float, Int

_SIDE = 192  # of the small copy in which squares are sought, at most, in samples
_SQUARES = (24, 16, 12, 8)  # samples, the sides of squares
_WINDOW = 8  # samples, the side of what must vary little everywhere in a square, and about it
_ABOUT = 1  # samples about a square that must show only grain too: a thing at its edge would be seen twice
_CLEAR = 0.98  # of a sample in plain view, that may lie in a square
_EVEN = 14.0  # of 255: the standard deviation of the samples of a window that may show only grain
_LEAST_VARIANCE = 2.0  # of 255, squared: paint so plain that nothing is plainer
_UNEVEN = 1.5  # times the variance of the plainest window, that the windows of a larger square may have
_FAR = 1.0  # how much more variance a square counts at a distance of the longer side of the face

_Pixels = NDArray[np.uint8]


def add_grain(filling: _Pixels, colours: _Pixels, clear: Bool, wanted: Bool) -> None:
    """Add the grain of a face to `filling` (H, W, 3), in place, where it is `wanted` (H, W).

    `colours` (H, W, 3) of the face hold where they are `clear` (H, W). `filling` has the colours that the face varies
    about; it stays as it is where the face shows no square of mere grain.
    """
    squares = _Squares(colours, clear)
    factor = squares.factor
    parts, _ = ndimage.label(squares.down(wanted.astype(np.float32))[..., 0] > 0, np.ones((3, 3)))
    texels = parts.repeat(factor, 0).repeat(factor, 1)[: wanted.shape[0], : wanted.shape[1]]
    for number, box in enumerate(ndimage.find_objects(texels), start=1):
        found = squares.best_for(parts == number)
        if found is None:
            continue
        row, column, side = (each * factor for each in found)
        square = np.s_[row : row + side, column : column + side]
        grain = colours[square].astype(np.float32) - filling[square]
        grain -= grain.mean(axis=(0, 1))
        here = (texels[box] == number) & wanted[box]
        down, across = (_mirrored(at, start, side) for at, start in zip(box, (row, column), strict=True))
        laid = filling[box] + grain[down][:, across]
        filling[box][here] = np.clip(np.rint(laid[here]), 0, 255).astype(np.uint8)


class _Squares:
    """The squares of a face that are in plain view, and how much the windows in each of them vary."""

    def __init__(self, colours: _Pixels, clear: Bool) -> None:
        self.factor = max(1, -(-max(clear.shape) // _SIDE))
        grey = cv2.cvtColor(colours, cv2.COLOR_RGB2GRAY).astype(np.float32)
        steps = (np.abs(np.diff(grey, axis=axis, append=0)) for axis in (0, 1))
        seen = clear.astype(np.float32)
        means = self.down(np.dstack([colours, *steps]) * seen[..., None]).astype(np.float64)
        self.variance = _window_variance(means, self.down(seen) >= _CLEAR)

    def down(self, layer: NDArray[np.float32]) -> NDArray[np.float32]:
        """(h, w, C) means of a layer (H, W) or (H, W, C) over squares of `factor` texels; beyond its border it is 0."""
        layer = layer.reshape(*layer.shape[:2], -1)
        size = [-(-side // self.factor) for side in layer.shape[:2]]
        padded = np.zeros((size[0] * self.factor, size[1] * self.factor, layer.shape[2]), np.float32)
        padded[: layer.shape[0], : layer.shape[1]] = layer
        means: NDArray[np.float32] = padded.reshape(size[0], self.factor, size[1], self.factor, -1).mean(axis=(1, 3))
        return means

    def best_for(self, part: Bool) -> tuple[int, int, int] | None:
        """Row, column and side, in samples, of the square whose grain a part takes; None where none shows only grain.

        It is the plainest of the largest that are nearly as plain as any window, the nearer to the part the better.
        """
        if not self.variance.size or self.variance.min() > _EVEN**2:
            return None
        away = ndimage.distance_transform_edt(~part) / max(part.shape)
        most = _UNEVEN * (self.variance + _LEAST_VARIANCE).min()
        for side in _SQUARES:
            worst = _largest_in(self.variance, side + 2 * _ABOUT - _WINDOW + 1) + _LEAST_VARIANCE
            half = _ABOUT + side // 2
            middle = away[half : half + worst.shape[0], half : half + worst.shape[1]]
            enough = most if side > _SQUARES[-1] else _EVEN**2 + _LEAST_VARIANCE
            if worst.size and worst.min() <= enough:
                row, column = divmod(int((worst * (1 + _FAR * middle)).argmin()), worst.shape[1])
                return row + _ABOUT, column + _ABOUT, side
        return None


def _window_variance(means: Float, clear: Bool) -> Float:
    """The largest variance of any layer of `means` (h, w, C) in a window, by where it begins.

    Infinite where not all its samples are `clear` (h, w, 1); none where no window fits.
    """
    side = _WINDOW
    layers = np.concatenate([clear, means * clear, means**2 * clear], axis=2)
    inside = _inside(np.pad(layers.cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0), (0, 0))), side)
    count, number = side * side, means.shape[2]
    variance = inside[..., 1 + number :] / count - (inside[..., 1 : 1 + number] / count) ** 2
    found: Float = np.where(np.rint(inside[..., 0]) == count, variance.max(axis=-1).clip(0.0), np.inf)
    return found


def _largest_in(values: Float, side: int) -> Float:
    """The largest of values (h, w) in squares of that side, by where they begin; none where none fits."""
    if min(values.shape) < side:
        return np.zeros((0, 0))
    largest = ndimage.maximum_filter(values, side, mode="constant", cval=np.inf, origin=-(side // 2))
    return np.asarray(largest)[: values.shape[0] - side + 1, : values.shape[1] - side + 1]


def _inside(sums: Float, side: int) -> Float:
    """Sums over squares of that side, by where they begin; none where none fits."""
    if min(sums.shape[:2]) <= side:
        return np.zeros((0, 0, *sums.shape[2:]))
    return sums[side:, side:] - sums[:-side, side:] - sums[side:, :-side] + sums[:-side, :-side]


def _mirrored(at: slice, start: int, side: int) -> Int:
    """For each place of a range its place in a square that begins at `start` and is mirrored at its edges."""
    turn = (np.arange(at.start, at.stop) - start) % (2 * side)
    return np.where(turn < side, turn, 2 * side - 1 - turn)
