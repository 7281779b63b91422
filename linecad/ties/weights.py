"""From candidates to ties: how much each is worth, by a table fitted to scenes of known depth."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linecad.arrays import Float, Int
from linecad.ties.candidates import SAME_RATIO, Candidate, Kind
from linecad.ties.table import AT_ONCE, LOG_ODDS
from solver.bodies.ties import Ties

BY_CHANCE = 0.05  # that a ratio which nothing asks for is right within TOLERANCE
CHANCE = float(np.log(BY_CHANCE / (1 - BY_CHANCE)))  # the same as log-odds
TOLERANCE = 0.02  # log ratio within which a tie holds
LEAST_WEIGHT = 2.0  # of a tie: weaker ones are so many that some always agree with a wrong place
REPEATING: tuple[Kind, ...] = ("plane", "level")
REPEATED = 0.6  # of the weight of planes, which repeat each other more than crossings do
OF_PIECES = 1 / 3  # of a tie's weight, that the look at pieces has
LEAST_OF_PIECES = 0.5  # what that must come to of a tie that pieces alone ask for: many of crumbs make the search long
FULL_SIZE = 30.0  # lines of the smaller body, from which a tie has its full weight: crumbs must not move walls
JOINED = 2.5  # weight of a bundle, from which on what hides the foot of one of its bodies hides that of the other
UNCLEAR = 0.4  # log-odds; feet below that are wrong in two cases of five, or more
SAME_FOOT = 0.1  # log height of the camera, within which unclear feet repeat each other
AGAIN = 0.5  # what is left of the weight of an unclear foot that repeats a heavier one of another body


def log_odds_of(candidate: Candidate) -> float:
    """Log-odds that the ratio is right."""
    known = LOG_ODDS[candidate.kind]
    return AT_ONCE[candidate.kind] + sum(known[name] * value for name, value in candidate.features.items())


def above_chance(candidate: Candidate) -> float:
    """By how much the log-odds of a candidate are above those of a ratio that nothing asks for."""
    return log_odds_of(candidate) - CHANCE


def worth_a_tie(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Those that add enough over chance."""
    return [candidate for candidate in candidates if above_chance(candidate) >= LEAST_WEIGHT]


def weigh_candidates(candidates: Sequence[Candidate], size: Int) -> Ties:
    """The ties of bodies of `size` (B,) lines, one for each candidate that is `worth_a_tie`, in their order."""
    chosen = worth_a_tie(candidates)
    with_ground = np.append(size, size.sum())  # the ground is no crumb
    smaller = np.array([with_ground[list(candidate.bodies)].min() for candidate in chosen], np.float64)
    repeated = np.array([REPEATED if candidate.kind == "plane" else 1.0 for candidate in chosen])
    gain = np.array([above_chance(candidate) for candidate in chosen])
    weight: Float = gain * np.minimum(1.0, smaller / FULL_SIZE) * repeated
    return Ties(
        bodies=np.array([candidate.bodies for candidate in chosen]).reshape(-1, 2),
        log_ratio=np.array([candidate.log_ratio for candidate in chosen]),
        tolerance=np.full(len(chosen), TOLERANCE),
        weight=weight,
        group=np.array([_group_of(candidate) for candidate in chosen]),
    )


def _group_of(candidate: Candidate) -> int:
    """The same number for all candidates that repeat each other, -1 for others."""
    if candidate.kind not in REPEATING:
        return -1
    return REPEATING.index(candidate.kind) + len(REPEATING) * (candidate.normal + 1)


def mean_of_looks(
    whole: tuple[Ties, list[Candidate]], pieces: tuple[Ties, list[Candidate]]
) -> tuple[Ties, list[Candidate]]:
    """Ties of bodies by what these show as wholes and by what their pieces show, and the candidate that each is of.

    What both ask for is one tie, at the ratio of the wholes. What one look alone shows has its share of the weight.
    """
    (ties, candidates), (others, told) = whole, pieces
    weight, alone = ties.weight * (1 - OF_PIECES), []
    free = np.ones(len(ties), bool)
    for number in range(len(others)):
        same = (ties.bodies == others.bodies[number]).all(axis=1) & (ties.group == others.group[number])
        off = np.where(free & same, np.abs(ties.log_ratio - others.log_ratio[number]), np.inf)
        worth = OF_PIECES * float(others.weight[number])
        if off.min(initial=np.inf) < SAME_RATIO:
            weight[off.argmin()] += worth
            free[off.argmin()] = False
        elif worth >= LEAST_OF_PIECES:
            alone.append(number)
    added = others.subset(np.array(alone, np.int64))
    mean = replace(ties, weight=weight).joined(replace(added, weight=OF_PIECES * added.weight))
    return mean, [*candidates, *(told[number] for number in alone)]


def with_feet_once(ties: Ties, candidates: Sequence[Candidate]) -> Ties:
    """The ties, each of one of the candidates, where unclear feet that repeat each other count little more than one.

    What hides the foot of a wall, a hedge or a row of cars, goes on before all bodies of that wall, and looks like a
    foot at the same height of each of them. A clear foot is a witness of its own.
    """
    part, shift = _hanging_together(ties, candidates)
    weight, heavier = ties.weight.copy(), dict[int, list[tuple[int, float]]]()
    for number in np.argsort(-ties.weight, kind="stable").tolist():
        if candidates[number].kind == "ground" and log_odds_of(candidates[number]) < UNCLEAR:
            body = int(ties.bodies[number, 0])
            height = float(ties.log_ratio[number] - shift[body])
            others = heavier.setdefault(int(part[body]), [])
            # Two feet of one body are rivals.
            if any(other != body and abs(height - of_other) < SAME_FOOT for other, of_other in others):
                weight[number] *= AGAIN
            others.append((body, height))
    return replace(ties, weight=weight)


def _hanging_together(ties: Ties, candidates: Sequence[Candidate]) -> tuple[Int, Float]:
    """The part (B,) that each body is in by strong bundles, and its log scale (B,) in that by the heaviest of them."""
    count = int(ties.bodies.max(initial=-1)) + 1
    part, shift = np.arange(count), np.zeros(count)
    bundles = [number for number, each in enumerate(candidates) if each.kind == "bundle"]
    strong = np.array([number for number in bundles if ties.weight[number] >= JOINED], np.int64)
    for number in strong[np.argsort(-ties.weight[strong], kind="stable")].tolist():
        first, second = ties.bodies[number]
        if part[first] != part[second]:
            own = part == part[second]
            shift[own] += shift[first] - shift[second] - ties.log_ratio[number]
            part[own] = part[first]
    return part, shift
