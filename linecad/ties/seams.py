"""Seams: where little holds a rigid body together, and how likely it is one body there.

Bodies keep together when single lines are left out. Two houses of one row whose fronts stand a little apart do so too:
the courses of the farther end at a corner of the nearer, in a dozen crossings that all ask for one plane, and nothing
speaks against it. Such places are found where the crossings inside a body part most easily; how likely they hold is
read off both sides as wholes, since a person sees it there too: another shade of wall, windows of other sizes, no
course that goes on.
"""

from dataclasses import dataclass, replace

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.decide.stability import LEAST_TOLERANCE
from linecad.graph.connectivity import group_numbers
from linecad.graph.weakest_cut import weakest_cut
from linecad.ties.bodies import RigidBodies
from linecad.ties.bundles import Bundle, find_bundles
from linecad.ties.candidates import SAME_RATIO, Features, Pair
from linecad.ties.colours import TYPICAL, Seen, in_common, shades
from linecad.ties.frequencies import Correlation
from linecad.ties.levels import LevelPair, find_levels
from linecad.ties.looks import Looks
from linecad.ties.planes import find_shared_planes
from linecad.ties.setting import Setting
from linecad.ties.sizes import find_sizes

LEAST_SIDE = 8  # lines
WEAKEST = 0.2  # conductance of a cut, from which a body holds without doubt
TYPICAL_SHADE = 0.65  # what two sides have in common where there is nothing to look at
MIDDLE = (0.02, 0.98)  # of the points of a side, that tell how far it reaches
# Of a bundle between two bodies; the others tell nothing more here (docs/results/ties.md).
OF_BUNDLE = (
    "near",
    "levels",
    "level excess",
    "level lead",
    "same eaves",
    "size excess",
    "corners",
    "pieces",
    "from both",
    "supported",
    "connected",
    "plane of it",
    "plane beside",
)
# Logistic regression on cuts of known depth, by tests/benchmarks/probability.py (docs/results/ties.md).
AT_ONCE = -3.3933
LOG_ODDS: dict[str, float] = {
    "near": -0.6992,
    "levels": 0.4968,
    "level excess": 0.2415,
    "level lead": 0.1921,
    "same eaves": 0.6402,
    "size excess": 0.1206,
    "corners": -0.1189,
    "pieces": 0.4191,
    "from both": -0.2630,
    "supported": 1.5760,
    "connected": 0.0082,
    "plane of it": 1.0232,
    "plane beside": 1.8568,
    "shade": 2.9889,
    "overlap across": 0.3728,
    "overlap down": -0.3411,
    "stays": 1.0825,
    "one ground": 3.1726,
}


@dataclass(frozen=True, eq=False)
class Seam:
    """A cut through a body."""

    larger: Int  # the lines of the side with more of them
    smaller: Int
    features: Features  # the last two by `linecad.ties.pieces.with_pieces_heard`

    @property
    def probability(self) -> float:
        """That both sides stand to each other as they do in the body."""
        log_odds = AT_ONCE + sum(slope * self.features[name] for name, slope in LOG_ODDS.items())
        return float(1 / (1 + np.exp(-log_odds)))


def without_feet(seam: Seam) -> float:
    """The probability that both sides stand as they do in the body, where neither feet nor pieces were heard."""
    told = seam.features | {"stays": 1.0, "one ground": 0.0}
    return replace(seam, features=told).probability


def find_seams(setting: Setting, looks: Looks) -> list[Seam]:
    """The seams of all bodies: of each the weakest cut, and of either side the weakest again, while they are weak.

    `looks` are those at the photo.
    """
    graph, body = setting.graph, setting.bodies.body
    agrees = graph.informative & (graph.misfit(setting.log_depth) <= np.maximum(graph.tolerance, LEAST_TOLERANCE))
    agrees &= (body[graph.edges[:, 0]] == body[graph.edges[:, 1]]) & (body[graph.edges[:, 0]] >= 0)
    edges, weight = graph.edges[agrees], graph.weight[agrees]
    cuts = [cut for lines in setting.lines for cut in _cuts(lines, edges, weight)]
    if not cuts:
        return []
    seams = [_seam(setting, looks.beside, one, other) for one, other in cuts]
    return [seam for seam in seams if seam is not None]


def _cuts(lines: Int, edges: Int, weight: Float) -> list[tuple[Int, Int]]:
    """The weak cuts through some lines and through either side, by edges (E, 2) of positive weight."""
    found: list[tuple[Int, Int]] = []
    left = [lines]
    while left:
        part = left.pop()
        inside = np.isin(edges, part).all(axis=1)
        own, own_weight = np.searchsorted(part, edges[inside]), weight[inside]
        group = group_numbers(len(part), own)
        if group.any():
            left += [part[group == number] for number in range(int(group.max()) + 1)]
            continue
        cut = weakest_cut(len(part), own, own_weight, LEAST_SIDE)
        if cut is not None and cut[1] < WEAKEST:
            # Of sides of one size that with the first line counts as the larger, whatever the sign of the way was.
            sides = sorted((part[cut[0]], part[~cut[0]]), key=lambda side: (-len(side), int(side[0])))
            found.append((sides[0], sides[1]))
            left += sides
    return found


def _seam(setting: Setting, beside: Seen | None, larger: Int, smaller: Int) -> Seam | None:
    """None where no crossing joins both sides at their depths."""
    side = np.full(len(setting.log_depth), -1)
    side[larger], side[smaller] = 0, 1
    sides = replace(setting, bodies=RigidBodies(side, 2))
    bundles = [bundle for bundle in find_bundles(sides) if abs(bundle.log_ratio) < SAME_RATIO]
    if not bundles:
        return None
    bundle = max(bundles, key=lambda each: each.log_odds)
    shade = TYPICAL_SHADE
    if beside is not None:
        shade = in_common(shades(beside[larger]), shades(beside[smaller]))
    known = _of_bundle(sides, bundle)
    across, down = (_overlap(*(points[:, axis] for points in sides.points)) for axis in (0, 1))
    return Seam(larger, smaller, {**known, "shade": shade, "overlap across": across, "overlap down": down})


def _of_bundle(sides: Setting, bundle: Bundle) -> Features:
    levels, sizes = find_levels(sides), find_sizes(sides)
    pair = Pair(sides, (0, 1), LevelPair(*levels), Correlation(*sizes), TYPICAL)
    known = pair.of_bundle(bundle, find_shared_planes(sides)).features
    return {name: known[name] for name in OF_BUNDLE}


def _overlap(larger: Float, smaller: Float) -> float:
    """The share of the coordinates of the smaller side that lie where the larger side is."""
    low, high = np.quantile(larger, MIDDLE)
    inside: Bool = (smaller > low) & (smaller < high)
    return float(inside.mean())
