"""Which rectangles are taken: of those that overlap in the photo none twice, the most in sum, exactly."""

from dataclasses import dataclass

import numpy as np
import shapely
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from linecad.arrays import Bool, Float, Int
from linecad.model.openings.quads import shared_areas

SHARED = 0.1  # of the smaller of two openings, from which they overlap in the photo
MOST_NODES = 10_000  # of a search; the largest of 50 photos were solved at the first
OPTIMAL = 0  # the status of milp where nothing is better

# Polygons of four corners, convex as rectangles of walls are in a photo.
Shapes = np.ndarray[tuple[int], np.dtype[np.object_]]


@dataclass(frozen=True, eq=False)
class Choice:
    """Which rectangles are taken, and how sure it is that no other choice is better."""

    taken: Int  # (M,) their places, ascending
    gap: float  # how much more another choice may be worth, as a share of this one; 0 where this is proven best

    @property
    def notes(self) -> tuple[str, ...]:
        """A note for people where the search ended at its limit."""
        if self.gap == 0:
            return ()
        return (f"windows and doors: another choice of them may be up to {self.gap:.1%} better; not proven",)


def choose(shapes: list[shapely.Polygon], log_odds: Float) -> Choice:
    """Which of shapes (N,) in the photo, convex and of four corners each, are taken.

    `log_odds` are above those of a rectangle that is as well left out. Openings of different walls compete too, since
    each pixel shows one of them. They count by the size of a shape, as long as its outline is: each opening is told by
    its outline, and the panes of a window, each nearly as likely as the whole, would outweigh it else.
    """
    every = np.array(shapes, object)
    value = log_odds * np.sqrt(shapely.area(every))
    taken = value > 0
    pairs = overlapping(every)
    pairs = pairs[taken[pairs].all(axis=1)]
    graph = coo_array((np.ones(len(pairs), np.int8), pairs.T), (len(every), len(every)))
    count, group = connected_components(graph, directed=False)
    group_of_pair = group[pairs[:, 0]]
    more = 0.0
    for number in np.flatnonzero(np.bincount(group, minlength=count) > 1).tolist():
        members = np.flatnonzero(group == number)
        inside = np.searchsorted(members, pairs[group_of_pair == number])
        taken[members], unproven = heaviest_set(value[members], inside)
        more += unproven
    return Choice(np.flatnonzero(taken), more / float(value[taken].sum()) if more > 0 else 0.0)


def overlapping(shapes: Shapes) -> Int:
    """The pairs (P, 2), the lower place first, of shapes (N,) of which only one can be taken."""
    first, second = shapely.STRtree(shapes).query(shapes)
    first, second = first[first < second], second[first < second]
    found: Int = np.column_stack([first, second])[_share(shapes[first], shapes[second])]
    return found


def not_overlapping(shapes: list[shapely.Polygon], others: list[shapely.Polygon]) -> Bool:
    """Which shapes (N,) overlap none of the others in the photo."""
    one, other = np.array(shapes, object), np.array(others, object)
    first, second = shapely.STRtree(other).query(one).reshape(2, -1) if len(one) else np.zeros((2, 0), np.int64)
    free = np.ones(len(one), bool)
    free[first[_share(one[first], other[second])]] = False
    return free


def _share(one: Shapes, other: Shapes) -> Bool:
    """Which pairs of shapes (P,) overlap by so much that only one of them can be taken."""
    shared = shared_areas(_corners(one), _corners(other))
    return np.asarray(shared > SHARED * np.minimum(shapely.area(one), shapely.area(other)))


def _corners(shapes: Shapes) -> Float:
    """The corners (P, 4, 2) of quadrilaterals (P,)."""
    corners: Float = shapely.get_coordinates(shapes).reshape(-1, 5, 2)[:, :4]
    return corners


def heaviest_set(value: Float, pairs: Int) -> tuple[Bool, float]:
    """The mask (N,) of the ones of most value (N,) in sum of which no two are a pair (P, 2); all above 0.

    And how much more another set may be worth: above 0 only where the search ended at MOST_NODES.
    """
    if 2 * len(pairs) == len(value) * (len(value) - 1):
        # All overlap all others, as most groups do: one is taken.
        return np.arange(len(value)) == value.argmax(), 0.0
    cliques = _cliques(len(value), pairs)
    row = np.repeat(np.arange(len(cliques)), [len(clique) for clique in cliques])
    rows = coo_array((np.ones(len(row)), (row, np.concatenate(cliques))), (len(cliques), len(value))).tocsr()
    found = milp(
        -value,
        constraints=LinearConstraint(rows, ub=1.0),
        integrality=np.ones(len(value)),
        bounds=Bounds(0, 1),
        options={"node_limit": MOST_NODES, "mip_rel_gap": 0.0},
    )
    # To take none is an answer, so that there is always one.
    assert found.x is not None, found.message
    taken = np.asarray(found.x > 0.5)
    more = 0.0 if found.status == OPTIMAL else -float(found.mip_dual_bound) - float(value[taken].sum())
    return taken, max(more, 0.0)


def _cliques(count: int, pairs: Int) -> list[list[int]]:
    """Groups of which all are pairs, such that each pair is in one: of a group one is taken, which is a tight bound."""
    near: list[set[int]] = [set() for _ in range(count)]
    for a, b in pairs.tolist():
        near[a].add(b)
        near[b].add(a)
    seen: set[tuple[int, int]] = set()
    cliques = []
    for a, b in pairs.tolist():
        if (a, b) in seen:
            continue
        clique = [a, b]
        for other in sorted(near[a] & near[b]):
            if near[other].issuperset(clique):
                clique.append(other)
        clique.sort()
        seen.update((one, two) for place, one in enumerate(clique) for two in clique[place + 1 :])
        cliques.append(clique)
    return cliques
