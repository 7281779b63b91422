"""Where else a body could stand: the places that evidence asks for, with what each is worth against the one it has."""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.ties.candidates import Candidate
from linecad.ties.evidence import Evidence
from linecad.ties.facts import FactTies, ties_of_facts
from linecad.ties.placing import BodyPlaces, kept_candidates, tie_up
from linecad.ties.sides import extended, part_off
from linecad.ties.weights import above_chance
from solver.bodies.local_search import sets_that_move
from solver.bodies.ties import Ties

SAME_PLACE = 0.01  # log scale within which two places are one
MOST = 12


@dataclass(frozen=True, eq=False)
class OtherPlace:
    """A place that a body does not have."""

    move: float  # log factor by which it and what goes with it would move away from the camera
    moved: Bool  # (B,) the bodies that go along
    worth: float  # log-odds against the place that the body has; negative where that is more likely
    reasons: tuple[Candidate, ...]  # what asks for it, the most telling first


@dataclass(frozen=True, eq=False)
class _Standing:
    """Bodies where they stand, and what ties them."""

    evidence: Evidence
    told: FactTies
    ties: Ties
    log_scale: Float  # (B,) of bodies, ground and map


def other_places(places: BodyPlaces, body: int) -> list[OtherPlace]:
    """The places that other evidence asks for, the most likely first; MOST at most, none for the reference.

    Each is that of a set of bodies which moves as a whole, of all such sets the one that loses least. Evidence that is
    too weak for a tie may be all there is: it proposes places, and orders those that cost the same.
    """
    return _elsewhere(_Standing(places.evidence, places.told, places.ties, places.placement.log_scale), body)


def other_places_of(places: BodyPlaces, part: Int) -> list[OtherPlace]:
    """The same for a part of a body, by its lines, which is a body of its own there: the last one."""
    evidence = part_off(places.evidence, part)
    told = ties_of_facts(evidence.setting, places.facts)
    log_scale = extended(places.placement.log_scale, places.evidence.setting.bodies, evidence)
    ties, _ = tie_up(evidence, places.facts, told)
    return _elsewhere(_Standing(evidence, told, ties, log_scale), evidence.setting.bodies.count - 1)


def _elsewhere(places: "_Standing", body: int) -> list[OtherPlace]:
    evidence, ties, log_scale = places.evidence, places.ties, places.log_scale
    kept = kept_candidates(evidence, places.told.cuts)
    if body == evidence.reference or not kept:
        return []
    first, second = np.array([each.bodies for each in kept], np.int64).T
    asked, gain = np.array([each.log_ratio for each in kept]), np.array([above_chance(each) for each in kept])
    now = ties.value(log_scale)
    found: list[OtherPlace] = []
    for moved in _sets(places, body):
        across = np.flatnonzero((moved[first] != moved[second]) & (gain > 0))
        by = np.where(moved[first[across]], 1.0, -1.0)
        moves = by * (asked[across] - log_scale[first[across]] + log_scale[second[across]])
        for move in _distinct(moves, gain[across]):
            reasons = across[np.abs(moves - move) <= SAME_PLACE]
            worth = ties.value(np.where(moved, log_scale + move, log_scale)) - now
            ordered = sorted(reasons.tolist(), key=lambda number: -gain[number])
            found.append(OtherPlace(move, moved, worth, tuple(kept[number] for number in ordered)))
    found.sort(key=lambda place: (-place.worth, -sum(map(above_chance, place.reasons)), abs(place.move)))
    best: list[OtherPlace] = []
    for place in found:
        if all(abs(place.move - other.move) > SAME_PLACE for other in best):
            best.append(place)
    return best[:MOST]


def _sets(places: "_Standing", body: int) -> list[Bool]:
    """The sets of bodies that may move with a body while the reference stays."""
    count, reference = len(places.log_scale), places.evidence.reference
    every = [*sets_that_move(places.ties, places.log_scale), *_clusters(places)]
    own = {moved.tobytes(): moved for moved in every if moved[body] and not moved[reference]}
    return list(own.values()) or [np.arange(count) == body]


def _clusters(places: "_Standing") -> list[Bool]:
    """Sets of bodies (B,) that hold together more than each does to the rest: single linkage by the ties that hold.

    A block that several ties hold to the reference has no cut of one tie, and moves as a whole all the same.
    """
    ties, count = places.ties, len(places.log_scale)
    weight: dict[tuple[int, int], float] = {}
    for tie in np.flatnonzero(ties.holds(places.log_scale)).tolist():
        one, other = sorted(ties.bodies[tie].tolist())
        weight[one, other] = weight.get((one, other), 0.0) + float(ties.weight[tie])
    cluster, found = np.arange(count), []
    for one, other in sorted(weight, key=lambda pair: (-weight[pair], pair)):
        if cluster[one] != cluster[other]:
            cluster[cluster == cluster[other]] = cluster[one]
            found.append(np.asarray(cluster == cluster[one]))
    return found


def _distinct(moves: np.ndarray, gain: np.ndarray) -> list[float]:
    """Moves to other places, of those nearer than SAME_PLACE the one that most asks for."""
    found: list[float] = []
    for number in np.argsort(-gain, kind="stable").tolist():
        move = float(moves[number])
        if abs(move) > SAME_PLACE and all(abs(move - other) > SAME_PLACE for other in found):
            found.append(move)
    return found
