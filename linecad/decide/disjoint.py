"""Paths that share no line: how many independent ways lead from one node of a graph to others (Menger's theorem)."""

from collections import deque
from collections.abc import Collection, Mapping

Neighbours = Mapping[int, Collection[int]]


def disjoint_paths(neighbours: Neighbours, start: int, goals: Collection[int], limit: int, joint: bool = False) -> int:
    """How many paths lead from `start` to `goals` without a common node but `start`, at most `limit`.

    Each goal ends one path at most, all that reach it if `joint`; no path goes through a goal. Augmenting paths over
    nodes split into an entry and an exit (Ford and Fulkerson): a way into a node that is taken leads back along its
    path.
    """
    after: dict[int, set[int]] = {start: set()}  # of each node on a path the next one; of the start, the next ones
    before: dict[int, int] = {}
    for count in range(limit):
        steps = _augmenting(neighbours, start, goals, after, before, joint)
        if not steps:
            return count
        for tail, head, forward in steps:
            if not forward:
                after[tail].discard(head)
                if before.get(head) == tail:
                    del before[head]
        for tail, head, forward in steps:
            if forward:
                after.setdefault(tail, set()).add(head)
                if not (joint and head in goals):
                    before[head] = tail
    return limit


def _augmenting(
    neighbours: Neighbours,
    start: int,
    goals: Collection[int],
    after: dict[int, set[int]],
    before: dict[int, int],
    joint: bool,
) -> list[tuple[int, int, bool]]:
    """The arcs (from, to, taken or given back) of one more path; none when there is none."""
    came: dict[tuple[int, bool], tuple[int, bool]] = {}  # state: node, at its exit
    waiting = deque([(start, True)])
    while waiting:
        state = node, at_exit = waiting.popleft()
        reached: list[tuple[int, bool]] = []
        if at_exit:
            for other in neighbours[node]:
                if other == start or other in after.get(node, ()):
                    continue
                if other in goals and (joint or other not in before):
                    came[other, False] = state
                    return _arcs(came, (other, False), (start, True))
                reached.append((other, False))
            if node in before:
                reached.append((node, False))
        elif node in before:
            if before[node] != start:
                reached.append((before[node], True))
        elif node not in goals:
            reached.append((node, True))
        for one in reached:
            if one not in came:
                came[one] = state
                waiting.append(one)
    return []


def _arcs(
    came: dict[tuple[int, bool], tuple[int, bool]], last: tuple[int, bool], first: tuple[int, bool]
) -> list[tuple[int, int, bool]]:
    arcs = []
    state = last
    while state != first:
        earlier = came[state]
        if earlier[0] != state[0]:
            arcs.append((earlier[0], state[0], True) if earlier[1] else (state[0], earlier[0], False))
        state = earlier
    return arcs
