"""Parts of bodies that a depth map puts elsewhere.

A body may be wrong in itself: two houses of a row whose fronts seem one plane, a line along a wrong axis. No scale of
the body puts that right, but the map sees it, and what lies on one side keeps together. So the lines of a body are
parted by the scale that the map asks of each, and a part goes where the map has it, as a whole, where that is likelier
right than the place it has.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import expit, logit

from linecad.arrays import Bool, Float, Int
from linecad.depth.depth_map import DepthMap, camera_depths
from linecad.directions import MAIN, across
from linecad.geometry import lengths, unit_normals, world_rays
from linecad.ties.depth_kind import DepthReading
from linecad.ties.depth_samples import weighted_median
from linecad.ties.setting import Setting, densest_groups
from solver.depths import end_ratios

ALONG = np.linspace(0.1, 0.9, 12)  # of a line's length
BESIDE = np.array([0.003, 0.005, 0.0075, 0.01, 0.0125])  # of the photo's width
SAME = 0.03  # log depth, half of the window of samples, and of lines, that are at one place
LEAST_SAMPLES, LEAST_AGREEING = 20, 0.25  # of a line; and their share in that window
MOST_PARTS = 12  # of a body
LEAST_LINES = 4  # of a part; what fewer lines ask for would become planes that only the map shows
LEAST_OFF = 0.04  # log scale by which a part that stands where the map has it may be off
MOST_KNOWN = 0.8  # probability of a place, from which on no map moves it: crossings hold it
WIDEST = 0.02  # of a map's errors, log depth, from which on it moves no part: exact ones gain, others lose as much
SUREST = 0.98  # probability, beyond which the fits below saw nothing
USUAL_WIDTH, USUAL_OFF = 0.02, 0.1  # of a map's errors, and of a part; log depth
# Logistic regressions on parts of known depth, by tests/benchmarks/map_parts.py (docs/results/depth-maps.md).
AT_ONCE = 0.2456
LOG_ODDS: dict[str, float] = {
    "known": -0.4322,
    "width": -1.6088,
    "off": 0.5582,
}
MOVED_AT_ONCE = 0.1525
MOVED_LOG_ODDS: dict[str, float] = {
    "width": -1.4090,
}


@dataclass(frozen=True, eq=False)
class Part:
    """Lines of one body that a map has elsewhere, all by the same."""

    lines: Int
    asked: float  # log scale by which the map asks them to grow, at their body's own scale
    move: float  # log scale, from where they stand to where the map has them
    known: float  # how likely they are right as they stand
    also: Int  # lines that go with them: with the largest part of a body those that the map puts nowhere, or in no part

    def features(self, width: float) -> dict[str, float]:
        """What tells who is right, them or a map of that width."""
        return {name: float(value) for name, value in _features(self.known, width, self.move).items()}

    def is_moved(self, width: float) -> bool:
        """Whether a map of that width is likelier right."""
        return width < WIDEST and self.known < MOST_KNOWN and bool(is_map_likelier(self.known, width, self.move))


@dataclass(frozen=True, eq=False)
class MapPart:
    """Lines that a map is believed to have elsewhere than their body, whatever a person says of lines and bodies."""

    lines: Int  # ascending
    heard: Float  # log by which the map asks each to grow, at its own body's scale; NaN where it is mute
    asked: float  # the same of all of them

    def joined(self, lines: Int) -> "MapPart":
        """With more lines, of which the map was not asked."""
        own, heard = np.append(self.lines, lines), np.append(self.heard, np.full(len(lines), np.nan))
        order = np.argsort(own)
        return MapPart(own[order], heard[order], self.asked)


def hear_lines(setting: Setting, depth: DepthMap, reading: DepthReading) -> Float:
    """By which log a map asks each line of a body to grow (N,), at its body's own scale; NaN where it is mute.

    A line is where most samples of the map beside it agree, on the plane that most of them lie on: beside the edge of a
    house one side shows what is behind.
    """
    graph, sight = setting.graph, setting.sight
    ends = graph.segments.ends
    along = np.diff(ends, axis=1)[:, 0]
    beside = unit_normals(along)
    on = ends[:, None, 0] + ALONG[:, None] * along[:, None]  # lines, along, x and y
    at = sight.width * np.concatenate([-BESIDE, BESIDE])
    pixels = on[:, :, None] + at[:, None] * beside[:, None, None]
    column, row = np.moveaxis(np.rint(pixels).astype(np.int64), -1, 0)
    inside = (column >= 0) & (column < depth.width) & (row >= 0) & (row < depth.height)
    column, row = np.where(inside, column, 0), np.where(inside, row, 0)
    rays, rays_on = (
        world_rays(each.reshape(-1, 2), sight.matrix, sight.rotation).reshape(*each.shape[:-1], -1)
        for each in (pixels, on)
    )
    slant = np.linalg.norm(rays[..., :MAIN], axis=-1)
    found = camera_depths(depth.values[row, column].astype(np.float64), slant, reading.kind, reading.shift)
    ratios = end_ratios(graph)
    # Along a line in space the inverse of its depth changes evenly in the photo.
    log_line = setting.log_depth[:, None] - np.log((1 - ALONG) / ratios[:, :1] + ALONG / ratios[:, 1:])
    with np.errstate(invalid="ignore"):
        off = np.log(np.where(inside & depth.valid[row, column], found, np.nan)) - log_line[:, :, None]
    log_scale = np.full(len(ends), np.nan)
    normals = across(graph.axis)
    for line in np.flatnonzero(setting.bodies.body >= 0).tolist():
        towards, towards_on = rays[line][..., normals[line]], rays_on[line][:, None, normals[line]]
        with np.errstate(divide="ignore", invalid="ignore"):
            beyond = np.log(towards_on / towards)  # of the depth on a plane over that on the line; NaN behind it
        log_scale[line] = _most_agree(off[line].reshape(-1, 1) - beyond.reshape(-1, 2))
    return log_scale


def _most_agree(excess: Float) -> float:
    """What most samples (S, 2) beside a line say, on one of two planes; NaN where too few say the same."""
    most, found = LEAST_AGREEING * len(excess), np.nan
    for own in excess.T:
        own = own[np.isfinite(own)]
        if len(own) < LEAST_SAMPLES:
            continue
        which = densest_groups(own, np.ones(len(own)), SAME, 1)[0][1]
        if len(which) > most:
            most, found = len(which), float(np.median(own[which]))
    return found


def find_parts(setting: Setting, asked: Float, log_scale: Float, of_map: float, probability: Float) -> list[Part]:
    """The parts of bodies that the map has elsewhere.

    It has `asked` lines (N,) to grow by a log. Bodies stand at log scales (B,), the map's depth is larger by the log
    `of_map`, and each line is right with a probability (N,).
    """
    length = lengths(np.diff(setting.graph.segments.ends, axis=1)[:, 0])
    parts: list[Part] = []
    for body, lines in enumerate(setting.lines):
        told = lines[np.isfinite(asked[lines])]
        off = asked[told] - log_scale[body] - of_map
        groups = [own for _, own in densest_groups(off, length[told], SAME, MOST_PARTS)]
        also = np.setdiff1d(lines, told[np.concatenate(groups)]) if groups else lines
        for own in groups:
            part = told[own]
            move = weighted_median(off[own], length[part])
            if len(part) >= LEAST_LINES and abs(move) > LEAST_OFF:
                known = float(np.average(probability[part], weights=length[part]))
                parts.append(Part(part, move + log_scale[body] + of_map, move, known, also))
            also = also[:0]
    return parts


def heard_again(part: MapPart, lines: Int, asked: Float) -> MapPart:
    """Those `lines` of a part that are of one body, where the map asks the lines of a photo (N,) to grow by a log.

    A body that was fitted anew has another scale. Where the map is mute about the lines, it is that of the whole part.
    """
    by = asked[part.lines] - part.heard
    told = np.isfinite(by)
    own = told & np.isin(part.lines, lines)
    by = by[own if own.any() else told]
    return MapPart(lines, asked[lines], part.asked + (float(np.median(by)) if len(by) else 0.0))


def is_map_likelier(known: Float | float, width: float, move: Float | float) -> Bool:
    """Whether a map of that width is likelier right than lines that it moves by a log scale (N,).

    `known` (N,) is how likely they are right as they stand.
    """
    told = _features(known, width, move)
    return np.asarray(AT_ONCE + sum(LOG_ODDS[name] * value for name, value in told.items()) > 0)


def _features(known: Float | float, width: float, move: Float | float) -> dict[str, Float]:
    return {
        "known": np.asarray(logit(np.clip(known, 1 - SUREST, SUREST))),
        "width": np.asarray(np.log(width / USUAL_WIDTH)),
        "off": np.asarray(np.log(np.abs(move) / USUAL_OFF)),
    }


def right_by_map(width: float) -> float:
    """How likely a part stands right where a map with errors of that width has it."""
    return float(expit(MOVED_AT_ONCE + MOVED_LOG_ODDS["width"] * np.log(width / USUAL_WIDTH)))
