"""Candidates: ratios of the scales of two bodies that some evidence asks for, each with all that speaks for it.

A ratio is of one kind. Where crossings ask for it, it is of kind *bundle*; else, where planes would become one, of kind
*plane*; else, where levels match, of kind *level*. Planes and levels that match at the ratio of a bundle are then
features of the bundle; sizes that match are a feature of whatever asks for a ratio, ends of uprights that match one of
levels. Only planes may repeat a ratio, each pair of planes for itself. Kind *ground* ties a body to the ground, which
counts as one more body, of which the log scale is that of the camera's height above it.
"""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from linecad.geometry import lengths
from linecad.ties.bundles import Bundle, find_bundles
from linecad.ties.colours import find_colours, likeness
from linecad.ties.feet import MOST_LOG_ODDS, Foot, find_feet
from linecad.ties.frequencies import Correlation, Frequencies
from linecad.ties.levels import LEAST_MATCHES, MOST, LevelPair, Match, find_levels
from linecad.ties.looks import Looks
from linecad.ties.planes import SharedPlane, find_shared_planes, is_induced
from linecad.ties.setting import Setting
from linecad.ties.sizes import find_sizes
from linecad.ties.upright_ends import find_upright_ends
from linecad.ties.walls import reach_below

Kind = Literal["bundle", "plane", "level", "ground"]
KINDS: tuple[Kind, ...] = get_args(Kind)
CONNECTING: tuple[Kind, ...] = ("bundle", "plane")  # kinds of ties that say that two bodies are one thing

SAME_RATIO = 0.015  # log ratio within which two pieces of evidence ask for the same
NEAR, FAR = 100.0, 800.0  # px at the reference width, over which nearness of bodies fades
NEAR_PLANES, FAR_PLANES = 150.0, 600.0
GAP_UNIT = 37.5  # px
MOST_EXCESS, MOST_LEAD, FARTHEST, MOST_RANK = 8.0, 4.0, 1.0, 4.0  # of features that would else run away
BELOW = 1.04  # times the height of a foot; a line that reaches lower contradicts it
MOST_BELOW = 0.05  # of a wall's lines by length, that may be a lamp before it

Features = dict[str, float]


@dataclass(frozen=True, eq=False)
class Candidate:
    """One ratio for two bodies."""

    kind: Kind
    bodies: tuple[int, int]  # the smaller number first
    log_ratio: float  # log scale of the first body less that of the second
    normal: int  # of the shared plane; -1 for other kinds
    features: Features


class Pair:
    """What candidates of one pair of bodies share."""

    def __init__(
        self, setting: Setting, bodies: tuple[int, int], levels: LevelPair, sizes: Correlation, like: float
    ) -> None:
        lines = np.sort(setting.bodies.size[list(bodies)])
        distance = setting.distance(*bodies)
        self.setting, self.bodies, self.levels, self.sizes = setting, bodies, levels, sizes
        self.features: Features = {
            "near": float(np.exp(-distance / NEAR)),
            "not far": float(np.exp(-distance / FAR)),
            "lines of the smaller": float(np.log(lines[0])),
            "lines of the larger": float(np.log(lines[1])),
            "levels": float(np.log1p(levels.fewest)),
            "colour": like,
        }

    def _candidate(self, kind: Kind, log_ratio: float, own: Features, normal: int = -1) -> Candidate:
        match = self.levels.at(log_ratio)
        common = {
            "level excess": min(match.excess, MOST_EXCESS),
            "level lead": self.levels.lead(match),
            "same eaves": float(self.levels.same_eaves(log_ratio)),
            "size excess": float(np.clip(self.sizes.at(log_ratio), 0.0, MOST_EXCESS)),
            "apart": min(abs(log_ratio), FARTHEST),
        }
        return Candidate(kind, self.bodies, log_ratio, normal, {**self.features, **common, **own})

    def of_bundle(self, bundle: Bundle, planes: list[SharedPlane]) -> Candidate:
        """The ratio of a bundle, with those of the bodies' shared planes that ask for the same."""
        supported, connected = self.setting.support(*self.bodies, bundle.log_ratio)
        at_once = [plane for plane in planes if abs(plane.log_ratio - bundle.log_ratio) < SAME_RATIO]
        implied = [min(plane.shares) for plane in at_once if plane.normal in bundle.coordinates]
        more = [min(plane.shares) for plane in at_once if plane.normal not in bundle.coordinates]
        own = {
            "log-odds": float(np.log(bundle.log_odds)),
            "of all": bundle.log_odds / bundle.of_all,
            "all log-odds": float(np.log(bundle.of_all)),
            "matched": float(np.log(bundle.matched)),
            "fewest lines": float(np.log(bundle.fewest)),
            "corners": float(np.log1p(bundle.corners)),
            "pieces": float(np.log1p(bundle.pieces)),
            "gap": float(np.sqrt(bundle.gap / GAP_UNIT)),
            "from both": float(bundle.from_both),
            "supported": supported,
            "connected": connected,
            "plane of it": max(implied, default=0.0),
            "plane beside": max(more, default=0.0),
            "overlap": max((_overlap(plane) * min(plane.shares) for plane in at_once), default=0.0),
        }
        return self._candidate("bundle", bundle.log_ratio, own)

    def of_plane(self, plane: SharedPlane, supported: float, connected: float) -> Candidate:
        """The ratio of a shared plane, with the shares of the fits that give it and that connect the bodies at all."""
        own = {
            "planes near": float(np.exp(-plane.distance / NEAR_PLANES)),
            "planes not far": float(np.exp(-plane.distance / FAR_PLANES)),
            "smaller share": min(plane.shares),
            "larger share": max(plane.shares),
            "fewest lines": float(np.log(min(plane.lines))),
            "most lines": float(np.log(max(plane.lines))),
            "rank": float(plane.rank),
            "horizontal": float(plane.normal == 2),
            "overlap": _overlap(plane),
            "supported": supported,
            "connected": connected,
        }
        return self._candidate("plane", plane.log_ratio, own, plane.normal)

    def of_level(self, peak: Match, ends: Correlation) -> Candidate:
        """The ratio at which most levels match, with the ends of uprights of both bodies."""
        own = {
            "matches": float(np.log(peak.matches)),
            "by chance": float(np.log(peak.by_chance + 0.5)),
            "ends lead": float(np.clip(ends.lead(peak.log_ratio), -MOST_LEAD, MOST_LEAD)),
        }
        return self._candidate("level", peak.log_ratio, own)


