"""Sizes: windows, panes and piers of two bodies have the same sizes at one ratio of scales more often than chance.

A size is the distance of two parallel lines that stand beside each other in one Manhattan plane. Heights above the
ground (`linecad.ties.levels`) ask that two bodies stand on one ground; sizes ask for nothing but the same windows.
"""

from itertools import permutations

import numpy as np

from linecad.arrays import Float, true_places
from linecad.directions import UP, across, count_of, level_axes
from linecad.ties.frequencies import Frequencies, spectrum
from linecad.ties.setting import Setting

ONE_PLANE = 0.004  # of the depth: lines that lie off a plane by less are in it
LEAST_SIZE = 0.012  # of the depth: what is smaller is known too badly
BESIDE = 0.5  # of the shorter line that must stand beside the other
LIKE = 0.25  # of the longer line that the shorter one must measure
NEAREST = 8  # neighbours of a line
LEAST_SIZES = 25  # of a body, for frequencies to tell anything
ALIKE = 0.003  # log size: standard deviation of how well one is known
AROUND = 0.12  # log size to both sides, over which frequencies are counted against their mean


def sizes_of(level: Float, upright: Float, middle: float) -> Frequencies:
    """How often each size occurs in a body, from the log distances (M,) of level lines and (M',) of its uprights.

    `middle` is the log of the body's median depth. Too few sizes tell nothing.
    """
    is_told = len(level) + len(upright) >= LEAST_SIZES
    spectra = [
        spectrum(sizes - middle, ALIKE, AROUND) if is_told and len(sizes) else None for sizes in (level, upright)
    ]
    return Frequencies(middle, tuple(spectra))


def find_sizes(setting: Setting) -> list[Frequencies]:
    """The sizes of each body."""
    graph = setting.graph
    depth = np.exp(setting.log_depth)
    points = graph.components * depth[:, None]
    found = []
    for lines in setting.lines:
        level: list[Float] = []
        upright: list[Float] = []
        for axis in range(count_of(graph.turns)):
            own = lines[graph.axis[lines] == axis]
            for frame in range(len(graph.turns) + 1 if axis == UP else 1):
                sides = level_axes(frame) if axis == UP else np.sort(across(np.array(axis))).tolist()
                for beside, normal in permutations(sides):
                    sizes = _distances(points[own], setting.reach[own], depth[own], beside, normal)
                    (upright if axis == UP else level).append(sizes)
        middle = float(np.median(setting.log_depth[lines]))
        found.append(sizes_of(np.concatenate(level), np.concatenate(upright), middle))
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
