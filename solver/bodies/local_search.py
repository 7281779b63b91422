"""A good placement in a fraction of a second, and how much worse every other place of a body is."""

import numpy as np

from linecad.arrays import Bool, Float, Int
from solver.bodies.ties import Ties

RESTARTS = 3
JUMP = 0.3  # log scale, one standard deviation, of the bodies that a restart moves
MOST_JUMPS = 3  # bodies
SAME_MOVE = 0.004  # log scale: moves nearer than this are one
MOST_MOVES = 60  # of one set of bodies, the heaviest ties first
LEAST_GAIN = 1e-9
ELSEWHERE = 0.05  # log scale: a body that moves less is where it was


def improve(ties: Ties, start: Float, seed: int) -> Float:
    """Log scales (B,) that no move of one set of bodies improves, from `start` and a few seeded restarts."""
    random = np.random.default_rng(seed)
    best, worth = climb(ties, start)
    for _ in range(RESTARTS):
        jumped = best.copy()
        chosen = random.integers(0, len(best), random.integers(1, MOST_JUMPS + 1))
        jumped[chosen] += random.normal(0, JUMP, len(chosen))
        found, value = climb(ties, jumped)
        if value > worth + LEAST_GAIN:
            best, worth = found, value
    return best


def climb(ties: Ties, start: Float) -> tuple[Float, float]:
    """Log scales (B,) that no move of one set of bodies improves, from `start`, and what they are worth."""
    scale, value = start.copy(), ties.value(start)
    improved = True
    while improved:
        improved = False
        for moved in sets_that_move(ties, scale):
            by, worth = _best_move(ties, scale, moved, 0.0)
            if worth > value + LEAST_GAIN:
                scale[moved] += by
                value, improved = worth, True
    return scale, value


def margins(ties: Ties, log_scale: Float, reference: int) -> Float:
    """(B,) by how much the weight falls at least where a body is moved by ELSEWHERE or more against the reference.

    Moves of one set of bodies are tried, to ratios that ties ask for: each body alone, with those that ties hold to
    it, and with those on its side of a cut. Other moves might lose less, so this is an upper bound. 0 for bodies that
    no tie leads to; the reference has the largest of all.
    """
    value = ties.value(log_scale)
    margin = np.full(len(log_scale), np.inf)
    for moved in sets_that_move(ties, log_scale):
        if moved[reference]:
            continue
        _, worth = _best_move(ties, log_scale, moved, ELSEWHERE)
        margin[moved] = np.minimum(margin[moved], max(0.0, value - worth))
    reached = ties.parts(np.ones(len(ties), bool), len(log_scale))
    margin[reached != reached[reference]] = 0.0
    finite = margin[np.isfinite(margin)]
    margin[~np.isfinite(margin)] = finite.max() if len(finite) else 0.0
    margin[reference] = margin.max(initial=0.0)
    return margin


def _best_move(ties: Ties, log_scale: Float, moved: Bool, least: float) -> tuple[float, float]:
    """The best shift of a set of bodies by `least` at least to a ratio that some tie asks for, and what all is worth.

    Nothing but the ties across changes by a move; a move to nowhere loses them all.
    """
    first, second = ties.bodies.T
    across = np.flatnonzero(moved[first] != moved[second])
    sign = np.where(moved[first[across]], 1.0, -1.0)
    shifts = sign * (ties.log_ratio[across] - log_scale[first[across]] + log_scale[second[across]])
    tried: list[float] = []
    best = (0.0, -np.inf)
    if least > 0:
        within = np.ones(len(ties), bool)
        within[across] = False
        best = (least, ties.subset(within).value(log_scale))
    for shift in shifts[np.argsort(-ties.weight[across], kind="stable")].tolist():
        if abs(shift) < max(least, LEAST_GAIN) or any(abs(shift - other) < SAME_MOVE for other in tried):
            continue
        tried.append(shift)
        worth = ties.value(np.where(moved, log_scale + shift, log_scale))
        if worth > best[1] + LEAST_GAIN:
            best = (shift, worth)
        if len(tried) == MOST_MOVES:
            break
    return best


def sets_that_move(ties: Ties, log_scale: Float) -> list[Bool]:
    """Sets of bodies (B,) that may move together: each alone, those that ties hold together, both sides of a cut."""
    count = len(log_scale)
    holds = ties.holds(log_scale)
    group = ties.parts(holds, count)
    sets = [np.arange(count) == body for body in range(count)]
    sets += [group == number for number in np.unique(group) if 1 < (group == number).sum() < count]
    for one, other, beyond in _bridges(np.unique(np.sort(ties.bodies[holds], axis=1), axis=0), count):
        here = group == group[one]
        sets += [here & (beyond == beyond[one]), here & (beyond == beyond[other])]
    return sets


def _bridges(pairs: Int, count: int) -> list[tuple[int, int, Bool]]:
    """Those of the pairs (P, 2) of `count` bodies without which a part falls apart, in their order.

    Each with the bodies (B,) on one side of it; the other side is the rest of the part.
    """
    beside: list[list[int]] = [[] for _ in range(count)]
    for one, other in pairs.tolist():
        beside[one].append(other)
        beside[other].append(one)
    # Depth first: `place` is when a body was reached, `back` the first place that what was reached from it leads to.
    place, back, parent = [-1] * count, [0] * count, [-1] * count
    reached: list[int] = []
    cut: dict[tuple[int, int], Bool] = {}
    for start in range(count):
        waiting = [(start, iter(beside[start]))] if place[start] < 0 else []
        while waiting:
            body, others = waiting[-1]
            if place[body] < 0:
                place[body] = back[body] = len(reached)
                reached.append(body)
            for other in others:
                if place[other] < 0:
                    parent[other] = body
                    waiting.append((other, iter(beside[other])))
                    break
                if other != parent[body]:
                    back[body] = min(back[body], place[other])
            else:
                waiting.pop()
                if parent[body] < 0:
                    continue
                back[parent[body]] = min(back[parent[body]], back[body])
                if back[body] == place[body]:
                    beyond = np.zeros(count, bool)
                    beyond[reached[place[body] :]] = True
                    cut[min(body, parent[body]), max(body, parent[body])] = beyond
    return [(one, other, beyond) for (one, other), beyond in sorted(cut.items(), key=lambda each: each[0])]
