"""Sets of bodies that may move together, and parts, against the plain way to find them."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from linecad.arrays import Bool, Int
from solver.bodies.local_search import sets_that_move
from solver.bodies.ties import Ties

COUNT = 7  # bodies

PAIRS = st.lists(
    st.tuples(st.integers(0, COUNT - 1), st.integers(0, COUNT - 1)).filter(lambda pair: pair[0] != pair[1])
)


def ties_of(pairs: list[tuple[int, int]]) -> Ties:
    """Ties of ratio 0, some of which join the same bodies."""
    ones = np.ones(len(pairs))
    bodies = np.array(pairs, np.int64).reshape(-1, 2)
    return Ties(bodies, 0.0 * ones, 0.1 * ones, ones, np.full(len(pairs), -1))


def reached(pairs: list[tuple[int, int]], start: int) -> set[int]:
    """All that pairs lead to from a body."""
    found = {start}
    while more := {other for pair in pairs for other in pair if found & {*pair}} - found:
        found |= more
    return found


def mask(bodies: set[int]) -> Bool:
    return np.isin(np.arange(COUNT), sorted(bodies))


@given(PAIRS)
def test_parts_are_numbered_by_their_first_bodies(pairs: list[tuple[int, int]]) -> None:
    firsts = [min(reached(pairs, body)) for body in range(COUNT)]
    part: Int = ties_of(pairs).parts(np.ones(len(pairs), bool), COUNT)
    assert part.tolist() == [sorted(set(firsts)).index(first) for first in firsts]


@given(PAIRS, st.lists(st.sampled_from([0.0, 1.0]), min_size=COUNT, max_size=COUNT))
def test_sets_that_move_are_bodies_parts_and_both_sides_of_each_cut(
    pairs: list[tuple[int, int]], places: list[float]
) -> None:
    held = sorted({(min(pair), max(pair)) for pair in pairs if places[pair[0]] == places[pair[1]]})
    expected = [mask({body}) for body in range(COUNT)]
    parts = sorted({tuple(sorted(reached(held, body))) for body in range(COUNT)})
    expected += [mask(set(part)) for part in parts if 1 < len(part) < COUNT]
    for pair in held:
        left = [other for other in held if other != pair]
        if pair[1] not in reached(left, pair[0]):
            expected += [mask(reached(left, body)) for body in pair]
    found = sets_that_move(ties_of(pairs), np.array(places))
    assert [each.tolist() for each in found] == [each.tolist() for each in expected]
