"""Links: by what each body hangs on the reference, body by body, and how likely each link holds.

The links are a tree. From the reference on, the body comes next that the most evidence ties to those which hang there
already; of the pieces of both bodies (`linecad.ties.pieces`) it is hung by those that are tied best. A body that stands
wrong takes along what hangs on it, and one that hangs on a wrong piece stands wrong with it.
"""

from dataclasses import dataclass, replace

import numpy as np

from linecad.arrays import Bool, Float
from linecad.ties.candidates import KINDS, Features, Kind
from linecad.ties.depth_ties import MapPlaces
from linecad.ties.pieces import Pieces
from linecad.ties.weights import above_chance

LEAST_WEIGHT = 0.5  # log-odds above chance of a candidate that tells
ASKS_FOR_IT, ONE_GROUND = 0.025, 0.03  # log scale within which a candidate, or two feet, ask for the places as they are
FULL_PIECE = 15.0  # lines of the smaller piece, from which a candidate has its full weight
TELLING = 1.0  # weight of the best candidate of a kind that counts as a kind of evidence
LARGEST_MARGIN = 20.0
TOLD = 0.97  # probability of a place that a person gave: nobody measured how often people are wrong
FARTHEST_OFF = 6.0  # widths of a depth map
# Logistic regression on bodies of known depth, by tests/benchmarks/probability.py (docs/results/ties.md).
AT_ONCE = 0.3269
LOG_ODDS: dict[str, float] = {
    "margin": 0.1109,
    "root of margin": 0.2783,
    "lines of the body": -0.8325,
    "lines of the piece": -0.9094,
    "lines of the other": -0.1955,
    "weight": 2.4779,
    "weight of all": 0.2142,
    "kinds": 0.2573,
    "weakest": 0.6249,
    "by a bundle": 0.6159,
    "by the ground": 0.0252,
    "bodies": -0.1455,
}
# The same where a depth map was heard.
WITH_MAP_AT_ONCE = 2.2675
WITH_MAP_LOG_ODDS: dict[str, float] = {
    "margin": 0.0784,
    "root of margin": 0.7895,
    "lines of the body": -0.6957,
    "lines of the piece": -0.6984,
    "lines of the other": -0.1812,
    "weight": 2.0938,
    "weight of all": 0.1597,
    "kinds": -0.1829,
    "weakest": -0.4118,
    "by a bundle": 0.2849,
    "by the ground": -0.3255,
    "bodies": -0.4754,
    "map's word": 0.5074,
    "off the map": -0.2869,
}


@dataclass(frozen=True, eq=False)
class Link:
    """A body and what it hangs on."""

    body: int
    to: int  # the body it hangs on
    piece: int  # of `body`, which is tied to
    other: int  # piece of `to`
    features: Features
    is_told: bool = False  # by a person

    @property
    def probability(self) -> float:
        """That both pieces stand to each other as they were placed."""
        with_map = "off the map" in self.features
        at_once, slopes = (WITH_MAP_AT_ONCE, WITH_MAP_LOG_ODDS) if with_map else (AT_ONCE, LOG_ODDS)
        log_odds = at_once + sum(slopes[name] * value for name, value in self.features.items())
        found = float(1 / (1 + np.exp(-log_odds)))
        return max(found, TOLD) if self.is_told else found


@dataclass(frozen=True)
class _Support:
    """A candidate between pieces of two bodies that asks for their places."""

    weight: float
    kind: Kind
    piece: int  # of the first body
    other: int  # of the second


