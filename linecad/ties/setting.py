"""What every kind of evidence looks at: the bodies of a photo, where they are seen, how they moved in the fits."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from linecad.arrays import Bool, Float, Int
from linecad.decide.stability import SAME_DEPTH, Fits
from linecad.depth.depth_map import DepthMap
from linecad.geometry import REFERENCE_WIDTH, depths_beside
from linecad.line_graph import LineGraph
from linecad.ties.bodies import RigidBodies

STEPS = 7  # points that stand for a segment where distances in the photo are measured
LEAST_SEEN = 3  # lines of a body that a fit must have to tell how the body moved


@dataclass(frozen=True, eq=False)
class Sight:
    """The photo that the lines were found in."""

    matrix: Float  # (3, 3) K, px
    rotation: Float  # (3, K) every direction in the camera frame, x, y, z of the world first
    width: int  # px
    pixels: NDArray[np.uint8] | None  # (H, W, 3) RGB, as straight as the lines; None where there is none to look at
    depth: DepthMap | None = None  # of the photo, on the same pixels


@dataclass(frozen=True, eq=False)
class Setting:
    """The bodies of a photo with their inner depths. Lengths are px at the reference width."""

    graph: LineGraph
    log_depth: Float  # (N,) of the fit to all lines, which holds inside each body
    bodies: RigidBodies
    fits: Fits
    sight: Sight

    @property
    def scale(self) -> float:
        """From px of the photo to px at the reference width."""
        return REFERENCE_WIDTH / self.sight.width

    @cached_property
    def lines(self) -> list[Int]:
        """The lines of each body."""
        order = np.argsort(self.bodies.body, kind="stable")
        ordered = self.bodies.body[order]
        starts = np.searchsorted(ordered, np.arange(self.bodies.count + 1))
        return [order[starts[body] : starts[body + 1]] for body in range(self.bodies.count)]

    @cached_property
    def points(self) -> list[Float]:
        """Points along the segments of each body, (P, 2) px."""
        return [sample(self.graph.segments.ends[lines] * self.scale) for lines in self.lines]

    @cached_property
    def trees(self) -> list[cKDTree]:
        """The same, for nearest neighbours."""
        return [cKDTree(points) for points in self.points]

    def distance(self, first: int, second: int) -> float:
        """Between the segments of two bodies in the photo, px."""
        return float(self.trees[first].query(self.points[second])[0].min())

    @cached_property
    def reach(self) -> Float:
        """(N, 2) from where to where along its own axis each line is seen, at its depth."""
        graph = self.graph
        points = graph.components * np.exp(self.log_depth)[:, None]
        reach = np.empty((len(points), 2))
        for end in range(2):
            along = np.take_along_axis(graph.end_components[:, end], graph.axis[:, None], 1)[:, 0]
            reach[:, end] = along * depths_beside(graph.end_components[:, end], points, graph.axis)
        reach.sort(axis=1)
        return reach

    @cached_property
    def _moved(self) -> tuple[Float, Int]:
        """By how much each body moved in each fit (F, B), NaN where it was not seen, and its group there (F, B)."""
        count = len(self.fits.present), self.bodies.count
        moved, group = np.full(count, np.nan), np.full(count, -1)
        for number, present in enumerate(self.fits.present):
            shift = self.fits.depth[number] - self.log_depth
            for body, lines in enumerate(self.lines):
                seen = lines[present[lines]]
                if len(seen) < LEAST_SEEN:
                    continue
                groups = self.fits.group[number, seen]
                main = np.bincount(groups).argmax()
                group[number, body] = main
                moved[number, body] = np.median(shift[seen[groups == main]])
        return moved, group

    def support(self, first: int, second: int, log_ratio: float) -> tuple[float, float]:
        """Shares of the fits that connect two bodies and give them this log scale ratio; that connect them at all."""
        moved, group = self._moved
        seen: Bool = np.isfinite(moved[:, first]) & np.isfinite(moved[:, second])
        connected = seen & (group[:, first] == group[:, second])
        same = connected & (np.abs(moved[:, first] - moved[:, second] - log_ratio) < SAME_DEPTH)
        fits = max(1, int(seen.sum()))
        return float(same.sum()) / fits, float(connected.sum()) / fits


def sample(ends: Float) -> Float:
    """STEPS points on each of N segments (N, 2, 2), as (N STEPS, 2)."""
    at = np.linspace(0, 1, STEPS)[None, :, None]
    points: Float = (ends[:, :1] * (1 - at) + ends[:, 1:] * at).reshape(-1, 2)
    return points


def densest_groups(values: Float, weight: Float, width: float, most: int) -> list[tuple[float, Int]]:
    """At most `most` groups of values (M,) that lie within 2 `width`, the heaviest first: weighted mean, and which."""
    found: list[tuple[float, Int]] = []
    left = np.arange(len(values))
    while len(left) and len(found) < most:
        order = left[np.argsort(values[left], kind="stable")]
        ordered, sums = values[order], np.r_[0.0, np.cumsum(weight[order])]
        end = np.searchsorted(ordered, ordered + 2 * width, side="right")
        start = int((sums[end] - sums[:-1]).argmax())
        own = order[start : end[start]]
        middle = float(np.average(values[own], weights=weight[own]))
        found.append((middle, own))
        left = left[np.abs(values[left] - middle) > 2 * width]
    return found