def find_candidates(setting: Setting, looks: Looks) -> list[Candidate]:
    """All candidates: first between a body and the ground, whose number is the count of bodies, then pair by pair.

    `looks` are those at the photo, of this setting or of one with other bodies.
    """
    bundles: dict[tuple[int, int], list[Bundle]] = {}
    planes: dict[tuple[int, int], list[SharedPlane]] = {}
    for bundle in find_bundles(setting):
        bundles.setdefault(bundle.bodies, []).append(bundle)
    for plane in find_shared_planes(setting):
        planes.setdefault(plane.bodies, []).append(plane)
    levels, colours = find_levels(setting), find_colours(setting, looks.beside)
    sizes, ends = find_sizes(setting), find_upright_ends(setting)
    found = find_ground(setting, looks)
    for first in range(setting.bodies.count):
        for second in range(first + 1, setting.bodies.count):
            bodies = (first, second)
            pair = LevelPair(levels[first], levels[second])
            if bodies in bundles or bodies in planes or pair.peaks:
                of_sizes = Correlation(sizes[first], sizes[second])
                known = Pair(setting, bodies, pair, of_sizes, likeness(colours, first, second))
                on_both = ends[first], ends[second]
                found += _of_pair(known, bundles.get(bodies, []), planes.get(bodies, []), on_both)
    return found


def find_ground(setting: Setting, looks: Looks) -> list[Candidate]:
    """The candidates between bodies and the ground alone."""
    return [_of_foot(setting, foot) for foot in find_feet(setting, looks.feet)]


def _of_pair(
    pair: Pair, bundles: list[Bundle], planes: list[SharedPlane], ends: tuple[Frequencies, Frequencies]
) -> list[Candidate]:
    found = [pair.of_bundle(bundle, planes) for bundle in bundles]
    taken = [bundle.log_ratio for bundle in bundles]
    for plane in planes:
        supported, connected = pair.setting.support(*pair.bodies, plane.log_ratio)
        if _is_new(plane.log_ratio, taken) and not is_induced(plane, connected):
            found.append(pair.of_plane(plane, supported, connected))
    taken += [plane.log_ratio for plane in planes]
    strong = (peak for peak in pair.levels.peaks[:MOST] if peak.matches >= LEAST_MATCHES)
    peaks = [peak for peak in strong if _is_new(peak.log_ratio, taken)]
    if peaks:
        of_ends = Correlation(*ends)
        found += [pair.of_level(peak, of_ends) for peak in peaks]
    return found


def _of_foot(setting: Setting, foot: Foot) -> Candidate:
    plane = foot.wall.plane
    ends = setting.graph.segments.ends[plane.lines] * setting.scale
    own: Features = {
        "clear": _log_odds(foot.probability),
        "others": min(foot.others, 1.0),
        "against": foot.against,
        "unseen": foot.unseen,
        "likelier unseen": float(foot.probability < foot.unseen),
        "share": plane.share,
        "lines of the wall": float(np.log(len(plane.lines))),
        "lines of the body": float(np.log(setting.bodies.size[foot.body])),
        "rank": min(float(plane.rank), MOST_RANK),
        "wide": float(np.log(np.ptp(ends[..., 0]) / GAP_UNIT + 1)),
        "other foot": float(foot.probability < foot.against),
        "lines below": float(_share_below(setting, foot) > MOST_BELOW),
    }
    return Candidate("ground", (foot.body, setting.bodies.count), -foot.log_height, -1, own)


def _share_below(setting: Setting, foot: Foot) -> float:
    """Share by length of the lines of a wall that reach below its foot, where there is no wall."""
    length = lengths(np.diff(setting.graph.segments.ends[foot.wall.plane.lines], axis=1)[:, 0])
    is_below = reach_below(setting, foot.wall) > BELOW * np.exp(foot.log_height)
    return float(length[is_below].sum() / length.sum())


def _log_odds(probability: float) -> float:
    """Bounded, as no feature may run away."""
    odds = probability / max(1.0 - probability, 1e-9)
    return float(np.clip(np.log(max(odds, 1e-9)), -MOST_LOG_ODDS, MOST_LOG_ODDS))


def _overlap(plane: SharedPlane) -> float:
    """How much of two main planes is one above the other: of lesser ones it tells nothing."""
    return plane.overlap if plane.rank == 0 else 0.0


def _is_new(log_ratio: float, taken: list[float]) -> bool:
    return all(abs(log_ratio - other) >= SAME_RATIO for other in taken)