def find_links(
    pieces: Pieces, log_scale: Float, margin: Float, reference: int, mapped: MapPlaces | None = None
) -> list[Link]:
    """A link for each body but the reference, outwards from there; what nothing ties hangs on the reference itself.

    `log_scale` (B + 1,) are the places of the bodies and, last, of the ground; `margin` (B,) tells how much worse every
    other place is; `mapped` is what a depth map made of the places, where one was heard.
    """
    support = _supports(pieces, log_scale)
    count = len(log_scale) - 1
    weight = np.zeros((count, count))
    for (first, second), own in support.items():
        weight[first, second] = sum(max((each.weight for each in own if each.kind == kind), default=0.0)
                                    for kind in KINDS)  # fmt: skip
    hangs = np.arange(count) == reference
    weakest = np.where(hangs, np.inf, 0.0)
    lines = np.bincount(pieces.body, pieces.size, count)
    margin = np.minimum(margin[:count], LARGEST_MARGIN)
    links: list[Link] = []
    while not hangs.all():
        free = np.where(hangs[:, None] & ~hangs, weight, -1.0)
        free[reference] += np.where(hangs, 0.0, 1e-9)  # what nothing ties hangs on the reference
        to, body = (int(each) for each in np.unravel_index(int(free.argmax()), free.shape))
        best = max(support.get((body, to), []), key=lambda each: each.weight, default=None)
        if best is None:
            best = _Support(0.0, "level", _largest(pieces, body), _largest(pieces, to))
        weakest[body] = min(weakest[to], weight[body, to])
        size = pieces.size[[best.piece, best.other]]
        features: Features = {
            "margin": float(margin[body]),
            "root of margin": float(np.sqrt(margin[body])),
            "lines of the body": float(np.log(lines[body])),
            "lines of the piece": float(np.log(size[0])),
            "lines of the other": float(np.log(size[1])),
            "weight": float(np.log1p(weight[body, to])),
            "weight of all": float(np.log1p(weight[body, hangs].sum())),
            "kinds": float(_kinds(support, body)),
            "weakest": float(np.log1p(weakest[body])),
            "by a bundle": float(best.kind == "bundle" and best.weight > 0),
            "by the ground": float(best.kind == "ground"),
            "bodies": float(np.log(count + 1)),
        }
        links.append(Link(body, to, best.piece, best.other, features | _by_the_map(mapped, body)))
        hangs[body] = True
    return links


def told_links(links: list[Link], pieces: Pieces, reference: int, told: Bool) -> list[Link]:
    """The links, those of bodies that a person `told` (B,) to stand as they do hung on the reference by that.

    Of the pieces of a body and of the reference the largest ones count.
    """
    return [
        replace(link, to=reference, piece=_largest(pieces, link.body), other=_largest(pieces, reference), is_told=True)
        if told[link.body]
        else link
        for link in links
    ]


def _supports(pieces: Pieces, log_scale: Float) -> dict[tuple[int, int], list[_Support]]:
    """For each ordered pair of bodies the candidates between their pieces that ask for the places they have."""
    found: dict[tuple[int, int], list[_Support]] = {}
    feet: list[tuple[int, float, float]] = []

    def add(first: int, second: int, weight: float, kind: Kind) -> None:
        bodies = int(pieces.body[first]), int(pieces.body[second])
        found.setdefault(bodies, []).append(_Support(weight, kind, first, second))
        found.setdefault(bodies[::-1], []).append(_Support(weight, kind, second, first))

    for candidate in pieces.candidates:
        first, second = candidate.bodies
        weight = above_chance(candidate)
        if weight < LEAST_WEIGHT:
            continue
        if candidate.kind == "ground":
            feet.append((first, log_scale[pieces.body[first]] - candidate.log_ratio, weight * _share(pieces, first)))
            continue
        apart = log_scale[pieces.body[first]] - log_scale[pieces.body[second]] - candidate.log_ratio
        if pieces.body[first] != pieces.body[second] and abs(apart) < ASKS_FOR_IT:
            weight *= min(_share(pieces, first), _share(pieces, second))
            add(first, second, weight, candidate.kind)
    for number, (first, height, weight) in enumerate(feet):
        for second, other_height, other_weight in feet[:number]:
            if pieces.body[first] != pieces.body[second] and abs(height - other_height) < ONE_GROUND:
                add(first, second, min(weight, other_weight), "ground")
    return found


def _share(pieces: Pieces, piece: int) -> float:
    """The share of its weight that a candidate of a piece has."""
    return min(1.0, float(pieces.size[piece]) / FULL_PIECE)


def _largest(pieces: Pieces, body: int) -> int:
    """The largest piece of a body."""
    return int(np.where(pieces.body == body, pieces.size, -1).argmax())


def _kinds(support: dict[tuple[int, int], list[_Support]], body: int) -> int:
    """How many kinds of evidence tell of a body's place."""
    return len({
        each.kind for (first, _), own in support.items() if first == body for each in own if each.weight > TELLING
    })  # fmt: skip


def _by_the_map(mapped: MapPlaces | None, body: int) -> Features:
    """What the map's word is worth about a body, and how many widths it is off it; 0 without one, {} without a map."""
    if mapped is None:
        return {}
    off = abs(float(mapped.misfit[body])) / mapped.width
    told = np.isfinite(off)
    return {"map's word": mapped.worth if told else 0.0, "off the map": min(off, FARTHEST_OFF) if told else 0.0}
