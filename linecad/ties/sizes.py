"""Sizes: windows, panes and piers of two bodies have the same sizes at one ratio of scales more often than chance.

A size is the distance of two parallel lines that stand beside each other in one Manhattan plane. Heights above the
ground (`linecad.ties.levels`) ask that two bodies stand on one ground; sizes ask for nothing but the same windows.
Two bodies are compared at all ratios at once, by the correlation of how often each log size occurs in them.
"""

from dataclasses import dataclass
from itertools import permutations
from typing import Self

import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Float, true_places
from linecad.directions import UP, across, count_of, level_axes
from linecad.geometry import depths_beside
from linecad.ties.setting import Setting

ONE_PLANE = 0.004  # of the depth: lines that lie off a plane by less are in it
LEAST_SIZE = 0.012  # of the depth: what is smaller is known too badly
BESIDE = 0.5  # of the shorter line that must stand beside the other
LIKE = 0.25  # of the longer line that the shorter one must measure
NEAREST = 8  # neighbours of a line
LEAST_SIZES = 25  # of a body, for frequencies to tell anything
STEP = 0.004  # log size, between two samples of a frequency
LARGEST = 4.0  # log size over the body's median depth, in magnitude
ALIKE = 0.003  # log size: standard deviation of how well one is known
AROUND = 0.12  # log size to both sides, over which frequencies are counted against their mean
WIDEST = 1.2  # log ratio beyond which no scale is looked for
SAME = 0.012  # log ratio within which a correlation counts for a ratio: bodies are not known better

Spectrum = NDArray[np.complex128]

_SAMPLES = round(2 * LARGEST / STEP)


@dataclass(frozen=True, eq=False)
class Sizes:
    """How often each size occurs in one body."""

    middle: float  # log of the body's median depth, which sizes are counted from
    # Of the frequencies of distances of level lines and of uprights; None where these are too few to tell.
    spectra: tuple[Spectrum | None, Spectrum | None]

    @classmethod
    def of(cls, level: Float, upright: Float, middle: float) -> Self:
        """From the log distances (M,) of level lines and (M',) of uprights of a body."""
        is_told = len(level) + len(upright) >= LEAST_SIZES
        spectra = [_spectrum(sizes - middle) if is_told and len(sizes) else None for sizes in (level, upright)]
        return cls(middle, (spectra[0], spectra[1]))


class SizePair:
    """The sizes of two bodies against each other, at log ratios of the scale of the first to that of the second."""

    def __init__(self, first: Sizes, second: Sizes) -> None:
        between = second.middle - first.middle  # the log ratio at which equal frequencies would be one upon the other
        most = round(WIDEST / STEP)
        shift = np.arange(-most, most + 1) - round(between / STEP)
        shift = shift[np.abs(shift) < _SAMPLES]
        self._places = shift * STEP + between
        total = np.zeros(len(shift))
        for own, other in zip(first.spectra, second.spectra, strict=True):
            if own is not None and other is not None:
                total += np.fft.irfft(np.conj(own) * other, 2 * _SAMPLES)[shift]
        spread = float(total.std()) if len(total) else 0.0
        self._excess = total / spread if spread > 0 else total

    def at(self, log_ratio: float) -> float:
        """Correlation at a ratio, in standard deviations of that at all ratios; 0 where nothing tells."""
        near = np.abs(self._places - log_ratio) <= SAME
        return float(self._excess[near].max()) if near.any() else 0.0


def find_sizes(setting: Setting) -> list[Sizes]:
    """The sizes of each body."""
    graph = setting.graph
    depth = np.exp(setting.log_depth)
    points = graph.components * depth[:, None]
    reach = np.empty((len(depth), 2))
    for end in range(2):
        along = np.take_along_axis(graph.end_components[:, end], graph.axis[:, None], 1)[:, 0]
        beside = depths_beside(graph.end_components[:, end], points, graph.axis)
        reach[:, end] = along * beside
    reach.sort(axis=1)
    found = []
    for lines in setting.lines:
        level: list[Float] = []
        upright: list[Float] = []
        for axis in range(count_of(graph.turns)):
            own = lines[graph.axis[lines] == axis]
            for frame in range(len(graph.turns) + 1 if axis == UP else 1):
                sides = level_axes(frame) if axis == UP else np.sort(across(np.array(axis))).tolist()
                for beside, normal in permutations(sides):
                    sizes = _distances(points[own], reach[own], depth[own], beside, normal)
                    (upright if axis == UP else level).append(sizes)
        middle = float(np.median(setting.log_depth[lines]))
        found.append(Sizes.of(np.concatenate(level), np.concatenate(upright), middle))
    return found


def _distances(points: Float, reach: Float, depth: Float, across: int, normal: int) -> Float:
    """Log distances of parallel lines along `across`, in planes of a `normal`, each to its NEAREST next ones.

    The lines run through `points` (M, 3) at `depth` (M,), from and to `reach` (M, 2) along their axis.
    """
    order = np.argsort(points[:, across], kind="stable")
    points, reach, depth = points[order], reach[order], depth[order]
    length = reach[:, 1] - reach[:, 0]
    in_plane = np.abs(points[:, normal] - points[:, normal, None]) < ONE_PLANE * depth[:, None]
    first, second = true_places(np.triu(in_plane, 1))
    apart = points[second, across] - points[first, across]
    shorter, longer = np.minimum(length[second], length[first]), np.maximum(length[second], length[first])
    beside = np.minimum(reach[second, 1], reach[first, 1]) - np.maximum(reach[second, 0], reach[first, 0])
    near = (apart > LEAST_SIZE * depth[first]) & (beside > BESIDE * shorter) & (shorter > LIKE * longer)
    first, apart = first[near], apart[near]
    # Pairs stand line by line, each line's next ones first.
    is_next = np.arange(len(first)) - np.searchsorted(first, first) < NEAREST
    return np.asarray(np.log(apart[is_next]))


def _spectrum(sizes: Float) -> Spectrum | None:
    """Of the frequency of log sizes less its mean round about, of unit energy; None where it is the same all over."""
    place = np.floor((sizes + LARGEST) / STEP).astype(np.int64)
    count = np.bincount(place[(place >= 0) & (place < _SAMPLES)], minlength=_SAMPLES).astype(np.float64)
    reach = int(np.ceil(3 * ALIKE / STEP))
    known = np.exp(-0.5 * (np.arange(-reach, reach + 1) * STEP / ALIKE) ** 2)
    frequency = np.convolve(count, known, "same")
    wide = 2 * round(AROUND / STEP) + 1
    frequency = frequency - np.convolve(frequency, np.full(wide, 1 / wide), "same")
    energy = float(np.linalg.norm(frequency))
    return np.fft.rfft(frequency / energy, 2 * _SAMPLES) if energy > 0 else None
