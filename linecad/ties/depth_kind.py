"""What a depth map measures, and whether it is of this photo: told by the walls, whose shapes are known.

The depths of lines inside a body are right to some tenths of a percent. A map whose log depth differs from theirs by
one number for each body tells the truth; one that is read as another kind bends the walls, and one of another photo, or
of one depth throughout, does not follow them at all.
"""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Float, Int
from linecad.depth.depth_map import DepthMap, Kind
from linecad.errors import DepthMapError
from linecad.ties.depth_samples import DepthSamples, WallVotes, wall_votes

LEAST_SAMPLES, LEAST_BODIES = 60, 2
LEAST_FAR = 15  # samples that differ in depth from the middle of their body
MOST_COUNTED = 100_000  # of the map's pixels, evenly taken, whose values tell whether they differ
LEAST_SPREAD = 0.01  # log of the 95th over the 5th percentile of the map's values
MOST_UNEVEN = 0.6  # share of the depth that walls span
QUARTER, LEAST_OFF = 0.25, 0.03  # of samples; log depth off the middle of a body
CLEARLY = 1.5  # times as uneven as another must z be for the other to be meant: a wrong focal length does as much
SAME_PLACES = 0.02  # log scale, the median over bodies, by which two kinds may differ where nothing tells them apart
UNTOLD: tuple[Kind, ...] = ("z", "distance", "affine-inverse")  # disparity without a shift is told by its file
SHIFTS = np.concatenate([[0.0], np.geomspace(1e-3, 10.0, 41)])  # of the map's upper values, above the least possible
REFINED = np.geomspace(1 / 1.25, 1.25, 15)


@dataclass(frozen=True, eq=False)
class DepthReading:
    """How a map was read."""

    kind: Kind
    shift: float  # in units of the map's inverse depth; 0 but for affine-inverse
    unevenness: float  # of the depth that walls span, how far off them the map is (`_Relief.unevenness`)
    spread: float  # log depth, the median by which samples are off the middle of their body
    log_scale: Float  # (B,) by which log the map asks each body to grow; NaN where it does not tell
    votes: WallVotes  # of which that is the median


def read_depth(depth: DepthMap, samples: DepthSamples) -> DepthReading | str:
    """The reading that makes walls flat, or one clause that says why the map is left out.

    Where the file tells the kind, that is taken; else the one that makes walls flattest. Raises DepthMapError where
    two kinds would place bodies apart and nothing tells which is meant.
    """
    if len(samples) < LEAST_SAMPLES or len(np.unique(samples.body)) < LEAST_BODIES:
        return "it covers too few walls of this photo"
    low, high = np.quantile(depth.values[depth.valid][:: max(1, depth.values.size // MOST_COUNTED)], [0.05, 0.95])
    if np.log(high / low) < LEAST_SPREAD:
        return "it holds one depth throughout"
    relief = _Relief(samples)
    if relief.count < LEAST_FAR:
        return "the walls of this photo span too little depth to tell whether it follows them"
    readings = [_best_reading(samples, relief, kind) for kind in (UNTOLD if depth.kind is None else (depth.kind,))]
    readings.sort(key=lambda reading: reading.unevenness)
    best = readings[0]
    usual = next(reading for reading in readings if reading.kind in (depth.kind, "z"))
    if best.unevenness > MOST_UNEVEN:
        return f"it is off the photo's walls by {best.unevenness:.0%} of the depth that they span"
    if best is not usual and usual.unevenness < CLEARLY * best.unevenness and _disagree(best, usual):
        raise DepthMapError(
            f"{depth.name} may hold {best.kind} or {usual.kind}: it is off the walls by {best.unevenness:.0%} of the "
            f"depth that they span as the one, by {usual.unevenness:.0%} as the other; say which, like --option "
            f"depth-kind={usual.kind}"
        )
    return best


def _best_reading(samples: DepthSamples, relief: "_Relief", kind: Kind) -> DepthReading:
    shift = _best_shift(samples, relief) if kind == "affine-inverse" else 0.0
    excess = samples.excess(kind, shift)
    known = np.isfinite(excess)
    off = np.abs(_off_middle(excess[known], samples.body[known]))
    spread = float(np.median(off)) if known.any() else float("inf")
    votes = wall_votes(samples, excess)
    return DepthReading(kind, shift, relief.unevenness(excess), spread, votes.of_bodies(samples.bodies), votes)


def _best_shift(samples: DepthSamples, relief: "_Relief") -> float:
    """What must be added to disparity for walls to be flattest."""
    unit = float(np.quantile(samples.value, 0.95))
    least = float(np.quantile(samples.value, 0.02))

    def best_of(shifts: Float) -> float:
        found = [relief.unevenness(samples.excess("affine-inverse", shift)) for shift in shifts]
        return float(shifts[int(np.argmin(found))])

    coarse = best_of(SHIFTS * unit - least)
    return best_of((coarse + least) * REFINED - least)


class _Relief:
    """How depths vary inside bodies: what a map has to follow, whatever scale it gives each body."""

    def __init__(self, samples: DepthSamples) -> None:
        self._body = samples.body
        own = np.abs(_off_middle(samples.log_depth, samples.body))
        self._far = own >= max(LEAST_OFF, float(np.quantile(own, 1 - QUARTER)))
        self._own = own

    @property
    def count(self) -> int:
        """How many samples tell."""
        return int(self._far.sum())

    def unevenness(self, excess: Float) -> float:
        """How far a map of such an excess (S,) is off the depths that vary, as a share of how much they do.

        0 for a perfect map, 1 for one of one depth throughout; the median over the QUARTER of the samples that differ
        most in depth from the middle of their body. Infinite where the map has no depth at most of them.
        """
        known = np.isfinite(excess)
        if known[self._far].mean() < 0.5:
            return float("inf")
        off = np.abs(_off_middle(excess[known], self._body[known]))[self._far[known]]
        return float(np.median(off / self._own[self._far & known]))


def _off_middle(values: Float, body: Int) -> Float:
    """Values (S,) less the median of those of their body (S,), whose numbers ascend."""
    off = values.copy()
    starts = np.flatnonzero(np.diff(body, prepend=-1)).tolist()
    for start, end in zip(starts, [*starts[1:], len(body)], strict=True):
        middle = (end - start) // 2
        off[start:end] -= np.partition(values[start:end], middle)[middle]
    return off


def _disagree(one: DepthReading, other: DepthReading) -> bool:
    """Whether two readings place bodies apart."""
    apart = one.log_scale - other.log_scale
    apart = apart[np.isfinite(apart)]
    return len(apart) > 1 and bool(np.median(np.abs(apart - np.median(apart))) > SAME_PLACES)
